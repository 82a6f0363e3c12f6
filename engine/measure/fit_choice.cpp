#include "engine/measure/fit_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace fettle::engine {

Result<ChosenShape> fitBestShape(const Version& field, const FitRegion& region,
                                 const std::vector<ShapeKind>& kinds, const FitOptions& options,
                                 JobControl& job) {
  ChosenShape chosen;
  constexpr double kMostTried = 1 << 18;
  const auto stride = static_cast<std::int32_t>(
      std::ceil(std::sqrt(static_cast<double>(region.samples) / kMostTried) - 1e-9));
  std::optional<FitSamples> some;
  some.emplace(field, region, std::max(1, kinds.size() > 1 ? stride : 1));
  std::vector<ShapeFit> fits;
  std::optional<Error> first_refusal;
  for (const ShapeKind kind : kinds) {
    auto fit = fitShape(*some, kind, options, job);
    if (!fit && fit.error().kind != ErrorKind::kInput) return tl::unexpected(fit.error());
    if (!fit && !first_refusal) first_refusal = fit.error();
    chosen.tried.push_back({kind, fit ? fit->rms_mm : std::numeric_limits<double>::quiet_NaN(),
                            fit ? std::string() : fit.error().what});
    if (fit) fits.push_back(*std::move(fit));
  }
  if (fits.empty()) return tl::unexpected(*first_refusal);
  const auto rmsOf = [&](ShapeKind kind) {
    for (const ShapeFit& fit : fits)
      if (fit.shape.kind == kind) return fit.rms_mm;
    return std::numeric_limits<double>::infinity();
  };
  constexpr double kTenth = 0.9;
  double correlation = std::numeric_limits<double>::infinity();
  for (const ShapeFit& fit : fits) correlation = std::min(correlation, fit.correlation);
  const ShapeFit* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const ShapeFit& fit : fits) {
    const ShapeKind kind = fit.shape.kind;
    double simpler = std::numeric_limits<double>::infinity();
    if (kind != ShapeKind::kPlane) simpler = rmsOf(ShapeKind::kPlane);
    if (kind == ShapeKind::kCone || kind == ShapeKind::kTorus)
      simpler = std::min(simpler, rmsOf(ShapeKind::kCylinder));
    if (kind == ShapeKind::kTorus)
      simpler = std::min({simpler, rmsOf(ShapeKind::kSphere), rmsOf(ShapeKind::kCone)});
    if (!(fit.rms_mm < kTenth * simpler) && std::isfinite(simpler)) continue;
    const double n = static_cast<double>(fit.samples) / correlation;
    const double rms = std::max(fit.rms_mm, some->rounding());
    const double information =
        2.0 * n * std::log(std::max(rms, 1e-300)) + fit.numbers * std::log(std::max(n, 2.0));
    if (best != nullptr && !(information < least)) continue;
    best = &fit;
    least = information;
  }
  if (best == nullptr) best = &fits.front();
  if (some->stride() == 1) {
    chosen.fit = *best;
    return chosen;
  }
  const ShapeKind kind = best->shape.kind;
  some.emplace(field, region, 1);
  auto whole = fitShape(*some, kind, options, job);
  if (!whole) return tl::unexpected(whole.error());
  chosen.fit = *std::move(whole);
  return chosen;
}

}  // namespace fettle::engine
