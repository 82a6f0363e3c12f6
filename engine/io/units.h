#pragma once

#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// Units and spacing that a file states; what it does not state is empty.
struct StatedUnits {
  std::optional<LengthUnit> lateral;
  std::optional<LengthUnit> height;
  std::optional<std::pair<double, double>> spacing;     ///< [lateral]
  std::optional<std::pair<double, double>> spacing_mm;  ///< as given by resolution tags; second choice
};

/// Determines units and spacing of `grid` from the user's options, then the file, then the defaults of
/// importField; appends what was assumed or overruled to `warnings`.
void determineUnits(Grid& grid, const StatedUnits& file, const ImportOptions& options,
                    std::vector<std::string>& warnings);

/// A unit by its size in metres: the usual name where there is one, otherwise the file's own.
[[nodiscard]] LengthUnit lengthUnitFromMetres(double metres, std::string_view name);

/// Whether a name is that of a quantity other than length: intensity, counts, volts, degrees and the like, in
/// any case.
[[nodiscard]] bool isNoLength(std::string_view name);

/// The unit that a file names for its heights; nothing for an empty or unknown name. A quantity that is not a
/// length keeps its name, and counts as 1 mm. Both give a warning unless the user gave a unit.
[[nodiscard]] std::optional<LengthUnit> heightUnitNamed(std::string_view name, const ImportOptions& options,
                                                        std::vector<std::string>& warnings);

/// Finds "unit NAME" or "units NAME" (or "units: NAME", "units=NAME") in a comment line of a text format.
[[nodiscard]] std::optional<LengthUnit> lengthUnitFromComment(std::string_view comment);

}  // namespace fettle::engine
