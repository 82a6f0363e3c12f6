// The program ends badly while it gives force: what the device is left with.
#include <csignal>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "tests/end_to_end/live/session.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;
using By = fake::WoodyCurrents::By;

class LiveDeath : public testing::TestWithParam<Firmware> {
 protected:
  static std::unique_ptr<Session> smoothing() {
    auto session = std::make_unique<Session>(GetParam());
    session->calibrate();
    session->arm();
    session->touch(3.0);
    session->use('s');
    session->goTo({20.0, 0.0, -3.0}, 1200ms);
    session->expectForce();
    return session;
  }
};
INSTANTIATE_TEST_SUITE_P(Firmware, LiveDeath, testing::Values(Firmware::kW8, Firmware::kP14),
                         [](const auto& i) { return firmwareName(i.param); });

TEST_P(LiveDeath, SegmentationFaultLeavesZeroAsTheLastWord) {
  const auto session = smoothing();
  const std::size_t from = session->woody.history().size() - 1;  // what is held
  session->program->signal(SIGSEGV);
  EXPECT_NE(session->program->wait(), 0);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(session->woody.log().ma, (std::array<std::int16_t, 3>{}));
  EXPECT_EQ(session->woody.log().watchdog_fired, 0U);
  EXPECT_GE(session->woody.log().direct_zeros, 1U);
  const auto history = session->woody.history();
  // After the first zero nothing but zeros.
  bool zeroed = false;
  for (std::size_t i = from; i < history.size(); ++i) {
    zeroed = zeroed || history[i].by == By::kDirect;
    if (zeroed) {
      EXPECT_EQ(history[i].ma, (std::array<std::int16_t, 3>{}));
    }
  }
  session->felt("SIGSEGV while pressing", from);
}

TEST_P(LiveDeath, KilledProgramLeavesTheFirmwaresWatchdogAndTheRecordingOfTheLastSecond) {
  const auto session = smoothing();
  const std::size_t from = session->woody.history().size() - 1;  // what is held
  const auto killed = std::chrono::steady_clock::now();
  session->program->signal(SIGKILL);
  EXPECT_EQ(session->program->wait(), 128 + SIGKILL);
  EXPECT_NE(session->woody.log().ma, (std::array<std::int16_t, 3>{}));  // no program can help this
  ASSERT_TRUE(eventually([&] { return session->woody.log().watchdog_fired == 1; }));
  EXPECT_EQ(session->woody.log().ma, (std::array<std::int16_t, 3>{}));
  const auto history = session->woody.history();
  const double ms = std::chrono::duration<double, std::milli>(history.back().at - killed).count();
  EXPECT_EQ(history.back().by, By::kWatchdog);
  session->felt("SIGKILL while pressing: zero after " + std::to_string(static_cast<int>(ms)) + " ms", from);

  // Nothing half-written stands where the outputs would be; what was recorded is next to it, and replays.
  EXPECT_FALSE(std::filesystem::exists(session->strokes));
  EXPECT_FALSE(std::filesystem::exists(session->out));
  std::string left;
  for (const auto& entry : std::filesystem::directory_iterator(session->folder.path()))
    if (entry.path().extension() == ".csv") left = entry.path().string();
  ASSERT_NE(left, "");
  const Outcome replayed =
      runProcess({FETTLE_PROGRAM, "replay", session->scan, left, session->out, "--json"});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_GT(nlohmann::json::parse(replayed.out)["samples_changed"], 0);
}

}  // namespace
}  // namespace fettle::tests
