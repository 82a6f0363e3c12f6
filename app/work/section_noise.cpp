#include "app/work/section_noise.h"

#include <cmath>

#include "engine/inspect/noise.h"
#include "engine/inspect/noise_model.h"

namespace fettle::app {

engine::Result<engine::SectionNoise> sectionNoiseOf(const engine::Version& field, engine::JobControl& job) {
  const auto finest = engine::estimateNoise(field, job);
  if (!finest) return tl::unexpected(finest.error());
  const auto model = engine::measureNoise(field, job);
  if (!model) return tl::unexpected(model.error());
  const double mm = field.grid().height_unit.mm;
  return engine::SectionNoise{finest->sigma * mm, std::sqrt(model->whole_rows) * mm,
                              std::sqrt(model->whole_columns) * mm};
}

engine::SectionNoise louderOf(const engine::SectionNoise& a, const engine::SectionNoise& b) noexcept {
  return {std::fmax(a.sample_mm, b.sample_mm), std::fmax(a.rows_mm, b.rows_mm),
          std::fmax(a.columns_mm, b.columns_mm)};
}

}  // namespace fettle::app
