#pragma once

#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// What a file says about units and spacing; what it does not say is empty.
struct StatedUnits {
  std::optional<LengthUnit> lateral;
  std::optional<LengthUnit> height;
  std::optional<std::pair<double, double>> spacing;     ///< [lateral]
  std::optional<std::pair<double, double>> spacing_mm;  ///< as resolution tags give it; second choice
};

/// Settles units and spacing of `grid` from the user's options, then the file, then the defaults of
/// importField; appends what was assumed or overruled to `warnings`.
void settleUnits(Grid& grid, const StatedUnits& file, const ImportOptions& options,
                 std::vector<std::string>& warnings);

/// A unit by its size in metres: the usual name where there is one, else the file's own.
[[nodiscard]] LengthUnit lengthUnitFromMetres(double metres, std::string_view name);

/// Whether a name stands for a quantity that is no length: intensity, counts, volts, degrees and the like, in
/// any case.
[[nodiscard]] bool isNoLength(std::string_view name);

/// The unit that a file names for its heights; nothing for an empty name, and for one that is not known. A
/// quantity that is no length keeps its name, and counts as 1 mm. Both are warned of unless the user gave a
/// unit.
[[nodiscard]] std::optional<LengthUnit> heightUnitNamed(std::string_view name, const ImportOptions& options,
                                                        std::vector<std::string>& warnings);

/// Finds "unit NAME" or "units NAME" (or "units: NAME", "units=NAME") in a comment line of a text format.
[[nodiscard]] std::optional<LengthUnit> lengthUnitFromComment(std::string_view comment);

}  // namespace fettle::engine
