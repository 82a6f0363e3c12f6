// Kills a program at work on a session again and again, at random moments, and looks at what is left.

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
#include "tests/engine/session/play.h"
#include "tests/support/process.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 500;
constexpr int kHeight = 300;

// What the driver reported before it was killed.
struct Reported {
  bool ready = false;
  std::int64_t begun = 0;
  std::int64_t committed = 0;
};

Reported readReported(const std::string& out) {
  Reported reported;
  std::istringstream lines(out);
  std::string word;
  while (lines >> word) {
    if (word == "ready") reported.ready = true;
    if (word == "begun") lines >> reported.begun;
    if (word == "committed") lines >> reported.committed;
  }
  return reported;
}

int killsWanted() {
  const char* wanted = std::getenv("FETTLE_KILLS");
  return wanted == nullptr ? 40 : std::atoi(wanted);
}

TEST(SessionKill, AtAnyMomentNothingButTheActionInProgressIsLost) {
  const int kills = killsWanted();
  constexpr int kLives = 8;  // of one session, before the next begins
  const tests::TempFolder folder;
  std::mt19937_64 random(20261121);
  std::map<std::string, int> seen;
  std::int64_t actions = 0;
  double slowest_open = 0.0;
  std::string path;
  std::uint64_t seed = 0;
  std::unique_ptr<Play> replay;
  std::int64_t known = 0;  // actions in the session after the life before
  for (int kill = 0; kill < kills; ++kill) {
    const bool is_new = kill % kLives == 0 || !fs::exists(path);
    if (is_new) {
      seed = random();
      path = folder.file(fmt::format("s{}.fettle", kill));
      replay = std::make_unique<Play>(seed, kWidth, kHeight);
      known = 0;
    }
    // Three of four die at work, within some actions after the session was open; the others at any time, most
    // of them while it is made or opened.
    const bool at_work = random() % 4 != 0;
    const double life_ms = std::uniform_real_distribution<double>(1.0, 120.0)(random);
    const std::string ready = folder.file("ready");
    fs::remove(ready);
    auto start = std::chrono::steady_clock::now();
    bool counting = !at_work;
    tests::ProcessOptions options;
    options.while_running = [&](int pid) {
      if (!counting) {
        counting = fs::exists(ready);
        start = std::chrono::steady_clock::now();
        return false;
      }
      if (std::chrono::steady_clock::now() - start < std::chrono::duration<double, std::milli>(life_ms))
        return false;
      ::kill(pid, SIGKILL);
      return true;
    };
    const tests::Outcome outcome =
        tests::runProcess({FETTLE_KILL_DRIVER, path, std::to_string(seed), std::to_string(kWidth),
                           std::to_string(kHeight), is_new ? "create" : "resume", ready},
                          options);
    ASSERT_EQ(outcome.status, 128 + SIGKILL) << "kill " << kill << ": " << outcome.err;
    const Reported reported = readReported(outcome.out);
    const bool log = fs::exists(path + "-wal") && fs::file_size(path + "-wal") > 0;
    ++seen[!fs::exists(path)                     ? "before the session was there"
           : !reported.ready                     ? "while it opened"
           : reported.begun > reported.committed ? "within an action"
                                                 : "before its first action"];
    seen["with a log left"] += log ? 1 : 0;
    if (!fs::exists(path)) {
      ASSERT_FALSE(reported.ready);
      continue;
    }
    JobControl job;
    const auto open_start = std::chrono::steady_clock::now();
    const Result<Session> session = openSession(path, {}, importField, job);
    slowest_open = std::max(
        slowest_open, std::chrono::duration<double>(std::chrono::steady_clock::now() - open_start).count());
    ASSERT_TRUE(session) << "kill " << kill << ": " << session.error().line();
    const Result<SessionSize> verified = verifySession(path, job);
    ASSERT_TRUE(verified) << "kill " << kill << ": " << verified.error().line();
    EXPECT_FALSE(fs::exists(path + "-wal")) << "reading puts a dead program's log in order";

    const auto there = static_cast<std::int64_t>(session->journal.size());
    ASSERT_GE(there, std::max(known, reported.committed)) << "kill " << kill << " lost what was committed";
    ASSERT_LE(there, std::max(known, reported.begun)) << "kill " << kill;
    seen["the action in progress was there"] += there > std::max(known, reported.committed) ? 1 : 0;
    actions += there - known;
    known = there;
    while (replay->actions() < there) replay->act(nullptr);
    ASSERT_EQ(difference(replay->session, *session, Compare::kWhole), "")
        << "kill " << kill << ", seed " << seed;
  }
  fmt::print("{} kills, {} actions survived, slowest open after one {:.1f} ms\n", kills, actions,
             slowest_open * 1e3);
  for (const auto& [what, count] : seen) fmt::print("  {:4} {}\n", count, what);
  // The moments must have been spread: a test that always kills an idle program shows nothing.
  EXPECT_GE(seen["within an action"], kills / 3);
  EXPECT_GE(seen["with a log left"], kills / 4);
}

}  // namespace
}  // namespace fettle::engine
