#include "app/window/scene_edits.h"

#include <algorithm>
#include <cmath>

#include "app/live/placement.h"

namespace fettle::app {

void applyScene(LoopClient& touch, const haptic::Scene& scene, std::vector<Notice>& notices) {
  const engine::Status taken = touch.setScene(scene);
  if (!taken) notices.push_back({taken.error().what, taken.error().remedy});
}

void noteWithoutForce(const LoopClient& touch, std::vector<Notice>& notices) {
  if (touch.device().profile().gives_force) return;
  if (const auto problem = problemOnEveryDevice(touch.scene(), touch.field().grid(), touch.rate()))
    notices.push_back({withoutForceText(*problem), ""});
}

double brushRadius(const LoopClient& touch) {
  return touch.scene().*haptic::brushRadiusOf(touch.tool());
}

void setBrushRadius(LoopClient& touch, double samples, std::vector<Notice>& notices) {
  if (!std::isfinite(samples)) return;
  haptic::Scene scene = touch.scene();
  const double radius = std::clamp(samples, 0.0, haptic::kMaxBrushRadius);
  double& of_tool = scene.*haptic::brushRadiusOf(touch.tool());
  if (of_tool == radius) return;
  of_tool = radius;
  applyScene(touch, scene, notices);
}

void setPressDepth(LoopClient& touch, double depth_mm) {
  if (touch.mouse() == nullptr || !std::isfinite(depth_mm)) return;
  haptic::MouseStylus& mouse = *touch.mouse();
  const engine::Grid& grid = touch.field().grid();
  const double step = 0.1 * std::max(grid.spacingXMm(), grid.spacingYMm());  // of LoopClient's mouse
  mouse.wheel((mouse.pressMm() - depth_mm) / step);
}

void toggleLimit(std::optional<double>& limit, double& last) {
  if (limit) last = *limit;
  limit = limit ? std::nullopt : std::optional(last);
}

}  // namespace fettle::app
