// Derivatives by Gaussian kernels: Canny, A Computational Approach to Edge Detection (1986), section VI, for
// steps; Steger, An Unbiased Detector of Curvilinear Structures (1998), section 2, for lines of curvature.
// Departures: a step is measured against the slope around it, since a height field has slopes that are not
// edges; both are in units of the field's own noise (edge_suggestion.h).
#include "engine/marks/edge_response.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/simd/kernel.h"

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

#define FETTLE_KERNEL "engine/marks/edge_response-inl.h"
#include "engine/simd/each_cpu-inl.h"

const auto kSlide = FETTLE_AT_LEVEL(bestCpuLevel(), slide);
const auto kSlideUp = FETTLE_AT_LEVEL(bestCpuLevel(), slideUp);

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

EdgeResponse::EdgeResponse(double sigma, Scatter scatter)
    : sigma_(sigma),
      kernels_(edgeKernels(sigma)),
      scatter_(scatter),
      side_(std::max(1, static_cast<int>(std::lround(2.0 * sigma)))) {
  median_reach_ = sigma >= 1.5 ? 2 : 1;
  median_ = makeMedianFilter(medianOf(2 * median_reach_ + 1), bestCpuLevel());
  // The kernel's reach and some samples more, since one column does not determine a plane.
  fill_reach_ = kernels_.radius + std::max(2, static_cast<int>(std::ceil(sigma)));
  margin_ = side_ + 1 + kernels_.radius + fill_reach_;  // slope at the side, its kernel, holes
}

bool EdgeResponse::run(const FieldReader& field, std::int32_t column, std::int32_t row, int columns, int rows,
                       const JobControl& job) {
  first_column_ = column - margin_;
  first_row_ = row - margin_;
  wide_ = columns + 2 * margin_;
  tall_ = rows + 2 * margin_;
  if (!read(field, job)) return false;
  if (holes_) fill();
  if (job.cancelled()) return false;
  differentiate();
  measure(columns, rows);
  return true;
}

// Heights without outliers, minus the first of them; holes and samples outside as NaN.
bool EdgeResponse::read(const FieldReader& field, const JobControl& job) {
  const std::size_t n = static_cast<std::size_t>(wide_) * static_cast<std::size_t>(tall_);
  z_.assign(n, kHole);
  valid_.assign(n, 0);
  const std::int32_t c0 = std::max(first_column_, 0), c1 = std::min(first_column_ + wide_, field.width());
  const std::int32_t r0 = std::max(first_row_, 0), r1 = std::min(first_row_ + tall_, field.height());
  holes_ = true;
  if (c0 >= c1 || r0 >= r1) return true;
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
      const std::size_t i = at(c - first_column_, r - first_row_);
      // On a slope the median of a window cut by the border is not at its middle: an apparent outlier is
      // tested again, against its own window.
      const bool lonely = rest_[o] > kLonely * spread_[o] &&
                          rest_[o] > kLonely * spreadAround(raw_, block.columns, block.rows, c - left,
                                                            r - low, median_reach_, middle_[o]);
      z_[i] = lonely ? middle_[o] : raw_[o];
      if (std::isnan(level)) level = z_[i];
      z_[i] -= level;
      valid_[i] = 1;
    }
  holes_ = any_hole || c0 > first_column_ || r0 > first_row_ || c1 < first_column_ + wide_ ||
           r1 < first_row_ + tall_;
  return true;
}

// Continues the surface over holes that a kernel at some sample reaches.
void EdgeResponse::fill() {
  const int reach = fill_reach_;
  // Valid samples below and left of each corner: so an empty neighbourhood is detected immediately.
  const std::size_t stride = static_cast<std::size_t>(wide_) + 1;
  counts_.assign(stride * (static_cast<std::size_t>(tall_) + 1), 0);
  for (int r = 0; r < tall_; ++r)
    for (int c = 0; c < wide_; ++c) {
      const std::size_t i = static_cast<std::size_t>(r + 1) * stride + static_cast<std::size_t>(c) + 1;
      counts_[i] = counts_[i - 1] + counts_[i - stride] - counts_[i - stride - 1] + valid_[at(c, r)];
    }
  std::vector<double> weights;  // wider than the kernel: a slope needs a wider base
  for (int d = -reach; d <= reach; ++d) weights.push_back(std::exp(-0.25 * d * d / (sigma_ * sigma_)));
  for (int r = 0; r < tall_; ++r)
    for (int c = 0; c < wide_; ++c) {
      if (valid_[at(c, r)] != 0) continue;
      const int c0 = std::max(c - reach, 0), c1 = std::min(c + reach + 1, wide_);
      const int r0 = std::max(r - reach, 0), r1 = std::min(r + reach + 1, tall_);
      const auto count = [&](int x, int y) {
        return counts_[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
      };
      float& z = z_[at(c, r)];
      if (count(c1, r1) - count(c0, r1) - count(c1, r0) + count(c0, r0) == 0) {
        z = 0.0F;
        continue;
      }
      double m[9] = {};
      for (int y = r0; y < r1; ++y) {
        const double wy = weights[static_cast<std::size_t>(y - r + reach)];
        for (int x = c0; x < c1; ++x) {
          if (valid_[at(x, y)] == 0) continue;
          const double w = wy * weights[static_cast<std::size_t>(x - c + reach)];
          const double dx = x - c, dy = y - r, h = z_[at(x, y)];
          m[0] += w, m[1] += w * dx, m[2] += w * dy;
          m[3] += w * dx * dx, m[4] += w * dx * dy, m[5] += w * dy * dy;
          m[6] += w * h, m[7] += w * dx * h, m[8] += w * dy * h;
        }
      }
      z = static_cast<float>(planeAtOrigin(m));
    }
}

void EdgeResponse::differentiate() {
  const int taps = 2 * kernels_.radius + 1, n = wide_ - 2 * kernels_.radius;
  const std::size_t size = static_cast<std::size_t>(wide_) * static_cast<std::size_t>(tall_);
  for (std::vector<float>* v : {&smooth_rows_, &first_rows_, &second_rows_, &gx_, &gy_, &hxx_, &hxy_, &hyy_})
    v->resize(size);
  for (int r = 0; r < tall_; ++r) {
    const std::size_t i = at(0, r), o = at(kernels_.radius, r);
    kSlide(&z_[i], kernels_.smooth.data(), taps, n, &smooth_rows_[o]);
    kSlide(&z_[i], kernels_.first.data(), taps, n, &first_rows_[o]);
    kSlide(&z_[i], kernels_.second.data(), taps, n, &second_rows_[o]);
  }
  for (int r = kernels_.radius; r < tall_ - kernels_.radius; ++r) {
    const std::size_t i = at(kernels_.radius, r - kernels_.radius), o = at(kernels_.radius, r);
    kSlideUp(&first_rows_[i], wide_, kernels_.smooth.data(), taps, n, &gx_[o]);
    kSlideUp(&smooth_rows_[i], wide_, kernels_.first.data(), taps, n, &gy_[o]);
    kSlideUp(&second_rows_[i], wide_, kernels_.smooth.data(), taps, n, &hxx_[o]);
    kSlideUp(&first_rows_[i], wide_, kernels_.first.data(), taps, n, &hxy_[o]);
    kSlideUp(&smooth_rows_[i], wide_, kernels_.second.data(), taps, n, &hyy_[o]);
  }
  if (!holes_) return;
  share_.resize(size);
  raw_.resize(std::max(raw_.size(), size));
  for (std::size_t i = 0; i < size; ++i) raw_[i] = static_cast<float>(valid_[i]);
  for (int r = 0; r < tall_; ++r)
    kSlide(&raw_[at(0, r)], kernels_.smooth.data(), taps, n, &smooth_rows_[at(kernels_.radius, r)]);
  for (int r = kernels_.radius; r < tall_ - kernels_.radius; ++r)
    kSlideUp(&smooth_rows_[at(kernels_.radius, r - kernels_.radius)], wide_, kernels_.smooth.data(), taps, n,
             &share_[at(kernels_.radius, r)]);
}

void EdgeResponse::measure(int columns, int rows) {
  const std::size_t n = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  for (std::vector<float>* v : {&step, &crease, &step_x, &step_y, &crease_x, &crease_y}) v->assign(n, 0.0F);
  whole.assign(n, 0);
  const bool scatter = scatter_ == Scatter::kMeasure;
  if (scatter)
    for (std::vector<float>* v : {&step_in_x, &step_in_y, &bend_in_x, &bend_in_y}) v->assign(n, 0.0F);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int x = c + margin_, y = r + margin_;
      const std::size_t i = at(x, y);
      if (valid_[i] == 0) continue;
      const std::size_t o = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + c;
      // The last half per mille of the share is rounding.
      const float share = holes_ ? share_[i] : 1.0F;
      whole[o] = share > 0.9995F;
      const float gx = gx_[i], gy = gy_[i];
      const float slope = std::sqrt(gx * gx + gy * gy);
      if (slope > 0.0F) {
        const float nx = gx / slope, ny = gy / slope;
        const int dx = static_cast<int>(std::lround(nx * static_cast<float>(side_)));
        const int dy = static_cast<int>(std::lround(ny * static_cast<float>(side_)));
        // Without a surface there, the slope of the surroundings is taken as that of the sample.
        const auto slopeAt = [&](std::size_t j) { return valid_[j] ? gx_[j] * nx + gy_[j] * ny : slope; };
        step[o] = share *
                  std::max(0.0F, slope - 0.5F * (slopeAt(at(x + dx, y + dy)) + slopeAt(at(x - dx, y - dy))));
        step_x[o] = nx;
        step_y[o] = ny;
      }
      if (scatter) {
        step_in_x[o] = gx - 0.5F * (gx_[at(x + side_, y)] + gx_[at(x - side_, y)]);
        step_in_y[o] = gy - 0.5F * (gy_[at(x, y + side_)] + gy_[at(x, y - side_)]);
        bend_in_x[o] = hxx_[i];
        bend_in_y[o] = hyy_[i];
      }
      const float mean = 0.5F * (hxx_[i] + hyy_[i]), half = 0.5F * (hxx_[i] - hyy_[i]), mixed = hxy_[i];
      const float root = std::sqrt(half * half + mixed * mixed);
      crease[o] = share * (std::fabs(mean) + root);
      // Eigenvector of mean + root or mean - root, whichever is larger in size; from the larger of its two
      // forms, since the other may be zero.
      const float l = mean >= 0.0F ? root : -root;  // eigenvalue less the mean
      float vx = mixed, vy = l - half;
      if (std::fabs(l + half) > std::fabs(vy)) vx = l + half, vy = mixed;
      const float length = std::sqrt(vx * vx + vy * vy);
      if (length > 0.0F) {
        crease_x[o] = vx / length;
        crease_y[o] = vy / length;
      } else {
        crease_x[o] = 1.0F;
      }
    }
}

}  // namespace fettle::engine
