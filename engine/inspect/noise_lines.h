#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/field/reader.h"

namespace fettle::engine {

/// What whole rows, or whole columns, of a field are off, found from all of their length: windows (noise_model.h) have the same
/// few offsets over and over, and which of them are quiet or without edges is decided by the offsets once these are loud.
struct LineNoise {
  double variance = 0.0;  ///< of an offset [height_unit^2]; 0: none found
  double error = 0.0;     ///< standard error of it
  /// With a variance: what the asked lines are off, from the first one of those that follow each other [height_unit]. It has what the
  /// surface has alike in the whole line, too.
  std::vector<double> offsets;
};

enum class LineDirection : std::uint8_t { kRows, kColumns };

/// The offsets of lines, by number in rising order. Lines that follow each other are compared sample by sample: fourth
/// differences, which a smooth surface has next to nothing of; their mean over a line, without the quarter at either end that
/// edges are in. Two halves of the line have their own noise of samples but the same offset, so that the mean of products of both
/// is the variance of offsets, unless it is below 3.5 standard errors of what independent samples make of it, or below 0.003 of
/// the variance of a sample (0.055 in standard deviations). Lines that are off by more than 4.5 standard deviations of the others
/// have an edge along them. Where the differences of lines that follow each other go together, as those of a wave over three lines and more,
/// they are the surface's. Not told from offsets: a surface that is rough from line to line and alike along the whole of them.
///
/// The error of variance is 2.3 / sqrt(lines) of itself for loud offsets. At most 512 samples a line are read. Turning heights upside
/// down changes nothing; bit-identical for any number of threads. Throws std::bad_alloc. Any thread.
[[nodiscard]] LineNoise noiseOfLines(const FieldReader& reader, LineDirection direction,
                                     std::span<const std::int32_t> lines);

}  // namespace fettle::engine
