#include "app/work/fit_noise.h"

#include <cmath>

#include "engine/inspect/noise.h"
#include "engine/inspect/noise_model.h"

namespace fettle::app {

engine::Status setNoise(engine::FitOptions& how, const engine::Version& field, engine::JobControl& job) {
  const auto finest = engine::estimateNoise(field, job);
  if (!finest) return tl::unexpected(finest.error());
  const auto model = engine::measureNoise(field, job);
  if (!model) return tl::unexpected(model.error());
  const engine::NoiseParts& parts = model->parts;
  const double mm = field.grid().height_unit.mm;
  how.noise_mm = finest->sigma * mm;
  how.rows_mm = std::sqrt(model->whole_rows) * mm;
  how.columns_mm = std::sqrt(model->whole_columns) * mm;
  // A mean of many neighbours has the covariances on both sides of each. The finest detail lacks what neighbours share.
  double both_sides = 0.0;
  for (const double covariance : parts.along_row) both_sides += 2.0 * covariance;
  for (const double covariance : parts.along_column) both_sides += 2.0 * covariance;
  how.shared = 1.0;
  if (both_sides > 0.0 && parts.uncorrelated > 0.0) {
    how.shared = 1.0 + both_sides / parts.uncorrelated;
    how.noise_mm = std::fmax(how.noise_mm, std::sqrt(parts.uncorrelated) * mm);
  }
  return {};
}

}  // namespace fettle::app
