#include "app/work/areal_choice.h"

#include <cmath>

namespace fettle::app {

void choose(const ArealChoice& choice, engine::ArealOptions& options) {
  options.volumes = choice.volumes;
  options.prune = choice.prune;
  if (choice.difference)
    options.at_ratios.insert(options.at_ratios.begin(),
                             {choice.difference->first, choice.difference->second});
}

void addChosen(Report& report, const ArealChoice& choice, const engine::ArealParameters& measured,
               std::size_t heights) {
  report["volume_ratios"] = Report::array({choice.volumes.peaks, choice.volumes.dales});
  report["prune"] = choice.prune;
  if (!choice.difference) return;
  // Where nothing could be measured there are no heights.
  const bool there = heights + 1 < measured.heights.size();
  const double height = there ? measured.heights[heights] - measured.heights[heights + 1] : std::nan("");
  report["sdc"] = {{"ratios", Report::array({choice.difference->first, choice.difference->second})},
                   {"height", std::isfinite(height) ? Report(height) : Report()}};
}

}  // namespace fettle::app
