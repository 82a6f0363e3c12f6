// Kills a program again and again while a hand strokes, filters, marks and undoes, and looks at what is left.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "engine/session/session.h"
#include "haptic/journal/session_player.h"
#include "tests/support/process.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

// What the driver reported before it died.
struct DriverReport {
  bool ready = false;
  bool doing = false;  // something was begun and not kept yet
  std::int64_t number = -1;
  std::string hash;
};

DriverReport readReport(const std::string& out) {
  DriverReport report;
  std::istringstream lines(out);
  std::string word;
  while (lines >> word) {
    if (word == "ready") report.ready = true;
    if (word == "doing") report.doing = true;
    if (word == "kept") {
      lines >> report.number >> report.hash;
      report.doing = false;
    }
  }
  return report;
}

int killsWanted() {
  const char* wanted = std::getenv("FETTLE_KILLS");
  return wanted == nullptr ? 20 : std::atoi(wanted);
}

TEST(SessionOfAHand, OpensAfterAKillAtAnyMomentWithAllButWhatWasBeingDone) {
  const int kills = killsWanted();
  constexpr int kLives = 5;  // of one session, before the next begins
  const tests::TempFolder folder;
  std::mt19937_64 random(20261121);
  std::map<std::string, int> seen;
  std::string path;
  DriverReport last;  // of the lives before
  std::int64_t ticks = 0, steps = 0;
  for (int kill = 0; kill < kills; ++kill) {
    const bool is_new = kill % kLives == 0 || !fs::exists(path);
    if (is_new) {
      path = folder.file(fmt::format("s{}.fettle", kill));
      last = {};
    }
    const double life_ms = std::uniform_real_distribution<double>(1.0, 900.0)(random);
    const std::string ready = folder.file("ready");
    fs::remove(ready);
    std::optional<std::chrono::steady_clock::time_point> start;
    tests::ProcessOptions options;
    options.while_running = [&](int pid) {
      if (!start) {
        if (fs::exists(ready)) start = std::chrono::steady_clock::now();
        return false;
      }
      if (std::chrono::steady_clock::now() - *start < std::chrono::duration<double, std::milli>(life_ms))
        return false;
      ::kill(pid, SIGKILL);
      return true;
    };
    const tests::Outcome outcome = tests::runProcess(
        {FETTLE_HAND_DRIVER, path, std::to_string(random()), is_new ? "create" : "resume", ready}, options);
    ASSERT_EQ(outcome.status, 128 + SIGKILL) << "kill " << kill << ": " << outcome.err;
    DriverReport report = readReport(outcome.out);
    ++seen[report.doing ? "while something was done" : "between two doings"];
    if (report.number < 0) {
      report.number = last.number;
      report.hash = last.hash;
    }
    if (!fs::exists(path)) {
      ASSERT_LT(report.number, 0) << "kill " << kill << ": what was kept is gone";
      ++seen["before the session was there"];
      continue;
    }
    engine::JobControl job;
    const engine::Result<engine::Session> session = engine::openSession(path, {}, engine::importField, job);
    ASSERT_TRUE(session) << "kill " << kill << ": " << session.error().line();
    const auto verified = engine::verifySession(path, job);
    ASSERT_TRUE(verified) << "kill " << kill << ": " << verified.error().line();
    if (report.number >= 0) {
      // One doing more may be there, and an undo may have moved on: the state that was reported is held all the
      // same.
      ASSERT_LE(report.number, session->history.last()) << "kill " << kill;
      EXPECT_EQ(fmt::format("{:016x}", engine::contentHash(session->history.state(report.number))),
                report.hash)
          << "kill " << kill;
    }
    const auto played = haptic::playSession(*session, job);
    ASSERT_TRUE(played) << "kill " << kill << ": " << played.error().line();
    EXPECT_EQ(played->state, session->history.number()) << "kill " << kill;
    EXPECT_EQ(engine::contentHash(played->field), engine::contentHash(session->history.current()))
        << "kill " << kill;
    ticks += played->ticks;
    steps = std::max(steps, played->steps);
    last.number = session->history.number();
    last.hash = fmt::format("{:016x}", engine::contentHash(session->history.current()));
  }
  fmt::print("{} kills; {} ticks played again; at most {} steps in a session\n", kills, ticks, steps);
  for (const auto& [what, count] : seen) fmt::print("  {:4} {}\n", count, what);
  // The moments must have been spread: a test that always kills an idle program shows nothing.
  EXPECT_GE(seen["while something was done"], kills / 3);
}

}  // namespace
}  // namespace fettle::app
