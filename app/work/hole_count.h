#pragma once

#include <cstdint>

#include "engine/field/version.h"

namespace fettle::app {

/// Samples of a field that have no height. Reads the tiles that have such. Any thread; throws std::bad_alloc.
[[nodiscard]] std::int64_t holesIn(const engine::Version& field);

}  // namespace fettle::app
