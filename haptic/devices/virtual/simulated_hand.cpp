#include "haptic/devices/virtual/simulated_hand.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "engine/base/stopwatch.h"
#include "haptic/base/force.h"

namespace fettle::haptic {

namespace {

constexpr double kLongestSubstep = 10e-6;  // [s]; 1/160 of the period of a 10 N/mm contact on 150 g
constexpr double kTremorLow = 8.0;         // [Hz]
constexpr double kTremorHigh = 12.0;

HandMotion tremor(const HandSpec& spec, std::uint64_t axis) noexcept {
  return {spec.tremor_mm, kTremorLow, kTremorHigh, spec.seed, axis};
}

}  // namespace

SimulatedHand::SimulatedHand(std::vector<HandTarget> path, const HandSpec& spec)
    : path_(std::move(path)), spec_(spec), tremor_{tremor(spec, 0), tremor(spec, 1), tremor(spec, 2)} {
  assert(!path_.empty());
  assert(spec.mass_kg > 0.0 && spec.rate_hz >= 100.0 && spec.rate_hz <= 100000.0);
  profile_.name = "simulated hand";
  profile_.space = DeviceSpace::kField;
  profile_.workspace_radius_mm = 1e9;
  profile_.max_force_n = spec.max_force_n;
  // K < 2 b / T of a wall, T = 1 ms, b all that damps it; b < 2 m / T of a damper (haptic/effects/spring.cpp,
  // viscosity.cpp). Profiles state damping up to 1 N s/mm.
  profile_.max_stiffness_n_per_mm = 2.0 * (spec.damping_n_s_per_mm + spec.device_damping_n_s_per_mm) * 1000.0;
  profile_.max_damping_n_s_per_mm = std::min(2.0 * 1e-3 * spec.mass_kg * spec.rate_hz, 1.0);
  profile_.resolution_mm = spec.resolution_mm;
  profile_.rate_hz = spec.rate_hz;
  profile_.gives_force = true;
  const double period = 1.0 / spec.rate_hz;
  substeps_ = static_cast<int>(std::ceil(period / kLongestSubstep - 1e-9));
  step_ = period / substeps_;
  static_cast<void>(start());
}

engine::Status SimulatedHand::start() {
  leg_ = 0;
  ticks_ = 0;
  read_once_ = false;
  target_ = targetAt(0.0).at;
  x_ = target_;
  v_ = force_ = glm::dvec3{0.0};
  work_ = 0.0;
  return {};
}

double SimulatedHand::seconds() const noexcept {
  return static_cast<double>(ticks_) / spec_.rate_hz;
}

void SimulatedHand::write(const glm::dvec3& f) noexcept {
  force_ = finite(f) ? f : glm::dvec3{0.0};
}

SimulatedHand::Target SimulatedHand::targetAt(double t) noexcept {
  while (leg_ + 1 < path_.size() && path_[leg_ + 1].t <= t) ++leg_;
  const HandTarget& from = path_[leg_];
  Target target{from.at_mm, from.tool};
  if (leg_ + 1 < path_.size() && t > from.t) {
    const HandTarget& to = path_[leg_ + 1];
    target.at += (to.at_mm - from.at_mm) * ((t - from.t) / (to.t - from.t));
  }
  if (spec_.tremor_mm > 0.0) target.at += glm::dvec3{tremor_[0].at(t), tremor_[1].at(t), tremor_[2].at(t)};
  return target;
}

void SimulatedHand::advance() noexcept {
  // Units: mm, s, N, kg: N / kg = 1000 mm/s^2. The target moves on a straight line within the tick.
  const double start = seconds();
  const glm::dvec3 next = targetAt(start + step_ * substeps_).at;
  const glm::dvec3 target_speed = (next - target_) / (step_ * substeps_);
  const double k = spec_.stiffness_n_per_mm;
  const double b = spec_.damping_n_s_per_mm;
  const double inverse_mass = 1000.0 / spec_.mass_kg;
  for (int i = 0; i < substeps_; ++i) {
    const glm::dvec3 aim = target_ + target_speed * (step_ * i);
    const glm::dvec3 sum =
        force_ + k * (aim - x_) + b * (target_speed - v_) - spec_.device_damping_n_s_per_mm * v_;
    v_ += sum * (inverse_mass * step_);
    const glm::dvec3 moved = v_ * step_;
    x_ += moved;
    work_ += glm::dot(force_, moved);
  }
  target_ = next;
  ++ticks_;
}

DeviceInput SimulatedHand::read() noexcept {
  if (read_once_) advance();
  read_once_ = true;
  input_.position_mm = x_;
  if (spec_.resolution_mm > 0.0) {
    for (int i = 0; i < 3; ++i)
      input_.position_mm[i] = std::floor(x_[i] / spec_.resolution_mm + 0.5) * spec_.resolution_mm;
  }
  input_.tool = targetAt(seconds()).tool;
  input_.buttons = input_.tool == Tool::kFeel ? 0 : kPrimaryButton;
  input_.link = LinkState::kConnected;
  input_.arrival_ns = engine::steadyNs();
  ++input_.sequence;
  return input_;
}

}  // namespace fettle::haptic
