#include "haptic/journal/computed_heights.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "engine/field/live_field.h"
#include "engine/field/tile.h"

namespace fettle::haptic {

namespace {

using engine::kTileSide;

engine::Result<ComputedHeights> made(const engine::Version& before, const engine::FillOptions& options,
                                     engine::JobControl& job) {
  auto filled = engine::fillHoles(before, options, job);
  if (!filled) return tl::unexpected(filled.error());
  ComputedHeights result;
  result.field = std::exchange(filled->field, {});
  result.filled = *std::move(filled);
  return result;
}

// Rounded to float once, as engine::lowered(), into tiles of the field's own memory.
engine::Result<ComputedHeights> made(const engine::Version& before, const engine::LineOptions& options,
                                     engine::JobControl& job) {
  const auto offsets = engine::findLineOffsets(before, options, job);
  if (!offsets) return tl::unexpected(offsets.error());
  const engine::FieldReader reader = before.reader();
  job.begin("levelling lines", static_cast<std::uint64_t>(reader.tileRows()));
  engine::LiveField live(before, engine::Growth::kAllowed);
  float z[engine::kTileSamples];
  double taken[engine::kTileSamples];
  for (std::int32_t row = 0; row < reader.height(); row += kTileSide) {
    if (job.cancelled()) return engine::cancelled();
    for (std::int32_t column = 0; column < reader.width(); column += kTileSide) {
      const engine::SampleRect rect{column, row, std::min(kTileSide, reader.width() - column),
                                    std::min(kTileSide, reader.height() - row)};
      reader.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
      offsets->readHeights(rect, taken);
      for (int r = 0; r < rect.rows; ++r)
        for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
          z[k] = static_cast<float>(z[k] - taken[k]);
      if (!live.writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide))
        return engine::failure("there is not enough memory for the levelled field", "level",
                               "keep the samples on a disk with --store FOLDER");
    }
    job.advance();
  }
  ComputedHeights result;
  result.field = live.snapshot();
  result.rows_rms = offsets->rms;
  return result;
}

}  // namespace

engine::Result<ComputedHeights> computeHeights(const engine::Version& before, const HeightsMaker& maker,
                                               engine::JobControl& job) {
  return std::visit([&](const auto& options) { return made(before, options, job); }, maker);
}

}  // namespace fettle::haptic
