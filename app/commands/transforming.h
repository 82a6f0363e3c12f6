#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"
#include "engine/transform/resample.h"

namespace fettle::app {

/// What `fettle transform` and the step "transform" of a recipe do, in the order of the members.
struct TransformArguments {
  std::vector<double> crop;             ///< x0, y0, x1, y1 [mm] from the lower left sample; empty: all
  std::vector<int> crop_samples;        ///< row from the top, column, rows, columns; empty: all
  std::string mirror;                   ///< x, y, or empty
  std::string turn;                     ///< 90, 180, 270 [degrees, counter-clockwise], or empty
  double angle = 0.0;                   ///< [degrees, counter-clockwise]
  std::vector<std::string> to_spacing;  ///< one or two lengths as typed; empty: as it is
  std::string method;                   ///< area, linear, cubic; empty: as the spacing asks for

  [[nodiscard]] bool resamples() const;  ///< whether samples come between others
};

/// Refuses arguments with which nothing is done, and a method without new samples (kInput).
[[nodiscard]] engine::Status checkTransform(const TransformArguments& options);

struct Transformed {
  engine::Version field;
  std::optional<engine::Resampling> method;  ///< where samples came between others
};

/// Of a field that is seen under a form what is seen of it at its new places (engine/transform). Errors (kInput): a rectangle without a sample, a spacing that is no length above 0, more than two; those of
/// engine::resampled.
[[nodiscard]] engine::Result<Transformed> transformed(const engine::Version& field,
                                                      const TransformArguments& options,
                                                      engine::JobControl& job);

/// Says on standard error that a form lay over a field, and none over what was made of it.
void warnOfFormLeft(const engine::Version& field, const engine::Version& made, const std::string& scan);

/// Size and spacing of what becomes of a field with this grid. Errors: as transformed.
[[nodiscard]] engine::Result<engine::Grid> transformedGrid(const engine::Grid& grid,
                                                           const TransformArguments& options);

/// The work for an estimate, on pieces of the field, and of the original where that goes along: without the crop, which only
/// says how many samples there are. `before`: the grid of what is transformed, which earlier steps made of the field.
/// Field and original live as long as what is returned.
enum class WithOriginal : std::uint8_t { kNo, kYes };
[[nodiscard]] PlannedOnPieces plannedTransform(const engine::Version& field, const engine::Version& original,
                                               const TransformArguments& options, const engine::Grid& before,
                                               WithOriginal with);

}  // namespace fettle::app
