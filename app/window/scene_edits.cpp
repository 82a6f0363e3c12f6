#include "app/window/scene_edits.h"

#include <algorithm>
#include <cmath>

#include "app/live/placement.h"

namespace fettle::app {

void applyScene(LoopClient& client, const haptic::Scene& scene, std::vector<Notice>& notices) {
  const engine::Status taken = client.setScene(scene);
  if (!taken) notices.push_back({taken.error().what, taken.error().remedy});
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
