#include "haptic/effects/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace fettle::haptic {

namespace {

using std::numbers::pi;

// A value computed as the largest stable one counts as stable.
constexpr double kRounding = 1.0 + 1e-9;
// The spring, or the friction, is reported as the cause while at least this share of the stable stiffness is
// left to it.
constexpr double kLeastShare = 0.1;
constexpr double kSplinePart = 1.02;  // of texture.h's bound on the curvature

bool lists(const Scene& scene, EffectKind kind) noexcept {
  return std::find(scene.effects.begin(), scene.effects.end(), kind) != scene.effects.end();
}

// The relief's part across the surface: K (1 + slope^2) + F curvature.
struct Relief {
  double slope_squared = 0.0;
  double pressed_n_per_mm = 0.0;  // F curvature
};

Relief reliefOf(const Scene& scene) noexcept {
  if (!lists(scene, EffectKind::kTexture)) return {};
  const TextureParams& texture = scene.params.texture;
  const double wave = pi / texture.wavelength_mm;
  const double slope = texture.amplitude_mm * wave;
  return {slope * slope, scene.force_limit_n * kSplinePart * 2.0 * texture.amplitude_mm * wave * wave};
}

double across(const Scene& scene) noexcept {
  if (!lists(scene, EffectKind::kSpring)) return 0.0;
  const Relief relief = reliefOf(scene);
  return scene.stiffness_n_per_mm * (1.0 + relief.slope_squared) + relief.pressed_n_per_mm;
}

double snapStiffness(const Scene& scene) noexcept {
  if (!lists(scene, EffectKind::kEdgeSnap)) return 0.0;
  return 4.0 * scene.params.edge_snap.force_n / scene.params.edge_snap.reach_mm;
}

double frictionStiffness(const Scene& scene) noexcept {
  return lists(scene, EffectKind::kFriction) ? scene.params.friction.stiffness_n_per_mm : 0.0;
}

// Of the estimate of the velocity.
double filteredDamping(const Scene& scene) noexcept {
  double sum = 0.0;
  if (lists(scene, EffectKind::kViscosity)) sum += scene.params.viscosity.damping_n_s_per_mm;
  if (lists(scene, EffectKind::kCoupling)) sum += scene.params.coupling.damping_n_s_per_mm;
  return sum;
}

double damping(const Scene& scene) noexcept {
  return filteredDamping(scene) +
         (lists(scene, EffectKind::kPassivity) ? scene.params.passivity.max_damping_n_s_per_mm : 0.0);
}

// What part of a scene is stable on a device, in the field's millimetres.
class Hold {
 public:
  Hold(const Scene& scene, const DeviceProfile& profile, double rate_hz, double scale,
       double longest_reach_mm)
      : scene_(scene),
        felt_(scene),
        device_(profile.name),
        rate_hz_(std::min(rate_hz, profile.rate_hz)),
        scale_(scale),
        stiffness_(profile.max_stiffness_n_per_mm * rate_hz_ / 1000.0 / scale),
        damping_(profile.max_damping_n_s_per_mm / scale) {
    felt_.force_limit_n = std::min(scene.force_limit_n, profile.max_force_n);
    felt_.params.edge_snap.reach_mm = std::min(scene.params.edge_snap.reach_mm, longest_reach_mm);
  }

  [[nodiscard]] std::optional<StabilityProblem> problem() const {
    if (across(felt_) > stiffness_ * kRounding) return acrossProblem();
    if (frictionStiffness(felt_) + snapStiffness(felt_) > stiffness_ * kRounding) return alongProblem();
    if (damping(felt_) > damping_ * kRounding) return dampingProblem();
    return std::nullopt;
  }
  /// The spring's, with the rest of the stiffness across the surface.
  [[nodiscard]] double stiffnessLeft() const noexcept {
    const Relief relief = reliefOf(felt_);
    return (stiffness_ - relief.pressed_n_per_mm) / (1.0 + relief.slope_squared);
  }
  /// Largest stable scale of the whole scene, relative to a scale of 1.
  [[nodiscard]] double largestScale() const noexcept {
    const double infinite = std::numeric_limits<double>::infinity();
    const double stiff = std::max(across(felt_), frictionStiffness(felt_) + snapStiffness(felt_));
    const double damps = damping(felt_);
    return roundedDown(
        std::min(stiff > 0.0 ? stiffness_ / stiff : infinite, damps > 0.0 ? damping_ / damps : infinite));
  }

 private:
  // "a stiffness of 3 N/mm, felt as 9, is more than the omni holds at 1000 Hz"
  [[nodiscard]] StabilityProblem tooMuch(const std::string& subject, double value, const char* unit,
                                         const char* with = "") const {
    const std::string felt = scale_ == 1.0 ? "" : fmt::format(", felt as {:.4g},", value * scale_);
    return {fmt::format("{} {:.6g} {}{}{} is more than the {} holds at {:.0f} Hz", subject, value, unit, with,
                        felt, device_, rate_hz_),
            {},
            0.0,
            scene_};
  }
  [[nodiscard]] StabilityProblem holdsNone(const char* what) const {
    return {fmt::format("the {} holds no {} at all", device_, what), "take another device", 0.0, scene_};
  }

  [[nodiscard]] StabilityProblem acrossProblem() const {
    if (!(stiffness_ > 0.0)) return holdsNone("stiffness");
    const bool texture = lists(scene_, EffectKind::kTexture);
    const double left = stiffnessLeft();
    if (left >= kLeastShare * stiffness_) {
      StabilityProblem p =
          tooMuch("a stiffness of", scene_.stiffness_n_per_mm, "N/mm", texture ? " with this texture" : "");
      p.largest = p.corrected.stiffness_n_per_mm = roundedDown(left);
      p.remedy = fmt::format("at most {:.4g} N/mm", p.largest);
      return p;
    }
    StabilityProblem p =
        tooMuch("a texture that stiffens the surface by up to", reliefOf(felt_).pressed_n_per_mm, "N/mm");
    const double spring = std::min(scene_.stiffness_n_per_mm, roundedDown(0.5 * stiffness_));
    // spring (1 + A^2 wave^2) + A F 2.04 wave^2 = what is held, for A.
    const double wave = pi / scene_.params.texture.wavelength_mm;
    const double square = spring * wave * wave;
    const double half = felt_.force_limit_n * kSplinePart * wave * wave;
    const double rest = stiffness_ - spring;
    p.largest = p.corrected.params.texture.amplitude_mm =
        roundedDown(rest / (half + std::sqrt(half * half + square * rest)));
    p.corrected.stiffness_n_per_mm = spring;
    p.remedy =
        fmt::format("an amplitude of at most {:.4g} mm with {:.4g} N/mm of stiffness", p.largest, spring);
    return p;
  }

  [[nodiscard]] StabilityProblem alongProblem() const {
    if (!(stiffness_ > 0.0)) return holdsNone("stiffness");
    const double grip = frictionStiffness(felt_), snap = snapStiffness(felt_);
    const double left = stiffness_ - snap;
    if (grip > 0.0 && left >= kLeastShare * stiffness_) {
      StabilityProblem p =
          tooMuch("friction with a stiffness of", grip, "N/mm", snap > 0.0 ? " with this edge snap" : "");
      p.largest = p.corrected.params.friction.stiffness_n_per_mm = roundedDown(left);
      p.remedy = fmt::format("at most {:.4g} N/mm ([friction] stiffness_n_per_mm)", p.largest);
      return p;
    }
    StabilityProblem p = tooMuch("edge snap with a stiffness of", snap, "N/mm");
    const double held = std::min(grip, roundedDown(0.5 * stiffness_));
    p.largest = p.corrected.params.edge_snap.force_n =
        roundedDown(0.25 * felt_.params.edge_snap.reach_mm * (stiffness_ - held));
    p.remedy = fmt::format("a force of at most {:.4g} N ([edge_snap] force_n)", p.largest);
    if (grip > 0.0) {
      p.corrected.params.friction.stiffness_n_per_mm = held;
      p.remedy += fmt::format(" with {:.4g} N/mm of friction", held);
    }
    return p;
  }

  [[nodiscard]] StabilityProblem dampingProblem() const {
    if (!(damping_ > 0.0)) return holdsNone("damping");
    const double asked = damping(felt_);
    StabilityProblem p = tooMuch("a damping of viscosity, coupling and passivity of", asked, "N s/mm");
    p.largest = roundedDown(damping_);
    p.remedy = fmt::format("at most {:.4g} N s/mm of them together", p.largest);
    const double share = p.largest / asked;
    p.corrected.params.viscosity.damping_n_s_per_mm *= share;
    p.corrected.params.coupling.damping_n_s_per_mm *= share;
    p.corrected.params.passivity.max_damping_n_s_per_mm *= share;
    return p;
  }

  const Scene& scene_;
  Scene felt_;  // with the force that the device gives at most, and the reach that the field has
  std::string device_;
  double rate_hz_, scale_;
  double stiffness_, damping_;  // held
};

}  // namespace

double roundedDown(double value) noexcept {
  if (!(value > 0.0)) return 0.0;
  if (std::isinf(value)) return value;
  const double digits = std::floor(std::log10(value)) - 3.0;
  // A power of ten above one is exact, below one it is not: dividing by it keeps 6 exactly 6.
  const double unit = std::pow(10.0, std::abs(digits));
  return digits < 0.0 ? std::floor(value * unit * kRounding) / unit
                      : std::floor(value / unit * kRounding) * unit;
}

StabilityNeed stabilityNeed(const Scene& scene, double rate_hz) noexcept {
  StabilityNeed need;
  need.stiffness_n_per_mm = std::max(across(scene), frictionStiffness(scene) + snapStiffness(scene));
  need.damping_n_s_per_mm = damping(scene);
  const double a = 1.0 / (1.0 + 1e-3 * scene.params.velocity.filter_ms * rate_hz);
  need.device_damping_n_s_per_mm =
      need.stiffness_n_per_mm / (2.0 * rate_hz) + filteredDamping(scene) * a / (2.0 - a);
  return need;
}

std::optional<StabilityProblem> stabilityProblem(const Scene& scene, const DeviceProfile& profile,
                                                 double rate_hz, double scale, double longest_reach_mm) {
  return Hold(scene, profile, rate_hz, scale, longest_reach_mm).problem();
}

double largestStiffness(const Scene& scene, const DeviceProfile& profile, double rate_hz, double scale) {
  return roundedDown(Hold(scene, profile, rate_hz, scale, kAnyReach_mm).stiffnessLeft());
}

Scene stableScene(Scene scene, const DeviceProfile& profile, double rate_hz, double scale,
                  double longest_reach_mm) {
  // Across, along, damping: each is corrected in one step, and none causes another again.
  for (int i = 0; i < 3; ++i) {
    auto problem = stabilityProblem(scene, profile, rate_hz, scale, longest_reach_mm);
    if (!problem) break;
    scene = std::move(problem->corrected);
  }
  return scene;
}

double largestStableScale(const Scene& scene, const DeviceProfile& profile, double rate_hz,
                          double longest_reach_mm) {
  return Hold(scene, profile, rate_hz, 1.0, longest_reach_mm).largestScale();
}

}  // namespace fettle::haptic
