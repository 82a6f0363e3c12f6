#include "bench/stiffness_sweep.h"

#include <algorithm>
#include <cmath>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "haptic/devices/virtual/simulated_hand.h"
#include "haptic/tick/tick.h"

namespace fettle::bench {

namespace {

constexpr double kDisplaced = 0.01;  // of the depth at rest
constexpr int kHalvings = 12;        // of a range of 4 : 1, to 0.1 %

engine::Version flatField() {
  engine::Grid grid;
  grid.width = grid.height = 16;
  return engine::makeField(grid, std::vector<float>(256, 0.0F));
}

// Long enough for an oscillation one hundredth from the bound to change by a tenth: b / (2 m) * 0.01 *
// seconds.
double secondsFor(const StiffnessSweepOptions& options) {
  return std::clamp(20.0 * options.mass_kg * 1e-3 / options.damping_n_s_per_mm, 1.0, 20.0);
}

// Whether the oscillation of a mass pressed on the flat grows.
bool buzzes(const engine::Version& field, double stiffness, double rate_hz,
            const StiffnessSweepOptions& options) {
  haptic::Scene scene;
  scene.effects = {haptic::EffectKind::kSpring};
  scene.stiffness_n_per_mm = stiffness;
  scene.force_limit_n = 10.0 * options.press_n;
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  haptic::HandSpec spec;
  spec.mass_kg = options.mass_kg;
  spec.stiffness_n_per_mm = 0.0;
  spec.damping_n_s_per_mm = 0.0;
  spec.device_damping_n_s_per_mm = options.damping_n_s_per_mm;
  spec.rate_hz = rate_hz;
  const double depth = options.press_n / stiffness;
  haptic::SimulatedHand hand({{0.0, {7.5, 7.5, -depth * (1.0 + kDisplaced)}}}, spec);

  const auto ticks = static_cast<std::int64_t>(secondsFor(options) * rate_hz);
  const std::int64_t part = ticks / 10;
  double early = 0.0, late = 0.0;
  for (std::int64_t i = 0; i < ticks; ++i) {
    const glm::dvec3 at = hand.read().position_mm;
    const haptic::ForceSample felt = tick.run({hand.seconds(), at, haptic::Tool::kFeel});
    hand.write(felt.force_n - glm::dvec3(0.0, 0.0, options.press_n));
    const double swing = std::abs(at.z + depth);
    if (swing > 0.5 * depth) return true;
    if (i < part) early = std::max(early, swing);
    if (i >= ticks - part) late = std::max(late, swing);
  }
  return late > early;
}

// The one-period map of SimulatedHand for a constant force F: v' = p v + q F, x' = x + g v + s F. With
// F = -K x its determinant is p + K (g q - p s), and the amplitude is constant where that is 1.
double exactBound(double rate_hz, const StiffnessSweepOptions& options) {
  constexpr double kLongestSubstep_s = 10e-6;
  const int substeps = static_cast<int>(std::ceil(1.0 / (rate_hz * kLongestSubstep_s) - 1e-9));
  const double h = 1.0 / (rate_hz * substeps);
  const double push = h / (options.mass_kg * 1e-3);  // velocity per newton and substep
  double p = 1.0, q = 0.0, g = 0.0, s = 0.0;
  for (int i = 0; i < substeps; ++i) {
    p -= options.damping_n_s_per_mm * push * p;
    q += push - options.damping_n_s_per_mm * push * q;
    g += h * p;
    s += h * q;
  }
  return (1.0 - p) / (g * q - p * s);
}

bool inRange(double value, double low, double high) {
  return value >= low && value <= high;
}

}  // namespace

engine::Result<std::vector<StiffnessRow>> stiffnessSweep(const StiffnessSweepOptions& options,
                                                         engine::JobControl& job) {
  if (!inRange(options.damping_n_s_per_mm, 1e-5, 0.02) || !inRange(options.mass_kg, 0.01, 10.0) ||
      !inRange(options.press_n, 0.1, 100.0) ||
      !std::all_of(options.rates_hz.begin(), options.rates_hz.end(),
                   [](double rate) { return inRange(rate, 100.0, 20000.0); }))
    return engine::inputError(
        "damping, mass, press or rate is out of range", "stiffness sweep",
        "damping 1e-5 to 0.02 N s/mm, mass 0.01 to 10 kg, press 0.1 to 100 N, rates 100 to 20000 Hz");
  const engine::Version field = flatField();
  std::vector<StiffnessRow> rows;
  job.begin("sweeping stiffness", options.rates_hz.size() * kHalvings);
  for (const double rate_hz : options.rates_hz) {
    StiffnessRow row;
    row.rate_hz = rate_hz;
    row.damping_n_s_per_mm = options.damping_n_s_per_mm;
    row.theory_n_per_mm = 2.0 * options.damping_n_s_per_mm * rate_hz;
    row.exact_n_per_mm = exactBound(rate_hz, options);
    double low = 0.5 * row.theory_n_per_mm;
    double high = 2.0 * row.theory_n_per_mm;
    for (int i = 0; i < kHalvings; ++i) {
      if (job.cancelled()) return engine::cancelled();
      const double middle = std::sqrt(low * high);
      (buzzes(field, middle, rate_hz, options) ? high : low) = middle;
      job.advance(1);
    }
    row.measured_n_per_mm = std::sqrt(low * high);
    row.ratio = row.measured_n_per_mm / row.theory_n_per_mm;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace fettle::bench
