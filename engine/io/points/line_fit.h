#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace fettle::engine {

/// A straight line index = scale * value + offset, and the deviation of the indices from it.
struct IndexLine {
  double scale = 0.0, offset = 0.0;
  double rms = std::numeric_limits<double>::infinity();  ///< [indices]
};

/// Fits that line by least squares, point by point (B. P. Welford, 1962).
class IndexLineFit {
 public:
  void add(double value, double index) {
    ++n_;
    const double dv = value - mean_v_, di = index - mean_i_;
    mean_v_ += dv / n_;
    mean_i_ += di / n_;
    vv_ += dv * (value - mean_v_);
    ii_ += di * (index - mean_i_);
    vi_ += dv * (index - mean_i_);
  }
  /// A line of infinite rms where there are fewer points than `fewest` (>= 2) or all values are equal.
  [[nodiscard]] IndexLine line(double fewest) const {
    if (!(vv_ > 0.0) || n_ < fewest) return {};
    const double scale = vi_ / vv_;
    return {scale, mean_i_ - scale * mean_v_, std::sqrt(std::max(0.0, ii_ - scale * vi_) / n_)};
  }

 private:
  double n_ = 0, mean_v_ = 0, mean_i_ = 0, vv_ = 0, ii_ = 0, vi_ = 0;
};

}  // namespace fettle::engine
