#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/filter/catalogue.h"

namespace fettle::bench {

struct PreviewBenchOptions {
  std::vector<int> sides = {1024, 4096, 10240};  ///< of the fields [samples], each 256 .. 32768
  std::vector<engine::FilterKind> kinds = {engine::FilterKind::kMedian, engine::FilterKind::kGaussian,
                                           engine::FilterKind::kTotalVariation,
                                           engine::FilterKind::kGeneralisedVariation};
  int window = 5;         ///< of the filters that have one [samples], odd
  double limit_s = 60.0;  ///< a preview that takes longer is cancelled, > 0 .. 1e6
};

/// A filter previewed while a view of the field is seen. Times from its request [s]; 0: not within the limit.
struct PreviewBenchRow {
  std::string filter;  ///< "median 5"
  std::int32_t side = 0;
  std::int64_t seen = 0;  ///< samples in view
  double first = 0.0;     ///< until all of the view shows the filter, approximately or not
  std::int32_t step =
      0;  ///< that is approximated from means of so many samples on a side; 0: not approximated
  double off_rms = 0.0;  ///< of the approximation, against the results [height_unit]
  double off_most = 0.0;
  bool estimated = false;  ///< of these: against an approximation from fewer samples
  double change_rms =
      0.0;             ///< what the filter changes, for comparison [height_unit]; 0: not within the limit
  double exact = 0.0;  ///< until all of the view has its results
  double whole = 0.0;  ///< until the whole field has; of a part of the field in view: not waited for
};

struct PreviewBenchReport {
  std::string machine;
  std::vector<PreviewBenchRow> rows;
};

/// Previews (engine::FilterView) of a milled part with noise, of which all is seen and then 1280 x 800 samples in the middle;
/// without drawing. Range sigmas are measured. Errors: kInput for options out of range; those of the filters; kCancelled.
/// Thread: any; blocks.
[[nodiscard]] engine::Result<PreviewBenchReport> benchPreviews(const PreviewBenchOptions& options,
                                                               engine::JobControl& job);

}  // namespace fettle::bench
