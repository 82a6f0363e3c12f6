#pragma once

#include <memory>

#include "engine/filter/block.h"

namespace fettle::engine {

/// Largest window, in samples, of a filter whose windows end at edge lines: a row of it is a word of bits.
inline constexpr int kMostLineWindow = 51;

/// How far beyond a window its results then depend on the lines and samples around it [samples].
inline constexpr int kLineReach = 2;

/// `windows`, each of whose results depends on the samples within `radius` alone, made to end at the edge lines of the
/// field: of a window that a line crosses only the samples count to which a way within it leads from its middle, from
/// row to row and from column to column, over no cut link (LineCuts). The others count as holes. Around the end of a line
/// such a way exists. Lines are some tenths of a sample off: where the medians of both sides of a window differ by more
/// than six standard deviations within each, the samples within two of the line are on the side whose median is nearer;
/// in a window with nothing beyond the line, those eighteen from its median are left out.
///
/// Costs, for each sample within `radius` of a line, some 50 ns per row of the window, and what `windows` takes for one
/// output; a median and a mean take that from the same sets of samples. Bit-identical to a plain search, sample by sample.
[[nodiscard]] std::unique_ptr<BlockFilter> endingAtLines(std::unique_ptr<BlockFilter> windows, int radius);

}  // namespace fettle::engine
