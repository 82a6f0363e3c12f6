#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/field/live_field.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::TempFolder;

std::unique_ptr<SessionWriter> created(const Session& session, const std::string& path,
                                       const SessionWriterOptions& options = {}) {
  JobControl job;
  auto writer = SessionWriter::create(session, path, options, job);
  EXPECT_TRUE(writer) << (writer ? "" : writer.error().line());
  return writer ? std::move(*writer) : nullptr;
}

RC_GTEST_PROP(SessionWriter, TheFileFollowsEveryActionAndAnotherReaderSeesIt, ()) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  Play play(*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::inRange(1, 300), *rc::gen::inRange(1, 300));
  SessionWriterOptions options;
  options.durability = Durability::kProgramDeath;
  options.checkpoint_bytes = *rc::gen::element<std::size_t>(0, 100000, 8 << 20);
  const auto writer = created(play.session, path, options);
  RC_ASSERT(writer != nullptr);
  JobControl job;
  const int rounds = *rc::gen::inRange(1, 4);
  for (int round = 0; round < rounds; ++round) {
    const int actions = *rc::gen::inRange(0, 12);
    for (int a = 0; a < actions; ++a) play.act(writer.get());
    const Status flushed = writer->flush(job);
    RC_ASSERT(flushed.has_value());
    RC_ASSERT(writer->status().waiting == 0U);
    RC_ASSERT(writer->status().committed_state == play.session.history.number());
    RC_ASSERT(differenceOnDisk(play.session, path) == "");
  }
}

TEST(SessionWriter, GoesOnWithAnOpenedSession) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  Play play(1, 300, 200);
  created(play.session, path);
  JobControl job;
  for (int round = 0; round < 5; ++round) {
    auto resumed = SessionWriter::open(path, {}, {}, importField, job);
    ASSERT_TRUE(resumed) << resumed.error().line();
    EXPECT_EQ(difference(play.session, resumed->session, Compare::kWhole), "");
    play = Play(1, resumed->session);
    for (int a = 0; a < 10; ++a) play.act(resumed->writer.get());
    if (round % 2 == 0) {
      ASSERT_TRUE(resumed->writer->close(job));
    }  // else the destructor writes what waits
  }
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
}

TEST(SessionWriter, AClosedSessionIsOneOrdinaryFile) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  Play play(1, 300, 200);
  auto writer = created(play.session, path);
  for (int a = 0; a < 10; ++a) play.act(writer.get());
  JobControl job;
  ASSERT_TRUE(writer->close(job));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
}

TEST(SessionWriter, AStepAfterUndoRemovesTheStepsThatWereUndone) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  Play play(4, 400, 300);
  auto writer = created(play.session, path);
  History& history = play.session.history;
  const auto push = [&](int column) {
    LiveField live(history.current(), Growth::kAllowed);
    ASSERT_TRUE(live.setHeight(column, 3, 100.0F + static_cast<float>(column)));
    ASSERT_TRUE(history.push({"s", StepKind::kStroke, {}, {}, 0}, live.snapshot()));
    writer->commit(history.number(), history.step(history.number()), {});
  };
  for (int k = 0; k < 6; ++k) push(60 * k);
  ASSERT_TRUE(history.goTo(2));
  writer->moveTo(2, {});
  push(399);
  JobControl job;
  ASSERT_TRUE(writer->flush(job));
  EXPECT_EQ(history.last(), 3);
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
  const auto size = verifySession(path, job);
  ASSERT_TRUE(size);
  EXPECT_EQ(size->tiles, 7 * 5 + 3);
}

TEST(SessionWriter, SaveAsTakesEverythingAndGoesOnThere) {
  const TempFolder folder;
  Play play(21, 300, 200);
  auto writer = created(play.session, folder.file("a.fettle"));
  for (int a = 0; a < 15; ++a) play.act(writer.get());
  JobControl job;
  ASSERT_TRUE(writer->saveAs(folder.file("b 'q' % ?#.fettle"), OriginalStorage::kEmbedded, job));
  EXPECT_EQ(writer->path(), folder.file("b 'q' % ?#.fettle"));
  const Session then = play.session;
  for (int a = 0; a < 15; ++a) play.act(writer.get());
  ASSERT_TRUE(writer->flush(job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("b 'q' % ?#.fettle")), "");
  // The first one stands where it stood when the work went elsewhere, or a little before.
  JobControl reading;
  const auto old = openSession(folder.file("a.fettle"), {}, importField, reading);
  ASSERT_TRUE(old) << old.error().line();
  EXPECT_LE(old->journal.size(), then.journal.size());
  // It is free: another program may continue it.
  EXPECT_TRUE(SessionWriter::open(folder.file("a.fettle"), {}, {}, importField, reading));
}

TEST(SessionWriter, SaveAsReplacesAnotherSessionWholeWithItsLog) {
  const TempFolder folder;
  Play old(5, 100, 100);
  {
    // A session that died with a log.
    auto writer = created(old.session, folder.file("old.fettle"));
    for (int a = 0; a < 10; ++a) old.act(writer.get());
    JobControl job;
    ASSERT_TRUE(writer->flush(job));
    ASSERT_GT(fs::file_size(folder.file("old.fettle-wal")), 0U);
    fs::copy_file(folder.file("old.fettle"), folder.file("b.fettle"));
    fs::copy_file(folder.file("old.fettle-wal"), folder.file("b.fettle-wal"));
  }
  Play play(6, 300, 200);
  auto writer = created(play.session, folder.file("a.fettle"));
  for (int a = 0; a < 5; ++a) play.act(writer.get());
  JobControl job;
  ASSERT_TRUE(writer->saveAs(folder.file("b.fettle"), OriginalStorage::kEmbedded, job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("b.fettle")), "");
}

TEST(SessionWriter, SaveAsCanEmbedAScanThatWasReferredTo) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif");
  JobControl job;
  Play play(8, 200, 150);
  ASSERT_TRUE(exportField(play.session.original, scan, {}, job));
  const auto imported = importField(scan, {}, job);
  ASSERT_TRUE(imported);
  play.session.original = imported->field;
  play.session.history = History(imported->field);
  play.session.scan = {scan, {}, imported->format, {}};
  play.session.storage = OriginalStorage::kReferenced;
  auto writer = created(play.session, folder.file("a.fettle"));
  for (int a = 0; a < 10; ++a) play.act(writer.get());
  ASSERT_TRUE(writer->saveAs(folder.file("b.fettle"), OriginalStorage::kReferenced, job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("b.fettle")), "");
  ASSERT_TRUE(writer->saveAs(folder.file("c.fettle"), OriginalStorage::kEmbedded, job));
  for (int a = 0; a < 10; ++a) play.act(writer.get());
  ASSERT_TRUE(writer->flush(job));
  // In its own place too.
  auto other = SessionWriter::open(folder.file("b.fettle"), {}, {}, importField, job);
  ASSERT_TRUE(other);
  ASSERT_TRUE(other->writer->saveAs(folder.file("b.fettle"), OriginalStorage::kEmbedded, job));
  fs::remove(scan);
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("c.fettle")), "");
  EXPECT_EQ(differenceOnDisk(other->session, folder.file("b.fettle")), "");
  EXPECT_FALSE(openSession(folder.file("a.fettle"), {}, importField, job));
}

// Its tiles lie behind those of the steps before; steps that are undone and replaced take only theirs away.
TEST(SessionWriter, AScanEmbeddedLaterStaysWhenTheStepsBeforeAreReplaced) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), path = folder.file("a.fettle");
  JobControl job;
  Play play(8, 200, 150);
  ASSERT_TRUE(exportField(play.session.original, scan, {}, job));
  const auto imported = importField(scan, {}, job);
  ASSERT_TRUE(imported);
  play.session.original = imported->field;
  play.session.history = History(imported->field);
  play.session.scan = {scan, {}, imported->format, {}};
  play.session.storage = OriginalStorage::kReferenced;
  auto writer = created(play.session, path);
  while (play.session.history.number() < 3) play.act(writer.get());
  ASSERT_TRUE(writer->saveAs(folder.file("b.fettle"), OriginalStorage::kEmbedded, job));
  ASSERT_TRUE(writer->saveAs(path, OriginalStorage::kEmbedded, job));
  for (const std::int64_t number : {2, 0}) {
    writer->moveTo(number, {});
    const History& history = play.session.history;
    writer->commit(number + 1,
                   {{"Again", StepKind::kMark, {}, {}, 0}, history.state(number), history.state(3)}, {});
    ASSERT_TRUE(writer->flush(job)) << number;
    const auto after = openSession(path, {}, importField, job);
    ASSERT_TRUE(after) << number << ": " << after.error().line();
    EXPECT_EQ(difference(after->original, play.session.original), "") << number;
    EXPECT_EQ(after->history.last(), number + 1);
    EXPECT_TRUE(verifySession(path, job)) << number;
  }
}

TEST(SessionWriter, OlderStepsAreReadBackFromTheFile) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  Play play(13, 300, 200);
  auto writer = created(play.session, path);
  while (play.session.history.number() < 15) play.act(writer.get());
  History bounded = play.session.history;
  std::vector<Version> dropped;
  bounded.setBound(1, dropped);
  ASSERT_GT(bounded.first(), 0);
  JobControl job;
  while (bounded.first() > 0) {
    auto step = writer->loadOlder(bounded, job);
    ASSERT_TRUE(step) << step.error().line();
    bounded.prepend(std::move(*step));
    const std::int64_t k = bounded.first();
    ASSERT_EQ(difference(bounded.state(k), play.session.history.state(k)), "");
    EXPECT_EQ(bounded.info(k + 1).name, play.session.history.info(k + 1).name);
  }
  EXPECT_FALSE(writer->loadOlder(bounded, job));
}

TEST(SessionWriter, ANewerTextReplacesOneThatStillWaits) {
  const TempFolder folder;
  Play play(1, 2000, 2000);
  auto writer = created(play.session, folder.file("a.fettle"));
  // A large step keeps the writer busy; of the texts behind it only the last is written.
  play.session.history.push({"f", StepKind::kFilter, {}, {}, 0}, strangeField(55, 2000, 2000));
  writer->commit(1, play.session.history.step(1), {});
  for (int k = 0; k < 1000; ++k) writer->setNote("camera", std::to_string(k));
  JobControl job;
  ASSERT_TRUE(writer->flush(job));
  EXPECT_LT(writer->status().committed, 900U);
  play.session.notes["camera"] = "999";
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("a.fettle")), "");
}

TEST(SessionWriter, HandingOverTakesMicrosecondsWhateverIsWritten) {
  const TempFolder folder;
  Play play(1, 2000, 2000);
  auto writer = created(play.session, folder.file("a.fettle"));
  double worst = 0.0;
  std::int64_t number = 0;
  std::vector<Version> fields{strangeField(55, 2000, 2000), strangeField(56, 2000, 2000)};
  for (int k = 0; k < 6; ++k) {
    play.session.history.push({"f", StepKind::kFilter, {}, {}, 0}, fields[static_cast<std::size_t>(k % 2)]);
    Step step = play.session.history.step(++number);
    const auto start = std::chrono::steady_clock::now();
    writer->commit(number, std::move(step), {});
    worst = std::max(worst, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  EXPECT_GT(writer->status().waiting, 1U);  // it was busy all the time
  // Six packings of 4 M samples take a second. A preempted thread may lose some 10 ms.
  EXPECT_LT(worst, 0.1);
  JobControl job;
  ASSERT_TRUE(writer->flush(job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("a.fettle")), "");
}

}  // namespace
}  // namespace fettle::engine
