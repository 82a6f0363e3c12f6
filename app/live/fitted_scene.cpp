#include "app/live/fitted_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "app/live/placement.h"
#include "haptic/effects/stability.h"
#include "haptic/scene/scene_numbers.h"

namespace fettle::app {

namespace {

// Smaller sides of parts of ordinary size [mm].
constexpr double kSmallestPart_mm = 50.0;
constexpr double kLargestPart_mm = 200.0;
// A ball is at most 16 cells (haptic::sphereProblem).
constexpr double kMostBall_cells = 16.0;
// A tenth of the default scene at 1:1: pressed in by 10 mm a hand is met by half a newton.
constexpr double kFaint_n_per_mm = 0.1;
constexpr double kMostOfReach = 0.5;

struct Sides {
  double smaller_mm, longer_mm;
};

Sides sidesOf(const engine::Grid& grid) {
  const double x = (grid.width - 1) * grid.spacingXMm();
  const double y = (grid.height - 1) * grid.spacingYMm();
  return {std::min(x, y), std::max(x, y)};
}

// The scale that is felt where the device holds it.
double ordinaryScale(const haptic::DeviceProfile& profile, double side_mm) {
  const double ordinary_mm = std::clamp(side_mm, kSmallestPart_mm, kLargestPart_mm);
  const double at_end = ordinary_mm / (2.0 * profile.workspace_radius_mm);
  const double beyond = std::max(side_mm / ordinary_mm, ordinary_mm / side_mm);  // 1 of an ordinary part
  return at_end < 1.0 ? std::min(at_end * beyond, 1.0) : std::max(at_end / beyond, 1.0);
}

// As it is displayed.
double toFourDigits(double value) {
  return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr);
}

haptic::Scene withLengthsOf(haptic::Scene scene, const haptic::Scene& other) {
  for (const haptic::SceneNumber& number : haptic::kSceneNumbers)
    if (haptic::lengthPower(number) != 0) number.set(scene, number.of(other));
  return scene;
}

haptic::Scene magnified(haptic::Scene scene, double magnification) {
  for (const haptic::SceneNumber& number : haptic::kSceneNumbers) {
    const int power = haptic::lengthPower(number);
    if (power == 0) continue;
    const double value = number.of(scene);
    // Stiffness and damping are rounded to the side that is stable; lengths, which bound a stiffness by way of a force, to the
    // nearest: what is then over by a two-thousandth is left to stabilityProblem.
    const double fitted =
        power > 0 ? toFourDigits(value * magnification) : haptic::roundedDown(value / magnification);
    number.set(scene, std::clamp(fitted, number.low, number.high));
  }
  return scene;
}

}  // namespace

haptic::Scene plainOf(const haptic::Scene& scene, const SceneFit& fit) {
  haptic::Scene plain = fit.plain;
  plain.effects = scene.effects;
  plain.invert = scene.invert;
  plain.max_change = scene.max_change;
  return plain;
}

haptic::Scene withEdits(haptic::Scene fitted, const haptic::Scene& scene,
                        const haptic::Scene& fitted_before) {
  for (const haptic::SceneNumber& number : haptic::kSceneNumbers)
    if (number.of(scene) != number.of(fitted_before)) number.set(fitted, number.of(scene));
  for (const haptic::SceneWord& word : haptic::kSceneWords)
    if (word.of(scene) != word.of(fitted_before)) word.set(fitted, word.of(scene));
  return fitted;
}

double wholeFieldScale(const haptic::DeviceProfile& profile, const engine::Grid& grid) {
  const double scale = sidesOf(grid).longer_mm / (2.0 * profile.workspace_radius_mm);
  return scale > 0.0 ? scale : 1.0;
}

haptic::Scene fittedScene(const haptic::Scene& scene, const haptic::DeviceProfile& profile,
                          const engine::Grid& grid, double rate_hz) {
  return fittedScene(scene, profile, grid, rate_hz, wholeFieldScale(profile, grid));
}

haptic::Scene fittedScene(const haptic::Scene& scene, const haptic::DeviceProfile& profile,
                          const engine::Grid& grid, double rate_hz, double scale) {
  const haptic::Scene plain = haptic::defaultScene();
  haptic::Scene usual = withLengthsOf(scene, plain);
  const double ordinary = ordinaryScale(profile, sidesOf(grid).smaller_mm);
  const double felt = profile.gives_force
                          ? std::min(ordinary, haptic::largestStableScale(plain, profile, rate_hz))
                          : ordinary;
  if (!(felt > 0.0)) return usual;
  if (felt == scale) return usual;
  haptic::Scene fitted = magnified(usual, scale / felt);
  fitted.tip_radius_mm =
      std::min(fitted.tip_radius_mm, kMostBall_cells * std::max(grid.spacingXMm(), grid.spacingYMm()));
  return fitted;
}

std::optional<FeltProblem> feltProblem(const haptic::Scene& scene, const haptic::DeviceProfile& profile,
                                       const engine::Grid& grid, double rate_hz, double scale) {
  if (profile.space != haptic::DeviceSpace::kDesk || !profile.gives_force ||
      !scene.lists(haptic::EffectKind::kSpring))
    return std::nullopt;
  const double whole = reachScale(profile, grid);
  const double stiffness = scene.stiffness_n_per_mm;
  // Where the device holds the scene with the whole field, a smaller scale is the user's choice.
  const auto unstable = scale < kMostOfReach * whole
                            ? haptic::stabilityProblem(scene, profile, rate_hz, whole, longestSnapMm(grid))
                            : std::nullopt;
  if (unstable)
    return FeltProblem{
        fmt::format("the hand reaches {:.3g} of {:.3g} mm of the field, with the whole of which {}",
                    2.0 * profile.workspace_radius_mm * scale, sidesOf(grid).smaller_mm, unstable->what),
        unstable->remedy};
  const double faint = std::min(kFaint_n_per_mm, 0.5 * profile.max_stiffness_n_per_mm);
  if (stiffness * scale >= faint) return std::nullopt;
  const double held = haptic::largestStiffness(scene, profile, rate_hz, scale);
  const double plain = std::min(held, haptic::roundedDown(haptic::defaultScene().stiffness_n_per_mm / scale));
  return FeltProblem{
      fmt::format("the surface is hardly felt: one millimetre of the hand is {:.3g} mm of the field, and a "
                  "stiffness of {:.4g} N/mm of the field is {:.2g} N/mm in the hand",
                  scale, stiffness, stiffness * scale),
      fmt::format("a stiffness of {:.4g} N/mm", plain)};
}

}  // namespace fettle::app
