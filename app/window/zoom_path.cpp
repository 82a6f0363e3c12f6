#include "app/window/zoom_path.h"

#include <cmath>

namespace fettle::app {
namespace {

constexpr double kRho = 1.42;
// Below this share of the picture two places are one, and the general formula would divide by nothing.
constexpr double kSamePlace = 1e-6;

}  // namespace

ZoomPath::ZoomPath(double far, double from, double to) noexcept
    : far_(far > kSamePlace * std::fmin(from, to) ? far : 0.0), from_(from) {
  if (far_ == 0.0) {
    length_ = std::log(to / from) / kRho;
    return;
  }
  const double reach = kRho * kRho * far_;
  const auto ratio = [&](double across, double sign) {
    return (to * to - from * from + sign * reach * reach) / (2.0 * across * reach);
  };
  // ln(-b + sqrt(b^2 + 1)) without cancellation.
  begin_ = -std::asinh(ratio(from, 1.0));
  length_ = (-std::asinh(ratio(to, -1.0)) - begin_) / kRho;
}

ZoomPath::Place ZoomPath::at(double way) const noexcept {
  const double s = kRho * way * length_;
  if (far_ == 0.0) return {way, from_ * std::exp(s)};
  const double travelled =
      from_ / (kRho * kRho) * (std::cosh(begin_) * std::tanh(s + begin_) - std::sinh(begin_));
  return {travelled / far_, from_ * std::cosh(begin_) / std::cosh(s + begin_)};
}

}  // namespace fettle::app
