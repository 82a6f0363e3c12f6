#include "engine/measure/height_rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

constexpr double kNoticed = 0.02;  // of a variance

// The largest height of a field, with the form that was taken out of it, and how far floats are apart there.
struct Rounding {
  double most = 0.0, step = 0.0;  // [height_unit]; 0: there is no height
};
Rounding roundingOf(const Version& field) {
  const HeightBounds bounds = (field.seenOf() != nullptr ? *field.seenOf() : field).reader().bounds();
  if (bounds.empty()) return {};
  const float most = std::max(std::abs(bounds.min), std::abs(bounds.max));
  return {double{most}, double{std::nextafter(most, std::numeric_limits<float>::infinity())} - double{most}};
}

}  // namespace

std::string roundingDoubt(std::initializer_list<const Version*> fields, double rms, std::string_view of) {
  if (!(rms > 0.0)) return {};
  const double unit = (*fields.begin())->grid().height_unit.mm;
  double variance = 0.0;
  Rounding widest;
  for (const Version* field : fields) {
    const Rounding own = roundingOf(*field);
    const double to_first = field->grid().height_unit.mm / unit;
    variance += std::pow(own.step * to_first, 2) / 12.0;
    if (own.step * to_first > widest.step) widest = {own.most * to_first, own.step * to_first};
  }
  const double share = variance / (rms * rms);
  if (!(share >= kNoticed)) return {};
  const std::string& name = (*fields.begin())->grid().height_unit.name;
  constexpr double kWhole = 0.1;  // two digits
  const std::string percent = share < kWhole ? fmt::format("{:.2g}", 100.0 * share)
                                             : fmt::format("{:.0f}", 100.0 * std::min(1.0, share));
  return fmt::format("heights up to {:.6g} {} are floats {:.2g} {} apart, which has {} % of the square of {}",
                     widest.most, name, widest.step, name, percent, of);
}

std::string roundingDoubt(const Version& field, const ArealParameters& measured) {
  const auto [most, step] = roundingOf(field);
  if (step == 0.0) return {};
  const Grid& grid = field.grid();
  const double variance = std::pow(step * grid.height_unit.mm, 2) / 12.0;
  const double dx = grid.spacingXMm(), dy = grid.spacingYMm();
  // Of variances: what rounding has of the mean square gradient. Of a flat field there is none, nor of one that is nothing but rounding.
  const double square = measured.sdq * measured.sdq;
  const double of_slopes =
      square > 0.0 ? variance * 4.0 / 3.0 * (1.0 / (dx * dx) + 1.0 / (dy * dy)) / square : 0.0;
  // Half the sum of both second differences; the middle sample is in both.
  const double curvature =
      0.5 * std::sqrt(variance * (6.0 / std::pow(dx, 4) + 6.0 / std::pow(dy, 4) + 8.0 / (dx * dx * dy * dy)));
  const auto shareOf = [&](double figure) { return figure > 0.0 ? curvature / figure : 0.0; };
  const double of_peaks = std::max(shareOf(measured.feature.spc), shareOf(measured.feature.svc));
  std::string what;
  if (of_slopes >= kNoticed)
    what = fmt::format("makes Sdq about {:.2g} % too large, Sdr {:.2g} %",
                       100.0 * (1.0 - std::sqrt(std::max(0.0, 1.0 - of_slopes))),
                       100.0 * std::min(1.0, of_slopes));
  if (of_peaks >= kNoticed)
    what += fmt::format("{}makes the curvature of a peak, of Spc and Svc, uncertain by {:.2g} %",
                        what.empty() ? "" : ", and ", 100.0 * of_peaks);
  if (what.empty()) return {};
  return fmt::format("heights up to {:.6g} {} are floats {:.2g} {} apart, which {}", most,
                     grid.height_unit.name, step, grid.height_unit.name, what);
}

}  // namespace fettle::engine
