#include "engine/measure/fit_rounds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/measure/fit_start.h"

namespace fettle::engine {

namespace {

double medianSize(std::vector<float> residuals) {
  if (residuals.empty()) return 0.0;
  for (float& r : residuals) r = std::abs(r);
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  return double{*middle};
}

// The coarse points in parts of a scale, and where on them a surface is best described.
struct CoarseFit {
  FitSamples::Coarse coarse;
  FitSamples samples;
  FitPoints points;

  CoarseFit(const FitSamples& all, double scale) : coarse(all.coarse(kMostPoints)) {
    for (glm::dvec3& p : coarse.points) p /= scale;
    samples = FitSamples(coarse.points, glm::dvec3(0.0));
    points.samples = &samples;
  }
  CoarseFit(const CoarseFit&) = delete;
  CoarseFit& operator=(const CoarseFit&) = delete;

  // Not next to the axis, which a normal does not determine: the point that half of all are farther from it than.
  [[nodiscard]] glm::dvec3 describedAt(const Shape& shape) const {
    const bool by_axis = shape.kind == ShapeKind::kCone || shape.kind == ShapeKind::kTorus;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < coarse.points.size(); ++i) {
      const glm::dvec3 from = coarse.points[i] - (by_axis ? shape.point : glm::dvec3(0.0));
      const glm::dvec3 across = by_axis ? from - glm::dot(from, shape.direction) * shape.direction : from;
      order.emplace_back(glm::dot(across, across), i);
    }
    const auto place = order.begin() + (by_axis ? static_cast<std::ptrdiff_t>(order.size() / 2) : 0);
    std::ranges::nth_element(order, place);
    return coarse.points[place->second];
  }

 private:
  static constexpr std::size_t kMostPoints = 800;
};

double costOf(const FitPoints& points, const FitWeights& weights, const FitSurface& surface, bool robust) {
  const std::vector<float> residuals = residualsOf(points, weights, surface);
  if (robust) return medianSize(residuals);
  double squares = 0.0;
  for (const float r : residuals) squares += double{r} * r;
  return squares;
}

std::optional<FitModel> startOn(const CoarseFit& on, ShapeKind kind, const FitWeights& weights, bool robust,
                                double least, JobControl& job) {
  std::vector<FitModel> starts;
  for (const Shape& shape : likelyShapes(on.coarse, kind, 3))
    starts.push_back({kind, FitSurface::of(shape, on.describedAt(shape))});
  // A cone of hardly any angle, a ring of hardly any curvature: near to what they contain.
  if (kind == ShapeKind::kCone || kind == ShapeKind::kTorus) {
    const ShapeKind simpler = kind == ShapeKind::kCone ? ShapeKind::kCylinder : ShapeKind::kCone;
    if (auto near = startOn(on, simpler, weights, robust, least, job)) starts.push_back({kind, near->base});
    if (kind == ShapeKind::kTorus)
      if (auto near = startOn(on, ShapeKind::kCylinder, weights, robust, least, job)) {
        // A straight tube, bent a little.
        FitModel bent{kind, near->base};
        std::swap(bent.base.ring, bent.base.tube);
        bent.base.axial = glm::cross(near->base.axial, near->base.radial);
        starts.push_back(bent);
      }
  }
  std::optional<FitModel> best;
  double least_cost = std::numeric_limits<double>::infinity();
  for (FitModel& start : starts) {
    if (job.cancelled()) return std::nullopt;
    if (!fitInRounds(on.points, weights, robust, least, start, job)) continue;
    const double cost = costOf(on.points, weights, start.base, robust);
    if (!(cost < least_cost)) continue;
    least_cost = cost;
    best = start;
  }
  return best;
}

}  // namespace

double robustScale(const FitPoints& points, const FitWeights& weights, const FitSurface& surface,
                   double least) {
  return std::max(1.4826 * medianSize(residualsOf(points, weights, surface)), least);
}

bool fitInRounds(const FitPoints& points, FitWeights weights, bool robust, double least, FitModel& model,
                 JobControl& job) {
  const int rounds = robust ? 20 : 1;
  double before = 0.0;
  for (int round = 0; round < rounds; ++round) {
    if (robust) {
      weights.robust_scale = robustScale(points, weights, model.base, least);
      if (round > 0 && std::abs(weights.robust_scale - before) < 1e-3 * before) break;
      before = weights.robust_scale;
    }
    if (!solveFit(points, weights, model, job) || job.cancelled()) return false;
  }
  return true;
}

std::optional<FitModel> startOfFit(const FitSamples& samples, double scale, ShapeKind kind,
                                   const FitWeights& weights, bool robust, double least, JobControl& job) {
  return startOn(CoarseFit(samples, scale), kind, weights, robust, least, job);
}

}  // namespace fettle::engine
