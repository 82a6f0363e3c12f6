#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "haptic/safety/safety.h"
#include "tests/haptic/safety/guard_witness.h"

namespace fettle::haptic {
namespace {

using tests::GuardWitness;

// One thing that happens to the guard, repeated for some ticks: plain numbers, so that a failure shrinks.
struct Happening {
  int kind = 0;
  int ticks = 1;
  double size = 0.0;
};

void showValue(const Happening& h, std::ostream& os) {
  os << "{" << h.kind << " x" << h.ticks << " " << h.size << "}";
}

rc::Gen<Happening> happening() {
  return rc::gen::apply(
      [](int kind, int ticks, int exponent, int mantissa) {
        return Happening{kind, ticks, std::ldexp(static_cast<double>(mantissa), exponent)};
      },
      rc::gen::inRange(0, 17), rc::gen::inRange(1, 700), rc::gen::inRange(-8, 12), rc::gen::inRange(-9, 10));
}

void happen(GuardWitness& w, const Happening& h, double& age_s) {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (int i = 0; i < h.ticks; ++i) {
    SafetyInput in;
    in.dt_s = 0.001;
    in.link = LinkState::kConnected;
    in.command_n = {h.size, -0.5 * h.size, 0.25 * h.size};
    bool input = true;
    switch (h.kind) {
      case 0:  // the hand comes out
      case 1:
        in.command_n = glm::dvec3(0.0);
        break;
      case 2:  // NaN pose
        in.command_n = {0.0, kNoNumber, 1.0};
        break;
      case 3:
        in.command_n = {kEndless, -kEndless, h.size};
        break;
      case 4:
        in.command_n = glm::dvec3(h.size) * 1e306;
        break;
      case 5:  // input lost, 1 to 700 ms
        input = false;
        break;
      case 6:  // debugger stop or a late tick
        if (i == 0) in.dt_s = 0.001 * h.ticks;
        break;
      case 7:
        in.dt_s = i % 2 == 0 ? kNoNumber : -1.0;
        break;
      case 8:
        in.velocity_mm_per_s = glm::dvec3(1000.0 * h.size, 0.0, 0.0);
        break;
      case 9:
        in.velocity_mm_per_s = glm::dvec3(kNoNumber);
        break;
      case 10:
        in.disturbance = Disturbance::kSurfaceReplaced;
        break;
      case 11:
        if (i == 0) in.link = LinkState::kDisconnected;
        break;
      case 12:
        if (i == 0) in.link = LinkState::kUncalibrated;
        break;
      case 13:
        if (i == 0) w.guard().disarm();
        break;
      case 14:  // opposite forces in turn
        in.command_n *= i % 2 == 0 ? 1.0 : -1.0;
        break;
      case 15:  // reports that do not get out
        in.output_pending = true;
        break;
      default:
        break;
    }
    age_s = input ? 0.0 : age_s + 0.001;
    in.input_age_s = age_s;
    static_cast<void>(w.step(in));
  }
}

RC_GTEST_PROP(ForceGuardProperty, NoInputBreaksTheProfileTheSlewOrTheLatch, ()) {
  SafetyLimits limits;
  limits.peak_force_n = *rc::gen::element(0.0, 0.5, 3.0, 8.0, 20.0);
  limits.continuous_force_n = 0.3 * limits.peak_force_n;
  limits.thermal_tau_s = *rc::gen::element(0.1, 1.0, 20.0);
  limits.slew_n_per_ms = *rc::gen::element(0.05, 0.6, 4.0);
  limits.damping_n_s_per_mm = *rc::gen::element(0.0, 0.004, 1.0);
  limits.small_force_n = *rc::gen::element(0.0, 0.1);
  RC_ASSERT(!limitsProblem(limits));
  GuardWitness w(limits);
  double age_s = 0.0;
  const auto all = *rc::gen::container<std::vector<Happening>>(happening());
  for (const Happening& h : all) {
    // Armed most of the time, else nothing is ever given.
    if (h.ticks % 3 != 0) w.arm();
    happen(w, h, age_s);
    RC_ASSERT(!w.problem());
  }
}

}  // namespace
}  // namespace fettle::haptic
