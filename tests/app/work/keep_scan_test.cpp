// The scan's file is written over while its unsaved work refers to it.

#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>

#include "app/work/open_document.h"
#include "engine/formats/formats.h"
#include "engine/session/session_scan.h"
#include "tests/app/work/hand_play.h"
#include "tests/app/work/part.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using app::SessionKeeper;

class KeptScan : public testing::Test {
 protected:
  KeptScan() {
    setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    EXPECT_TRUE(engine::exportField(roughPart(), scan, {}, job));
    auto opened = app::openDocument(scan, {}, app::Recovery::kLeave, std::size_t{64} << 20, job);
    EXPECT_TRUE(opened) << opened.error().line();
    document = *std::move(opened);
    history = document.history;
    keeper = std::make_unique<SessionKeeper>(document);
    auto started = app::LoopClient::start(history, document.original, brushScene(), {}, keeper.get());
    EXPECT_TRUE(started);
    client = *std::move(started);
    hand = std::make_unique<HandPlay>(*client, *keeper, 5);
  }
  ~KeptScan() override { client->finish(); }

  void work() {
    const std::int64_t before = client->history().last();
    while (client->history().last() < before + 2) static_cast<void>(hand->act());
    hand->settle();
    hand->untilKept();
  }
  template <class Done>
  void until(const char* what, const Done& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!done()) {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << what;
      client->poll();
      keeper->poll();
    }
  }
  void replaceScan() { ASSERT_TRUE(engine::exportField(client->upright().inverted(), scan, {}, job)); }
  // What a program that starts now would find: nothing is closed yet, as after a kill.
  void expectRecovered() {
    const auto session = engine::openSession(app::recoveryPath(scan), {}, engine::importField, job);
    ASSERT_TRUE(session) << session.error().line();
    EXPECT_EQ(engine::contentHash(session->original), engine::contentHash(document.original));
    EXPECT_EQ(session->history.number(), client->history().number());
    EXPECT_EQ(engine::contentHash(session->history.current()), storedHash(client->history().current()));
  }

  TempFolder folder;
  engine::JobControl job;
  std::string scan = folder.file("scan.tif");
  app::Document document;
  engine::History history;
  std::unique_ptr<SessionKeeper> keeper;
  std::unique_ptr<app::LoopClient> client;
  std::unique_ptr<HandPlay> hand;
};

TEST_F(KeptScan, GoesIntoTheSessionBeforeTheWindowWritesOverIt) {
  work();
  keeper->keepScan();
  std::optional<engine::Status> kept;
  until("the scan is kept", [&] { return (kept = keeper->scanKept()).has_value(); });
  ASSERT_TRUE(*kept) << kept->error().line();
  replaceScan();
  work();
  expectRecovered();
}

TEST_F(KeptScan, GoesIntoTheSessionThatIsMadeAfterItWasWrittenOver) {
  keeper->keepScan();
  const auto kept = keeper->scanKept();
  ASSERT_TRUE(kept && *kept);
  replaceScan();
  work();
  expectRecovered();
}

TEST_F(KeptScan, GoesIntoTheSessionWhenAnotherProgramReplacedIt) {
  // Before there is a session: the first step makes one that refers to nothing.
  replaceScan();
  work();
  expectRecovered();
}

TEST_F(KeptScan, GoesIntoTheSessionSoonAfterAnotherProgramReplacedIt) {
  work();
  replaceScan();
  until("the session holds the scan", [&] {
    const auto facts = engine::sessionFacts(app::recoveryPath(scan));
    return facts && facts->storage == engine::OriginalStorage::kEmbedded;
  });
  expectRecovered();
}

TEST_F(KeptScan, GoesIntoTheSessionAtItsEndAtTheLatest) {
  work();
  replaceScan();
  client->finish();
  ASSERT_TRUE(keeper->close(SessionKeeper::Afterwards::kKeep));
  expectRecovered();
}

}  // namespace
}  // namespace fettle::tests
