#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/field_view.h"
#include "engine/field/grid.h"
#include "engine/filter/catalogue.h"

namespace fettle::bench {

struct PreviewBenchOptions {
  std::vector<int> sides = {1024, 4096, 10240};  ///< of the fields [samples], each 256 .. 32768
  std::vector<engine::FilterKind> kinds = {engine::FilterKind::kMedian, engine::FilterKind::kGaussian,
                                           engine::FilterKind::kTotalVariation,
                                           engine::FilterKind::kGeneralisedVariation};
  int window = 5;                  ///< of the filters that have one [samples], odd
  double limit_s = 60.0;           ///< a filter's preview that takes longer is cancelled, > 0 .. 1e6
  bool fill = true, level = true;  ///< filled holes and levelled lines, too
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

/// Filled holes or levelled lines previewed likewise.
struct HeightPreviewRow {
  std::string what;  ///< "fill discs", "level matching"
  std::int32_t side = 0;
  std::int64_t seen = 0;    ///< samples in view
  double first = 0.0;       ///< until the first picture [s]; 0: there was none before the whole
  std::int32_t step = 1;    ///< samples on a side of the means that it is of
  double exact = 0.0;       ///< share of what changes in view that the last picture has exactly
  double off_said = 0.0;    ///< how far it says it is off, rms [height_unit]
  bool estimated = false;   ///< against a coarser approximation
  double off_whole = 0.0;   ///< and is, against the whole, where that changes something
  double change_rms = 0.0;  ///< there, from what was before; 0 where holes were
  double whole = 0.0;       ///< until the whole is there [s]
  double alone = 0.0;       ///< without a preview [s]
  std::uint64_t hash = 0;   ///< of both
};

struct PreviewBenchReport {
  std::string machine;
  std::vector<PreviewBenchRow> rows;
  std::vector<HeightPreviewRow> heights;
};

/// What a picture shows of so many samples in the middle of a field.
[[nodiscard]] engine::FieldView middleView(const engine::Grid& grid, std::int32_t columns, std::int32_t rows);

/// Adds previews of filled holes (of fields with single ones, discs, one large one) and of levelled lines (of a milled part, offsets
/// between its lines): haptic::computeHeights with a view. Errors: kFailed where a result differs from the one without a preview.
[[nodiscard]] engine::Status benchHeightPreviews(std::int32_t side, bool fill, bool level,
                                                 std::vector<HeightPreviewRow>& rows,
                                                 engine::JobControl& job);

/// Previews (engine::FilterView) of a milled part with noise, of which all is seen and then 1280 x 800 samples in the middle;
/// without drawing. Range sigmas are measured. Errors: kInput for options out of range; those of the filters; kCancelled.
/// Thread: any; blocks.
[[nodiscard]] engine::Result<PreviewBenchReport> benchPreviews(const PreviewBenchOptions& options,
                                                               engine::JobControl& job);

}  // namespace fettle::bench
