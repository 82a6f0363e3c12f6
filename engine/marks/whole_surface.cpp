#include "engine/marks/whole_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/simd/cpu.h"

namespace fettle::engine {

namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
// A sample is an outlier when it lies this many times farther from its median than samples around it do: 6.7
// standard deviations of normal noise.
constexpr float kLonely = 10.0F;

FilterSpec medianOf(int window) {
  FilterSpec spec;
  spec.kind = FilterKind::kMedian;
  spec.window = window;
  return spec;
}

std::size_t indexOf(int c, int r, int columns) noexcept {
  return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c);
}

// Least squares plane z = a + b x + c y at x = y = 0 from weighted moments; the mean where the samples do not
// span a plane.
double planeAtOrigin(const double (&m)[9]) noexcept {
  const double w = m[0], x = m[1], y = m[2], xx = m[3], xy = m[4], yy = m[5], z = m[6], xz = m[7], yz = m[8];
  const double mx = x / w, my = y / w, mz = z / w;
  const double cxx = xx / w - mx * mx, cxy = xy / w - mx * my, cyy = yy / w - my * my;
  const double cxz = xz / w - mx * mz, cyz = yz / w - my * mz;
  const double det = cxx * cyy - cxy * cxy;
  // Samples on a line do not determine the slope across it.
  if (!(det > 1e-3 * std::max(cxx, cyy) * std::max(std::max(cxx, cyy), 1e-9))) return mz;
  const double b = (cyy * cxz - cxy * cyz) / det, c = (cxx * cyz - cxy * cxz) / det;
  return mz - b * mx - c * my;
}

// Median of |z - middle| over the window around (c, r) of a block, holes left out.
float spreadAround(const std::vector<float>& z, int columns, int rows, int c, int r, int reach,
                   float middle) noexcept {
  float rest[25];
  int n = 0;
  for (int y = std::max(r - reach, 0); y <= std::min(r + reach, rows - 1); ++y)
    for (int x = std::max(c - reach, 0); x <= std::min(c + reach, columns - 1); ++x) {
      const float h =
          z[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)];
      if (!std::isnan(h)) rest[n++] = std::fabs(h - middle);
    }
  if (n == 0) return 0.0F;
  std::nth_element(rest, rest + n / 2, rest + n);
  return rest[n / 2];
}

}  // namespace

WholeSurface::WholeSurface(double sigma, int radius)
    : sigma_(sigma),
      median_reach_(sigma >= 1.5 ? 2 : 1),
      // The kernel's reach and some samples more, since one column does not determine a plane.
      fill_reach_(radius + std::max(2, static_cast<int>(std::ceil(sigma)))),
      median_(makeMedianFilter(medianOf(2 * median_reach_ + 1), bestCpuLevel())) {}

bool WholeSurface::read(const FieldReader& field, std::int32_t column, std::int32_t row, int columns,
                        int rows, const JobControl& job) {
  const std::size_t n = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  heights.assign(n, kHole);
  valid.assign(n, 0);
  const std::int32_t c0 = std::max(column, 0), c1 = std::min(column + columns, field.width());
  const std::int32_t r0 = std::max(row, 0), r1 = std::min(row + rows, field.height());
  holes = true;
  if (c0 >= c1 || r0 >= r1) {
    fill(columns, rows);
    return true;
  }
  Block block;
  const std::int32_t left = std::max(c0 - median_reach_, 0), low = std::max(r0 - median_reach_, 0);
  block.columns = std::min(c1 + median_reach_, field.width()) - left;
  block.rows = std::min(r1 + median_reach_, field.height()) - low;
  block.stride = block.columns;
  raw_.resize(static_cast<std::size_t>(block.columns) * static_cast<std::size_t>(block.rows));
  field.readHeights(left, low, block.columns, block.rows, raw_.data(), block.stride);
  block.heights = raw_.data();
  float highest = 0.0F;
  bool any_hole = false;
  for (const float z : raw_) {
    if (std::isnan(z)) any_hole = true;
    highest = std::max(highest, std::isnan(z) ? 0.0F : std::fabs(z));
  }
  block.holes = any_hole;
  block.magnitude = highest;
  // Twice: the medians, then the medians of the residuals.
  block.out_columns = block.columns;
  block.out_rows = block.rows;
  block.out_stride = block.stride;
  middle_.resize(raw_.size());
  spread_.resize(raw_.size());
  block.out = middle_.data();
  if (!median_->run(block, job)) return false;
  for (std::size_t i = 0; i < raw_.size(); ++i) middle_[i] = std::isnan(raw_[i]) ? kHole : middle_[i];
  rest_.resize(raw_.size());
  for (std::size_t i = 0; i < raw_.size(); ++i) rest_[i] = std::fabs(raw_[i] - middle_[i]);
  block.heights = rest_.data();
  block.magnitude = 2.0F * highest;
  block.out = spread_.data();
  if (!median_->run(block, job)) return false;
  // The heights' mean level would cost precision of the derivatives.
  float level = kHole;
  for (std::int32_t r = r0; r < r1; ++r)
    for (std::int32_t c = c0; c < c1; ++c) {
      const std::size_t o = static_cast<std::size_t>(r - low) * static_cast<std::size_t>(block.stride) +
                            static_cast<std::size_t>(c - left);
      if (std::isnan(raw_[o])) continue;
      const std::size_t i = indexOf(c - column, r - row, columns);
      // On a slope the median of a window cut by the border is not at its middle: an apparent outlier is
      // tested again, against its own window.
      const bool lonely = rest_[o] > kLonely * spread_[o] &&
                          rest_[o] > kLonely * spreadAround(raw_, block.columns, block.rows, c - left,
                                                            r - low, median_reach_, middle_[o]);
      heights[i] = lonely ? middle_[o] : raw_[o];
      if (std::isnan(level)) level = heights[i];
      heights[i] -= level;
      valid[i] = 1;
    }
  holes = any_hole || c0 > column || r0 > row || c1 < column + columns || r1 < row + rows;
  if (holes) fill(columns, rows);
  return true;
}

// Continues the surface over holes that a kernel at some sample reaches.
void WholeSurface::fill(int columns, int rows) {
  const int reach = fill_reach_;
  // Valid samples below and left of each corner: so an empty neighbourhood is detected immediately.
  const std::size_t stride = static_cast<std::size_t>(columns) + 1;
  counts_.assign(stride * (static_cast<std::size_t>(rows) + 1), 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const std::size_t i = static_cast<std::size_t>(r + 1) * stride + static_cast<std::size_t>(c) + 1;
      counts_[i] =
          counts_[i - 1] + counts_[i - stride] - counts_[i - stride - 1] + valid[indexOf(c, r, columns)];
    }
  std::vector<double> weights;  // wider than the kernel: a slope needs a wider base
  for (int d = -reach; d <= reach; ++d) weights.push_back(std::exp(-0.25 * d * d / (sigma_ * sigma_)));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (valid[indexOf(c, r, columns)] != 0) continue;
      const int c0 = std::max(c - reach, 0), c1 = std::min(c + reach + 1, columns);
      const int r0 = std::max(r - reach, 0), r1 = std::min(r + reach + 1, rows);
      const auto count = [&](int x, int y) {
        return counts_[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
      };
      float& z = heights[indexOf(c, r, columns)];
      if (count(c1, r1) - count(c0, r1) - count(c1, r0) + count(c0, r0) == 0) {
        z = 0.0F;
        continue;
      }
      double m[9] = {};
      for (int y = r0; y < r1; ++y) {
        const double wy = weights[static_cast<std::size_t>(y - r + reach)];
        for (int x = c0; x < c1; ++x) {
          if (valid[indexOf(x, y, columns)] == 0) continue;
          const double w = wy * weights[static_cast<std::size_t>(x - c + reach)];
          const double dx = x - c, dy = y - r, h = heights[indexOf(x, y, columns)];
          m[0] += w, m[1] += w * dx, m[2] += w * dy;
          m[3] += w * dx * dx, m[4] += w * dx * dy, m[5] += w * dy * dy;
          m[6] += w * h, m[7] += w * dx * h, m[8] += w * dy * h;
        }
      }
      z = static_cast<float>(planeAtOrigin(m));
    }
}

}  // namespace fettle::engine
