#include "engine/mosaic/join.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "engine/mosaic/overlap_motions.h"

namespace fettle::engine {
namespace {

// The scan that nothing joins to the first, and why its pairs failed.
tl::unexpected<Error> notJoined(const std::string& number, const std::vector<std::string>& names,
                                const OverlapMotions& found) {
  const auto scan = static_cast<std::size_t>(std::stoul(number));
  std::string why = "no other lies where it would overlap it";
  for (const FailedPair& pair : found.failed) {
    if (pair.first != scan && pair.second != scan) continue;
    why = fmt::format("with {}: {}", names[pair.first == scan ? pair.second : pair.first], pair.reason.what);
    break;
  }
  return inputError("no overlap joins this scan to the first", names[scan],
                    why + "; leave it out, or say where scans lie");
}

}  // namespace

double usualPlay(const std::vector<Version>& scans) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Version& scan : scans)
    shortest = std::min({shortest, (scan.grid().width - 1) * scan.grid().spacingXMm(),
                         (scan.grid().height - 1) * scan.grid().spacingYMm()});
  return 0.1 * shortest;
}

Result<JoinedScans> joinScans(const std::vector<Version>& scans, const JoinOptions& options,
                              JobControl& job) {
  auto found = overlapMotions(scans, options.places, options.play.value_or(usualPlay(scans)), options.align,
                              options.names, job);
  if (!found) return tl::unexpected(found.error());
  const auto middles = middlesOf(scans, job);
  if (!middles) return tl::unexpected(middles.error());
  auto poses = adjustPoses(*middles, found->pairs, options.align.moves);
  if (!poses) return notJoined(poses.error().where, options.names, *found);
  auto overlaps = overlapDeviations(scans, *poses, job);
  if (!overlaps) return tl::unexpected(overlaps.error());
  const auto grid = gridOverAll(scans, *poses);
  if (!grid) return tl::unexpected(grid.error());
  auto field = blendedScans(scans, *poses, *grid, options.blend, job);
  if (!field) return tl::unexpected(field.error());
  return JoinedScans{std::move(found->pairs), *std::move(poses), *std::move(overlaps),
                     std::move(found->repeated), *std::move(field)};
}

}  // namespace fettle::engine
