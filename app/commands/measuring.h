#pragma once

#include <optional>
#include <string>

#include "app/commands/form_option.h"
#include "app/commands/noise_option.h"
#include "app/commands/scale_option.h"
#include "app/work/work_estimate.h"
#include "engine/field/version.h"
#include "engine/io/import.h"
#include "engine/measure/areal.h"

namespace fettle::app {

/// The parameters of a surface that `fettle measure` and `report` state.
struct PlannedMeasuring {
  const engine::Version& counted;  ///< as countedOf
  const std::string& scan;         ///< its path
  const engine::Imported& imported;
  const FormArguments& form;
  const ScaleArguments& scale;
  engine::ArealOptions areal;
  int trials;      ///< as of addNoiseOption
  int states = 1;  ///< of as many samples that are measured
};

/// The work for an estimate. What `measuring` refers to lives as long as what is returned.
[[nodiscard]] PlannedOnPieces plannedMeasuring(const PlannedMeasuring& measuring);

/// What the noise of the scan does to what was measured: by trials on all of it, or, where as many as are usual are made and that is none
/// of so many samples, on a part of it. `limited`: the surface that was measured; `stated`: its parameters. Nothing, and errors, as arealNoise.
[[nodiscard]] engine::Result<std::optional<PartNoise>> noiseOfMeasured(const PlannedMeasuring& measuring,
                                                                       const ScaleLimited& limited,
                                                                       const engine::ArealParameters& stated,
                                                                       engine::JobControl& job);

}  // namespace fettle::app
