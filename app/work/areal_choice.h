#pragma once

#include <optional>
#include <utility>

#include "app/report.h"
#include "engine/measure/areal.h"

namespace fettle::app {

/// What a person may choose of the functional and the feature parameters; shares of 1.
struct ArealChoice {
  engine::VolumeRatios volumes = {};            ///< of Vmp, Vmc, Vvc and Vvv
  double prune = engine::ArealOptions().prune;  ///< of Sz: hills and dales that are lower are no features
  std::optional<std::pair<double, double>> difference =
      {};  ///< the material ratios of Sdc, the smaller one first; none: no Sdc
};

/// What is to be measured for it.
void choose(const ArealChoice& choice, engine::ArealOptions& options);

/// The keys volume_ratios, prune and, with a difference, sdc.
void addChosen(Report& report, const ArealChoice& choice, const engine::ArealParameters& measured);

}  // namespace fettle::app
