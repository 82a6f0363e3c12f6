// Sessions among the formats of scans.

#include <gtest/gtest.h>

#include "engine/io/export.h"
#include "engine/io/import.h"
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
  // The content tells, whatever the name.
  std::filesystem::rename(folder.file("a.fettle"), folder.file("a.tif"));
  const auto read = importField(folder.file("a.tif"), {}, job);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(difference(play.session.history.current(), read->field), "");
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
