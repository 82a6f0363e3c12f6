#pragma once

#include <string>
#include <vector>

#include "engine/field/grid.h"

namespace fettle::render {

/// 1, 2 or 5 times a power of ten, the largest not above `value` (> 0, finite).
[[nodiscard]] double roundDown125(double value);

/// A length unit for displayed numbers: its name in UTF-8 ("µm") and how many of it make one of the field's
/// unit.
struct ShownUnit {
  std::string name;
  double per_unit = 1.0;
};

/// A readable unit for a length of `size` (in `unit`, > 0): `unit` itself when the number lies in [smallest,
/// largest), otherwise the metric unit for which it lies in [1, 1000). Units that are not metric stay.
[[nodiscard]] ShownUnit shownUnit(const engine::LengthUnit& unit, double size, double smallest,
                                  double largest);

/// A unit for lengths in millimetres that reads like `shown`, a unit for lengths in units of `mm` millimetres.
[[nodiscard]] ShownUnit ofMillimetres(const ShownUnit& shown, double mm);

/// The units in which quantities of one field are shown: each quantity in one unit, on panels and legends alike.
struct FieldUnits {
  ShownUnit height;  ///< of heights
  ShownUnit
      change;  ///< of changes, limits, deviations, noise: a thousandth of the heights' span is readable in it
  ShownUnit length;           ///< across the field: positions, sizes of brushes and windows
  double height_step = 1e-4;  ///< to which heights are read: some ten-thousandth of their span [height.name]
};

/// The units for a field whose heights lie in [low, high] [height_unit], single spikes left out, finite. The field's own
/// unit where numbers are readable in it, else a metric one; a field without extent in a direction keeps its own.
[[nodiscard]] FieldUnits fieldUnits(const engine::Grid& grid, double low, double high);

/// The unit of deviations up to `size` [height_unit]: `change` as long as numbers are readable in it.
[[nodiscard]] ShownUnit deviationUnit(const engine::LengthUnit& unit, const ShownUnit& change, double size);

/// Decimals for numbers that are to be read to `step` (> 0, finite): 0 to 12.
[[nodiscard]] int decimalsFor(double step);

/// Round numbers within [low, high], about `wanted` of them, with only the decimals they need.
struct Tick {
  double value = 0.0;
  std::string text;
};
[[nodiscard]] std::vector<Tick> ticks(double low, double high, int wanted);

/// A number with three significant digits, no exponent between 1e-4 and 1e6; a true minus sign.
[[nodiscard]] std::string shortNumber(double value);

}  // namespace fettle::render
