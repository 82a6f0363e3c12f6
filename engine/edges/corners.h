#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/edge_line.h"

namespace fettle::engine {

/// Extends the located ends of open lines, straight on, to where they meet another line, the extension of another end, or
/// the border of a field of so many samples: at most kMostExtension samples. A line is located up to where it has
/// samples on both sides, a sample or two short of a corner, and filters would reach around its end. Ends of lines before number
/// `first` are only extended to later lines: they were there before.
///
/// The points that are added have step, slope and kind of the end, and its deviation, which grows by kEndTangent of
/// the extension. Ends that meet something already stay as they are, as do those that run along what they would meet
/// (less than some 20 degrees). Positions are multiples of 2^-20. Deterministic; O(points). Thread: any.
void extendEnds(std::vector<EdgeLine>& lines, std::size_t first, std::int32_t columns, std::int32_t rows);

/// A line without what extendEnds() has added to it: points at its ends with the figures of the point before.
[[nodiscard]] EdgeLine withoutExtensions(const EdgeLine& line);

inline constexpr double kMostExtension = 4.0;  ///< [samples]
inline constexpr double kEndTangent = 0.15;    ///< error of the direction of an end

}  // namespace fettle::engine
