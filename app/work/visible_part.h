#pragma once

#include <cstdint>
#include <span>

#include "engine/field/field_view.h"
#include "engine/field/grid.h"

namespace fettle::app {

/// A visible sample.
struct Seen {
  std::int32_t column = 0, row = 0;
};

/// The part of a field that is shown: the tiles around all visible samples, some more on each side, since what is between two
/// of these is visible too. No tiles where nothing is visible.
[[nodiscard]] engine::FieldView visiblePart(const engine::Grid& grid, std::span<const Seen> seen,
                                            const Seen& middle);

}  // namespace fettle::app
