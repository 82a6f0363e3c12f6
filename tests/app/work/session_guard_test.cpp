// What a command does about sessions before it replaces a file.

#include <filesystem>

#include <gtest/gtest.h>

#include "app/work/open_document.h"
#include "app/work/recent_files.h"
#include "app/work/session_guard.h"
#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"
#include "tests/app/work/part.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;
using engine::OriginalStorage;

class Guard : public testing::Test {
 protected:
  Guard() {
    setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
    fs::create_directory(folder.file("scans"));
    fs::create_directory(folder.file("work"));
    for (const std::string& path : {scan, other_scan})
      EXPECT_TRUE(engine::exportField(path == scan ? roughPart() : roughPart().inverted(), path, {}, job));
  }
  void makeSession(const std::string& path, const std::string& of) {
    engine::JobControl own;
    const auto imported = engine::importField(of, {}, own);
    engine::Session session;
    session.scan = {of, {}, imported->format, {}};
    session.storage = OriginalStorage::kReferenced;
    session.original = imported->field;
    session.history = engine::History(imported->field);
    session.journal.push_back({R"({"do":"something"})", "", {}, 0});
    ASSERT_TRUE(engine::saveSession(session, path, own));
  }
  static bool holdsItsScan(const std::string& path) {
    const auto facts = engine::sessionFacts(path);
    return facts && facts->storage == OriginalStorage::kEmbedded;
  }

  TempFolder folder;
  engine::JobControl job;
  std::string scan = folder.file("scans/a.tif"), other_scan = folder.file("scans/b.tif");
};

TEST_F(Guard, GivesEachSessionOfAScanTheScanBeforeThatIsReplaced) {
  const std::string next_to_scan = folder.file("scans/a.fettle"), recent = folder.file("work/a.fettle");
  const std::string recovery = app::recoveryPath(scan), other = folder.file("scans/b.fettle");
  for (const std::string& path : {next_to_scan, recent, recovery}) makeSession(path, scan);
  makeSession(other, other_scan);
  app::RecentFiles(app::recentFile()).add(recent);
  app::ScanGuard guard;
  ASSERT_TRUE(guard.protectSessions(folder.file("scans/new.tif"), job));
  EXPECT_FALSE(holdsItsScan(next_to_scan));
  const auto spared = guard.protectSessions(scan, job);
  ASSERT_TRUE(spared) << spared.error().line();
  for (const std::string& path : {next_to_scan, recent, recovery}) EXPECT_TRUE(holdsItsScan(path)) << path;
  EXPECT_FALSE(holdsItsScan(other));
  fs::remove(scan);
  for (const std::string& path : {next_to_scan, recent, recovery}) {
    const auto session = engine::openSession(path, {}, engine::importField, job);
    ASSERT_TRUE(session) << session.error().line();
    EXPECT_EQ(engine::contentHash(session->original), engine::contentHash(roughPart()));
    EXPECT_EQ(session->journal.size(), 1U);
  }
}

TEST_F(Guard, RefusesWhileAnotherProgramWorksOnASessionOfTheScan) {
  makeSession(app::recoveryPath(scan), scan);
  const auto other = engine::SessionWriter::open(app::recoveryPath(scan), {}, {}, engine::importField, job);
  ASSERT_TRUE(other);
  app::ScanGuard guard;
  const auto refused = guard.protectSessions(scan, job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
  EXPECT_NE(refused.error().line().find("is working on the session"), std::string::npos)
      << refused.error().line();
  EXPECT_NE(refused.error().line().find(scan), std::string::npos) << refused.error().line();
}

TEST_F(Guard, LosesNoJournalWithoutBeingForcedTo) {
  const std::string path = folder.file("work/a.fettle");
  EXPECT_TRUE(app::refuseToLoseWork(path));
  ASSERT_TRUE(engine::exportField(roughPart(), path, {}, job));
  EXPECT_TRUE(app::refuseToLoseWork(path));  // nothing was done to it by hand
  makeSession(path, scan);
  const auto refused = app::refuseToLoseWork(path);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("--force"), std::string::npos) << refused.error().line();
  // What it is cannot be determined.
  fs::resize_file(path, 5000);
  EXPECT_FALSE(app::refuseToLoseWork(path));
  fs::resize_file(path, 0);
  EXPECT_TRUE(app::refuseToLoseWork(path));
}

}  // namespace
}  // namespace fettle::tests
