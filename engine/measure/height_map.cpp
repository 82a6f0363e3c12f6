#include "engine/measure/height_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();

// The middle one, or the mean of both; nothing for an empty list.
double medianHeightOf(std::vector<double>& values) {
  if (values.empty()) return kNoHeight;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

// The mean of those within twelve median distances of the median: on slopes and curved surfaces all, of spikes none. The
// median alone would be the middle of a slope without what its curvature adds, unlike the window that it counts as.
double robustMeanOf(std::vector<double>& values, std::vector<double>& distances) {
  constexpr double kMostDistances = 12.0;
  const double median = medianHeightOf(values);
  distances.clear();
  for (const double z : values) distances.push_back(std::abs(z - median));
  const double limit = kMostDistances * medianHeightOf(distances);
  double sum = 0.0, count = 0.0;
  for (const double z : values)
    if (std::abs(z - median) <= limit) {
      sum += z - median;
      count += 1.0;
    }
  return count > 0.0 ? median + sum / count : median;
}

// The eight heights around a place, sorted; how many there are.
std::size_t neighboursOf(const HeightMap& map, std::int32_t column, std::int32_t row,
                         std::array<double, 8>& out) noexcept {
  std::size_t count = 0;
  for (std::int32_t r = std::max(0, row - 1); r <= std::min(map.height - 1, row + 1); ++r)
    for (std::int32_t c = std::max(0, column - 1); c <= std::min(map.width - 1, column + 1); ++c)
      if ((c != column || r != row) && !std::isnan(map.at(c, r))) {
        std::size_t place = count++;
        for (; place > 0 && out[place - 1] > map.at(c, r); --place) out[place] = out[place - 1];
        out[place] = map.at(c, r);
      }
  return count;
}

struct Apart {
  double distance = kNoHeight, range = 0.0;
};
Apart apartFrom(const HeightMap& map, std::int32_t column, std::int32_t row) noexcept {
  constexpr std::size_t kFewest = 4;
  std::array<double, 8> around{};
  const double z = map.at(column, row);
  if (std::isnan(z)) return {};
  const std::size_t n = neighboursOf(map, column, row, around);
  if (n < kFewest) return {};
  const double middle = 0.5 * (around[(n - 1) / 2] + around[n / 2]);
  return {std::abs(z - middle), around[n - 2] - around[1]};
}

// Sums over a window, rows first.
struct HeightWindow {
  int reach = 0;
  std::vector<double> weight;  // of offsets -reach .. reach

  HeightWindow(double sigma, double spacing) {
    const double samples = sigma / spacing;
    reach = std::max(1, static_cast<int>(std::ceil(3.5 * samples)));
    for (int i = -reach; i <= reach; ++i)
      weight.push_back(samples > 0.0 ? std::exp(-0.5 * i * i / (samples * samples)) : (i == 0 ? 1.0 : 0.0));
  }
  [[nodiscard]] double at(int i) const noexcept { return weight[static_cast<std::size_t>(i + reach)]; }
  [[nodiscard]] double sum() const noexcept {
    double all = 0.0;
    for (const double w : weight) all += w;
    return all;
  }
};

}  // namespace

Result<HeightMap> heightMapOf(const Version& field, Region region, std::int32_t block_x, std::int32_t block_y,
                              double base, JobControl& job) {
  const FieldReader reader = field.reader();
  const Grid& grid = reader.grid();
  const double unit = grid.height_unit.mm;
  HeightMap map;
  map.width = std::max(1, grid.width / block_x);
  map.height = std::max(1, grid.height / block_y);
  map.spacing_x = grid.spacingXMm() * block_x;
  map.spacing_y = grid.spacingYMm() * block_y;
  const auto widthOf = [](double spacing, std::int32_t block) {
    return spacing * std::sqrt((static_cast<double>(block) * block - 1.0) / 12.0);
  };
  map.own_x = widthOf(grid.spacingXMm(), block_x);
  map.own_y = widthOf(grid.spacingYMm(), block_y);
  map.x0 = 0.5 * (block_x - 1) * grid.spacingXMm();
  map.y0 = 0.5 * (block_y - 1) * grid.spacingYMm();
  map.z.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), kNoHeight);
  job.begin("reading heights", static_cast<std::uint64_t>(map.height));
  tbb::parallel_for(std::int32_t{0}, map.height, [&](std::int32_t row) {
    if (job.cancelled()) return;
    std::vector<float> strip(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(block_y));
    for (std::int32_t r = 0; r < block_y; r += kTileSide)
      for (std::int32_t c = 0; c < grid.width; c += kTileSide)
        readRegion(
            reader, region,
            {c, row * block_y + r, std::min(kTileSide, grid.width - c), std::min(kTileSide, block_y - r)},
            strip.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) + c,
            grid.width);
    std::vector<double> values, distances;
    for (std::int32_t column = 0; column < map.width; ++column) {
      values.clear();
      for (std::int32_t r = 0; r < block_y; ++r)
        for (std::int32_t c = 0; c < block_x; ++c) {
          const std::int32_t at = column * block_x + c;
          if (at >= grid.width) continue;
          const double z = strip[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) +
                                 static_cast<std::size_t>(at)];
          if (!std::isnan(z)) values.push_back(z);
        }
      if (2 * values.size() < static_cast<std::size_t>(block_x) * static_cast<std::size_t>(block_y)) continue;
      map.z[map.index(column, row)] = robustMeanOf(values, distances) * unit - base;
    }
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return map;
}

double spacingFor(const Grid& grid, double places) noexcept {
  const double area = grid.spacingXMm() * grid.width * grid.spacingYMm() * grid.height;
  return std::max({std::sqrt(area / places), grid.spacingXMm(), grid.spacingYMm()});
}

Result<HeightsAround> heightsAround(const Version& field, Region region, JobControl& job) {
  const Grid& grid = field.grid();
  const double side = spacingFor(grid, 64.0 * 64.0);
  const auto blockOf = [side](double spacing, std::int32_t most) {
    return std::clamp(static_cast<std::int32_t>(std::lround(side / spacing)), 1, most);
  };
  const auto map = heightMapOf(field, region, blockOf(grid.spacingXMm(), grid.width),
                               blockOf(grid.spacingYMm(), grid.height), 0.0, job);
  if (!map) return tl::unexpected(map.error());
  std::vector<double> heights;
  heights.reserve(map->z.size());
  std::ranges::copy_if(map->z, std::back_inserter(heights), [](double z) { return !std::isnan(z); });
  if (heights.empty()) return HeightsAround{};
  const auto at = [&heights](double share) {
    const auto place =
        heights.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(heights.size() - 1));
    std::ranges::nth_element(heights, place);
    return *place;
  };
  const double middle = at(0.5);
  return HeightsAround{middle, std::max(std::abs(at(0.05)), std::abs(at(0.95)))};
}

void dropSpikes(HeightMap& map) {
  constexpr double kOfRange = 4.0, kOfMedian = 8.0;
  std::vector<Apart> apart(map.z.size());
  std::vector<double> distances;
  distances.reserve(map.z.size());
  tbb::parallel_for(std::int32_t{0}, map.height, [&](std::int32_t row) {
    for (std::int32_t c = 0; c < map.width; ++c) apart[map.index(c, row)] = apartFrom(map, c, row);
  });
  for (const Apart& a : apart)
    if (!std::isnan(a.distance)) distances.push_back(a.distance);
  const double median = medianHeightOf(distances);
  for (std::size_t i = 0; i < apart.size(); ++i)
    if (apart[i].distance > kOfRange * apart[i].range + kOfMedian * median) map.z[i] = kNoHeight;
}

SmoothMap smoothed(const HeightMap& map, double sigma, AtHoles holes, Borders borders) {
  // Where the window is cut off it shifts the height by the curvature, and noise counts more.
  constexpr double kLeastWeight = 0.8, kFromBorder = 1.7;
  const auto left = [sigma](double own) { return std::sqrt(std::max(0.0, sigma * sigma - own * own)); };
  const HeightWindow across(left(map.own_x), map.spacing_x), up(left(map.own_y), map.spacing_y);
  const std::size_t places = map.z.size();
  // Sums along rows of weight times 1, i, i^2, z, i z.
  std::array<std::vector<double>, 5> sums;
  for (std::vector<double>& sum : sums) sum.assign(places, 0.0);
  tbb::parallel_for(std::int32_t{0}, map.height, [&](std::int32_t row) {
    for (std::int32_t c = 0; c < map.width; ++c) {
      std::array<double, 5> s{};
      for (int i = std::max(-across.reach, -c); i <= std::min(across.reach, map.width - 1 - c); ++i) {
        const double z = map.at(c + i, row), w = across.at(i);
        if (std::isnan(z)) continue;
        s[0] += w;
        s[1] += w * i;
        s[2] += w * i * i;
        s[3] += w * z;
        s[4] += w * i * z;
      }
      for (std::size_t k = 0; k < s.size(); ++k) sums[k][map.index(c, row)] = s[k];
    }
  });
  SmoothMap out;
  out.value = map;
  out.slope_x.assign(places, kNoHeight);
  out.slope_y.assign(places, kNoHeight);
  const auto there =
      static_cast<double>(std::ranges::count_if(map.z, [](double z) { return !std::isnan(z); }));
  const double whole =
      across.sum() * up.sum() * there / static_cast<double>(std::max<std::size_t>(1, places));
  tbb::parallel_for(std::int32_t{0}, map.height, [&](std::int32_t row) {
    for (std::int32_t c = 0; c < map.width; ++c) {
      const std::size_t at = map.index(c, row);
      out.value.z[at] = kNoHeight;
      if (holes == AtHoles::kStay && std::isnan(map.z[at])) continue;
      if (borders == Borders::kLeftOut &&
          (std::min(c, map.width - 1 - c) * map.spacing_x < kFromBorder * sigma - 0.5 * map.spacing_x ||
           std::min(row, map.height - 1 - row) * map.spacing_y < kFromBorder * sigma - 0.5 * map.spacing_y))
        continue;
      double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, z = 0.0, xz = 0.0, yz = 0.0;
      for (int j = std::max(-up.reach, -row); j <= std::min(up.reach, map.height - 1 - row); ++j) {
        const std::size_t line = map.index(c, row + j);
        const double w = up.at(j);
        n += w * sums[0][line];
        x += w * sums[1][line];
        xx += w * sums[2][line];
        y += w * j * sums[0][line];
        xy += w * j * sums[1][line];
        yy += w * j * j * sums[0][line];
        z += w * sums[3][line];
        xz += w * sums[4][line];
        yz += w * j * sums[3][line];
      }
      if (n < kLeastWeight * whole) continue;
      // The plane about the window's mean.
      const double mx = x / n, my = y / n, mz = z / n;
      const double sxx = xx / n - mx * mx, sxy = xy / n - mx * my, syy = yy / n - my * my;
      const double sxz = xz / n - mx * mz, syz = yz / n - my * mz;
      const double determinant = sxx * syy - sxy * sxy;
      if (!(determinant > 1e-6 * sxx * syy)) continue;
      const double by_x = (syy * sxz - sxy * syz) / determinant, by_y = (sxx * syz - sxy * sxz) / determinant;
      out.value.z[at] = mz - by_x * mx - by_y * my;
      out.slope_x[at] = by_x / map.spacing_x;
      out.slope_y[at] = by_y / map.spacing_y;
    }
  });
  return out;
}

namespace {

// The coefficients of a cubic B-spline through values that are mirrored at both ends, in place (Unser 1999, box 2).
void toCoefficients(double* values, std::size_t count, std::size_t stride) {
  if (count < 2) return;
  const double pole = std::sqrt(3.0) - 2.0;
  constexpr double kGain = 6.0;
  const auto at = [&](std::size_t i) -> double& { return values[i * stride]; };
  double sum = at(0), power = pole;
  // Beyond 40 places the pole's power is below 1e-22.
  const std::size_t reach = std::min<std::size_t>(count - 1, 40);
  for (std::size_t i = 1; i <= reach; ++i, power *= pole) sum += power * at(i);
  at(0) = sum;
  for (std::size_t i = 1; i < count; ++i) at(i) += pole * at(i - 1);
  at(count - 1) = pole / (pole * pole - 1.0) * (at(count - 1) + pole * at(count - 2));
  for (std::size_t i = count - 1; i-- > 0;) at(i) = pole * (at(i + 1) - at(i));
  for (std::size_t i = 0; i < count; ++i) at(i) *= kGain;
}

void splineWeights(double t, std::array<double, 4>& weight, std::array<double, 4>& slope) noexcept {
  const double s = 1.0 - t;
  weight = {s * s * s / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
            (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0, t * t * t / 6.0};
  slope = {-0.5 * s * s, -2.0 * t + 1.5 * t * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t};
}

}  // namespace

MapSpline::MapSpline(const HeightMap& map) : coefficients_(map) {
  HeightMap& co = coefficients_;
  whole_.assign(co.z.size(), 0);
  // A hole gets its nearest height along the row, else along the column: what it does to places beyond the next is below
  // 0.07 of the difference, and those next to it are not used.
  const std::int32_t width = co.width, height = co.height;
  for (std::int32_t r = 0; r + 1 < height; ++r)
    for (std::int32_t c = 0; c + 1 < width; ++c) {
      bool whole = true;
      for (std::int32_t j = std::max(0, r - 1); j <= std::min(height - 1, r + 2); ++j)
        for (std::int32_t i = std::max(0, c - 1); i <= std::min(width - 1, c + 2); ++i)
          whole = whole && !std::isnan(map.at(i, j));
      whole_[map.index(c, r)] = whole ? 1 : 0;
    }
  const auto fill = [&](std::size_t first, std::size_t count, std::size_t stride) {
    double last = kNoHeight;
    for (std::size_t i = 0; i < count; ++i) {
      double& z = co.z[first + i * stride];
      if (std::isnan(z)) z = last;
      last = z;
    }
    for (std::size_t i = count; i-- > 0;) {
      double& z = co.z[first + i * stride];
      if (std::isnan(z)) z = last;
      last = z;
    }
  };
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  for (std::size_t r = 0; r < h; ++r) fill(r * w, w, 1);
  for (std::size_t c = 0; c < w; ++c) fill(c, h, w);
  for (double& z : co.z)
    if (std::isnan(z)) z = 0.0;
  tbb::parallel_for(std::size_t{0}, h, [&](std::size_t r) { toCoefficients(&co.z[r * w], w, 1); });
  tbb::parallel_for(std::size_t{0}, w, [&](std::size_t c) { toCoefficients(&co.z[c], h, w); });
}

MapSpline::Place MapSpline::at(double x, double y) const noexcept {
  const HeightMap& co = coefficients_;
  const double u = (x - co.x0) / co.spacing_x, v = (y - co.y0) / co.spacing_y;
  if (!(u >= 0.0 && v >= 0.0 && u <= co.width - 1.0 && v <= co.height - 1.0) || co.width < 2 || co.height < 2)
    return {};
  const auto c = std::min(static_cast<std::int32_t>(u), co.width - 2),
             r = std::min(static_cast<std::int32_t>(v), co.height - 2);
  if (whole_[co.index(c, r)] == 0) return {};
  std::array<double, 4> wx, wy, sx, sy;
  splineWeights(u - c, wx, sx);
  splineWeights(v - r, wy, sy);
  const auto mirrored = [](std::int32_t i, std::int32_t count) {
    return i < 0 ? -i : i >= count ? 2 * (count - 1) - i : i;
  };
  MapSpline::Place place;
  for (std::int32_t j = 0; j < 4; ++j) {
    const std::int32_t row = mirrored(r - 1 + j, co.height);
    double value = 0.0, slope = 0.0;
    for (std::int32_t i = 0; i < 4; ++i) {
      const double z = co.at(mirrored(c - 1 + i, co.width), row);
      value += wx[static_cast<std::size_t>(i)] * z;
      slope += sx[static_cast<std::size_t>(i)] * z;
    }
    place.z += wy[static_cast<std::size_t>(j)] * value;
    place.slope_x += wy[static_cast<std::size_t>(j)] * slope;
    place.slope_y += sy[static_cast<std::size_t>(j)] * value;
  }
  place.slope_x /= co.spacing_x;
  place.slope_y /= co.spacing_y;
  place.there = true;
  return place;
}

}  // namespace fettle::engine
