#include "app/files/reading_fields.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"

namespace fettle::app {
namespace {

TEST(ReadingFields, what_the_engine_says_of_options_is_said_of_the_fields_of_the_page) {
  EXPECT_EQ(inFieldWords("the file states no unit, mm is assumed: give it with --unit"),
            "the file states no unit, mm is assumed: set \"unit\"");
  EXPECT_EQ(inFieldWords("mm and 1 mm are assumed: give them with --unit and --spacing"),
            "mm and 1 mm are assumed: set \"unit\" and \"spacing\"");
  EXPECT_EQ(inFieldWords("if they are holes, give --no-data -9999"),
            "if they are holes, set \"no data\" to -9999");
  EXPECT_EQ(inFieldWords("if they are heights, give the height per count with --z-scale"),
            "if they are heights, give the height per count as \"z scale\"");
  EXPECT_EQ(inFieldWords("or give --unit if that is wrong"), "or set \"unit\" if that is wrong");
  EXPECT_EQ(inFieldWords("--cell-size sets them"), "\"cell size\" sets them");
  EXPECT_EQ(inFieldWords("two parts -- of one scan"), "two parts -- of one scan");
}

TEST(ReadingFields, a_guess_is_one_about_what_the_numbers_mean) {
  EXPECT_TRUE(isGuess("the file states no unit, mm is assumed: give it with --unit"));
  EXPECT_TRUE(isGuess("1 % of the samples are exactly 0 mm: if they are holes, give --no-data 0"));
  EXPECT_FALSE(isGuess("cells of 2.5 ft estimated from their density: --cell-size sets them"));
  EXPECT_FALSE(isGuess("heights have more digits than a float holds"));
  EXPECT_FALSE(anyGuess({}));
  EXPECT_TRUE(anyGuess({"heights", "give --unit"}));
}

TEST(ReadingFields, what_was_said_is_told_by_the_names_of_the_fields) {
  ScanOptions reading;
  EXPECT_EQ(readingText(reading), "");
  reading.unit = "mm";
  reading.no_data = 0.0;
  EXPECT_EQ(readingText(reading), "unit mm, no data 0");
  reading.spacing = {0.25, 0.5};
  EXPECT_EQ(readingText(reading), "spacing 0.25 x 0.5, unit mm, no data 0");
}

TEST(ReadingFields, it_is_told_what_the_file_said_and_what_a_person_said) {
  const std::vector<std::string> no_unit{
      "the file states no height unit, mm is assumed: give it with --unit"};
  const FieldsThatApply raster = fieldsThatApply("GTiff", true);
  const ReadingSources guessed = readingSources({}, no_unit, raster);
  EXPECT_EQ(guessed.file, "from the file: spacing");
  EXPECT_EQ(guessed.person, "");
  const std::vector<std::string> doubt{
      "heights in um where mm is stated or assumed? give --z-scale 0.001 or --spacing"};
  EXPECT_EQ(readingSources({}, doubt, raster).file, "from the file: spacing, unit") << "a doubt is no guess";
  ScanOptions said;
  said.unit = "um";
  const ReadingSources both = readingSources(said, {}, raster);
  EXPECT_EQ(both.file, "from the file: spacing");
  EXPECT_EQ(both.person, "as you say: unit um");
  EXPECT_EQ(readingSources({}, {}, fieldsThatApply("LAS", false)).file, "from the file: unit")
      << "points have no spacing";
}

TEST(ReadingFields, only_what_can_apply_to_a_format_is_asked) {
  EXPECT_TRUE(fieldsThatApply("PNG", true).camera);
  EXPECT_FALSE(fieldsThatApply("PNG", false).camera) << "no counts";
  EXPECT_FALSE(fieldsThatApply("X3P", true).camera);
  EXPECT_FALSE(fieldsThatApply("GTiff", true).cells);
  EXPECT_TRUE(fieldsThatApply("PLY", false).cells);
  // Text may be a matrix or points, until it is read.
  EXPECT_TRUE(fieldsOfName("a.txt").cells);
  EXPECT_TRUE(fieldsOfName("a.txt").spacing);
  EXPECT_FALSE(fieldsOfName("a.tif").cells);
  EXPECT_FALSE(fieldsOfName("a.las").spacing);
  EXPECT_TRUE(fieldsOfName("a").spacing);
  // The names are those of the table of formats.
  const auto formats = engine::formats();
  for (const char* name : {"PLY", "PCD", "LAS", "XYZ", "STL", "GTiff", "PNG"})
    EXPECT_TRUE(std::ranges::any_of(formats, [&](const auto& format) { return format.name == name; }))
        << name;
}

}  // namespace
}  // namespace fettle::app
