#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/field/edge_line.h"

namespace fettle::engine {

/// Edge lines as bytes, every bit of every number kept: a 32-bit count, then for each line its id (64 bits), whether
/// it is closed (a byte), a 32-bit count of points, and each point as x, y and a byte (bit 0: located, bit 1: a
/// crease), followed for a located one by its five other values in the order of EdgePoint. Little-endian.
[[nodiscard]] std::string packLines(const EdgeLines& lines);

/// Empty for bytes that packLines() does not make: too few or too many, a number that is not finite, a position
/// beyond +-2^20, a negative deviation, an id that two lines have.
[[nodiscard]] std::optional<EdgeLines> unpackLines(std::string_view bytes);

}  // namespace fettle::engine
