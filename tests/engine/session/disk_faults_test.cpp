// A disk that runs full or loses power at any moment of a session's life.

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"
#include "tests/engine/session/faulty_disk.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::TempFolder;

// Until the writer has nothing to do: all written, or an error.
SessionStatus settled(const SessionWriter& writer) {
  for (;;) {
    const SessionStatus status = writer.status();
    if (status.waiting == 0 || status.error) return status;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

std::int64_t next(std::int64_t n) {
  return n < 12 ? n + 1 : n + n / 4;
}

class FaultAtEveryOperation : public testing::TestWithParam<FaultyDisk::Fault> {};

TEST_P(FaultAtEveryOperation, IsReportedKeepsTheWorkAndIsMadeGoodByTryingAgain) {
  int struck = 0;
  for (std::int64_t n = 1;; n = next(n)) {
    const TempFolder folder;
    const std::string path = folder.file("a.fettle");
    FaultyDisk disk;
    JobControl job;
    Play play(static_cast<std::uint64_t>(n), 150, 150);
    SessionWriterOptions options;
    options.checkpoint_bytes = 100000;
    auto writer = SessionWriter::create(play.session, path, options, job);
    ASSERT_TRUE(writer);
    disk.failAt(n, GetParam());
    for (int a = 0; a < 10; ++a) play.act(writer->get());
    const SessionStatus status = settled(**writer);
    const bool over = !disk.struck();
    if (status.error) {
      ++struck;
      EXPECT_EQ(status.error->kind, ErrorKind::kFailed);
      EXPECT_NE(status.error->line().find(path), std::string::npos) << status.error->line();
      EXPECT_NE(status.error->line().find("elsewhere"), std::string::npos) << status.error->line();
      EXPECT_GT(status.waiting, 0U);
    }  // else a checkpoint was struck, which may fail: the log holds everything
    disk.heal();
    (*writer)->retry();
    const Status flushed = (*writer)->flush(job);
    ASSERT_TRUE(flushed) << "operation " << n << ": " << flushed.error().line();
    EXPECT_FALSE((*writer)->status().error);
    ASSERT_EQ(differenceOnDisk(play.session, path), "") << "operation " << n;
    for (int a = 0; a < 3; ++a) play.act(writer->get());
    ASSERT_TRUE((*writer)->close(job));
    ASSERT_EQ(differenceOnDisk(play.session, path), "") << "operation " << n;
    if (over) break;
  }
  EXPECT_GT(struck, 12);
}

TEST_P(FaultAtEveryOperation, OfASaveElsewhereLeavesNothingThereAndNothingLost) {
  for (std::int64_t n = 1;; n = next(n)) {
    const TempFolder folder;
    const std::string path = folder.file("a.fettle");
    const std::string other = folder.file("b.fettle");
    FaultyDisk disk;
    JobControl job;
    Play play(77, 150, 150);
    auto writer = SessionWriter::create(play.session, path, {}, job);
    ASSERT_TRUE(writer);
    for (int a = 0; a < 6; ++a) play.act(writer->get());
    ASSERT_TRUE((*writer)->flush(job));
    const Session before = play.session;
    std::ofstream(other) << "what stood there";
    disk.failAt(n, GetParam());
    const Status status = (*writer)->saveAs(other, OriginalStorage::kEmbedded, job);
    const bool over = !disk.struck();
    disk.heal();
    if (!status) {
      EXPECT_NE(status.error().line().find(other), std::string::npos) << status.error().line();
      std::ifstream old(other);
      std::string line;
      std::getline(old, line);
      // The name changes hands in one instant; a fault after it leaves a whole session there.
      EXPECT_EQ(line != "what stood there" ? differenceOnDisk(before, other) : "", "") << "operation " << n;
      EXPECT_EQ((*writer)->path(), path);
    }
    for (int a = 0; a < 3; ++a) play.act(writer->get());
    ASSERT_TRUE((*writer)->flush(job));
    ASSERT_EQ(differenceOnDisk(play.session, (*writer)->path()), "") << "operation " << n;
    if (over) {
      EXPECT_TRUE(status);
      break;
    }
  }
}

TEST_P(FaultAtEveryOperation, OfAWholeSaveLeavesWhatStoodThere) {
  for (std::int64_t n = 1;; n = next(n)) {
    const TempFolder folder;
    const std::string path = folder.file("a.fettle");
    FaultyDisk disk;
    JobControl job;
    Play old(1, 100, 100);
    ASSERT_TRUE(saveSession(old.session, path, job));
    Play play(2, 150, 150);
    for (int a = 0; a < 6; ++a) play.act(nullptr);
    disk.failAt(n, GetParam());
    const auto saved = saveSession(play.session, path, job);
    const bool over = !disk.struck();
    disk.heal();
    ASSERT_EQ(differenceOnDisk(saved ? play.session : old.session, path), "") << "operation " << n;
    for (const auto& left : fs::directory_iterator(folder.path()))
      EXPECT_EQ(left.path().filename(), "a.fettle") << "operation " << n;
    if (over) break;
  }
}

INSTANTIATE_TEST_SUITE_P(DiskFaults, FaultAtEveryOperation,
                         testing::Values(FaultyDisk::Fault::kOnce, FaultyDisk::Fault::kFromThenOn),
                         [](const auto& fault) {
                           return std::string(fault.param == FaultyDisk::Fault::kOnce ? "Once" : "ForGood");
                         });

// Power fails after some actions; opens what is left, copied to where the dead writer cannot reach it.
struct AfterPowerCut {
  std::int64_t committed = 0;
  std::int64_t there = -1;
  std::string problem;
};

AfterPowerCut cutPowerAfter(Durability durability, int actions, int keep_of_256, std::uint64_t seed) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  AfterPowerCut result;
  JobControl job;
  Play play(seed, 200, 150);
  const std::string copy = folder.file("copy.fettle");
  {
    FaultyDisk disk;
    SessionWriterOptions options;
    options.durability = durability;
    options.checkpoint_bytes = 60000;
    auto writer = SessionWriter::create(play.session, path, options, job);
    EXPECT_TRUE(writer);
    for (int a = 0; a < actions; ++a) {
      play.act(writer->get());
      (void)settled(**writer);
    }
    result.committed = play.actions();
    disk.cutPower(keep_of_256, seed);
    fs::copy_file(path, copy);
    if (fs::exists(path + "-wal")) fs::copy_file(path + "-wal", copy + "-wal");
    writer->reset();
    disk.heal();
  }
  const auto session = openSession(copy, {}, importField, job);
  if (!session) {
    result.problem = session.error().line();
    return result;
  }
  if (const auto whole = verifySession(copy, job); !whole) result.problem = whole.error().line();
  result.there = static_cast<std::int64_t>(session->journal.size());
  Play replay(seed, 200, 150);
  while (replay.actions() < result.there) replay.act(nullptr);
  if (result.problem.empty()) result.problem = difference(replay.session, *session, Compare::kWhole);
  return result;
}

TEST(PowerFailure, LosesNothingCommittedWhenCommitsAreFlushed) {
  for (int k = 0; k < 30; ++k) {
    const AfterPowerCut cut =
        cutPowerAfter(Durability::kPowerFailure, 1 + k % 12, k % 3 * 100, static_cast<std::uint64_t>(k));
    EXPECT_EQ(cut.problem, "") << k;
    EXPECT_EQ(cut.there, cut.committed) << k;
  }
}

TEST(PowerFailure, TakesTheLastActionsAndLeavesAWholeSessionWhenTheyAreNotFlushed) {
  std::int64_t lost = 0;
  for (int k = 0; k < 30; ++k) {
    const AfterPowerCut cut =
        cutPowerAfter(Durability::kProgramDeath, 1 + k % 12, k % 3 * 100, static_cast<std::uint64_t>(k));
    EXPECT_EQ(cut.problem, "") << k;
    EXPECT_LE(cut.there, cut.committed) << k;
    lost += cut.committed - cut.there;
  }
  EXPECT_GT(lost, 0);  // else the disk of these tests flushes by itself, and the test above shows nothing
}

TEST(FullDisk, OfATmpfsKeepsTheWorkUntilThereIsRoomOrAnotherPlace) {
  const TempFolder folder;
  if (mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=3m") != 0)
    GTEST_SKIP() << "mounting is not permitted";
  {
    const TempFolder elsewhere;
    const std::string path = folder.file("a.fettle");
    JobControl job;
    Play play(3, 500, 300);
    auto writer = SessionWriter::create(play.session, path, {}, job);
    ASSERT_TRUE(writer) << writer.error().line();
    std::ofstream(folder.file("ballast")) << std::string(1 << 20, 'x');
    int actions = 0;
    while (!settled(**writer).error && ++actions < 500) play.act(writer->get());
    const SessionStatus status = (*writer)->status();
    ASSERT_TRUE(status.error) << "the disk never ran full";
    EXPECT_EQ(status.error->line(), "the session cannot be written: the disk is full, " + path +
                                        ", free space on the disk or save the session elsewhere");
    for (int a = 0; a < 5; ++a) play.act(writer->get());
    EXPECT_GT(settled(**writer).waiting, 1U);
    // In its own folder there is no room for another one either: nothing is left of the try.
    const Status refused = (*writer)->saveAs(folder.file("b.fettle"), OriginalStorage::kEmbedded, job);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().what, "the disk is full, the file was not written");
    EXPECT_EQ(refused.error().where, folder.file("b.fettle")) << "the file that was asked for";
    EXPECT_FALSE(fs::exists(folder.file("b.fettle")));
    ASSERT_TRUE((*writer)->saveAs(elsewhere.file("b.fettle"), OriginalStorage::kEmbedded, job));
    EXPECT_FALSE((*writer)->status().error);
    for (int a = 0; a < 5; ++a) play.act(writer->get());
    ASSERT_TRUE((*writer)->close(job));
    EXPECT_EQ(differenceOnDisk(play.session, elsewhere.file("b.fettle")), "");
    // What was committed before is still there to be opened.
    const auto old = openSession(path, {}, importField, job);
    ASSERT_TRUE(old) << old.error().line();
    EXPECT_GT(old->journal.size(), 0U);
  }
  umount(folder.path().c_str());
}

TEST(FullDisk, ALimitOnFileSizesIsOneClearLine) {
  const TempFolder folder;
  JobControl job;
  Play play(3, 500, 300);
  auto writer = SessionWriter::create(play.session, folder.file("a.fettle"), {}, job);
  ASSERT_TRUE(writer);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{100000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  for (int a = 0; a < 10; ++a) play.act(writer->get());
  const SessionStatus status = settled(**writer);
  const auto whole = saveSession(play.session, folder.file("b.fettle"), job);
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  ASSERT_TRUE(status.error);
  EXPECT_NE(status.error->line().find("the session cannot be read or written"), std::string::npos)
      << status.error->line();
  ASSERT_FALSE(whole);
  EXPECT_FALSE(fs::exists(folder.file("b.fettle")));
  (*writer)->retry();
  ASSERT_TRUE((*writer)->close(job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("a.fettle")), "");
}

}  // namespace
}  // namespace fettle::engine
