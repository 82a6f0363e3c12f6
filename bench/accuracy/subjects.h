#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// A named field that is difficult in one respect.
struct Subject {
  std::string name;
  engine::Version field;
};

/// A field of side x side samples of `height(column, row)` [mm]; `spacing_mm` apart, `spacing_y_mm` in the other direction
/// where it is not 0.
[[nodiscard]] engine::Result<engine::Version> fieldOf(std::int32_t side, double spacing_mm,
                                                      const std::function<double(int, int)>& height,
                                                      double spacing_y_mm = 0.0);

/// "flat"; "step", a wall of 1 mm, slanted over the grid; "ridge", walls one sample wide, 0.5 mm high;
/// "groove", concave corners of 90 degrees; "noise", white, sigma 20 um. 0.05 mm apart, `side` samples in
/// each direction.
[[nodiscard]] engine::Result<std::vector<Subject>> hardSubjects(std::int32_t side);

/// Grounds that a search of the closest point goes astray on, `side` samples in each direction, 0.05 mm apart: "noise",
/// sigma 20 um; "anisotropic noise", the same 0.03 x 0.12 mm apart; "steps", walls of 0.5 mm, slanted over the grid;
/// "saddles", 0.4 mm high; "ridges", walls one sample wide; "holes" and "spikes" of 5 mm, noise with 5 and 1 % of them.
[[nodiscard]] engine::Result<std::vector<Subject>> searchGrounds(std::int32_t side);

/// White noise of sigma 1 at a sample, the same for the same `seed`.
[[nodiscard]] double whiteNoise(std::uint64_t seed, int column, int row);

}  // namespace fettle::bench
