#include "bench/bench_forms.h"

#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/seen_field.h"
#include "engine/field/tile.h"

namespace fettle::bench {

engine::NominalForm benchPlane(const engine::Grid& grid) {
  const double wide = grid.width * grid.spacingXMm(), tall = grid.height * grid.spacingYMm();
  const double to_height = 0.1 / grid.height_unit.mm;
  return engine::PolynomialForm{
      1, grid.width, grid.height, 0.0, {0.0, 0.5 * tall * to_height, 0.5 * wide * to_height}};
}

engine::NominalForm benchSphere(const engine::Grid& grid) {
  engine::ShapeForm form;
  form.width = grid.width;
  form.height = grid.height;
  form.spacing_x_mm = grid.spacingXMm();
  form.spacing_y_mm = grid.spacingYMm();
  form.height_mm = grid.height_unit.mm;
  form.column = 0.5 * grid.width;
  form.row = 0.5 * grid.height;
  form.curvature = -0.1 / std::hypot(grid.width * form.spacing_x_mm, grid.height * form.spacing_y_mm);
  return form;
}

engine::Result<engine::Version> bentAndSeen(const engine::Version& field, const engine::NominalForm& form,
                                            engine::JobControl& job) {
  const engine::FieldReader from = field.reader();
  auto builder = engine::FieldBuilder::create(field.grid(), "benchmark field");
  if (!builder) return tl::unexpected(builder.error());
  const auto columns = static_cast<std::size_t>(from.width());
  std::vector<float> row(columns);
  std::vector<std::uint8_t> marks(columns);
  for (std::int32_t r = 0; r < from.height(); ++r) {
    from.readHeights(0, r, from.width(), 1, row.data(), from.width());
    from.readMarks(0, r, from.width(), 1, marks.data(), from.width());
    for (std::int32_t c = 0; c < from.width(); ++c)
      row[static_cast<std::size_t>(c)] =
          static_cast<float>(row[static_cast<std::size_t>(c)] + form.heightAt(c, r));
    builder->writeHeights(0, r, from.width(), 1, row.data(), from.width());
    builder->writeMarks(0, r, from.width(), 1, marks.data(), from.width());
  }
  const engine::Version bent =
      (*std::move(builder)).build().withForm(std::make_shared<const engine::NominalForm>(form));
  const auto seen = engine::SeenField::of(bent, job);
  if (!seen) return tl::unexpected(seen.error());
  return seen->seen();
}

std::int64_t bytesOfSeen(const engine::Version& seen) {
  return static_cast<std::int64_t>(engine::changedTiles(*seen.seenOf(), seen).size()) *
         static_cast<std::int64_t>(sizeof(engine::Tile));
}

}  // namespace fettle::bench
