// A command that would write over somebody's work, or over the scan that work refers to.

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "engine/session/session.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class Replacing : public testing::Test {
 protected:
  void SetUp() override {
    setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
    ASSERT_EQ(fettle({"synth", scan, "--size", "128x96"}).status, 0);
    ASSERT_EQ(fettle({"synth", other, "--size", "128x96", "--seed", "9"}).status, 0);
    // As the window leaves one: a step, its journal, and the scan by its path.
    engine::JobControl job;
    const auto imported = engine::importField(scan, {}, job);
    ASSERT_TRUE(imported);
    engine::Session session;
    session.scan = {scan, {}, imported->format, {}};
    session.storage = engine::OriginalStorage::kReferenced;
    session.original = imported->field;
    session.history = engine::History(imported->field);
    session.history.push({"Invert", engine::StepKind::kInvert, {}, {}, 0}, imported->field.inverted());
    session.journal.push_back({R"({"do":"something"})", "", {}, 1});
    ASSERT_TRUE(engine::saveSession(session, work, job));
  }
  [[nodiscard]] std::string hashOf(const std::string& path) const {
    return fettleJson({"filter", path, folder.file("same.tif"), "--filter", "box", "--window", "1"})["hash"];
  }

  TempFolder folder;
  std::string scan = folder.file("over.tif"), other = folder.file("other.tif");
  std::string work = folder.file("work.fettle");
};

TEST_F(Replacing, ConvertRefusesToReplaceASessionWithAJournalUnlessForced) {
  const std::string before = hashOf(work);
  for (const auto& command : std::vector<std::vector<std::string>>{
           {"convert", other, work},
           {"filter", other, work, "--filter", "box"},
           {"synth", work, "--size", "64x64"},
           {"compare", scan, other, "--deviation", work},
           {"convert", other, "--out-dir", folder.path(), "--to", "fettle"}}) {
    if (command[2] == "--out-dir") std::filesystem::copy_file(work, folder.file("other.fettle"));
    expectRefused(fettle(command), "has a journal of 1 entries and 1 step");
  }
  EXPECT_EQ(hashOf(work), before);
  ASSERT_EQ(fettle({"convert", other, work, "--force"}).status, 0);
  EXPECT_EQ(hashOf(work), hashOf(other));
  // One that a command made holds nobody's work.
  EXPECT_EQ(fettle({"convert", other, work}).status, 0);
}

TEST_F(Replacing, ASessionSurvivesThatItsScanIsWrittenOver) {
  const std::string before = hashOf(work);
  const Outcome baked = fettle({"convert", work, scan});
  ASSERT_EQ(baked.status, 0) << baked.err;
  EXPECT_NE(baked.err.find("over.tif: is the scan of the session"), std::string::npos) << baked.err;
  EXPECT_NE(hashOf(scan), hashOf(other));
  EXPECT_EQ(hashOf(work), before);
  // From now on it needs no file.
  std::filesystem::remove(scan);
  EXPECT_EQ(hashOf(work), before);
}

}  // namespace
}  // namespace fettle::tests
