// Attacks on the hand, each through the whole tick of the live loop: peak force and its rate are printed, and
// held to the device's profile. What ends the program (SIGSEGV, SIGKILL ...) is in last_resort_test.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::LoopBench;
using tests::testOptions;

constexpr int kAttackedSide = 128;
constexpr double kPeak = 5.0;      // woody_v2015
constexpr double kRest_mm = -1.0;  // 1 N at the default 1 N/mm

engine::Version flatAt(float height) {
  return fettle::tests::fieldOf(kAttackedSide, kAttackedSide, [=](int, int) { return height; });
}

// A tip that rests a millimetre inside a flat field, force active and steady; watches what the hand gets.
class RestingTip {
 public:
  RestingTip() : start_(flatAt(0.0F)) {
    LoopOptions options = testOptions(Tool::kFeel);
    DeviceProfile woody;
    woody.max_force_n = kPeak;
    woody.max_damping_n_s_per_mm = 0.008;
    options.limits = limitsFor(woody);
    bench = std::make_unique<LoopBench>(start_, start_, defaultScene(), options);
    EXPECT_TRUE(start_.memory()->tiles.reserve(100) && start_.memory()->nodes.reserve(100));
    bench->device.input.position_mm = {60.3, 60.4, 2.0};
    EXPECT_TRUE(bench->send(CommandKind::kArm));
    for (int i = 0; i < 700; ++i) bench->tick();
    bench->device.input.position_mm.z = kRest_mm;
    for (int i = 0; i < 100; ++i) bench->tick();
    EXPECT_NEAR(bench->device.force.z, 1.0, 1e-9);
    last_ = bench->device.force;
  }

  void tick(int ticks = 1, std::int64_t since_ns = LoopBench::kPeriod_ns) {
    for (int i = 0; i < ticks; ++i) {
      bench->tick(since_ns);
      const glm::dvec3 f = bench->device.force;
      EXPECT_TRUE(std::isfinite(f.x) && std::isfinite(f.y) && std::isfinite(f.z));
      const double dt_ms = 1e-6 * static_cast<double>(since_ns);
      peak_n = std::max(peak_n, glm::length(f));
      rate_n_per_ms = std::max(rate_n_per_ms, glm::length(f - last_) / dt_ms);
      rise_n_per_ms = std::max(rise_n_per_ms, (glm::length(f) - glm::length(last_)) / dt_ms);
      last_ = f;
    }
  }
  [[nodiscard]] const engine::Version& start() const { return start_; }
  [[nodiscard]] const SafetyLimits& limits() const { return bench->loop.guard().limits(); }

  double peak_n = 0.0;         // after the attack began
  double rate_n_per_ms = 0.0;  // of the force vector
  double rise_n_per_ms = 0.0;  // of its size
  std::unique_ptr<LoopBench> bench;

 private:
  engine::Version start_;
  glm::dvec3 last_{0.0};
};

struct Attack {
  const char* name;
  bool ramped;  // a rise that no hand did: at most small at first, then peak in ramp_s
  std::function<void(RestingTip&)> run;
};

void restore(RestingTip& tip, const engine::Version& version) {
  EXPECT_TRUE(tip.bench->send(CommandKind::kRestore, [&](LoopCommand& c) { c.version = version; }));
}

void adopt(RestingTip& tip, const engine::Version& version) {
  EXPECT_TRUE(tip.bench->send(CommandKind::kSnapshot, [](LoopCommand& c) { c.id = 1; }));
  tip.tick();
  EXPECT_TRUE(tip.bench->send(CommandKind::kAdopt, [&](LoopCommand& c) {
    c.id = 1;
    c.version = version;
  }));
  tip.tick();
  EXPECT_EQ(tip.bench->newest(EventKind::kAdopted).id, 1U);
}

void changeScene(RestingTip& tip, const std::function<void(Scene&)>& change) {
  Scene scene = defaultScene();
  change(scene);
  EXPECT_TRUE(tip.bench->send(CommandKind::kScene, [&](LoopCommand& c) {
    c.scene = std::make_unique<PreparedScene>(scene, tip.start());
  }));
}

void gap(RestingTip& tip, int ms) {
  tip.bench->device.speaking = false;
  tip.tick(ms);
  tip.bench->device.speaking = true;
  // Meanwhile the hand went deep.
  tip.bench->device.input.position_mm.z = -4.0;
  tip.tick(1000);
}

TEST(Attack, NoneGivesMoreThanTheProfileOrFasterThanTheSlewLimit) {
  const double kNaN = std::numeric_limits<double>::quiet_NaN();
  const engine::Version lifted = flatAt(10.0F);
  const Attack attacks[] = {
      {"pose NaN for 5 ticks", false,
       [&](RestingTip& t) {
         t.bench->device.input.position_mm.y = kNaN;
         t.tick(5);
         t.bench->device.input.position_mm.y = 60.4;
         t.tick(1000);
       }},
      {"pose infinite", false,
       [&](RestingTip& t) {
         t.bench->device.input.position_mm.z = -std::numeric_limits<double>::infinity();
         t.tick(1000);
       }},
      {"pose jumps 20 mm inwards", true,
       [&](RestingTip& t) {
         t.bench->device.input.position_mm.z = -20.0;
         t.tick(1000);
       }},
      {"pose jumps to and fro", false,
       [&](RestingTip& t) {
         for (int i = 0; i < 1000; ++i) {
           t.bench->device.input.position_mm.z = i % 2 == 0 ? -20.0 : 20.0;
           t.tick();
         }
       }},
      {"gap of 10 ms, then 4 mm deep", true, [&](RestingTip& t) { gap(t, 10); }},
      {"gap of 30 ms, then 4 mm deep", true, [&](RestingTip& t) { gap(t, 30); }},
      {"gap of 60 ms, then 4 mm deep", true, [&](RestingTip& t) { gap(t, 60); }},
      {"gap of 500 ms, then 4 mm deep", true, [&](RestingTip& t) { gap(t, 500); }},
      {"debugger stop of 3 s, 4 mm deep", true,
       [&](RestingTip& t) {
         t.bench->device.input.position_mm.z = -4.0;
         t.tick(1, 3'000'000'000);
         t.tick(1000);
       }},
      {"ticks 1 to 9 ms late, 4 mm deep", false,
       [&](RestingTip& t) {
         t.bench->device.input.position_mm.z = -4.0;
         for (int i = 0; i < 300; ++i) t.tick(1, 1'000'000 * (1 + i % 9));
       }},
      {"field edited 4 mm up under the tip", true,
       [&](RestingTip& t) {
         engine::LiveField edited(t.start(), engine::Growth::kAllowed);
         const std::vector<float> plateau(20 * 20, 4.0F);
         EXPECT_TRUE(edited.writeHeights(50, 50, 20, 20, plateau.data(), 20));
         restore(t, edited.snapshot());
         t.tick(1000);
       }},
      {"version adopted 10 mm above the tip", true,
       [&](RestingTip& t) {
         engine::LiveField up(t.start(), engine::Growth::kAllowed);
         const std::vector<float> ten(std::size_t{kAttackedSide} * kAttackedSide, 10.0F);
         EXPECT_TRUE(up.writeHeights(0, 0, kAttackedSide, kAttackedSide, ten.data(), kAttackedSide));
         adopt(t, up.snapshot());
         t.tick(1000);
       }},
      {"undo to and fro by 10 mm", true,
       [&](RestingTip& t) {
         for (int i = 0; i < 20; ++i) {
           restore(t, i % 2 == 0 ? lifted : t.start());
           t.tick(20);
           static_cast<void>(t.bench->poll());
         }
       }},
      {"stiffness 1000 N/mm from one tick on", true,
       [&](RestingTip& t) {
         changeScene(t, [](Scene& s) { s.stiffness_n_per_mm = s.force_limit_n = 1000.0; });
         t.tick(1000);
       }},
      {"field turned over under the tip", true,
       [&](RestingTip& t) {
         restore(t, flatAt(-10.0F));
         t.tick(50);
         changeScene(t, [](Scene& s) { s.invert = true; });
         t.tick(1000);
       }},
      {"unplugged, back 4 mm deep, armed there", true,
       [&](RestingTip& t) {
         t.bench->device.input.link = LinkState::kDisconnected;
         t.bench->tick();  // the force is gone with the device: no rate
         t.bench->device.input.link = LinkState::kConnected;
         t.bench->device.input.position_mm.z = -4.0;
         t.tick(10);
         EXPECT_TRUE(t.bench->send(CommandKind::kArm));
         t.tick(1000);
         EXPECT_EQ(t.peak_n, 0.0);
       }},
  };
  std::printf("%-42s %8s %12s %12s  %s\n", "attack on a tip that rests with 1 N", "peak N", "rate N/ms",
              "rise N/ms", "state after");
  for (const Attack& attack : attacks) {
    SCOPED_TRACE(attack.name);
    RestingTip tip;
    const double before = glm::length(tip.bench->device.force);
    attack.run(tip);
    const SafetyState state = tip.bench->loop.guard().state();
    std::printf("%-42s %8.3f %12.4f %12.4f  %s %s\n", attack.name, tip.peak_n, tip.rate_n_per_ms,
                tip.rise_n_per_ms, name(state).data(), name(tip.bench->loop.guard().cause()).data());
    const SafetyLimits& limits = tip.limits();
    EXPECT_LE(tip.peak_n, kPeak * (1.0 + 1e-12));
    EXPECT_LE(tip.rate_n_per_ms, limits.slew_n_per_ms + 1e-9);
    if (attack.ramped) {
      // At most `small` and one tick of the ramp.
      EXPECT_LE(tip.rise_n_per_ms, limits.small_force_n + 1e-3 * kPeak / limits.ramp_s + 1e-9);
    }
    EXPECT_NEAR(before, 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace fettle::haptic
