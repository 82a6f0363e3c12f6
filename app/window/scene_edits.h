#pragma once

#include <optional>
#include <vector>

#include "app/work/loop_client.h"

namespace fettle::app {

/// Changes of the scene and of the brush as panels, keys and mouse make them. What cannot be, or what the
/// device does not hold, is said in a notice and not done. Threading: main.
void applyScene(LoopClient& touch, const haptic::Scene& scene, std::vector<Notice>& notices);
/// A notice when no known device would hold the scene; where one is connected, its own refusal counts.
void noteWithoutForce(const LoopClient& touch, std::vector<Notice>& notices);

/// Whether the tool sets or clears marks: those have a brush of their own.
[[nodiscard]] bool isMarkTool(haptic::Tool tool) noexcept;
/// Of the tool that is on [samples].
[[nodiscard]] double brushRadius(const LoopClient& touch);
void setBrushRadius(LoopClient& touch, double samples, std::vector<Notice>& notices);
/// How deep the mouse presses [mm]; nothing happens without a mouse.
void setPressDepth(LoopClient& touch, double depth_mm);

/// A largest change [height unit] on or off; `last` is what it is when it is on again.
void toggleLimit(std::optional<double>& limit, double& last);

}  // namespace fettle::app
