#include "haptic/trials/grown_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/field/builder.h"

namespace fettle::trials {

std::optional<engine::Version> wholeSquare(const engine::Version& field, std::int32_t side) {
  const engine::FieldReader reader = field.reader();
  const std::int32_t columns = std::min(side, reader.width()), rows = std::min(side, reader.height());
  const std::int32_t last_column = reader.width() - columns, last_row = reader.height() - rows;
  struct Place {
    std::int32_t column, row;
    [[nodiscard]] std::int64_t from(std::int32_t c, std::int32_t r) const {
      return std::int64_t{c - column} * (c - column) + std::int64_t{r - row} * (r - row);
    }
  };
  std::vector<Place> places;
  const std::int32_t step = std::max(1, side / 2);
  for (std::int32_t r = last_row / 2 % step; r <= last_row; r += step)
    for (std::int32_t c = last_column / 2 % step; c <= last_column; c += step) places.push_back({c, r});
  std::stable_sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    return a.from(last_column / 2, last_row / 2) < b.from(last_column / 2, last_row / 2);
  });
  std::vector<float> z(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (const Place& place : places) {
    reader.readHeights(place.column, place.row, columns, rows, z.data(), columns);
    if (std::any_of(z.begin(), z.end(), [](float v) { return std::isnan(v); })) continue;
    engine::Grid grid = field.grid();
    grid.width = columns;
    grid.height = rows;
    return engine::makeField(grid, z);
  }
  return std::nullopt;
}

engine::Version grownByBall(const engine::Version& field, double radius_mm, int finer) {
  const engine::FieldReader reader = field.reader();
  engine::Grid grid = field.grid();
  grid.width = (grid.width - 1) * finer + 1;
  grid.height = (grid.height - 1) * finer + 1;
  grid.spacing_x /= finer;
  grid.spacing_y /= finer;
  const auto at = [&](std::int32_t c, std::int32_t r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(c);
  };
  std::vector<double> surface(at(0, grid.height));
  for (std::int32_t r = 0; r < grid.height; ++r)
    for (std::int32_t c = 0; c < grid.width; ++c) {
      const std::int32_t c0 = std::min(c / finer, reader.width() - 2),
                         r0 = std::min(r / finer, reader.height() - 2);
      const double u = static_cast<double>(c) / finer - c0, v = static_cast<double>(r) / finer - r0;
      const double low = (1.0 - u) * reader.heightAt(c0, r0) + u * reader.heightAt(c0 + 1, r0);
      const double high = (1.0 - u) * reader.heightAt(c0, r0 + 1) + u * reader.heightAt(c0 + 1, r0 + 1);
      surface[at(c, r)] = (1.0 - v) * low + v * high;
    }
  // Row by row of the ball: how much higher the centre is than a point at that offset, in height units.
  const double unit = grid.height_unit.mm, sx = grid.spacingXMm(), sy = grid.spacingYMm();
  const auto reach_x = static_cast<std::int32_t>(radius_mm / sx),
             reach_y = static_cast<std::int32_t>(radius_mm / sy);
  std::vector<double> grown(surface.size(), -std::numeric_limits<double>::infinity());
  std::vector<double> cap(static_cast<std::size_t>(2 * reach_x + 1));
  for (std::int32_t dr = -reach_y; dr <= reach_y; ++dr) {
    int columns = 0;
    for (std::int32_t dc = 0; dc <= reach_x; ++dc) {
      const double left = radius_mm * radius_mm - dr * sy * dr * sy - dc * sx * dc * sx;
      if (left < 0.0) break;
      cap[static_cast<std::size_t>(dc)] = std::sqrt(left) / unit;
      columns = dc + 1;
    }
    for (std::int32_t r = std::max(0, -dr); r < std::min(grid.height, grid.height - dr); ++r)
      for (std::int32_t dc = 1 - columns; dc < columns; ++dc) {
        const double up = cap[static_cast<std::size_t>(std::abs(dc))];
        const std::int32_t first = std::max(0, -dc), end = std::min(grid.width, grid.width - dc);
        const double* from = surface.data() + at(first + dc, r + dr);
        double* to = grown.data() + at(first, r);
        for (std::int32_t i = 0; i < end - first; ++i) to[i] = std::max(to[i], from[i] + up);
      }
  }
  return engine::makeField(grid, std::vector<float>(grown.begin(), grown.end()));
}

}  // namespace fettle::trials
