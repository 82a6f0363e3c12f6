// The areal spline filter as the tensor product of the profile filter of ISO 16610-22 (spline_lines.h), which is how such a filter is
// taken to surfaces (H. Zhang, D. Ott, J. Song, W. Chu, An areal isotropic spline filter for surface metrology, 2015, who
// also state that it is not isotropic), and robust by Tukey's weights, as ISO/TR 16610-32 has it for profiles. These are those of the robust
// Gaussian regression filter of the same cut-off (robust_gaussian.h), not of distances from the spline: at natural ends a spline cannot bend,
// and what is far from it there is no outlier. Weights from a robust start and then one step is what P. Bickel (One-step Huber
// estimates in the linear model, 1975) and V. Yohai (High breakdown-point and high efficiency robust estimates for regression, 1987)
// begin with. The text of ISO
// 16610-62 was not at hand.
//
// With A = I + a^4 Q of each axis and T = Ay x Ax the surface s = T^-1 z is that of least sum of (z - s)^2 + s (T - 1) s. With
// weights w, 0 at holes, it is that of least sum of w (z - s)^2 + s (T - 1) s:
//
//     (W + T - 1) s = W z,   or with H = 1 - W   s = T^-1 (W z + H s)
//
// of which x = sqrt(H) s is found by conjugate gradients (M. Hestenes, E. Stiefel, 1952) from (1 - sqrt(H) T^-1 sqrt(H)) x =
// sqrt(H) T^-1 W z: one application of the filter for each step. If e is the error of x, the sum of w times the squared error of s
// is less than e (1 - sqrt(H) T^-1 sqrt(H)) e, which conjugate gradients make least, and which their steps state
// (Z. Strakos, P. Tichy, 2002).

#include "engine/filter/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/field/tile.h"
#include "engine/filter/robust_gaussian.h"
#include "engine/filter/spline_lines.h"
#include "engine/filter/surface_pass.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kMostSteps = 1000;
// Errors of a step are those that so many later ones take away, all but a little.
constexpr std::size_t kLater = 4;

// A plane through the middle of the heights: the filter leaves it as it is, and smaller numbers lose less.
struct SplineLevel {
  double mean = 0.0, along_x = 0.0, along_y = 0.0;
  double half_width = 1.0, half_height = 1.0;
  double deviation = 0.0;  // standard, of the heights about it

  [[nodiscard]] double at(std::int32_t c, std::int32_t r) const noexcept {
    return mean + along_x * (c / half_width - 1.0) + along_y * (r / half_height - 1.0);
  }
};

class SplineSurface {
 public:
  SplineSurface(const Version& input, const FilterSpec& spec, CpuLevel level)
      : reader_(input.reader()),
        width_(reader_.width()),
        height_(reader_.height()),
        x_(spec.nesting_mm / reader_.grid().spacingXMm(), width_),
        y_(spec.nesting_mm / reader_.grid().spacingYMm(), height_),
        level_(level) {
    z_.resize(static_cast<std::size_t>(reader_.grid().samples()));
    eachRow([&](std::int32_t r) { reader_.readHeights(0, r, width_, 1, z_.data() + at(r), width_); });
    findPlane();
    plane_.width = width_;
    plane_.height = height_;
    plane_.z.resize(z_.size());
  }

  // Weights of samples of the whole field, row-major, and how small an error matters beside them.
  struct Weights {
    const float* each;
    std::ptrdiff_t stride;
    double scale;
  };

  // Without weights: all 1. Holes have none. False when cancelled.
  bool solve(const std::optional<Weights>& weights, const JobControl& job) {
    if (!weights && !holes_) {
      eachRow([&](std::int32_t r) {
        for (std::int32_t c = 0; c < width_; ++c) plane_.z[at(r) + c] = about(c, r);
      });
      return smoothPlane(x_, y_, plane_, level_, job);
    }
    lack_.resize(z_.size());  // root of H
    found_.resize(z_.size()), rest_.resize(z_.size()), direction_.resize(z_.size());
    eachRow([&](std::int32_t r) {
      for (std::int32_t c = 0; c < width_; ++c) {
        const std::size_t i = at(r) + c;
        const double weight = !(z_[i] == z_[i]) ? 0.0
                              : weights         ? static_cast<double>(weights->each[r * weights->stride + c])
                                                : 1.0;
        lack_[i] = std::sqrt(1.0 - weight);
        found_[i] = 0.0;
      }
    });
    return findLacking(weights ? weights->scale : plane_level_.deviation, job);
  }

  // The surface that was solved for, rounded once.
  void copyTo(std::vector<float>& to) const {
    to.resize(z_.size());
    eachRow([&](std::int32_t r) {
      for (std::int32_t c = 0; c < width_; ++c)
        to[at(r) + c] = static_cast<float>(plane_level_.at(c, r) + plane_.z[at(r) + c]);
    });
  }

  // Standard, of the heights about their plane.
  [[nodiscard]] double deviation() const noexcept { return plane_level_.deviation; }

 private:
  [[nodiscard]] std::size_t at(std::int32_t row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
  }

  [[nodiscard]] double about(std::int32_t c, std::int32_t r) const noexcept {
    return static_cast<double>(z_[at(r) + c]) - plane_level_.at(c, r);
  }

  void eachRow(const auto& f) const {
    constexpr std::int32_t kAtOnce = 16;
    tbb::parallel_for(std::int32_t{0}, (height_ + kAtOnce - 1) / kAtOnce, [&](std::int32_t part) {
      for (std::int32_t r = part * kAtOnce; r < std::min((part + 1) * kAtOnce, height_); ++r) f(r);
    });
  }

  // Of rows, and of their sums in order: the same for any number of threads.
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> sums(const auto& of_row) const {
    std::vector<std::array<double, N>> rows(static_cast<std::size_t>(height_));
    eachRow([&](std::int32_t r) { rows[static_cast<std::size_t>(r)] = of_row(r); });
    std::array<double, N> all{};
    for (const std::array<double, N>& row : rows)
      for (std::size_t i = 0; i < N; ++i) all[i] += row[i];
    return all;
  }
  [[nodiscard]] double sum(const auto& of_row) const {
    return std::get<0>(sums<1>([&](std::int32_t r) { return std::array{of_row(r)}; }));
  }

  void findPlane() {
    SplineLevel& level = plane_level_;
    level.half_width = std::max(0.5 * (width_ - 1), 0.5);
    level.half_height = std::max(0.5 * (height_ - 1), 0.5);
    const auto first = sums<2>([&](std::int32_t r) {
      std::array<double, 2> sum{};
      for (std::size_t i = at(r); i < at(r + 1); ++i)
        if (z_[i] == z_[i]) sum[0] += 1.0, sum[1] += static_cast<double>(z_[i]);
      return sum;
    });
    const double count = first[0];
    holes_ = count < static_cast<double>(z_.size());
    if (count == 0.0) return;
    level.mean = first[1] / count;
    const auto second = sums<7>([&](std::int32_t r) {
      std::array<double, 7> sum{};
      for (std::int32_t c = 0; c < width_; ++c) {
        const double z = about(c, r), u = c / level.half_width - 1.0, v = r / level.half_height - 1.0;
        if (z != z) continue;
        const double terms[] = {u, v, u * u, v * v, u * v, u * z, v * z};
        for (std::size_t i = 0; i < 7; ++i) sum[i] += terms[i];
      }
      return sum;
    });
    // About the middle of the samples there are; a slope that they do not determine is none.
    const double u = second[0] / count, v = second[1] / count;
    const double uu = second[2] / count - u * u, vv = second[3] / count - v * v,
                 uv = second[4] / count - u * v;
    const double uz = second[5] / count, vz = second[6] / count, size = uu * vv - uv * uv;
    if (size > 1e-6 * (uu + vv) * (uu + vv)) {
      level.along_x = (uz * vv - vz * uv) / size;
      level.along_y = (vz * uu - uz * uv) / size;
      level.mean -= level.along_x * u + level.along_y * v;
    }
    const double squares = sum([&](std::int32_t r) {
      double of_row = 0.0;
      for (std::int32_t c = 0; c < width_; ++c)
        if (const double z = about(c, r); z == z) of_row += z * z;
      return of_row;
    });
    level.deviation = std::sqrt(squares / count);
  }

  // plane_ = what the filter makes of the root of H times `of`, plus the weighted heights.
  bool applied(const std::vector<double>& of, bool heights, const JobControl& job) {
    eachRow([&](std::int32_t r) {
      for (std::int32_t c = 0; c < width_; ++c) {
        const std::size_t i = at(r) + c;
        double value = lack_[i] * of[i];
        if (heights && lack_[i] < 1.0) value += (1.0 - lack_[i] * lack_[i]) * about(c, r);
        plane_.z[i] = value;
      }
    });
    return smoothPlane(x_, y_, plane_, level_, job);
  }

  bool findLacking(double scale, const JobControl& job) {
    // The distance of x from what the filter makes of it.
    if (!applied(found_, true, job)) return false;
    double squares = sum([&](std::int32_t r) {
      double of_row = 0.0;
      for (std::size_t i = at(r); i < at(r + 1); ++i) {
        rest_[i] = direction_[i] = lack_[i] * plane_.z[i] - found_[i];
        of_row += rest_[i] * rest_[i];
      }
      return of_row;
    });
    const double enough = std::pow(kSplineTolerance * scale, 2) * static_cast<double>(z_.size()),
                 none = 1e-32 * squares;
    std::vector<double> gains;  // of the steps, in squared errors
    while (gains.size() < kMostSteps && squares > none) {
      if (!applied(direction_, false, job)) return false;
      const double along = sum([&](std::int32_t r) {
        double of_row = 0.0;
        for (std::size_t i = at(r); i < at(r + 1); ++i)
          of_row += direction_[i] * (direction_[i] - lack_[i] * plane_.z[i]);
        return of_row;
      });
      // What no sample determines.
      if (!(along > 1e-14 * squares)) break;
      const double size = squares / along;
      const double next = sum([&](std::int32_t r) {
        double of_row = 0.0;
        for (std::size_t i = at(r); i < at(r + 1); ++i) {
          found_[i] += size * direction_[i];
          rest_[i] -= size * (direction_[i] - lack_[i] * plane_.z[i]);
          of_row += rest_[i] * rest_[i];
        }
        return of_row;
      });
      gains.push_back(size * squares);
      if (gains.size() >= kLater && std::accumulate(gains.rbegin(), gains.rbegin() + kLater, 0.0) <= enough)
        break;
      const double turn = next / squares;
      squares = next;
      eachRow([&](std::int32_t r) {
        for (std::size_t i = at(r); i < at(r + 1); ++i) direction_[i] = rest_[i] + turn * direction_[i];
      });
    }
    return applied(found_, true, job);
  }

  FieldReader reader_;
  std::int32_t width_, height_;
  SplineAxis x_, y_;
  CpuLevel level_;
  std::vector<float> z_;
  bool holes_ = false;
  SplineLevel plane_level_;
  SplinePlane plane_;
  std::vector<double> lack_, found_, rest_, direction_;
};

// What the rounds of the robust Gaussian find. The memory of the rounds is given back before the spline takes its own.
struct RobustWeights {
  std::vector<float> weights;  // none: all are 1
  std::ptrdiff_t stride = 0;
  double limit = 0.0;  // [height_unit]; 0 where nothing is left out
  std::int64_t weightless = 0;
};

// None when the job was cancelled.
std::optional<RobustWeights> robustWeights(const Version& input, const FilterSpec& spec, CpuLevel level,
                                           const FilterTuning& tuning, JobControl& job) {
  RobustRegression rounds(input, spec, level);
  if (!rounds.find(tuning.work, job)) return std::nullopt;
  RobustWeights found{{}, rounds.stride(), rounds.limit(), rounds.weightless()};
  found.weights = rounds.takeWeights();
  return found;
}

Result<PassResult> passOfWhole(const std::vector<float>& surface, const FieldReader& field,
                               const Version& input, const Version& original, const FilterSpec& spec,
                               const FilterTuning& tuning, JobControl& job) {
  return passOfSurface(
      [&](const SampleRect& rect, float* out, std::ptrdiff_t stride) {
        for (int r = 0; r < rect.rows; ++r)
          std::copy_n(surface.data() + std::ptrdiff_t{rect.row + r} * field.width() + rect.column,
                      rect.columns, out + r * stride);
        return true;
      },
      std::max(field.width(), field.height()), input, original, spec, tuning, job);
}

}  // namespace

Result<PassResult> splinePass(const Version& input, const Version& original, const FilterSpec& spec,
                              const FilterTuning& tuning, JobControl& job) {
  std::vector<float> surface;
  {
    SplineSurface filter(input, spec, std::min(tuning.level, bestCpuLevel()));
    if (!filter.solve({}, job)) return cancelled();
    filter.copyTo(surface);
  }
  return passOfWhole(surface, input.reader(), input, original, spec, tuning, job);
}

Result<PassResult> robustSplinePass(const Version& input, const Version& original, const FilterSpec& spec,
                                    const FilterTuning& tuning, JobControl& job) {
  const CpuLevel level = std::min(tuning.level, bestCpuLevel());
  std::optional<RobustWeights> robust = robustWeights(input, spec, level, tuning, job);
  if (!robust) return cancelled();
  std::vector<float> surface;
  {
    SplineSurface filter(input, spec, level);
    using Weights = SplineSurface::Weights;
    const std::vector<float>& z = robust->weights;
    const double scale = robust->limit > 0.0 ? robust->limit : filter.deviation();
    if (!filter.solve(z.empty() ? std::nullopt : std::optional(Weights{z.data(), robust->stride, scale}),
                      job))
      return cancelled();
    filter.copyTo(surface);
  }
  const std::int64_t weightless = robust->weightless;
  robust.reset();
  Result<PassResult> result = passOfWhole(surface, input.reader(), input, original, spec, tuning, job);
  if (result) result->weightless = weightless;
  return result;
}

}  // namespace fettle::engine
