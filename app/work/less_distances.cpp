#include "app/work/less_distances.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/field/builder.h"

namespace fettle::app {

engine::Result<engine::Version> lessDistances(const engine::Version& field, const engine::Version& distances,
                                              engine::JobControl& job) {
  const engine::Grid& grid = distances.grid();
  auto builder = engine::FieldBuilder::create(grid, "what it is compared with");
  if (!builder) return tl::unexpected(builder.error());
  const engine::FieldReader heights = field.reader(), away = distances.reader();
  std::vector<float> row(static_cast<std::size_t>(grid.width)), less(row.size());
  for (std::int32_t r = 0; r < grid.height; ++r) {
    if (job.cancelled()) return engine::cancelled();
    heights.readHeights(0, r, grid.width, 1, row.data(), grid.width);
    away.readHeights(0, r, grid.width, 1, less.data(), grid.width);
    for (std::size_t i = 0; i < row.size(); ++i) row[i] -= less[i];
    builder->writeHeights(0, r, grid.width, 1, row.data(), grid.width);
  }
  return std::move(*builder).build();
}

}  // namespace fettle::app
