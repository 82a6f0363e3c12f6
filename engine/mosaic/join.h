#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/align.h"
#include "engine/mosaic/blended.h"
#include "engine/mosaic/overlap_motions.h"
#include "engine/mosaic/pose_adjustment.h"

namespace fettle::engine {

struct JoinOptions {
  std::optional<std::vector<glm::dvec2>> places;  ///< as of overlapMotions(); none: overlaps are searched for
  std::optional<double> play;                     ///< by how much places may be wrong [mm]; none: usualPlay()
  AlignOptions align;
  Blend blend = Blend::kFade;
  std::vector<std::string> names;  ///< of the scans, for errors; as many as there are
};

struct JoinedScans {
  std::vector<PairMotion> pairs;
  AdjustedPoses poses;
  std::vector<OverlapDeviation> overlaps;
  std::vector<RepeatedPair> repeated;
  Version field;
};

/// A tenth of the shortest side [mm].
[[nodiscard]] double usualPlay(const std::vector<Version>& scans);

/// Lays scans that overlap onto each other and makes one of them: overlapMotions(), adjustPoses(), overlapDeviations() and
/// blendedScans() one after the other, with their costs and threads. The first stays where it is.
/// Errors: a scan that no overlap joins to the first (kInput, by its name, with the reason); those of each.
[[nodiscard]] Result<JoinedScans> joinScans(const std::vector<Version>& scans, const JoinOptions& options,
                                            JobControl& job);

}  // namespace fettle::engine
