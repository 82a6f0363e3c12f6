#pragma once

#include <vector>

#include "engine/base/job.h"
#include "engine/edges/offsets.h"
#include "engine/edges/sides.h"
#include "engine/edges/surroundings.h"
#include "engine/field/edge_line.h"

namespace fettle::engine {

/// The parameters of a round.
struct RoundPlan {
  Offsets offsets;              ///< searched
  double depth = 0.0;           ///< half the width of the strip [samples]
  int half = 0;                 ///< the strip is 2 half + 1 points long
  double step_deviation = 0.0;  ///< change of the offset from point to point [samples]
  double smoothing = 0.0;       ///< of the new line, Gaussian along it [points]
  int tangent_half = 0;         ///< points before and after that give the tangent
  double deviation = 0.0;       ///< of the line from the edge before the round [samples]
};

/// What a round found at a point of a line.
struct Finding {
  Sides sides;
  double offset = 0.0;     ///< from the point where it was before the round [samples]
  double deviation = 0.0;  ///< of the chain [samples]
  double variance = 0.0;   ///< of the samples about the sides, at least that of the noise [height_unit^2]
  double evidence = 0.0;   ///< chi-square that two surfaces explain and one does not
  bool located = false;
};

/// Step, slope change and standard deviations of a located point; its position is left to the caller.
[[nodiscard]] EdgePoint edgePointOf(const Finding& finding);

struct LocatedLine {
  std::vector<glm::dvec2> points;  ///< one for each before
  std::vector<Finding> findings;
  bool strong = false;  ///< its steps stand out from the noise
};

/// Moves one line nearer to its edge. Reads the lines as they were before the round.
struct LineRound {
  /// Shorter lines have too few samples.
  static constexpr int kLeastPoints = 5;

  const std::vector<Polyline>& lines;
  const LineIndex& index;
  const std::vector<bool>& strong;
  int own = 0;
  Stage stage = Stage::kFirst;
  double noise = 0.0;  ///< [height_unit]
  RoundPlan plan;

  /// Notes in the window how well its samples fit. Blocks, on all workers; stops early when cancelled.
  [[nodiscard]] LocatedLine run(SampleWindow& window, const JobControl& job) const;

 private:
  [[nodiscard]] StripLine coarse(const SideContext& context, const std::vector<Surroundings>& around,
                                 const JobControl& job) const;
  [[nodiscard]] std::vector<Finding> findingsOf(const SideContext& context, const StripLine& line) const;
};

}  // namespace fettle::engine
