#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"
#include "engine/measure/features.h"
#include "engine/measure/material_ratio.h"
#include "engine/measure/region.h"
#include "engine/measure/spatial.h"

namespace fettle::engine {

/// Areal surface texture parameters of ISO 25178-2:2021 over the samples of a region, heights about their mean after
/// the form is taken out. No S- or L-filter is applied: scaleFiltered (scale_filter.h)
/// before. NaN where the samples do not
/// determine a figure (skewness of a flat surface, slopes without a cell): `not_stated` has the reason then. None is stated of a
/// form through all samples, nor where Sz is no more than two of the steps between floats as large as the heights.
struct ArealParameters {
  std::int64_t samples = 0;
  std::int64_t cells = 0;  ///< with four samples of the region: those of sdq and sdr
  double mean = 0.0;       ///< of the heights less the form, from which the others are measured [height_unit]
  // Height, 4.2 [height_unit].
  double sq = 0.0;   ///< root mean square height
  double ssk = 0.0;  ///< skewness
  double sku = 0.0;  ///< kurtosis
  double sp = 0.0;   ///< maximum peak height
  double sv = 0.0;   ///< maximum pit depth
  double sz = 0.0;   ///< maximum height
  double sa = 0.0;   ///< arithmetical mean height
  // Hybrid, 4.3.
  double sdq = 0.0;  ///< root mean square gradient [mm/mm]
  double sdr = 0.0;  ///< developed interfacial area ratio [1], 0 for a plane
  // Functional, 4.4.
  MaterialRatio ratio;
  std::vector<double> ratios;           ///< Smr of each height asked for, 0 .. 1
  std::vector<double> heights;          ///< Smc of each ratio asked for [height_unit]
  std::vector<double> material, voids;  ///< Vm and Vv of each ratio asked for [height_unit]
  std::vector<double> differences;      ///< Sdc of each pair of ratios asked for [height_unit], >= 0
  // Spatial, and features.
  SpatialParameters spatial;
  std::shared_ptr<const SpatialAnalysis>
      analysis;  ///< where it was asked for and there was memory; else null
  FeatureParameters feature;

  std::vector<NotStated> not_stated;  ///< of the groups that were asked for
};

/// The groups to measure besides the height parameters, and what of the material ratio curve.
struct ArealOptions {
  Region region = Region::kAll;
  bool hybrid = true, functional = true, spatial = true, feature = true;
  std::vector<double> at_heights = {};  ///< for Smr [height_unit], about the mean
  std::vector<double> at_ratios = {};   ///< for Smc, 0 .. 1
  std::vector<double> at_volumes = {};  ///< for Vm and Vv, 0 .. 1
  std::vector<RatioPair> between = {};  ///< for Sdc
  VolumeRatios volumes = {};            ///< of Vmp, Vmc, Vvc and Vvv
  /// Numbers of the form that were fitted to these samples, FittedForm::numbers; 0: others, or none.
  int fitted = 0;
  bool analysis = false;  ///< keep the autocorrelation: 4 bytes per sample
  double prune = 0.05;    ///< share of Sz below which a hill is no feature
  /// Memory that is free for spatial parameters [bytes], 0: that is not known; none: as availableMemory() finds it.
  std::optional<std::uint64_t> free_memory = {};
};

/// Measures them. The surface between four samples is the bilinear patch through them, as everywhere in Fettle: the
/// gradient's mean square over it is exact, its area is integrated by 3 x 3 Gauss-Legendre points. On a sine of
/// wavelength L sampled every h both are lower than the sine's by (2 pi h / L)^2 / 12 of the gradient's square.
///
/// Sums in double, compensated over the tiles; order statistics exact. Bit-identical for any number of threads. Memory:
/// 4 bytes per sample while heights are sorted, 48 for features, 40 for spatial parameters, which are not stated where
/// so much is not free. Errors: kInput for a region without samples; kFailed without memory;
/// kCancelled. Thread: any; a long job on all workers of the calling arena.
[[nodiscard]] Result<ArealParameters> measureAreal(const Version& field, const NominalForm& form,
                                                   const ArealOptions& options, JobControl& job);

}  // namespace fettle::engine
