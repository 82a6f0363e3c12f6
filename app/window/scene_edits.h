#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/work/loop_client.h"
#include "haptic/scene/scene_numbers.h"

namespace fettle::app {

/// Changes of the scene and of the brush by panels, keys and mouse. An invalid change, or one that the device
/// cannot hold, is refused with a notice. Threading: main.
void applyScene(LoopClient& client, const haptic::Scene& scene, std::vector<Notice>& notices);
/// "0 to 2 N", "above 0, at most 1000 N/mm".
[[nodiscard]] std::string rangeInWords(const haptic::SceneNumber& number);
/// What is wrong with a number of the scene while it is typed, as a sentence: out of its range, at odds with another number, more
/// than the device holds, or, of a device without force, more than any known one holds. Empty: nothing.
[[nodiscard]] std::string numberProblem(const LoopClient& client, const haptic::SceneNumber& number,
                                        double typed);
/// Takes a typed number into the scene: out of its range the nearest in it, with a notice that passes. What the device does not
/// hold is refused with a notice, and the value before stays: a typing error can make a scene a thousand times as stiff.
void setNumber(LoopClient& client, const haptic::SceneNumber& number, double typed,
               std::vector<Notice>& notices);
/// The largest value that the device holds with the rest of the scene; nothing where it holds the whole range.
[[nodiscard]] std::optional<double> largestHeld(const LoopClient& client, const haptic::SceneNumber& number);
/// What a number is where no scene says otherwise: in a scene that is fitted, its lengths are those of the fit.
[[nodiscard]] double unlessSaid(const LoopClient& client, const haptic::SceneNumber& number);
/// Lists an effect or leaves it out; the spring comes before those that depend on it.
void listEffect(LoopClient& client, haptic::EffectKind kind, bool on, std::vector<Notice>& notices);

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
