#include "app/work/session_guard.h"

#include <fstream>

#include <gtest/gtest.h>

#include "engine/session/session.h"
#include "tests/app/work/part.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using app::replacedFiles;

TEST(ReplacedFiles, AreThoseThatAreThereEachWithWhatGoes) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), marks = folder.file("new_marks.png");
  const std::string session_path = folder.file("work.fettle");
  std::ofstream(scan) << "scan";
  EXPECT_TRUE(replacedFiles({folder.file("new.tif"), marks}, scan).texts.empty());
  std::ofstream(marks) << "marks";
  const auto marks_only = replacedFiles({folder.file("new.tif"), marks}, scan);
  ASSERT_EQ(marks_only.texts.size(), 1U);
  EXPECT_EQ(marks_only.texts[0], "new_marks.png is there already.");
  EXPECT_FALSE(marks_only.scan);
  // By another spelling, too.
  const auto itself = replacedFiles({folder.file("./scan.tif")}, scan);
  ASSERT_EQ(itself.texts.size(), 1U);
  EXPECT_TRUE(itself.scan);
  EXPECT_NE(itself.texts[0].find("is the scan that is worked on"), std::string::npos);
  EXPECT_FALSE(replacedFiles({scan}, "").scan);

  engine::Session session;
  session.original = roughPart();
  session.history = engine::History(session.original);
  session.history.push({"Invert", engine::StepKind::kInvert, {}, {}, 0}, session.original.inverted());
  engine::JobControl job;
  ASSERT_TRUE(engine::saveSession(session, session_path, job));
  const auto work = replacedFiles({session_path}, scan);
  ASSERT_EQ(work.texts.size(), 1U);
  EXPECT_NE(work.texts[0].find("its 1 step and its journal"), std::string::npos) << work.texts[0];
}

}  // namespace
}  // namespace fettle::tests
