#include "app/work/areal_choice.h"

#include <cmath>

namespace fettle::app {

void choose(const ArealChoice& choice, engine::ArealOptions& options) {
  options.volumes = choice.volumes;
  options.prune = choice.prune;
  if (choice.difference) options.between = {{choice.difference->first, choice.difference->second}};
}

void addChosen(Report& report, const ArealChoice& choice, const engine::ArealParameters& measured) {
  report["volume_ratios"] = Report::array({choice.volumes.peaks, choice.volumes.dales});
  report["prune"] = choice.prune;
  if (!choice.difference) return;
  // Where nothing could be measured there is none.
  const double height = measured.differences.empty() ? std::nan("") : measured.differences.front();
  report["sdc"] = {{"ratios", Report::array({choice.difference->first, choice.difference->second})},
                   {"height", std::isfinite(height) ? Report(height) : Report()}};
}

}  // namespace fettle::app
