// A person's work in real time, kept in a session as it goes, made again from the journal alone.

#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "app/work/open_document.h"
#include "engine/field/live_field.h"
#include "engine/formats/formats.h"
#include "haptic/journal/session_player.h"
#include "tests/app/work/hand_play.h"
#include "tests/app/work/part.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using app::Document;
using app::LoopClient;
using app::SessionKeeper;

constexpr std::size_t kHistoryBytes = std::size_t{64} << 20;

Document fromField(const engine::Version& field, const std::string& name) {
  Document document;
  document.path = name;
  document.original = field;
  document.history = engine::History(field, kHistoryBytes);
  return document;
}

std::unique_ptr<LoopClient> clientOf(const Document& document, const engine::History& history,
                                     SessionKeeper& keeper) {
  auto client = LoopClient::start(history, document.original, brushScene(), {}, &keeper);
  EXPECT_TRUE(client) << (client ? "" : client.error().line());
  return client ? std::move(*client) : nullptr;
}

TEST(SessionJournal, ReplaysToTheBitsThatHandsFiltersAndUndoMade) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  std::map<std::string, int> did;
  std::uint64_t expected = 0;
  std::int64_t number = 0;
  // Three lives of one session: the second and third continue from the file.
  for (std::uint64_t life = 0; life < 3; ++life) {
    Document document;
    if (life == 0) {
      document = fromField(roughPart(), folder.file("scan.tif"));
    } else {
      engine::JobControl job;
      auto opened = app::openDocument(path, {}, app::Recovery::kLeave, kHistoryBytes, job);
      ASSERT_TRUE(opened) << opened.error().line();
      document = *std::move(opened);
      ASSERT_TRUE(document.writer);
      EXPECT_EQ(storedHash(document.history.current()), expected);
      EXPECT_EQ(document.history.number(), number);
    }
    const engine::History history = document.history;
    SessionKeeper keeper(document);
    if (life == 0) keeper.saveAs(path, engine::OriginalStorage::kEmbedded);
    auto client = clientOf(document, history, keeper);
    ASSERT_TRUE(client);
    HandPlay play(*client, keeper, 1000 + life);
    for (int i = 0; i < 10; ++i) ++did[play.act()];
    play.settle();
    // Another loop in the same life.
    const engine::Status other_rate = client->setRate(life == 1 ? 1500.0 : 1000.0);
    ASSERT_TRUE(other_rate) << other_rate.error().line();
    for (int i = 0; i < 4; ++i) ++did[play.act()];
    play.settle();
    client->finish();
    expected = storedHash(client->history().current());
    number = client->history().number();
    const engine::Status closed = keeper.close(SessionKeeper::Afterwards::kKeep);
    ASSERT_TRUE(closed) << closed.error().line();
  }
  for (const auto& [what, count] : did) std::printf("  %3d %s\n", count, what.c_str());

  engine::JobControl job;
  const auto session = engine::openSession(path, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(engine::contentHash(session->history.current()), expected);
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(played->loops, 4);
  EXPECT_EQ(played->state, number);
  EXPECT_EQ(engine::contentHash(played->field), expected);
  std::printf("%lld ticks, %lld steps, %lld filters, %zu entries\n", static_cast<long long>(played->ticks),
              static_cast<long long>(played->steps), static_cast<long long>(played->filters),
              session->journal.size());
  EXPECT_GT(played->steps, 3);
}

TEST(SessionJournal, ReplaysFiltersWhoseRangeWasLeftToTheNoiseToTheSameBits) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  Document document = fromField(roughPart(), folder.file("scan.tif"));
  const engine::History history = document.history;
  SessionKeeper keeper(document);
  keeper.saveAs(path, engine::OriginalStorage::kEmbedded);
  auto client = clientOf(document, history, keeper);
  ASSERT_TRUE(client);
  HandPlay play(*client, keeper, 7);
  engine::FilterSpec spec;
  for (const auto& [kind, window] :
       {std::pair{engine::FilterKind::kBilateral, 5}, {engine::FilterKind::kTotalVariation, 11}}) {
    spec.kind = kind;
    spec.window = window;
    play.apply(spec);
  }
  play.settle();
  for (const app::Notice& notice : play.notices()) ADD_FAILURE() << notice.what;
  client->finish();
  const std::uint64_t expected = storedHash(client->history().current());
  ASSERT_TRUE(keeper.close(SessionKeeper::Afterwards::kKeep));

  engine::JobControl job;
  const auto session = engine::openSession(path, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(played->filters, 2);
  EXPECT_EQ(engine::contentHash(played->field), expected);
}

// Holes and lines under the hand: a step each, undone and made again, kept, and replayed from their numbers alone.
TEST(SessionJournal, ReplaysFilledHolesAndLevelledLinesToTheSameBits) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  engine::LiveField holed(roughPart(), engine::Growth::kAllowed);
  for (std::int32_t row = 30; row < 36; ++row)
    for (std::int32_t column = 40; column < 49; ++column)
      ASSERT_TRUE(holed.setHeight(column, row, std::numeric_limits<float>::quiet_NaN()));
  Document document = fromField(holed.snapshot(), folder.file("scan.tif"));
  const engine::History history = document.history;
  SessionKeeper keeper(document);
  keeper.saveAs(path, engine::OriginalStorage::kEmbedded);
  auto client = clientOf(document, history, keeper);
  ASSERT_TRUE(client);
  HandPlay play(*client, keeper, 5);
  const std::int64_t holes = engine::summarize(client->field()).no_data;
  ASSERT_GE(holes, 54);
  engine::FillOptions fill;
  fill.most_extent_mm = 20.0 * client->field().grid().spacingXMm();
  play.make(fill);
  play.settle();
  EXPECT_EQ(client->history().number(), 1);
  EXPECT_LE(engine::summarize(client->field()).no_data, holes - 54) << "others are as small";
  engine::JobControl job;
  const auto by_command = engine::fillHoles(history.current(), fill, job);
  ASSERT_TRUE(by_command);
  EXPECT_EQ(storedHash(client->history().current()), engine::contentHash(by_command->field));
  engine::LineOptions lines;
  lines.method = engine::LineMethod::kMatching;
  play.make(lines);
  play.settle();
  EXPECT_EQ(client->history().number(), 2);
  client->undo();
  client->undo();
  play.settle();
  EXPECT_EQ(engine::summarize(client->field()).no_data, holes);
  client->redo();
  play.settle();
  EXPECT_EQ(storedHash(client->history().current()), engine::contentHash(by_command->field));
  client->redo();
  play.settle();
  for (const app::Notice& notice : play.notices()) ADD_FAILURE() << notice.what;
  client->finish();
  const std::uint64_t expected = storedHash(client->history().current());
  ASSERT_TRUE(keeper.close(SessionKeeper::Afterwards::kKeep));

  const auto session = engine::openSession(path, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(engine::contentHash(session->history.current()), expected);
  EXPECT_EQ(session->history.info(1).name, "Fill holes: least curvature");
  EXPECT_EQ(session->history.info(2).name, "Level rows: matching");
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(played->steps, 2);
  EXPECT_EQ(engine::contentHash(played->field), expected);
}

TEST(SessionJournal, BeginsWithWhatACommandHadMadeOfTheScan) {
  const TempFolder folder;
  const std::string path = folder.file("work.fettle");
  engine::JobControl job;
  const engine::Version original = roughPart();
  engine::FilterSpec spec;
  spec.window = 5;
  const auto filtered = engine::applyFilter(original, original, spec, job);
  ASSERT_TRUE(filtered);
  engine::ExportOptions options;
  options.original = original;
  ASSERT_TRUE(engine::exportField(filtered->field, path, options, job));
  std::uint64_t expected = 0;
  {
    auto opened = app::openDocument(path, {}, app::Recovery::kLeave, kHistoryBytes, job);
    ASSERT_TRUE(opened) << opened.error().line();
    const engine::History history = opened->history;
    ASSERT_EQ(history.number(), 1);
    SessionKeeper keeper(*opened);
    auto client = clientOf(*opened, history, keeper);
    ASSERT_TRUE(client);
    HandPlay play(*client, keeper, 11);
    spec.kind = engine::FilterKind::kMedian;
    spec.max_change = 0.02;
    play.apply(spec);
    play.settle();
    client->finish();
    expected = storedHash(client->history().current());
    ASSERT_TRUE(keeper.close(SessionKeeper::Afterwards::kKeep));
  }
  const auto session = engine::openSession(path, {}, engine::importField, job);
  ASSERT_TRUE(session) << session.error().line();
  EXPECT_EQ(haptic::journalStart(*session), 1);
  const auto played = haptic::playSession(*session, job);
  ASSERT_TRUE(played) << played.error().line();
  EXPECT_EQ(engine::contentHash(played->field), expected);
}

TEST(SessionKeeper, WhatIsOnlyLookedAtLeavesNoFile) {
  const TempFolder folder;
  setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  const std::string scan = folder.file("scan.tif");
  {
    Document document = fromField(roughPart(), scan);
    const engine::History history = document.history;
    SessionKeeper keeper(document);
    auto client = clientOf(document, history, keeper);
    ASSERT_TRUE(client);
    for (int i = 0; i < 50; ++i) client->poll();
    client->finish();
    EXPECT_TRUE(keeper.close(SessionKeeper::Afterwards::kKeep));
  }
  EXPECT_FALSE(std::filesystem::exists(app::recoveryPath(scan)));
}

TEST(SessionKeeper, UnsavedWorkIsThereAgainAndGoneWhenDiscarded) {
  const TempFolder folder;
  setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  const std::string scan = folder.file("scan.tif");
  const std::string recovery = app::recoveryPath(scan);
  std::uint64_t expected = 0;
  for (const auto afterwards : {SessionKeeper::Afterwards::kKeep, SessionKeeper::Afterwards::kDiscard}) {
    Document document;
    if (afterwards == SessionKeeper::Afterwards::kKeep) {
      document = fromField(roughPart(), scan);
    } else {
      engine::JobControl job;
      auto opened = app::openDocument(scan, {}, app::Recovery::kTake, kHistoryBytes, job);
      ASSERT_TRUE(opened) << opened.error().line();
      document = *std::move(opened);
      EXPECT_TRUE(document.recovered);
      EXPECT_EQ(storedHash(document.history.current()), expected);
    }
    const engine::History history = document.history;
    SessionKeeper keeper(document);
    auto client = clientOf(document, history, keeper);
    ASSERT_TRUE(client);
    HandPlay play(*client, keeper, 5);
    while (client->history().last() < 2) static_cast<void>(play.act());
    play.settle();
    client->finish();
    expected = storedHash(client->history().current());
    ASSERT_TRUE(keeper.close(afterwards));
    EXPECT_EQ(std::filesystem::exists(recovery), afterwards == SessionKeeper::Afterwards::kKeep);
  }
}

}  // namespace
}  // namespace fettle::tests
