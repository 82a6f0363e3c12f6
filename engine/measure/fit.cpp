#include "engine/measure/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "engine/measure/fit_bias.h"
#include "engine/measure/fit_errors.h"
#include "engine/measure/fit_rounds.h"
#include "engine/measure/fit_variance.h"

namespace fettle::engine {

Shape ShapeFit::moved(const std::array<double, kMost>& by) const noexcept {
  const FitModel model{shape.kind, surface};
  Eigen::VectorXd numbers_by(model.size());
  for (int k = 0; k < model.size(); ++k) numbers_by[k] = by[static_cast<std::size_t>(k)];
  Shape result = model.moved(numbers_by).shape(shape.kind, glm::dvec3(0.0), shape.direction);
  result.point = middle + scale * result.point;
  result.radius *= scale;
  result.tube_radius *= scale;
  return result;
}

namespace {

// In the order of ShapeFit::Errors.
using ShapeNumbers = std::array<double, 11>;

ShapeNumbers numbersOf(const Shape& s) {
  const bool plane = s.kind == ShapeKind::kPlane;
  return {s.point.x,
          s.point.y,
          s.point.z,
          s.direction.x,
          s.direction.y,
          s.direction.z,
          s.radius,
          s.tube_radius,
          s.half_angle,
          plane ? std::atan(-s.direction.x / s.direction.z) : 0.0,
          plane ? std::atan(-s.direction.y / s.direction.z) : 0.0};
}

ShapeFit::Errors byName(const ShapeNumbers& e) {
  return {{e[0], e[1], e[2]}, {e[3], e[4], e[5]}, e[6], e[7], e[8], e[9], e[10]};
}

}  // namespace

ShapeFit::Errors ShapeFit::errors() const noexcept {
  ShapeNumbers e = figureVariances<11>(*this, numbersOf);
  for (double& each : e) each = std::sqrt(each);
  return byName(e);
}

ShapeFit::Errors ShapeFit::biases() const {
  return byName(figureBiases<11>(*this, numbersOf));
}

Result<ShapeFit> fitShape(const FitSamples& samples, ShapeKind kind, const FitOptions& options,
                          JobControl& job) {
  const int numbers = infoOf(kind).numbers;
  if (static_cast<int>(std::min<std::size_t>(samples.size(), 100)) < numbers)
    return undetermined(
        kind, fmt::format("{}: {} samples for {} numbers", infoOf(kind).text, samples.size(), numbers),
        "take a larger region");
  ShapeFit fit;
  fit.scale = samples.reach();
  fit.numbers = numbers;
  if (!(fit.scale > 0.0)) return undetermined(kind, "its direction", "take a larger region");
  job.begin("fitting", 0);
  const double least = std::max(samples.rounding() / fit.scale, 1e-13);
  FitWeights weights{options.vertical, 0.0};
  auto model = startOfFit(samples, fit.scale, kind, weights, options.robust, least, job);
  if (job.cancelled()) return cancelled();
  if (!model)
    return undetermined(
        kind,
        kind == ShapeKind::kPlane ? "its direction: they lie on one line" : std::string(infoOf(kind).text),
        "take a larger region or a simpler shape");
  const FitPoints points{&samples, fit.scale};
  if (!fitInRounds(points, weights, options.robust, least, *model, job)) {
    if (job.cancelled()) return cancelled();
    return undetermined(kind, std::string(infoOf(kind).text),
                        "no finite shape is nearest to the samples; try --robust");
  }
  if (options.robust) weights.robust_scale = robustScale(points, weights, model->base, least);
  const FitSums sums = fitSums(points, weights, *model);
  fit.surface = model->base;
  fit.middle = samples.middle();
  fit.shape.kind = kind;
  fit.shape = fit.moved({});
  if (kind == ShapeKind::kCylinder || kind == ShapeKind::kTorus)
    fit.shape.direction = inAxisSense(fit.shape.direction);
  fit.samples = static_cast<std::int64_t>(samples.size());
  fit.left_out = sums.left_out;
  fit.rms_mm = sums.used > 0 ? fit.scale * std::sqrt(sums.squares / static_cast<double>(sums.used)) : 0.0;
  fit.largest_mm = fit.scale * sums.largest;
  std::optional<FitLineSums> lines;
  if ((options.rows_mm > 0.0 || options.columns_mm > 0.0) && samples.lattice().rows > 0)
    lines.emplace(points, weights, *model);
  const auto noise = setCovariance(fit, *model, sums, lines ? &*lines : nullptr, options, samples.rounding());
  if (!noise) return tl::unexpected(noise.error());
  if (auto status = checkDetermined(fit, *model); !status) return tl::unexpected(status.error());
  Eigen::MatrixXd covariance(numbers, numbers);
  for (int a = 0; a < numbers; ++a)
    for (int b = 0; b < numbers; ++b)
      covariance(a, b) = fit.covariance[static_cast<std::size_t>(a * ShapeFit::kMost + b)];
  Eigen::Map<Eigen::VectorXd>(fit.bias.data(), numbers) =
      numbersBias(points, weights, *model, *noise, covariance);
  return fit;
}

double residualAt(const ShapeFit& fit, const glm::dvec3& point, bool vertical) noexcept {
  return fit.scale * placeOf(fit.surface, {vertical, 0.0}, (point - fit.middle) / fit.scale).residual;
}

}  // namespace fettle::engine
