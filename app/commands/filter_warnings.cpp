#include "app/commands/filter_warnings.h"

#include <fmt/format.h>

#include "app/terminal.h"
#include "engine/filter/unjudged.h"

namespace fettle::app {

void addWeightless(Report& report, const engine::Filter& filter, const engine::FilterReport& done,
                   const std::string& of) {
  if (!filter.robust) return;
  report["weightless"] = done.weightless;
  if (const std::string warning = engine::warningOf(done); !warning.empty()) warn(of + ": " + warning);
}

engine::Status addUnjudged(Report& report, const engine::Version& field, const engine::FilterSpec& spec,
                           const std::string& of, const engine::JobControl& job) {
  if (spec.kind != engine::FilterKind::kOutliers) return {};
  const auto unjudged = engine::countUnjudged(field, spec, job);
  if (!unjudged) return engine::cancelled();
  report["unjudged"] = *unjudged;
  if (*unjudged > 0)
    warn(fmt::format(
        "{}: {} samples have too few others around them to be judged, and stay: between holes and "
        "at ragged rims; a larger --window or fettle remove takes them",
        of, *unjudged));
  return {};
}

void warnOfCutoff(const engine::FilterSpec& spec, const engine::Grid& grid, const std::string& of) {
  if (const std::string warning = engine::warningOf(spec, grid); !warning.empty()) warn(of + ": " + warning);
}

void warnOfBroughtBack(const engine::FilterSpec& spec, const engine::FilterReport& done,
                       const engine::Grid& grid, const std::string& of) {
  // A filter under a limit moves nothing farther than that from where it was within it.
  if (!spec.max_change || !(done.max_change > 2.0 * *spec.max_change)) return;
  warn(
      fmt::format("{}: --max-change counts from the scan as it was opened: what earlier steps moved farther, "
                  "as an outlier "
                  "that was taken out, came back, by up to {:.6g} {}",
                  of, done.max_change, grid.height_unit.name));
}

}  // namespace fettle::app
