#include <filesystem>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/field/difference.h"
#include "engine/formats/formats.h"
#include "engine/session/session.h"
#include "tests/engine/session/play.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::TempFolder;

std::string saved(const Session& session, const std::string& path) {
  JobControl job;
  const auto size = saveSession(session, path, job);
  return size ? "" : size.error().line();
}

Result<Session> opened(const std::string& path, const SessionOpenOptions& options = {}) {
  JobControl job;
  return openSession(path, options, importField, job);
}

RC_GTEST_PROP(Session, WhateverWasDoneComesBackBitForBit, ()) {
  const TempFolder folder;
  const int width = *rc::gen::element(1, 2, 63, 64, 65, 130, 600);
  const int height = *rc::gen::element(1, 3, 64, 128, 200);
  Play play(*rc::gen::arbitrary<std::uint64_t>(), width, height);
  const int actions = *rc::gen::inRange(0, 40);
  for (int a = 0; a < actions; ++a) play.act(nullptr);
  RC_ASSERT(saved(play.session, folder.file("a.fettle")) == "");
  const auto session = opened(folder.file("a.fettle"));
  if (!session) RC_FAIL(session.error().line());
  RC_ASSERT(difference(play.session, *session, Compare::kWhole) == "");
  // One file, and nothing next to it.
  RC_ASSERT(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST(Session, SavingIsSeenToAdvanceTileByTile) {
  const TempFolder folder;
  const Play play(3, 300, 200);
  JobControl job;
  ASSERT_TRUE(saveSession(play.session, folder.file("a.fettle"), job));
  EXPECT_STREQ(job.stage(), "writing the session");
  EXPECT_EQ(job.total(), 20U);
  EXPECT_EQ(job.done(), job.total());
}

TEST(Session, StatesShareInMemoryWhatTheySharedBefore) {
  const TempFolder folder;
  Play play(7, 700, 500);
  for (int a = 0; a < 60; ++a) play.act(nullptr);
  ASSERT_EQ(saved(play.session, folder.file("a.fettle")), "");
  const auto session = opened(folder.file("a.fettle"));
  ASSERT_TRUE(session);
  const History& a = play.session.history;
  const History& b = session->history;
  for (std::int64_t k = a.first() + 1; k <= a.last(); ++k)
    // A tile written with the bits it had is not stored, so there may be fewer.
    EXPECT_LE(changedTiles(b.state(k - 1), b.state(k)).size(),
              changedTiles(a.state(k - 1), a.state(k)).size());
  EXPECT_LE(b.bytes(), a.bytes());
}

TEST(Session, ABoundOnTheHistoryLoadsTheStepsNearestToTheCurrentState) {
  const TempFolder folder;
  Play play(3, 600, 400);
  while (play.session.history.last() < 30 || play.session.history.number() < 20) play.act(nullptr);
  ASSERT_EQ(saved(play.session, folder.file("a.fettle")), "");
  SessionOpenOptions options;
  options.history_bytes = 40 * sizeof(Tile);
  const auto session = opened(folder.file("a.fettle"), options);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_GT(session->history.first(), 0);
  EXPECT_LT(session->history.first(), session->history.number());
  EXPECT_EQ(difference(session->history.current(), play.session.history.current()), "");
  for (std::int64_t k = session->history.first(); k <= session->history.last(); ++k)
    EXPECT_EQ(difference(session->history.state(k), play.session.history.state(k)), "") << k;
  options.history_bytes = 0;
  options.journal = JournalReading::kLeave;
  const auto bare = opened(folder.file("a.fettle"), options);
  ASSERT_TRUE(bare);
  EXPECT_EQ(difference(bare->history.current(), play.session.history.current()), "");
  EXPECT_TRUE(bare->journal.empty());
}

TEST(Session, AHistoryThatForgotItsOldestStepsKeepsItsNumbers) {
  const TempFolder folder;
  Play play(11, 300, 200);
  while (play.session.history.last() < 12 || play.session.history.number() < 9) play.act(nullptr);
  std::vector<Version> dropped;
  play.session.history.setBound(1, dropped);
  const std::int64_t first = play.session.history.first();
  ASSERT_GT(first, 1);
  ASSERT_EQ(saved(play.session, folder.file("a.fettle")), "");
  const auto session = opened(folder.file("a.fettle"));
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(difference(play.session, *session, Compare::kHeldByBoth), "");
  EXPECT_EQ(session->history.info(first).name, "Earlier steps");
  EXPECT_EQ(difference(session->history.state(0), play.session.original), "");
}

TEST(Session, AHistoryThatDoesNotBeginWithTheScanIsRefused) {
  const TempFolder folder;
  Play play(5, 100, 100);
  play.session.history = History(play.session.original.inverted());
  EXPECT_NE(saved(play.session, folder.file("a.fettle")), "");
  EXPECT_FALSE(fs::exists(folder.file("a.fettle")));
}

// A scan on disk and a session that refers to it.
struct Referenced {
  TempFolder folder;
  std::string scan = folder.file("scan.tif");
  std::string path = folder.file("a.fettle");
  Play play{2, 200, 150};

  Referenced() {
    JobControl job;
    EXPECT_TRUE(exportField(play.session.original, scan, {}, job));
    const auto imported = importField(scan, {}, job);
    EXPECT_TRUE(imported);
    play.session.original = imported->field;
    play.session.history = History(imported->field);
    play.session.scan = {scan, {}, imported->format, {}};
    play.session.storage = OriginalStorage::kReferenced;
    for (int a = 0; a < 10; ++a) play.act(nullptr);
    EXPECT_EQ(saved(play.session, path), "");
  }
};

TEST(ReferencedScan, IsImportedAgainAndTheSessionHoldsOnlyWhatChanged) {
  Referenced r;
  const auto session = opened(r.path);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(difference(r.play.session, *session, Compare::kWhole), "");
  EXPECT_EQ(session->storage, OriginalStorage::kReferenced);
}

TEST(ReferencedScan, IsFoundWhereFolderAndSessionWentTogether) {
  Referenced r;
  fs::create_directory(r.folder.path() / "moved");
  fs::rename(r.scan, r.folder.path() / "moved/scan.tif");
  fs::rename(r.path, r.folder.path() / "moved/a.fettle");
  const auto session = opened((r.folder.path() / "moved/a.fettle").string());
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(difference(r.play.session, *session, Compare::kWhole), "");
}

TEST(ReferencedScan, ThatIsMissingOrAnotherIsSaid) {
  Referenced r;
  fs::rename(r.scan, r.folder.file("elsewhere.tif"));
  auto session = opened(r.path);
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().line().find("the scan of the session is missing: " + r.scan), std::string::npos)
      << session.error().line();
  SessionOpenOptions options;
  options.scan_path = r.folder.file("elsewhere.tif");
  EXPECT_TRUE(opened(r.path, options));

  JobControl job;
  ASSERT_TRUE(exportField(strangeField(99, 200, 150), r.scan, {}, job));
  session = opened(r.path);
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().line().find("its bytes differ"), std::string::npos) << session.error().line();
}

TEST(ReferencedScan, WithoutAFileCannotBeReferredTo) {
  const TempFolder folder;
  Play play(2, 20, 20);
  play.session.storage = OriginalStorage::kReferenced;
  EXPECT_NE(saved(play.session, folder.file("a.fettle")).find("no file that the session could refer to"),
            std::string::npos);
  play.session.scan.path = folder.file("none.tif");
  EXPECT_NE(saved(play.session, folder.file("a.fettle")), "");
  EXPECT_FALSE(fs::exists(folder.file("a.fettle")));
}

TEST(Session, KeepsHowTheScanWasImported) {
  const TempFolder folder;
  Play play(2, 20, 20);
  play.session.scan.path = folder.file("cloud.xyz");
  play.session.scan.format = "XYZ";
  play.session.scan.import.no_data = -9999.0;
  play.session.scan.import.spacing = {0.1, 1.0 / 3.0};
  play.session.scan.import.z_scale = -2.5;
  play.session.scan.import.unit = LengthUnit{"um", 1e-3};
  play.session.scan.import.cell_size = 0.7;
  play.session.scan.import.cell_rule = CellRule::kHighest;
  ASSERT_EQ(saved(play.session, folder.file("a.fettle")), "");
  const auto session = opened(folder.file("a.fettle"));
  ASSERT_TRUE(session) << session.error().line();
  const ImportOptions& a = play.session.scan.import;
  const ImportOptions& b = session->scan.import;
  EXPECT_EQ(a.no_data, b.no_data);
  EXPECT_EQ(a.spacing, b.spacing);
  EXPECT_EQ(a.z_scale, b.z_scale);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.cell_size, b.cell_size);
  EXPECT_EQ(a.cell_rule, b.cell_rule);
  EXPECT_EQ(session->scan.path, play.session.scan.path);
  EXPECT_EQ(session->scan.format, "XYZ");
}

TEST(Session, RealScansComeBackBitForBit) {
  for (const char* name : {"afm_line_noise_f32.tif", "dsm_ahn_buildings.tif", "shapes_plate_u16.png"}) {
    FETTLE_SCAN_OR_SKIP(path, name);
    const TempFolder folder;
    JobControl job;
    const auto scan = importField(path, {}, job);
    ASSERT_TRUE(scan);
    Session session;
    session.original = scan->field;
    session.history = History(scan->field);
    session.scan = {path, {}, scan->format, {}};
    ASSERT_EQ(saved(session, folder.file("a.fettle")), "");
    const auto back = opened(folder.file("a.fettle"));
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(difference(session, *back, Compare::kWhole), "") << name;
  }
}

}  // namespace
}  // namespace fettle::engine
