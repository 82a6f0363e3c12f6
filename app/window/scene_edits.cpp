#include "app/window/scene_edits.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/live/placement.h"
#include "app/texts/texts.h"

namespace fettle::app {

void applyScene(LoopClient& client, const haptic::Scene& scene, std::vector<Notice>& notices) {
  const engine::Status taken = client.setScene(scene);
  if (!taken) notices.push_back({taken.error().what, taken.error().remedy});
}

namespace {

haptic::Scene with(haptic::Scene scene, const haptic::SceneNumber& number, double value) {
  number.set(scene, value);
  return scene;
}

std::string shown(const haptic::SceneNumber& number, double value) {
  return fmt::format("{:.4g}{}{}", value, number.unit.empty() ? "" : " ", number.unit);
}

}  // namespace

// As haptic::rangeText(), in the language of the window.
std::string rangeInWords(const haptic::SceneNumber& number) {
  const std::string high = fmt::format("{}{}{}", number.high, number.unit.empty() ? "" : " ", number.unit);
  if (number.kind == haptic::NumberKind::kWhole)
    return trFormat("a whole number from {} to {}", number.low, high);
  return number.low_end == haptic::LowEnd::kExcluded ? trFormat("above {}, at most {}", number.low, high)
                                                     : trFormat("{} to {}", number.low, high);
}

std::string numberProblem(const LoopClient& client, const haptic::SceneNumber& number, double typed) {
  const auto nearest = haptic::nearestInRange(number, typed);
  if (!nearest) return trFormat("must be {}", rangeInWords(number));
  // As setNumber(): of a value that is much too large the device's limit is what matters.
  if (const auto problem = client.stabilityProblem(with(client.scene(), number, typed)))
    return fmt::format("{}: {}", problem->what, problem->remedy);
  if (*nearest != typed)
    return trFormat("must be {}: {} is taken", rangeInWords(number), shown(number, *nearest));
  const haptic::Scene scene = with(client.scene(), number, typed);
  if (auto problem = haptic::sceneProblem(scene)) return *std::move(problem);
  if (client.device().profile().gives_force) return {};
  const auto problem = problemOnEveryDevice(scene, client.field().grid(), client.rate());
  return problem ? withoutForceText(*problem) : std::string();
}

void setNumber(LoopClient& client, const haptic::SceneNumber& number, double typed,
               std::vector<Notice>& notices) {
  const auto nearest = haptic::nearestInRange(number, typed);
  if (!nearest) {
    notices.push_back({trFormat("{}: must be {}", tr(number.name), rangeInWords(number)),
                       trFormat("{} stays", shown(number, number.of(client.scene())))});
    return;
  }
  if (client.stabilityProblem(with(client.scene(), number, typed))) {
    applyScene(client, with(client.scene(), number, typed), notices);
    return;
  }
  applyScene(client, with(client.scene(), number, *nearest), notices);
  if (*nearest != typed)
    notices.push_back({trFormat("{}: {} is taken, it must be {}", tr(number.name), shown(number, *nearest),
                                rangeInWords(number)),
                       "", "", 1, false, true});
  noteWithoutForce(client, notices);
}

std::optional<double> largestHeld(const LoopClient& client, const haptic::SceneNumber& number) {
  const auto problem = client.stabilityProblem(with(client.scene(), number, number.high));
  if (!problem) return std::nullopt;
  const double held = number.of(problem->corrected);
  return held < number.high ? std::optional(held) : std::nullopt;
}

double unlessSaid(const LoopClient& client, const haptic::SceneNumber& number) {
  const auto& fit = client.fit();
  const double plain = number.of(haptic::defaultScene());
  const bool fitted = fit && (haptic::lengthPower(number) != 0 || number.of(fit->plain) == plain);
  return fitted ? number.of(fit->fitted) : plain;
}

void listEffect(LoopClient& client, haptic::EffectKind kind, bool on, std::vector<Notice>& notices) {
  haptic::Scene scene = client.scene();
  if (scene.lists(kind) == on) return;
  if (!on)
    std::erase(scene.effects, kind);
  else if (kind == haptic::EffectKind::kSpring)
    scene.effects.insert(scene.effects.begin(), kind);
  else
    scene.effects.push_back(kind);
  applyScene(client, scene, notices);
}

void noteWithoutForce(const LoopClient& client, std::vector<Notice>& notices) {
  if (client.device().profile().gives_force) return;
  if (const auto problem = problemOnEveryDevice(client.scene(), client.field().grid(), client.rate()))
    notices.push_back({withoutForceText(*problem), ""});
}

void setTip(LoopClient& client, haptic::TipShape tip, std::vector<Notice>& notices) {
  constexpr double kUsualBall = 2.0;  // [samples]
  constexpr int kAllRounds = 2048;
  haptic::Scene scene = client.scene();
  if (scene.tip == tip) return;
  scene.tip = tip;
  const engine::Grid& grid = client.field().grid();
  if (tip == haptic::TipShape::kSphere && haptic::sphereProblem(scene.tip_radius_mm, grid))
    scene.tip_radius_mm = kUsualBall * std::max(grid.spacingXMm(), grid.spacingYMm());
  // A ball may have fewer; at this level a point may not.
  if (tip == haptic::TipShape::kPoint && scene.level == haptic::ContactLevel::kPaper)
    scene.search_rounds = kAllRounds;
  applyScene(client, scene, notices);
}

double brushRadius(const LoopClient& client) {
  return client.scene().*haptic::brushRadiusOf(client.tool());
}

void setBrushRadius(LoopClient& client, double samples, std::vector<Notice>& notices) {
  if (!std::isfinite(samples)) return;
  haptic::Scene scene = client.scene();
  const double radius = std::clamp(samples, 0.0, haptic::kMaxBrushRadius);
  double& of_tool = scene.*haptic::brushRadiusOf(client.tool());
  if (of_tool == radius) return;
  of_tool = radius;
  applyScene(client, scene, notices);
}

void setPressDepth(LoopClient& client, double depth_mm) {
  if (client.mouse() == nullptr || !std::isfinite(depth_mm)) return;
  haptic::MouseStylus& mouse = *client.mouse();
  const engine::Grid& grid = client.field().grid();
  const double step = 0.1 * std::max(grid.spacingXMm(), grid.spacingYMm());  // of LoopClient's mouse
  mouse.wheel((mouse.pressMm() - depth_mm) / step);
}

void toggleLimit(std::optional<double>& limit, double& last) {
  if (limit) last = *limit;
  limit = limit ? std::nullopt : std::optional(last);
}

}  // namespace fettle::app
