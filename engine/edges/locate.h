#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/edge_line.h"
#include "engine/field/reader.h"

namespace fettle::engine {

// Edge lines located from the strokes of a hand: a person draws roughly where an edge is, the samples next to
// the stroke decide where exactly it lies.
//
// All positions are sample coordinates, (column, row): sample centres are at whole numbers. Where the spacing
// differs between the axes, distances and normals are still those of the grid of samples, not of the part.

/// A stroke along an edge.
struct EdgeStroke {
  std::int64_t id = 0;  ///< the caller's; copied to the line
  std::vector<glm::dvec2>
      points;           ///< [samples], in drawing order; any distance apart, also outside the field
  bool closed = false;  ///< the last point joins the first
};

struct LocateOptions {
  static constexpr double kLeastHand = 0.25, kMostHand = 3.0;
  /// Standard deviation of the strokes from the edges [samples], kLeastHand .. kMostHand: 1.2 for a careful
  /// hand, 2.5 for a rough one. The search begins with 2.75 times as much on either side.
  double hand_deviation = 1.2;
};

/// Samples farther than this from every stroke, along columns and rows, have no influence [samples].
[[nodiscard]] int locateReach(const LocateOptions& options);

/// Locates the line of each stroke. `noise` is the standard deviation of the field's noise [height_unit], > 0;
/// estimateNoise() measures it.
///
/// How, in four rounds of shrinking reach: the samples around a stroke get coordinates along and across it;
/// around each point, a short strip is divided across into planes, at the stroke's own break, at those of
/// neighbouring strokes in their order, and at further breaks at a price; the least sum of squared residuals
/// for each offset of the own break is its cost, and a chain along the stroke picks the offsets (Viterbi 1967).
/// A second stage assigns the samples next to the line to the surface that they fit. Lines 2 to 10 samples
/// apart are located together: they neither take each other's edge nor cross, unless their strokes do. At walls of
/// 24 noises or more the line then runs between the samples that are certainly of either side (walls.h).
/// What was tried and measured: docs/decisions/edge-lines.md.
///
/// A point is not located where there are too few samples on a side, neither surface is a plane, the break
/// explains too little, or its position is uncertain by more than a sample.
///
/// Result: one line per stroke, in their order. Holes are left out; samples that no surface explains (spikes,
/// mixed pixels) are as well. Arithmetic in double, relative to a height of each stroke. Bit-identical for any
/// number of threads, and for any other cut of the field that holds the strokes and locateReach() around them,
/// moved by whole samples, if the strokes' coordinates are multiples of 2^-20.
///
/// Memory about 2 KiB, time about 0.1 ms of one core, per sample of stroke length; neither depends on the size
/// of the field. Progress counts points, a cancel takes effect within about 50 ms. Thread: any; blocks, on all
/// workers of the calling arena. Errors: kInput for noise or options out of range, a coordinate that is not
/// finite or beyond +-2^20, or strokes of more than 2^22 samples in all; kCancelled.
[[nodiscard]] Result<std::vector<EdgeLine>> locateEdgeLines(const FieldReader& field, double noise,
                                                            std::span<const EdgeStroke> strokes,
                                                            const LocateOptions& options, JobControl& job);

}  // namespace fettle::engine
