#include "engine/transform/form_along.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/field/builder.h"
#include "engine/field/sample_rect.h"
#include "engine/field/seen_field.h"

namespace fettle::engine {

std::optional<NominalForm> formAlong(const Version& field, const PlaceMap& places, std::int32_t width,
                                     std::int32_t height) {
  const FieldForm form = formOfHeights(field);
  return form == nullptr ? std::nullopt : movedForm(*form, places, width, height);
}

Result<Version> seenUnder(const Version& samples, const std::optional<NominalForm>& form, JobControl& job) {
  if (!form) return samples;
  const auto seen = SeenField::of(samples.withForm(std::make_shared<const NominalForm>(*form)), job);
  if (!seen) return tl::unexpected(seen.error());
  return seen->seen();
}

Result<Version> raisedUnder(const Version& seen, const NominalForm& form, JobControl& job) {
  Grid grid = seen.grid();
  grid.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the field with its form");
  if (!builder) return tl::unexpected(builder.error());
  const FieldReader from = seen.reader();
  const TileRange tiles = allTiles(seen.grid());
  job.begin("restoring the form", static_cast<std::uint64_t>(tiles.tiles()));
  tbb::parallel_for(std::int64_t{0}, tiles.tiles(), [&](std::int64_t i) {
    if (job.cancelled()) return;
    constexpr double kMost = std::numeric_limits<float>::max();
    SampleRect rect{static_cast<std::int32_t>(i % tiles.columns) * kTileSide,
                    static_cast<std::int32_t>(i / tiles.columns) * kTileSide, 0, 0};
    rect.columns = std::min(kTileSide, from.width() - rect.column);
    rect.rows = std::min(kTileSide, from.height() - rect.row);
    float z[kTileSamples];
    double raised[kTileSamples];
    std::uint8_t marks[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    from.readMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
    form.readHeights(rect, raised, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
        if (z[k] == z[k]) z[k] = static_cast<float>(std::clamp(z[k] + raised[k], -kMost, kMost));
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    builder->writeMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build().withLines(seen.lines());
}

}  // namespace fettle::engine
