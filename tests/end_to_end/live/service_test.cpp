// The program with an Inverse3 behind a replacement of its service that was written apart from the driver: `fettle devices`, a session,
// and the forces that the service was asked for when it is attacked.
#include <csignal>
#include <cstdio>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "tests/end_to_end/live/session.h"
#include "tests/haptic/devices/fake_vendor/fake_inverse_service.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;
using fake::InverseAnswer;

constexpr double kMaxForceN = 3.0;  // of an unknown device: the service states none

class ServiceDevice : public testing::Test {
 protected:
  void start(double up_mm) {
    const std::string scan = folder_.file("flat.tif");
    ASSERT_NO_FATAL_FAILURE(writePlate(scan));
    raise(up_mm);
    program_ = std::make_unique<LiveProgram>(
        std::vector<std::string>{"record", scan, folder_.file("s.csv"), folder_.file("o.tif"), "--device",
                                 "inverse3", "--keys", "--json"},
        folder_.path().string(), service_.address());
  }
  void armUntil(const char* state) {
    ASSERT_TRUE(eventually([&] {
      program_->press('a');
      return program_->says(state, 2s);
    })) << program_->err();
  }
  // The program armed, and the hand pressing into the surface.
  void press() {
    ASSERT_NO_FATAL_FAILURE(start(30.0));
    ASSERT_NO_FATAL_FAILURE(armUntil(" s: active"));
    ASSERT_NO_FATAL_FAILURE(pressDown());
  }
  void pressDown() {
    for (double up = 30.0; up > -2.0; up -= 0.1) {
      raise(up);
      std::this_thread::sleep_for(2ms);  // the speed of the hand
    }
    ASSERT_TRUE(eventually([&] { return now() > 0.2; })) << program_->err();
  }
  // The hand above the middle of the workspace.
  void raise(double mm) {
    service_.change([mm](auto& w) {
      for (fake::InverseUnit& unit : w.units) unit.position_m[2] = 0.20 + 0.001 * mm;
    });
  }
  void answer(InverseAnswer how) {
    service_.change([how](auto& w) { w.answer = how; });
  }
  [[nodiscard]] double now() const {
    const auto f = service_.received().force_n;
    return std::hypot(f[0], f[1], f[2]);
  }
  // The next forces, as often as there are messages.
  [[nodiscard]] double strongestOfTheNext(std::size_t count) {
    const std::size_t first = service_.received().forces_n.size();
    EXPECT_TRUE(eventually([&] { return service_.received().forces_n.size() >= first + count; }));
    const std::vector<float> forces = service_.received().forces_n;
    return static_cast<double>(
        *std::max_element(forces.begin() + static_cast<std::ptrdiff_t>(first), forces.end()));
  }
  // By key; the whole connection was within the rules.
  void quit() {
    program_->press('q');
    EXPECT_EQ(program_->wait(), 0) << program_->err();
    expectNoSanitizerReport(*program_);
    expectNoRuleBroken();
  }
  void expectNoRuleBroken() {
    EXPECT_TRUE(eventually([&] { return service_.received().connections == 0; }));
    for (const std::string& rule : service_.rules.broken()) ADD_FAILURE() << rule;
  }
  // Prints the row of docs/safety.md; the guard's limits hold at the device.
  void expectWithinLimits(const char* attack) {
    const auto received = service_.received();
    double peak = 0.0, rise = 0.0, before = 0.0;
    for (const float force : received.forces_n) {
      const double f = static_cast<double>(force);
      peak = std::max(peak, f);
      rise = std::max(rise, f - before);
      before = f;
    }
    std::printf("| %-45s | %-14s | %6.3f | %7.4f | %6.3f |\n", attack, "inverse3", peak, rise, now());
    std::fflush(stdout);
    EXPECT_LE(peak, kMaxForceN * 1.001);
    EXPECT_GT(peak, 0.2);
    // One tick of rise; where the machine held the loop up, as many ticks at once as the guard allows.
    EXPECT_LE(rise, 2.0);
    EXPECT_EQ(now(), 0.0);
  }

  TempFolder folder_;
  fake::FakeInverseService service_;
  std::unique_ptr<LiveProgram> program_;
};

TEST_F(ServiceDevice, IsListedWithItsLimitsWhileItIsThere) {
  const auto rowNow = [&] {
    LiveProgram program({"devices", "--json"}, folder_.path().string(), service_.address());
    EXPECT_EQ(program.wait(), 0) << program.err();
    const nlohmann::json report = program.report();
    for (const auto& row : report["devices"])
      if (row["id"].get<std::string>().starts_with("inverse3")) return row;
    return nlohmann::json();
  };
  const nlohmann::json row = rowNow();
  EXPECT_EQ(row["id"], "inverse3:049D");
  EXPECT_EQ(row["state"], "ready");
  EXPECT_EQ(row["max_force_n"], kMaxForceN);
  EXPECT_EQ(service_.received().messages, 0U) << "a list asks for no force, not even for zero";
  service_.change([](auto& w) { w.units.clear(); });
  const nlohmann::json gone = rowNow();
  EXPECT_TRUE(gone.is_null() || gone["state"] != "ready") << gone;
  expectNoRuleBroken();
}

TEST_F(ServiceDevice, ArmedInsideTheSurfaceThenTakenOutAndPressed) {
  ASSERT_NO_FATAL_FAILURE(start(-2.0));
  ASSERT_NO_FATAL_FAILURE(armUntil(" s: armed"));
  EXPECT_EQ(strongestOfTheNext(300), 0.0);
  raise(30.0);
  EXPECT_TRUE(program_->says(" s: active")) << program_->err();
  ASSERT_NO_FATAL_FAILURE(pressDown());
  quit();
  expectWithinLimits("armed 2 mm inside, taken out, pressed");
}

TEST_F(ServiceDevice, DisarmedWhilePressingAndArmedThere) {
  ASSERT_NO_FATAL_FAILURE(press());
  program_->press('d');
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  ASSERT_NO_FATAL_FAILURE(armUntil(" s: armed"));
  EXPECT_EQ(strongestOfTheNext(300), 0.0);
  quit();
  expectWithinLimits("disarmed while pressing, armed there");
}

TEST_F(ServiceDevice, OfTwoTheOtherIsAskedForNoForce) {
  service_.change([](auto& w) {
    fake::InverseUnit other;
    other.id = "04A0";
    w.units.push_back(other);
  });
  ASSERT_NO_FATAL_FAILURE(press());
  const auto other = service_.received().other_force_n;
  EXPECT_EQ(std::hypot(other[0], other[1], other[2]), 0.0);
  quit();
  expectWithinLimits("two of one kind, the first pressed");
}

TEST_F(ServiceDevice, UnpluggedWhilePressingAndBack) {
  ASSERT_NO_FATAL_FAILURE(press());
  auto units = std::make_shared<std::vector<fake::InverseUnit>>();
  service_.change([units](auto& w) { std::swap(*units, w.units); });
  EXPECT_TRUE(program_->says("fault, unplugged")) << program_->err();
  service_.change([units](auto& w) { std::swap(*units, w.units); });
  raise(30.0);
  EXPECT_TRUE(program_->says("device connected")) << program_->err();
  quit();
  expectWithinLimits("unplugged while pressing, back");
}

TEST_F(ServiceDevice, ServiceEndsWhilePressingAndIsBack) {
  ASSERT_NO_FATAL_FAILURE(press());
  service_.stop();
  EXPECT_TRUE(program_->says("fault, unplugged")) << program_->err();
  raise(30.0);
  service_.start();
  EXPECT_TRUE(program_->says("device connected")) << program_->err();
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  quit();
  expectWithinLimits("service ends while pressing, back");
}

TEST_F(ServiceDevice, ServiceClosesTheConnectionAgainAndAgain) {
  ASSERT_NO_FATAL_FAILURE(press());
  answer(InverseAnswer::kCloses);
  EXPECT_TRUE(program_->says("fault, unplugged")) << program_->err();
  EXPECT_TRUE(eventually([&] { return service_.received().ever_connected > 4; }));
  answer(InverseAnswer::kState);
  EXPECT_TRUE(program_->says("device connected")) << program_->err();
  quit();
  expectWithinLimits("service closes each connection for a while");
}

TEST_F(ServiceDevice, GarbageWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  for (const InverseAnswer wrong :
       {InverseAnswer::kHuge, InverseAnswer::kNull, InverseAnswer::kWords, InverseAnswer::kNoPosition,
        InverseAnswer::kNoState, InverseAnswer::kNotJson, InverseAnswer::kCutShort}) {
    answer(wrong);
    const unsigned long from = service_.received().messages;
    EXPECT_TRUE(eventually([&] { return service_.received().messages > from + 20; })) << program_->err();
  }
  EXPECT_TRUE(program_->says("fault, input lost")) << program_->err();
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  answer(InverseAnswer::kState);
  quit();
  expectWithinLimits("seven kinds of answers without a pose");
}

TEST_F(ServiceDevice, AnotherDevicesStateWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  answer(InverseAnswer::kOtherDevice);
  EXPECT_TRUE(program_->says("fault, unplugged")) << program_->err();
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  answer(InverseAnswer::kState);
  quit();
  expectWithinLimits("answers with another device's id");
}

TEST_F(ServiceDevice, StandsWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  answer(InverseAnswer::kNothing);
  EXPECT_TRUE(program_->says("fault")) << program_->err();
  answer(InverseAnswer::kState);
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  quit();
  expectWithinLimits("service does not answer");
}

TEST_F(ServiceDevice, AnswersSlowlyWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  service_.change([](auto& w) { w.slowness = 30ms; });
  const unsigned long from = service_.received().messages;
  EXPECT_TRUE(eventually([&] { return service_.received().messages > from + 30; })) << program_->err();
  service_.change([](auto& w) { w.slowness = 0ms; });
  quit();
  expectWithinLimits("each answer takes 30 ms for a second");
}

TEST_F(ServiceDevice, TwoAnswersForOneMessageWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  answer(InverseAnswer::kTwice);
  const unsigned long from = service_.received().messages;
  EXPECT_TRUE(eventually([&] { return service_.received().messages > from + 500; })) << program_->err();
  // The hand comes out: poses that had queued up would hold the force for half a second.
  raise(30.0);
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  quit();
  expectWithinLimits("two answers for each message");
}

TEST_F(ServiceDevice, AFrameOfATerabyteWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  answer(InverseAnswer::kHugeFrame);
  EXPECT_TRUE(program_->says("fault")) << program_->err();
  answer(InverseAnswer::kState);
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  quit();
  expectWithinLimits("a frame that states 1 TiB");
}

TEST_F(ServiceDevice, CtrlCWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  program_->signal(SIGINT);
  program_->wait();
  expectNoRuleBroken();
  expectWithinLimits("Ctrl-C while pressing");
}

TEST_F(ServiceDevice, CrashWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  program_->signal(SIGSEGV);
  program_->wait();
  EXPECT_TRUE(eventually([&] { return service_.received().connections == 0; }));
  expectWithinLimits("SIGSEGV while pressing");
}

}  // namespace
}  // namespace fettle::tests
