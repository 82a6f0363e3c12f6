#include "engine/measure/fit_bias.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/measure/fit_terms.h"

namespace fettle::engine {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// Small beside a scale of 1, on which distances bend, and large beside the root of rounding, of which second differences are.
constexpr double kBiasStep = 1e-4;

// A weighted distance and its derivatives by the numbers, of surfaces moved by a step of each number to both sides.
class DistanceNear {
 public:
  DistanceNear(const FitModel& model, const FitWeights& weights) : weights_(weights) {
    const int n = model.size();
    at_.emplace_back(model, Vector::Zero(n));
    for (int k = 0; k < n; ++k)
      for (const double step : {kBiasStep, -kBiasStep}) at_.emplace_back(model, step * Vector::Unit(n, k));
  }
  // The distance of a point; its derivatives to `row`.
  double operator()(std::size_t which, const glm::dvec3& p, Vector& row) const {
    const FitPlace on = placeOf(at_[which].surface(), weights_, p);
    at_[which].derivatives(on.at, on.point, row.data());
    row *= on.factor;
    return on.residual;
  }

 private:
  FitWeights weights_;
  std::vector<FitModel::Rows> at_;
};

// Derivatives of a sample's distance: by its height and by the numbers, first and second.
struct SampleSlopes {
  double by_height = 0.0, by_height_twice = 0.0;
  Vector by_numbers, mixed;
  Matrix by_numbers_twice;
};

SampleSlopes slopesAt(const DistanceNear& distance, const glm::dvec3& p, int n) {
  SampleSlopes s{0.0, 0.0, Vector(n), Vector(n), Matrix(n, n)};
  Vector up(n), down(n);
  const glm::dvec3 by(0.0, 0.0, kBiasStep);
  const double here = distance(0, p, s.by_numbers);
  const double above = distance(0, p + by, up), below = distance(0, p - by, down);
  s.by_height = (above - below) / (2.0 * kBiasStep);
  s.by_height_twice = (above - 2.0 * here + below) / (kBiasStep * kBiasStep);
  s.mixed = (up - down) / (2.0 * kBiasStep);
  for (int k = 0; k < n; ++k) {
    distance(static_cast<std::size_t>(1 + 2 * k), p, up);
    distance(static_cast<std::size_t>(2 + 2 * k), p, down);
    s.by_numbers_twice.col(k) = (up - down) / (2.0 * kBiasStep);
  }
  s.by_numbers_twice = 0.5 * (s.by_numbers_twice + s.by_numbers_twice.transpose()).eval();
  return s;
}

}  // namespace

Vector numbersBias(const FitPoints& points, const FitWeights& weights, const FitModel& model, double variance,
                   const Matrix& covariance) {
  const int n = model.size();
  constexpr std::uint64_t kMostSamples = 4096;
  const std::uint64_t every = points.samples->size() / kMostSamples + 1;
  const DistanceNear distance(model, {weights.vertical, 0.0});
  FitTerms counts(model, weights);
  std::vector<SampleSlopes> slopes;
  double samples = 0.0;
  Matrix information = Matrix::Zero(n, n);
  FitSamples::Block block;
  for (std::size_t b = 0; b < points.samples->blocks(); ++b) {
    points.samples->read(b, block);
    for (int i = 0; i < block.count; ++i) {
      // Scattered by Fibonacci hashing: every n-th sample could be of a few columns.
      const std::uint64_t number = points.samples->first(b) + static_cast<std::uint64_t>(i);
      if (((number * 0x9E3779B97F4A7C15ULL) >> 32) % every != 0) continue;
      const glm::dvec3 p = block.points[static_cast<std::size_t>(i)] / points.scale;
      if (!counts.take(p)) continue;
      slopes.push_back(slopesAt(distance, p, n));
      const Vector& row = slopes.back().by_numbers;
      information.noalias() += row * row.transpose();
      samples += 1.0;
    }
  }
  if (slopes.empty()) return Vector::Constant(n, std::nan(""));
  const Matrix inverse = information.completeOrthogonalDecomposition().pseudoInverse();
  // The sum over the samples of distance times derivative is 0 at the solution. Its mean to second order in the noise e of a
  // height and the change d of the numbers, of which the first is -inverse J c e: c, K, H, J as in SampleSlopes.
  const double share = samples * static_cast<double>(every);  // of all
  Vector mean = Vector::Zero(n);
  for (const SampleSlopes& s : slopes) {
    const Vector& j = s.by_numbers;
    const double c = s.by_height;
    mean += variance * (c * s.mixed + 0.5 * s.by_height_twice * j);
    // Of one sample's own noise in the numbers, which all samples share.
    const Vector own = -(variance * c * samples / share) * (inverse * j);
    mean += c * (s.by_numbers_twice * own) + s.mixed * j.dot(own) + j * s.mixed.dot(own);
    mean +=
        s.by_numbers_twice * (covariance * j) + 0.5 * j * (s.by_numbers_twice.cwiseProduct(covariance)).sum();
  }
  return -(inverse * mean);
}

}  // namespace fettle::engine
