#pragma once

#include <cstdint>
#include <span>

#include "engine/measure/line_offsets.h"

namespace fettle::engine {

/// Leaves slow form across the lines in the field (LineOptions::form_degree): of what is taken from the lines their trend over
/// the lines is taken away, and `form_rms` is set. `counts`: samples that count, of each line; lines without any do not count,
/// and what is taken from them is still to be set.
void leaveForm(LineOffsets& offsets, std::span<const std::int64_t> counts, int degree);

}  // namespace fettle::engine
