#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/align.h"
#include "engine/mosaic/pose_adjustment.h"

namespace fettle::engine {

/// A pair that should overlap and could not be aligned.
struct FailedPair {
  std::size_t first = 0, second = 0;
  Error reason;
};

/// A pair whose surface repeats itself (Alignment::repeat).
struct RepeatedPair {
  std::size_t first = 0, second = 0;
  glm::dvec2 shift{0.0};  ///< by which the second, moved further, fits as well [mm]
};

struct OverlapMotions {
  std::vector<PairMotion> pairs;
  std::vector<Alignment> alignments;  ///< of each pair, in its pieces' own coordinates
  std::vector<FailedPair> failed;
  std::vector<RepeatedPair> repeated;
};

/// Aligns every two scans that overlap. `places`: where the lower left sample of each lies, roughly [mm]; then the parts of
/// both that overlap, and so much around them as `play` [mm] allows places to be wrong, are aligned with a
/// search among themselves. Without places every pair is tried over the whole of both, which finds overlaps of at least a
/// fifth. A pair that cannot be aligned is no error: others may place its scans. `names`: what its reason calls the scans, as many
/// as there are, or none: the words of `options`.
/// Costs, threads: alignFields() of each; memory: two pieces besides, not in a store. Errors: kCancelled. Throws std::bad_alloc.
[[nodiscard]] Result<OverlapMotions> overlapMotions(const std::vector<Version>& scans,
                                                    const std::optional<std::vector<glm::dvec2>>& places,
                                                    double play, const AlignOptions& options,
                                                    const std::vector<std::string>& names, JobControl& job);

/// The middle of each scan, at its middle height, in its field coordinates [mm]. Errors: kCancelled. Throws std::bad_alloc.
[[nodiscard]] Result<std::vector<glm::dvec3>> middlesOf(const std::vector<Version>& scans, JobControl& job);

/// The places that the grids of scans state; nothing where all are at one place, as where files state none.
[[nodiscard]] std::optional<std::vector<glm::dvec2>> statedPlaces(const std::vector<Version>& scans);

/// Places of scans that were taken in rows of `columns`, from the lower left, row by row, each overlapping the next by a share
/// of its own side; each as wide and high as it is.
[[nodiscard]] std::vector<glm::dvec2> placesInRows(const std::vector<Version>& scans, std::size_t columns,
                                                   double overlap);

}  // namespace fettle::engine
