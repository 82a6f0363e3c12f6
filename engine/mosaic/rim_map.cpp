#include "engine/mosaic/rim_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <tbb/parallel_for.h>

#include "engine/field/reader.h"

namespace fettle::engine {

namespace {

constexpr std::int32_t kMostBlocks = 256;

// The squares of distances to the nearest of places with a square of their own, along a line, in place: the lower envelope
// of parabolas (P. Felzenszwalb and D. Huttenlocher, Distance transforms of sampled functions, 2012).
void nearestSquares(std::vector<double>& square, double step) {
  const std::size_t n = square.size();
  std::vector<std::size_t> at;
  std::vector<double> from;
  const auto place = [step](std::size_t i) { return step * static_cast<double>(i); };
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isinf(square[i])) continue;
    double meets = -std::numeric_limits<double>::infinity();
    while (!at.empty()) {
      const std::size_t k = at.back();
      meets =
          (square[i] + place(i) * place(i) - square[k] - place(k) * place(k)) / (2.0 * (place(i) - place(k)));
      if (meets > from.back()) break;
      at.pop_back();
      from.pop_back();
      meets = -std::numeric_limits<double>::infinity();
    }
    at.push_back(i);
    from.push_back(meets);
  }
  if (at.empty()) return;
  std::vector<double> out(n);
  for (std::size_t i = 0, k = 0; i < n; ++i) {
    while (k + 1 < at.size() && from[k + 1] <= place(i)) ++k;
    const double off = place(i) - place(at[k]);
    out[i] = off * off + square[at[k]];
  }
  square = out;
}

}  // namespace

Result<RimMap> RimMap::create(const Version& field, JobControl& job) {
  const FieldReader reader = field.reader();
  const Grid& grid = reader.grid();
  const auto blockOf = [](std::int32_t count) { return (count + kMostBlocks - 1) / kMostBlocks; };
  const std::int32_t across = blockOf(grid.width), up = blockOf(grid.height);
  RimMap map;
  map.width_ = (grid.width + across - 1) / across;
  map.height_ = (grid.height + up - 1) / up;
  map.block_x_ = across * grid.spacingXMm();
  map.block_y_ = up * grid.spacingYMm();
  map.x0_ = 0.5 * (across - 1) * grid.spacingXMm();
  map.y0_ = 0.5 * (up - 1) * grid.spacingYMm();
  map.right_ = (grid.width - 1) * grid.spacingXMm();
  map.upper_ = (grid.height - 1) * grid.spacingYMm();
  const double infinite = std::numeric_limits<double>::infinity();
  map.distance_.assign(static_cast<std::size_t>(map.width_) * static_cast<std::size_t>(map.height_),
                       infinite);
  job.begin("looking for rims", static_cast<std::uint64_t>(map.height_));
  const auto w = static_cast<std::size_t>(map.width_), h = static_cast<std::size_t>(map.height_);
  tbb::parallel_for(std::size_t{0}, h, [&](std::size_t row) {
    if (job.cancelled()) return;
    const auto first = static_cast<std::int32_t>(row) * up;
    const std::int32_t rows = std::min(up, grid.height - first);
    std::vector<float> strip(static_cast<std::size_t>(rows) * static_cast<std::size_t>(grid.width));
    reader.readHeights(0, first, grid.width, rows, strip.data(), grid.width);
    std::vector<double> line(w, infinite);
    for (std::size_t c = 0; c < w; ++c) {
      const std::int32_t left = static_cast<std::int32_t>(c) * across,
                         columns = std::min(across, grid.width - left);
      std::int64_t holes = 0;
      for (std::int32_t r = 0; r < rows; ++r)
        for (std::int32_t k = left; k < left + columns; ++k)
          holes += std::isnan(strip[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) +
                                    static_cast<std::size_t>(k)])
                       ? 1
                       : 0;
      if (2 * holes > std::int64_t{rows} * columns) line[c] = 0.0;
    }
    nearestSquares(line, map.block_x_);
    std::copy(line.begin(), line.end(), map.distance_.begin() + static_cast<std::ptrdiff_t>(row * w));
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  tbb::parallel_for(std::size_t{0}, w, [&](std::size_t c) {
    std::vector<double> line(h);
    for (std::size_t r = 0; r < h; ++r) line[r] = map.distance_[r * w + c];
    nearestSquares(line, map.block_y_);
    for (std::size_t r = 0; r < h; ++r) map.distance_[r * w + c] = std::sqrt(line[r]);
  });
  return map;
}

double RimMap::at(double x, double y) const noexcept {
  const double least = 1e-6 * std::min(block_x_, block_y_);
  const double border = std::min({x, right_ - x, y, upper_ - y});
  const auto between = [](double v, std::int32_t count) {
    return std::clamp(v, 0.0, static_cast<double>(count - 1));
  };
  const double u = between((x - x0_) / block_x_, width_), v = between((y - y0_) / block_y_, height_);
  const auto c = std::min(static_cast<std::int32_t>(u), std::max(0, width_ - 2)),
             r = std::min(static_cast<std::int32_t>(v), std::max(0, height_ - 2));
  const std::int32_t right = std::min(c + 1, width_ - 1), above = std::min(r + 1, height_ - 1);
  const double s = u - c, t = v - r;
  const auto distance = [this](std::int32_t column, std::int32_t row) {
    return std::min(distance_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(column)],
                    1e300);
  };
  const double to_hole = (1.0 - t) * ((1.0 - s) * distance(c, r) + s * distance(right, r)) +
                         t * ((1.0 - s) * distance(c, above) + s * distance(right, above));
  return std::max({least, std::min(border, to_hole)});
}

}  // namespace fettle::engine
