// Attacks that come over the wire, on the real program, seen from the device. Each prints its row of the
// table in docs/safety.md.
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "tests/end_to_end/live/session.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;

class LiveAttack : public testing::TestWithParam<Firmware> {
 protected:
  // A session that gives a force of about 1 N on a hand that rests.
  static std::unique_ptr<Session> pressing() {
    auto session = std::make_unique<Session>(GetParam());
    session->calibrate();
    session->arm();
    session->touch(3.0);
    session->expectForce();
    return session;
  }
  [[nodiscard]] static std::size_t size() { return GetParam() == Firmware::kW8 ? 8 : 14; }
};
INSTANTIATE_TEST_SUITE_P(Firmware, LiveAttack, testing::Values(Firmware::kW8, Firmware::kP14),
                         [](const auto& i) { return firmwareName(i.param); });

TEST_P(LiveAttack, ShortAndOversizedReportsAreLeftOut) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size();
  for (int i = 0; i < 50; ++i) {
    session->woody.sendRaw({1, 2, 3});
    session->woody.sendRaw(std::vector<std::uint8_t>(200, 0x77));
    std::this_thread::sleep_for(4ms);
  }
  const Felt felt = session->felt("50 short and 50 oversized reports in 200 ms", from);
  EXPECT_GT(felt.peak_n, 0.5);
  const auto report = session->end();
  EXPECT_EQ(report["device"]["bad_inputs"], 100);
}

TEST_P(LiveAttack, GarbageOfTheRightSizeIsAJumpAndRampsTheForce) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size();
  for (int i = 0; i < 20; ++i) {
    session->woody.sendRaw(std::vector<std::uint8_t>(size(), 0x5A));
    std::this_thread::sleep_for(10ms);
  }
  std::this_thread::sleep_for(200ms);
  session->felt("20 reports of garbage of the right size", from);
  static_cast<void>(session->end());
}

TEST_P(LiveAttack, EncodersThatJumpAcrossTheWorkspaceGiveNoKick) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size();
  const auto deep = countsAt({0.0, 0.0, -60.0});
  const auto high = countsAt({0.0, 0.0, 60.0});
  for (int i = 0; i < 30; ++i) {
    session->woody.turnTo(i % 2 == 0 ? deep : high);
    std::this_thread::sleep_for(7ms);
  }
  session->woody.turnTo(deep);
  std::this_thread::sleep_for(1000ms);
  const Felt felt = session->felt("encoders jump 120 mm to and fro, then stay 60 mm deep", from);
  EXPECT_GT(felt.peak_n, 2.0);  // where the hand pushes that deep it gets what the profile has
  EXPECT_GT(session->end()["safety"]["jumps"], 0);
}

TEST_P(LiveAttack, PausesOf20MillisecondsFadeTheForceAndRampItBack) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size();
  // A pause that the machine makes one of 50 ms is a fault, and another is made in its place.
  constexpr int kMost = 10;
  int pauses = 0;
  for (int i = 0; i < kMost && pauses < 5; ++i) {
    session->woody.pause(20ms);
    std::this_thread::sleep_for(200ms);
    pauses += !session->armedAgainAfterAFault();
  }
  EXPECT_EQ(pauses, 5);
  session->felt("5 pauses of 20 ms", from);
  const auto report = session->end();
  EXPECT_GE(report["safety"]["silences"], 5);
}

TEST_P(LiveAttack, SilenceOf200MillisecondsIsAFaultThatStaysUntilArmed) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size();
  session->woody.pause(200ms);
  ASSERT_TRUE(session->program->says("fault, input lost")) << session->program->err();
  session->expectNoForce();
  std::this_thread::sleep_for(400ms);
  EXPECT_EQ(session->woody.log().ma, (std::array<std::int16_t, 3>{}));
  session->goTo({0.0, 0.0, 6.0}, 200ms);
  session->arm();
  session->goTo({0.0, 0.0, -3.0}, 300ms);
  session->expectForce();
  session->felt("silence of 200 ms, armed again", from);
  EXPECT_GE(session->end()["safety"]["faults"], 1);  // a machine that stalls for 50 ms adds its own
}

TEST_P(LiveAttack, ProgramStoppedByADebuggerGivesNothingWhenItRunsOn) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size() - 1;  // what is held
  session->program->signal(SIGSTOP);
  std::this_thread::sleep_for(1000ms);
  const std::uint64_t watchdog = session->woody.log().watchdog_fired;
  EXPECT_EQ(watchdog, 1U);  // nobody writes: the firmware's own 500 ms are what is left
  session->woody.turnTo(countsAt({0.0, 0.0, -8.0}));
  session->program->signal(SIGCONT);
  ASSERT_TRUE(session->program->says("fault,")) << session->program->err();
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(session->woody.log().ma, (std::array<std::int16_t, 3>{}));
  session->felt("stopped for 1 s (SIGSTOP), hand 5 mm deeper meanwhile", from);
  const auto report = session->end();
  EXPECT_GT(report["missed"], 500);
}

TEST_P(LiveAttack, StalledOutputHoldsTheWriterAloneNeverTheLoop) {
  const auto session = pressing();
  const std::size_t from = session->woody.history().size();
  session->woody.stallOut(true);
  // What the device does not take, the hand does not feel: a fault, or the force would come back as a kick.
  ASSERT_TRUE(session->program->says("fault,")) << session->program->err();
  std::this_thread::sleep_for(1500ms);
  session->woody.stallOut(false);
  ASSERT_TRUE(
      eventually([&, n = session->woody.log().outputs] { return session->woody.log().outputs > n + 50; }));
  EXPECT_EQ(session->woody.log().ma, (std::array<std::int16_t, 3>{}));
  session->goTo({0.0, 0.0, 6.0}, 200ms);
  session->arm();
  session->goTo({0.0, 0.0, -3.0}, 300ms);
  session->expectForce();
  session->felt("output stalled for 1.5 s, armed again", from);
  const auto stalled = session->end();
  EXPECT_GT(stalled["device"]["longest_output_us"], 1'400'000.0);

  const auto plain = pressing();
  std::this_thread::sleep_for(1500ms);
  const auto report = plain->end();
  for (const auto* r : {&stalled, &report})
    std::printf("lateness with output %s: p50 %.0f us, p99 %.0f us, worst %.0f us, missed %lld of %lld\n",
                r == &stalled ? "stalled 1.5 s" : "taken", (*r)["lateness"]["p50_us"].get<double>(),
                (*r)["lateness"]["p99_us"].get<double>(), (*r)["lateness"]["worst_us"].get<double>(),
                (*r)["missed"].get<long long>(), (*r)["ticks"].get<long long>());
  // A loop that waited for the write would miss 1,500 ticks; a busy machine costs some in either session.
  EXPECT_LE(stalled["missed"].get<double>(), report["missed"].get<double>() + 500.0);
}

}  // namespace
}  // namespace fettle::tests
