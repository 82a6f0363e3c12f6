// Text with a row of heights per line, as other programs write it.

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

constexpr int kWide = 20;  // more columns than points have

// Heights column + 100 * line, of `lines` lines, separated as wanted.
std::string rowsOf(int columns, int lines, std::string_view separator) {
  std::string text;
  for (int r = 0; r < lines; ++r) {
    for (int c = 0; c < columns; ++c)
      text += fmt::format("{}{}.5", c == 0 ? std::string_view() : separator, c + 100 * r);
    text += "\n";
  }
  return text;
}

void expectRows(const Imported& scan, int columns, int lines) {
  ASSERT_EQ(scan.format, "Matrix");
  ASSERT_EQ(scan.field.grid().width, columns);
  ASSERT_EQ(scan.field.grid().height, lines);
  for (int r = 0; r < lines; ++r)
    for (int c = 0; c < columns; ++c)
      ASSERT_EQ(stored(scan.field, r, c), static_cast<float>(c + 100 * r) + 0.5F)
          << "line " << r << ", column " << c;
}

TEST(Matrix, TheFirstLineIsTheTopWhateverSeparates) {
  const TempFolder folder;
  for (const std::string_view separator : {" ", "   ", "\t", ",", ";", ", ", " ; "})
    for (const char* name : {"a.txt", "a.csv", "a.dat", "a.asc", "a"}) {
      SCOPED_TRACE(fmt::format("\"{}\" in {}", separator, name));
      writeBytes(folder.file(name), rowsOf(kWide, 3, separator));
      FETTLE_LOAD(scan, folder.file(name));
      expectRows(scan, kWide, 3);
    }
}

TEST(Matrix, RowsAreLongerThanWhatIsReadToRecogniseThem) {
  const TempFolder folder;
  writeBytes(folder.file("a.txt"), rowsOf(3000, 2, "\t"));
  FETTLE_LOAD(scan, folder.file("a.txt"));
  expectRows(scan, 3000, 2);
}

TEST(Matrix, TitlesRemarksBlankLinesAndLineEndsAreNoHeights) {
  const TempFolder folder;
  std::string text = "\xef\xbb\xbfHeight image, 3 lines\n\n% made by hand\n\"Date\",\"Today\"\n" +
                     rowsOf(kWide, 3, ",") + "\n# the end\n";
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  writeBytes(folder.file("a.csv"), text);
  FETTLE_LOAD(scan, folder.file("a.csv"));
  expectRows(scan, kWide, 3);
}

TEST(Matrix, RemarksStateSizesAndTheUnitOfHeights) {
  const TempFolder folder;
  // As Gwyddion writes it; so few columns are a matrix only by these remarks.
  writeBytes(folder.file("a.txt"),
             "# Channel: Topography\n# Width: 10.0 \xc2\xb5m\n# Height: 0.006 mm\n# Value units: m\n"
             "1e-9\t2e-9\t3e-9\t4e-9\n5e-9\t6e-9\t7e-9\t8e-9\n9e-9\tnan\t11e-9\t12e-9\n");
  FETTLE_LOAD(scan, folder.file("a.txt"));
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(grid.width, 4);
  EXPECT_EQ(grid.height, 3);
  EXPECT_EQ(grid.lateral_unit.name, "um");
  EXPECT_DOUBLE_EQ(grid.spacing_x, 2.5);
  EXPECT_DOUBLE_EQ(grid.spacing_y, 2.0);
  EXPECT_EQ(grid.height_unit.name, "m");
  EXPECT_EQ(stored(scan.field, 0, 0), 1e-9F);
  EXPECT_EQ(stored(scan.field, 2, 3), 12e-9F);
  EXPECT_TRUE(std::isnan(stored(scan.field, 2, 1)));
  EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();

  // What a person says counts.
  ImportOptions options;
  options.spacing = std::pair{0.5, 0.25};
  options.unit = lengthUnitFromName("nm");
  FETTLE_LOAD(said, folder.file("a.txt"), options);
  EXPECT_EQ(said.field.grid().spacing_x, 0.5);
  EXPECT_EQ(said.field.grid().spacing_y, 0.25);
  EXPECT_EQ(said.field.grid().lateral_unit.name, "nm");

  writeBytes(folder.file("bare.txt"), rowsOf(kWide, 2, " "));
  FETTLE_LOAD(bare, folder.file("bare.txt"));
  EXPECT_TRUE(warned(bare.warnings, "--unit and --spacing"));
}

TEST(Matrix, EmptyFieldsAndWordsForNothingAreHoles) {
  const TempFolder folder;
  const std::string rest = ",1,2,3,4,5,6,7,8,9,10,11,12,13,14,15";
  writeBytes(folder.file("a.csv"), "nan,,NA,---,BAD" + rest + "\n,2,3,4,5" + rest + "\n1,2,3,4," + rest +
                                       "\n" + ",,,,," + ",,,,,,,,,,,,,,\n");
  FETTLE_LOAD(scan, folder.file("a.csv"));
  EXPECT_EQ(scan.field.grid().width, 20);
  EXPECT_EQ(scan.field.grid().height, 4);
  EXPECT_EQ(summarize(scan.field).no_data, 5 + 1 + 1 + 20);
  EXPECT_TRUE(std::isnan(stored(scan.field, 1, 0)));
  EXPECT_TRUE(std::isnan(stored(scan.field, 2, 4)));
  // Where the lines differ by it, a separator at the end of one stands before a hole.
  const std::string fifteen = "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15";
  writeBytes(folder.file("last.csv"), fifteen + ",\n" + fifteen + ",16\n" + fifteen + ",\n");
  FETTLE_LOAD(last, folder.file("last.csv"));
  ASSERT_EQ(last.field.grid().width, 17);
  EXPECT_TRUE(std::isnan(stored(last.field, 0, 16)));
  EXPECT_EQ(stored(last.field, 1, 16), 16.0F);
  EXPECT_TRUE(std::isnan(stored(last.field, 2, 16)));
  // A separator behind the last field of every line begins no column; a first line without a height is one.
  writeBytes(folder.file("b.txt"), rowsOf(kWide, 2, "\t"));
  std::string text = readBytes(folder.file("b.txt"));
  std::string nothing;
  for (int c = 0; c < kWide; ++c) nothing += "NaN\t";
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\t");
  writeBytes(folder.file("b.txt"), nothing + "\n" + text);
  FETTLE_LOAD(behind, folder.file("b.txt"));
  EXPECT_EQ(behind.field.grid().width, kWide);
  EXPECT_EQ(behind.field.grid().height, 3);
  EXPECT_TRUE(std::isnan(stored(behind.field, 0, 0)));
  EXPECT_EQ(stored(behind.field, 1, 0), 0.5F);
}

TEST(Matrix, PointsStayPoints) {
  const TempFolder folder;
  const auto formatOf = [&](const char* name, const std::string& text) {
    writeBytes(folder.file(name), text);
    const auto scan = load(folder.file(name));
    return scan ? scan->format : scan.error().line();
  };
  const std::string ten = " 1 2 3 4 5 6 7\n";
  EXPECT_EQ(formatOf("a.txt", "0 0 1" + ten + "1 0 2" + ten + "0 1 3" + ten + "1 1 4" + ten), "XYZ");
  // Points of many columns: named in a line, in a remark; and by the file's name.
  std::string names = "x y z", values;
  for (int c = 3; c < kWide; ++c) names += fmt::format(" f{}", c), values += fmt::format(" {}", c);
  const std::string points =
      "0 0 1" + values + "\n1 0 2" + values + "\n0 1 3" + values + "\n1 1 4" + values + "\n";
  EXPECT_EQ(formatOf("named.txt", names + "\n" + points), "XYZ");
  EXPECT_EQ(formatOf("remark.txt", "//" + names + "\n" + points), "XYZ");
  EXPECT_EQ(formatOf("points.xyz", points), "XYZ");
  EXPECT_EQ(formatOf("bare.txt", points), "Matrix");
}

TEST(Matrix, WhatIsNoMatrixIsRefusedWithItsPlace) {
  const TempFolder folder;
  const auto errorOf = [&](const std::string& text) {
    writeBytes(folder.file("a.txt"), text);
    const auto scan = load(folder.file("a.txt"));
    return scan ? std::string("read") : scan.error().line();
  };
  const std::string rows = rowsOf(kWide, 3, " ");
  EXPECT_NE(errorOf(rows + "1 2 3\n").find("line 4 holds 3 heights, the first row 20"), std::string::npos);
  EXPECT_NE(errorOf(rows + rowsOf(kWide + 1, 1, " ")).find("line 4 holds 21 heights"), std::string::npos);
  std::string word = rows;
  word.replace(word.rfind("207.5"), 5, "seven");
  EXPECT_NE(errorOf(word).find("\"seven\" in line 3, column 8 is not a number"), std::string::npos);
  std::string comma = rowsOf(kWide, 3, ";");
  comma.replace(comma.rfind("207.5"), 5, "207,5");
  EXPECT_NE(errorOf(comma).find("decimal comma"), std::string::npos);
  std::string commas = rowsOf(kWide, 3, ";");
  for (char& c : commas) c = c == '.' ? ',' : c;
  EXPECT_NE(errorOf(commas).find("decimal comma"), std::string::npos);
  // Cut inside its last number it still reads as one.
  writeBytes(folder.file("cut.txt"), rows.substr(0, rows.size() - 2));
  FETTLE_LOAD(cut, folder.file("cut.txt"));
  EXPECT_TRUE(warned(cut.warnings, "may be cut short"));
}

TEST(Matrix, HeightsAreScaledAndRoundedOnce) {
  const TempFolder folder;
  std::string text = "1.0000000596046448";  // a little over the middle between 1 and the next float
  for (int c = 1; c < kWide; ++c) text += " 2";
  writeBytes(folder.file("a.txt"), text + "\n");
  FETTLE_LOAD(scan, folder.file("a.txt"));
  EXPECT_EQ(stored(scan.field, 0, 0), std::nextafter(1.0F, 2.0F));
  ImportOptions options;
  options.z_scale = 0.5;
  options.no_data = 2.0;
  FETTLE_LOAD(scaled, folder.file("a.txt"), options);
  EXPECT_EQ(stored(scaled.field, 0, 0), 0.5F);
  EXPECT_EQ(summarize(scaled.field).no_data, kWide - 1);
}

}  // namespace
}  // namespace fettle::engine
