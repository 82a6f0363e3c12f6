// Sessions among the formats of scans.

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

TEST(SessionFormat, AFieldGoesInAndComesOutWithMarksAndSign) {
  const TempFolder folder;
  JobControl job;
  const Version field = strangeField(3, 333, 200);
  for (const Version& v : {field, field.inverted()}) {
    const auto written = exportField(v, folder.file("a.fettle"), {}, job);
    ASSERT_TRUE(written) << written.error().line();
    EXPECT_EQ(written->format, "Fettle");
    const auto read = importField(folder.file("a.fettle"), {}, job);
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(read->format, "Fettle");
    EXPECT_EQ(difference(v, read->field), "");
  }
}

TEST(SessionFormat, AWorkedOnSessionReadsAsItsCurrentState) {
  const TempFolder folder;
  JobControl job;
  Play play(3, 200, 200);
  for (int a = 0; a < 30; ++a) play.act(nullptr);
  ASSERT_TRUE(saveSession(play.session, folder.file("a.fettle"), job));
  // The content decides, whatever the name.
  std::filesystem::rename(folder.file("a.fettle"), folder.file("a.tif"));
  const auto read = importField(folder.file("a.tif"), {}, job);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(difference(play.session.history.current(), read->field), "");
}

TEST(SessionFormat, AFieldIsAStepFromTheOriginalThatItWasMadeFrom) {
  const TempFolder folder;
  JobControl job;
  const std::string path = folder.file("a.fettle");
  const Version original = strangeField(3, 333, 200), made = strangeField(4, 333, 200);
  for (const bool inverted : {false, true}) {
    const auto turned = [&](const Version& v) { return inverted ? v.inverted() : v; };
    ExportOptions options;
    options.original = turned(original);
    ASSERT_TRUE(exportField(turned(made), path, options, job));
    auto read = importField(path, {}, job);
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(difference(turned(made), read->field), "");
    ASSERT_TRUE(read->original);
    EXPECT_EQ(difference(turned(original), *read->original), "");
    const auto session = openSession(path, {}, importField, job);
    ASSERT_TRUE(session) << session.error().line();
    EXPECT_EQ(session->history.number(), inverted ? 2 : 1);
    EXPECT_EQ(difference(original, session->original), "");
    // What was made of a session keeps its original, whatever is said of the grid.
    ImportOptions other_unit;
    other_unit.unit = lengthUnitFromName("um");
    read = importField(path, other_unit, job);
    ASSERT_TRUE(read);
    EXPECT_TRUE(read->original->grid() == read->field.grid());
  }
  ASSERT_TRUE(exportField(made, path, {}, job));
  EXPECT_EQ(openSession(path, {}, importField, job)->history.number(), 0);
}

TEST(SessionFormat, OptionsThatDoNotApplyAreRefusedAndOthersWinWithAWarning) {
  const TempFolder folder;
  JobControl job;
  ASSERT_TRUE(exportField(strangeField(3, 20, 20), folder.file("a.fettle"), {}, job));
  ImportOptions options;
  options.z_scale = 2.0;
  EXPECT_FALSE(importField(folder.file("a.fettle"), options, job));
  options.z_scale.reset();
  options.spacing = {2.0, 3.0};
  const auto read = importField(folder.file("a.fettle"), options, job);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->field.grid().spacing_y, 3.0);
  EXPECT_EQ(read->warnings.size(), 1U);
}

}  // namespace
}  // namespace fettle::engine
