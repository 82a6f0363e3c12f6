#include "app/commands/filling.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "app/commands/typed_values.h"
#include "engine/base/job.h"
#include "engine/field/piece.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"
#include "engine/field/tile.h"

namespace fettle::app {

engine::Result<engine::FillOptions> fillOptionsOf(const FillArguments& arguments, const engine::Grid& grid) {
  engine::FillOptions options;
  options.method =
      arguments.method == "membrane" ? engine::FillMethod::kMembrane : engine::FillMethod::kCurvature;
  options.at_border = arguments.at_border;
  if (arguments.most_area > 0.0) options.most_area_mm2 = arguments.most_area;
  if (!arguments.most_extent.empty()) {
    // A length across the field, not a height.
    engine::Grid lateral = grid;
    lateral.height_unit = grid.lateral_unit;
    const auto extent = parseHeight(arguments.most_extent, lateral, "--max-extent");
    if (!extent) return tl::unexpected(extent.error());
    if (*extent <= 0.0)
      return engine::inputError("no hole is that small", "--max-extent", "give a length above 0");
    options.most_extent_mm = *extent * grid.lateral_unit.mm;
  }
  return options;
}

namespace {

// Samples without a height in a tile that lie in the field.
double holesIn(const engine::FieldReader& reader, std::int32_t tc, std::int32_t tr) {
  const int columns = std::min(engine::kTileSide, reader.width() - tc * engine::kTileSide);
  const int rows = std::min(engine::kTileSide, reader.height() - tr * engine::kTileSide);
  return static_cast<double>(reader.tile(tc, tr).nan_samples) - (engine::kTileSamples - columns * rows);
}

// Of a rectangle; of tiles that lie in it in part, as if their holes were spread evenly.
double holesIn(const engine::FieldReader& reader, const engine::SampleRect& rect) {
  const auto shared = [](std::int32_t tile, std::int32_t first, std::int32_t count) {
    const std::int32_t low = tile * engine::kTileSide;
    return static_cast<double>(std::min(low + engine::kTileSide, first + count) - std::max(low, first)) /
           engine::kTileSide;
  };
  double holes = 0.0;
  for (std::int32_t tr = rect.row / engine::kTileSide; tr * engine::kTileSide < rect.row + rect.rows; ++tr)
    for (std::int32_t tc = rect.column / engine::kTileSide;
         tc * engine::kTileSide < rect.column + rect.columns; ++tc)
      holes += std::min(1.0, shared(tr, rect.row, rect.rows) * shared(tc, rect.column, rect.columns)) *
               holesIn(reader, tc, tr);
  return holes;
}

}  // namespace

PlannedOnPieces plannedFill(const engine::Version& field, const engine::FillOptions& options) {
  const engine::FieldReader reader = field.reader();
  const double all = holesIn(reader, {0, 0, reader.width(), reader.height()});
  std::int32_t column = 0, row = 0;
  double before = 0.0;
  for (std::int32_t tr = 0; tr < reader.tileRows() && before < 0.5 * all; ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns() && before < 0.5 * all; ++tc) {
      before += holesIn(reader, tc, tr);
      column = tc * engine::kTileSide + engine::kTileSide / 2;
      row = tr * engine::kTileSide + engine::kTileSide / 2;
    }
  return {.work = [&field, options](const engine::SampleRect& r,
                                    engine::JobControl& job) -> engine::Result<engine::Version> {
            engine::Version piece = engine::pieceOf(field, r.column, r.row, r.columns, r.rows);
            // What the border of a piece cuts off is a hole in the field.
            engine::FillOptions bordered = options;
            bordered.at_border = true;
            auto filled = engine::fillHoles(piece, bordered, job);
            if (filled) return std::move(filled->field);
            if (filled.error().kind == engine::ErrorKind::kInput) return piece;  // every sample is a hole
            return tl::unexpected(filled.error());
          },
          .amount = [&field](const engine::SampleRect& r) { return holesIn(field.reader(), r); },
          .column = column,
          .row = row,
          .uneven = true};  // a session keeps both states of the tiles with holes alone
}

}  // namespace fettle::app
