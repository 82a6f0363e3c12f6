#pragma once

#include <optional>
#include <string>

#include "engine/field/grid.h"

namespace fettle::engine {

/// What a format has no field for - units, exact spacing and origin, counts, the coordinate system - as text,
/// lines of "key = value". Formats that can carry a text of a program's own carry this one; other programs
/// pass it over.
[[nodiscard]] std::string gridNotes(const Grid& grid);

/// The grid that the text describes, without its sides; nothing if anything is missing or cannot be.
[[nodiscard]] std::optional<Grid> gridOfNotes(const std::string& text);

}  // namespace fettle::engine
