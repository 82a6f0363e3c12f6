#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/reference/command_table.h"
#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "render/config.h"

namespace fettle::app {

/// A length as typed by the user, in height units of the field: "0.5" is in the field's own height unit,
/// "0.5mm", "20um" in the named unit. Errors: not a number, unknown unit, negative, not finite.
[[nodiscard]] engine::Result<double> parseHeight(const std::string& text, const engine::Grid& grid,
                                                 const std::string& option);

/// The same with a sign: "-0.5mm". Errors: as above, without "negative".
[[nodiscard]] engine::Result<double> parseSignedHeight(const std::string& text, const engine::Grid& grid,
                                                       const std::string& option);

/// Allowed sides of a size, both ends included.
struct SideRange {
  int smallest;
  int largest;
};
inline constexpr SideRange kFieldSides{1, engine::Grid::kMaxSide};
inline constexpr SideRange kWindowSides{render::kSmallestPicture, render::kLargestPiece};
inline constexpr SideRange kPictureSides{render::kSmallestPicture, render::kLargestPicture};

/// "WIDTHxHEIGHT", both within `sides`. Errors name the option.
[[nodiscard]] engine::Result<std::pair<int, int>> parseSize(const std::string& text,
                                                            const std::string& option, SideRange sides);

/// The error of a seed as typed; empty when it is valid. For Parameter::problem.
[[nodiscard]] std::string seedProblem(const std::string& text);

/// The parts that the simulated scanner knows, each with its description.
[[nodiscard]] std::vector<Word> partWords();

}  // namespace fettle::app
