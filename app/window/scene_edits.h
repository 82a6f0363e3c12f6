#pragma once

#include <optional>
#include <vector>

#include "app/work/loop_client.h"

namespace fettle::app {

/// Changes of the scene and of the brush by panels, keys and mouse. An invalid change, or one that the device
/// cannot hold, is refused with a notice. Threading: main.
void applyScene(LoopClient& client, const haptic::Scene& scene, std::vector<Notice>& notices);
/// A notice when no known device would hold the scene; a connected device refuses for itself.
void noteWithoutForce(const LoopClient& client, std::vector<Notice>& notices);

/// The shape of the tip. A ball whose radius does not fit this field gets one of two samples.
void setTip(LoopClient& client, haptic::TipShape tip, std::vector<Notice>& notices);

/// Of the active tool [samples].
[[nodiscard]] double brushRadius(const LoopClient& client);
void setBrushRadius(LoopClient& client, double samples, std::vector<Notice>& notices);
/// Press depth of the mouse [mm]; no effect without a mouse.
void setPressDepth(LoopClient& client, double depth_mm);

/// Switches a limit of change [height unit] on or off; `last` is its value when it is switched on again.
void toggleLimit(std::optional<double>& limit, double& last);

}  // namespace fettle::app
