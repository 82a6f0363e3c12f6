#include "engine/measure/fit_solve.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <tbb/parallel_for.h>
#include <glm/geometric.hpp>
#include <unsupported/Eigen/NonLinearOptimization>

namespace fettle::engine {

namespace {

// A vector turned about the direction of `by`, by its length.
glm::dvec3 turnedBy(const glm::dvec3& v, const glm::dvec3& by) {
  const double angle = glm::length(by);
  if (!(angle > 1e-300)) return v;
  const glm::dvec3 k = by / angle;
  return std::cos(angle) * v + std::sin(angle) * glm::cross(k, v) +
         (1.0 - std::cos(angle)) * glm::dot(k, v) * k;
}

// The small turn that a change of the turn `by` along `d` adds: the left Jacobian of rotation vectors.
glm::dvec3 addedTurn(const glm::dvec3& by, const glm::dvec3& d) {
  const double angle = glm::length(by);
  if (!(angle > 1e-8)) return d + 0.5 * glm::cross(by, d);
  const glm::dvec3 k = by / angle;
  const double s = std::sin(angle) / angle;
  return s * d + (1.0 - s) * glm::dot(k, d) * k + (1.0 - std::cos(angle)) / angle * glm::cross(k, d);
}

glm::dvec3 turnOf(const FitModel& model, const Eigen::VectorXd& by) {
  const FitSurface& base = model.base;
  glm::dvec3 turn = by[1] * glm::cross(base.radial, base.axial) + by[2] * base.axial;
  if (model.size() > 4) turn += by[3] * base.radial;
  return turn;
}

// Rows (derivatives, residual) of many points as the triangle that has the same sums of products: QR by parts. The solver
// takes it in place of all rows, which need no memory then.
class Triangle {
 public:
  explicit Triangle(int columns) : columns_(columns), rows_(Eigen::MatrixXd::Zero(kRows, columns)) {}
  double* next() {
    if (used_ == kRows) fold();
    return row_;
  }
  void take() {
    for (int c = 0; c < columns_; ++c) rows_(used_, c) = row_[c];
    ++used_;
  }
  Eigen::MatrixXd folded() {
    fold();
    return rows_.topRows(columns_);
  }

 private:
  static constexpr int kRows = 512;
  void fold() {
    Eigen::Ref<Eigen::MatrixXd> used = rows_.topRows(used_);
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(used);
    for (int c = 0; c < columns_; ++c)
      for (int r = c + 1; r < columns_; ++r) rows_(r, c) = 0.0;
    used_ = columns_;
  }
  int columns_, used_ = columns_;
  Eigen::MatrixXd rows_ = {};
  double row_[FitModel::kMost + 1] = {};
};

struct FitFunctor {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const FitPoints& points;
  const FitWeights& weights;
  const FitModel& model;
  JobControl& job;
  mutable Eigen::VectorXd at = {};
  mutable Eigen::MatrixXd triangle = {};

  [[nodiscard]] int inputs() const { return model.size(); }
  [[nodiscard]] int values() const { return model.size() + 1; }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& f) const {
    evaluate(x);
    f = triangle.col(model.size());
    return job.cancelled() ? -1 : 0;
  }
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& j) const {
    if (at.size() != x.size() || at != x) evaluate(x);
    j = triangle.leftCols(model.size());
    return job.cancelled() ? -1 : 0;
  }

 private:
  void evaluate(const Eigen::VectorXd& x) const {
    const FitModel::Rows rows(model, x);
    const int n = model.size();
    std::vector<Eigen::MatrixXd> parts(points.groups());
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t group) {
      if (job.cancelled()) return;
      Triangle part(n + 1);
      FitSamples::Block block;
      for (std::size_t b = points.begin(group); b < points.begin(group + 1); ++b) {
        points.samples->read(b, block);
        for (int i = 0; i < block.count; ++i) {
          const glm::dvec3 p = block.points[static_cast<std::size_t>(i)] / points.scale;
          const FitPlace on = placeOf(rows.surface(), weights, p);
          double* row = part.next();
          rows.derivatives(on.at, on.point, row);
          double factor = on.factor, residual = on.residual;
          if (weights.robust_scale > 0.0) {
            // Squares of f = sqrt(2 rho) are twice Tukey's function.
            const double c = FitWeights::kTukey * weights.robust_scale, x2 = std::pow(residual / c, 2);
            const double share = weights.share(residual);
            const double value = x2 >= 1.0 ? c * std::sqrt(1.0 / 3.0)
                                           : std::abs(residual) * std::sqrt(1.0 - x2 + x2 * x2 / 3.0);
            factor *= value > 0.0 ? share * std::abs(residual) / value : 1.0;
            residual = residual < 0.0 ? -value : value;
          }
          for (int k = 0; k < n; ++k) row[k] *= factor;
          row[n] = residual;
          part.take();
        }
      }
      parts[group] = part.folded();
    });
    Triangle all(n + 1);
    if (!job.cancelled())
      for (const Eigen::MatrixXd& part : parts)
        for (Eigen::Index r = 0; r < part.rows(); ++r) {
          double* row = all.next();
          for (Eigen::Index c = 0; c < part.cols(); ++c) row[c] = part(r, c);
          all.take();
        }
    triangle = all.folded();
    at = x;
  }
};

}  // namespace

FitSurface FitModel::moved(const Eigen::VectorXd& by) const noexcept {
  FitSurface surface = base;
  const glm::dvec3 turn = turnOf(*this, by);
  surface.foot += by[0] * base.normal();
  surface.radial = turnedBy(base.radial, turn);
  surface.axial = turnedBy(base.axial, turn);
  if (kind == ShapeKind::kSphere) {
    surface.ring += by[3];
    surface.tube = surface.ring;
  } else if (size() > 4) {
    surface.ring += by[4];
    if (size() > 5) surface.theta += by[5];
    if (size() > 6) surface.tube += by[6];
  }
  return surface;
}

FitModel::Rows::Rows(const FitModel& model, const Eigen::VectorXd& by)
    : kind_(model.kind), surface_(model.moved(by)), normal_(model.base.normal()) {
  const glm::dvec3 turn = turnOf(model, by);
  turns_[0] = addedTurn(turn, glm::cross(model.base.radial, model.base.axial));
  turns_[1] = addedTurn(turn, model.base.axial);
  turns_[2] = addedTurn(turn, model.base.radial);
}

void FitModel::Rows::derivatives(const FitSurface::At& at, const glm::dvec3& point,
                                 double* out) const noexcept {
  out[0] = -glm::dot(at.gradient, normal_);
  const glm::dvec3 moment = glm::cross(point - surface_.foot, at.gradient);
  out[1] = -glm::dot(turns_[0], moment);
  out[2] = -glm::dot(turns_[1], moment);
  if (kind_ == ShapeKind::kPlane) return;
  if (kind_ == ShapeKind::kSphere) {
    out[3] = at.by_ring + at.by_tube;
    return;
  }
  out[3] = -glm::dot(turns_[2], moment);
  out[4] = at.by_ring;
  if (kind_ == ShapeKind::kCylinder) return;
  out[5] = at.by_theta;
  if (kind_ == ShapeKind::kTorus) out[6] = at.by_tube;
}

const char* FitModel::nameOf(int number) const noexcept {
  constexpr const char* kNames[] = {"position", "direction", "direction",         "direction",
                                    "radius",   "angle",     "radius of the tube"};
  return kind == ShapeKind::kSphere && number == 3 ? "radius" : kNames[number];
}

double FitWeights::factor(double gradient_z) const noexcept {
  return vertical ? 1.0 / std::max(std::abs(gradient_z), kSteepest) : 1.0;
}

FitPlace placeOf(const FitSurface& surface, const FitWeights& weights, const glm::dvec3& p) noexcept {
  FitPlace place{surface.at(p), p};
  place.factor = weights.factor(place.at.gradient.z);
  place.residual = place.factor * place.at.distance;
  if (!weights.vertical) return place;
  constexpr int kMostSteps = 30;
  glm::dvec3 q = p;
  FitSurface::At at = place.at;
  for (int step = 0; step < kMostSteps; ++step) {
    if (!(at.gradient.z >= FitWeights::kSteepest)) return place;
    const double by = at.distance / at.gradient.z;
    q.z -= by;
    at = surface.at(q);
    // Rounding of z, in which steps end.
    if (!(std::abs(by) > 1e-15 * (1.0 + std::abs(q.z)))) break;
  }
  if (!(at.gradient.z >= FitWeights::kSteepest) || !(std::abs(at.distance) < 1e-12 * (1.0 + std::abs(q.z))))
    return place;
  return {at, q, 1.0 / at.gradient.z, p.z - q.z};
}

double FitWeights::share(double residual) const noexcept {
  if (!(robust_scale > 0.0)) return 1.0;
  const double x = residual / (kTukey * robust_scale), rest = 1.0 - x * x;
  return rest > 0.0 ? rest * rest : 0.0;
}

std::size_t FitPoints::groups() const noexcept {
  constexpr std::size_t kBlocks = 64;
  return (samples->blocks() + kBlocks - 1) / kBlocks;
}
std::size_t FitPoints::begin(std::size_t group) const noexcept {
  constexpr std::size_t kBlocks = 64;
  return std::min(group * kBlocks, samples->blocks());
}

bool solveFit(const FitPoints& points, const FitWeights& weights, FitModel& model, JobControl& job) {
  FitFunctor functor{points, weights, model, job};
  Eigen::LevenbergMarquardt<FitFunctor> solver(functor);
  solver.parameters.maxfev = 120;
  solver.parameters.ftol = 1e-13;
  solver.parameters.xtol = 1e-13;
  // A first step of the size of the region; MINPACK's 100 would let a start jump to another minimum.
  solver.parameters.factor = 1.0;
  Eigen::VectorXd by = Eigen::VectorXd::Zero(model.size());
  solver.minimize(by);
  if (!by.allFinite() || !std::isfinite(solver.fnorm)) return false;
  model.base = model.moved(by);
  return true;
}

std::vector<float> residualsOf(const FitPoints& points, const FitWeights& weights,
                               const FitSurface& surface) {
  std::vector<float> residuals(points.samples->size());
  tbb::parallel_for(std::size_t{0}, points.groups(), [&](std::size_t group) {
    FitSamples::Block block;
    for (std::size_t b = points.begin(group); b < points.begin(group + 1); ++b) {
      points.samples->read(b, block);
      for (int i = 0; i < block.count; ++i) {
        const glm::dvec3 p = block.points[static_cast<std::size_t>(i)] / points.scale;
        residuals[points.samples->first(b) + static_cast<std::size_t>(i)] =
            static_cast<float>(placeOf(surface, weights, p).residual);
      }
    }
  });
  return residuals;
}

}  // namespace fettle::engine
