#pragma once

#include <optional>
#include <string>

#include "engine/field/grid.h"
#include "haptic/devices/device.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

// A scene's lengths are those of the field: as they are, a stiffness of 1 N/mm is 0.00007 N/mm to a hand whose 70 mm are a scan of
// 5 um, and 70 kN/mm to one whose 70 mm are 5 km. Where the user gave no scene, the default one is fitted: the whole field is within
// the hand's reach, and its lengths are multiplied by one number so that the hand feels an ordinary part.
//
//   scale of the hand    S = longer side / reach                      [mm of the field per mm of the hand]
//   scale that is felt   f = that of an ordinary part, at most the largest at which the device holds the scene
//   magnification        m = S / f       lengths * m, all per length / m (haptic::lengthPower), all else as it is
//
// A part of ordinary size is as wide as its smaller side is, 50 to 200 mm: f = smaller side / reach, so that m = 1 and nothing is
// changed for a square one that the device holds. Smaller and larger fields are felt at 1:1 (f = 1): from the size where the
// ordinary ends f goes there as fast as the size leaves it, so that no two sizes next to each other differ much.

/// A scene before a fit, as the program begins with it, and after it. A number or word that is still that of the fit is fitted again for
/// another device, any other is the user's.
struct SceneFit {
  haptic::Scene plain, fitted;
};

/// The scene before the fit with what is neither number nor word (effects, inversion, largest change) as it is now.
[[nodiscard]] haptic::Scene plainOf(const haptic::Scene& scene, const SceneFit& fit);
/// `fitted` with the numbers and words in which `scene` differs from an earlier fit.
[[nodiscard]] haptic::Scene withEdits(haptic::Scene fitted, const haptic::Scene& scene,
                                      const haptic::Scene& fitted_before);

/// The scale [mm of the field per mm of the hand] at which the longer side of the field is within reach of a device on the desk; 1 for
/// a field of one sample.
[[nodiscard]] double wholeFieldScale(const haptic::DeviceProfile& profile, const engine::Grid& grid);

/// The scene with the default scene's lengths, fitted to be felt at `scale` [mm of the field per mm of the hand] or less. Stable
/// there with the effects of the default scene; with others as at 1:1, see its stabilityProblem. A value out of a scene's range is
/// the nearest in it. With the default's lengths as they are for a device that holds no stiffness at all.
[[nodiscard]] haptic::Scene fittedScene(const haptic::Scene& scene, const haptic::DeviceProfile& profile,
                                        const engine::Grid& grid, double rate_hz, double scale);
/// The same at wholeFieldScale().
[[nodiscard]] haptic::Scene fittedScene(const haptic::Scene& scene, const haptic::DeviceProfile& profile,
                                        const engine::Grid& grid, double rate_hz);

/// Why a scene that was not fitted is felt badly at a scale.
struct FeltProblem {
  std::string
      what;  ///< a sentence: nothing is felt, or the hand reaches a part of the field, and by which value
  std::string remedy;  ///< names a stiffness with which it is otherwise
};
/// Of a device on the desk that gives force; nothing for others, and where all is well: the hand reaches half of what it would
/// reach with a softer spring, and feels a tenth of what is felt at 1:1.
[[nodiscard]] std::optional<FeltProblem> feltProblem(const haptic::Scene& scene,
                                                     const haptic::DeviceProfile& profile,
                                                     const engine::Grid& grid, double rate_hz, double scale);

}  // namespace fettle::app
