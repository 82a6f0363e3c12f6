#include "engine/measure/scale_filter.h"

#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"
#include "engine/measure/form.h"
#include "engine/measure/lowered.h"

namespace fettle::engine {

namespace {

// Without marks, which would keep samples.
Result<Version> heightsAbout(const Version& field, const NominalForm& form, JobControl& job) {
  Grid grid = field.grid();
  grid.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the levelled field");
  if (!builder) return tl::unexpected(builder.error());
  const FieldReader from = field.reader();
  tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(tileCount(from)), [&](std::int64_t i) {
    if (job.cancelled()) return;
    const SampleRect rect = tileRect(from, i);
    float z[kTileSamples];
    double nominal[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    form.readHeights(rect, nominal, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
        z[k] = static_cast<float>(z[k] - nominal[k]);
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

}  // namespace

Result<Version> scaleFiltered(const Version& field, const FilterSpec& filter, Waves waves, JobControl& job,
                              FilterReport* report, const NominalForm* about) {
  if (Status valid = validate(filter, field.grid()); !valid) return tl::unexpected(valid.error());
  NominalForm form;
  if (about != nullptr) {
    form = *about;
  } else {
    const auto fit = fitForm(field, {.degree = 1, .region = Region::kAll, .robust = false}, job);
    if (!fit && fit.error().kind == ErrorKind::kInput) return field;  // of holes alone
    if (!fit) return tl::unexpected(fit.error());
    form = fit->form;
  }
  const auto heights = heightsAbout(field, form, job);
  if (!heights) return tl::unexpected(heights.error());
  const auto filtered = applyFilter(*heights, *heights, filter, job);
  if (!filtered) return tl::unexpected(filtered.error());
  if (report != nullptr) *report = filtered->report;
  const FieldReader low = filtered->field.reader(), from = field.reader();
  return lowered(
      field, "filtering",
      [&](const SampleRect& rect, double* taken) {
        float z[kTileSamples], of_filter[kTileSamples];
        form.readHeights(rect, taken, kTileSide);
        low.readHeights(rect.column, rect.row, rect.columns, rect.rows, of_filter, kTileSide);
        if (waves == Waves::kLong)
          from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
        for (int r = 0; r < rect.rows; ++r)
          for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k) {
            taken[k] += of_filter[k];
            if (waves == Waves::kLong) taken[k] = z[k] - taken[k];
          }
      },
      job);
}

}  // namespace fettle::engine
