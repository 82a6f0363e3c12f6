#pragma once

#include <cstdint>

#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// Steps and noise, some holes and marks; sides that end inside a tile. The same on every machine.
[[nodiscard]] Version scanWithEverything(std::int32_t width, std::int32_t height, std::uint64_t seed = 1);

/// A spec of each filter whose result is far from its input everywhere.
[[nodiscard]] FilterSpec specFor(FilterKind kind, int passes, int threads);

}  // namespace fettle::engine
