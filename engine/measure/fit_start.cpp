#include "engine/measure/fit_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>

#include <Eigen/Dense>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

using Vec = Eigen::Vector3d;

glm::dvec3 glmOf(const Vec& v) {
  return {v.x(), v.y(), v.z()};
}

struct Oriented {
  Vec p, n;
};

// Normals of windows of `radius` blocks to each side: of the quadratic, or with few points the plane, that is nearest to
// the heights.
void addNormals(const FitSamples::Coarse& coarse, std::int32_t radius, std::vector<Oriented>& out) {
  std::vector<int> grid(static_cast<std::size_t>(coarse.columns) * static_cast<std::size_t>(coarse.rows), -1);
  const auto cell = [&](std::int32_t c, std::int32_t r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(coarse.columns) +
           static_cast<std::size_t>(c);
  };
  for (std::size_t i = 0; i < coarse.points.size(); ++i)
    grid[cell(coarse.column[i], coarse.row[i])] = static_cast<int>(i);
  constexpr std::size_t kWindows = 80;
  const std::size_t step = std::max<std::size_t>(1, coarse.points.size() / kWindows);
  std::vector<int> near;
  for (std::size_t i = step / 2; i < coarse.points.size(); i += step) {
    near.clear();
    for (std::int32_t r = std::max(0, coarse.row[i] - radius);
         r <= std::min(coarse.rows - 1, coarse.row[i] + radius); ++r)
      for (std::int32_t c = std::max(0, coarse.column[i] - radius);
           c <= std::min(coarse.columns - 1, coarse.column[i] + radius); ++c)
        if (const int k = grid[cell(c, r)]; k >= 0) near.push_back(k);
    if (near.size() < 4) continue;
    const int terms = near.size() >= 8 ? 6 : 3;
    const glm::dvec3& centre = coarse.points[i];
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(near.size()), terms);
    Eigen::VectorXd heights(static_cast<Eigen::Index>(near.size()));
    for (std::size_t k = 0; k < near.size(); ++k) {
      const glm::dvec3 d = coarse.points[static_cast<std::size_t>(near[k])] - centre;
      const auto row = static_cast<Eigen::Index>(k);
      rows.row(row).head<3>() << 1.0, d.x, d.y;
      if (terms == 6) rows.row(row).tail<3>() << d.x * d.x, d.x * d.y, d.y * d.y;
      heights[row] = d.z;
    }
    const auto solver = rows.colPivHouseholderQr();
    if (solver.rank() < terms) continue;
    const Eigen::VectorXd x = solver.solve(heights);
    out.push_back({Vec(centre.x, centre.y, centre.z + x[0]), Vec(-x[1], -x[2], 1.0).normalized()});
  }
}

// The point that is nearest to lines through points along directions; without components along `axis` if one is given.
std::optional<Vec> meeting(const std::vector<Oriented>& of, const std::optional<Vec>& axis) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vec right = Vec::Zero();
  for (const Oriented& o : of) {
    Vec n = o.n;
    if (axis) n -= n.dot(*axis) * *axis;
    if (n.norm() < 1e-9) continue;
    n.normalize();
    Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
    if (axis) across -= *axis * axis->transpose();
    normal += across;
    right += across * o.p;
  }
  if (axis) normal += *axis * axis->transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normal);
  if (!(eigen.eigenvalues()[0] > 1e-14 * static_cast<double>(of.size()))) return std::nullopt;
  return Vec(normal.ldlt().solve(right));
}

Vec leastDirection(const Eigen::Matrix3d& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix).eigenvectors().col(0);
}

void setHollow(Shape& shape, const std::vector<Oriented>& of) {
  // Normals point upwards: towards the centre or the axis of a hollow shape.
  double inwards = 0.0;
  for (const Oriented& o : of) {
    const glm::dvec3 from = glmOf(o.p) - shape.point;
    glm::dvec3 out = from;
    if (shape.kind != ShapeKind::kSphere) {
      out -= glm::dot(from, shape.direction) * shape.direction;
      if (shape.kind == ShapeKind::kTorus) out = from - shape.radius * glm::normalize(out + 1e-300);
    }
    inwards -= glm::dot(out, glmOf(o.n)) / (glm::length(out) + 1e-300);
  }
  shape.hollow = inwards > 0.0;
}

std::optional<Shape> planeBy(const std::vector<Oriented>& of) {
  Vec mean = Vec::Zero(), normal = Vec::Zero();
  for (const Oriented& o : of) {
    mean += o.p / static_cast<double>(of.size());
    normal += o.n;
  }
  Shape shape;
  shape.point = glmOf(mean);
  shape.direction = glmOf(normal.normalized());
  return shape;
}

std::optional<Shape> sphereBy(const std::vector<Oriented>& of) {
  const auto centre = meeting(of, std::nullopt);
  if (!centre) return std::nullopt;
  Shape shape;
  shape.kind = ShapeKind::kSphere;
  shape.point = glmOf(*centre);
  for (const Oriented& o : of) shape.radius += (o.p - *centre).norm() / static_cast<double>(of.size());
  setHollow(shape, of);
  return shape;
}

std::optional<Shape> cylinderBy(const std::vector<Oriented>& of) {
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  for (const Oriented& o : of) normals += o.n * o.n.transpose();
  const Vec axis = leastDirection(normals);
  const auto centre = meeting(of, axis);
  if (!centre) return std::nullopt;
  Shape shape;
  shape.kind = ShapeKind::kCylinder;
  shape.point = glmOf(*centre);
  shape.direction = glmOf(axis);
  for (const Oriented& o : of) {
    const Vec from = o.p - *centre;
    shape.radius += (from - from.dot(axis) * axis).norm() / static_cast<double>(of.size());
  }
  setHollow(shape, of);
  return shape;
}

// The axis that all normals meet, by the reciprocal product of lines.
std::optional<std::pair<Vec, Vec>> revolutionAxis(const std::vector<Oriented>& of) {
  Eigen::Matrix3d nn = Eigen::Matrix3d::Zero(), nm = Eigen::Matrix3d::Zero(), mm = Eigen::Matrix3d::Zero();
  for (const Oriented& o : of) {
    const Vec moment = o.p.cross(o.n);
    nn += o.n * o.n.transpose();
    nm += o.n * moment.transpose();
    mm += moment * moment.transpose();
  }
  nn += 1e-12 * nn.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d by = nn.ldlt().solve(nm);
  const Vec axis = leastDirection(mm - nm.transpose() * by);
  const Vec moment = -by * axis;
  if (!axis.allFinite() || !moment.allFinite()) return std::nullopt;
  return std::pair(axis, Vec(axis.cross(moment)));
}

std::optional<Shape> coneBy(const std::vector<Oriented>& of) {
  Vec mean = Vec::Zero();
  for (const Oriented& o : of) mean += o.n / static_cast<double>(of.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), normals = Eigen::Matrix3d::Zero();
  Vec right = Vec::Zero();
  for (const Oriented& o : of) {
    spread += (o.n - mean) * (o.n - mean).transpose();
    normals += o.n * o.n.transpose();
    right += o.n * o.n.dot(o.p);
  }
  Vec axis = leastDirection(spread);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normals);
  if (!(eigen.eigenvalues()[0] > 1e-13 * static_cast<double>(of.size()))) return std::nullopt;
  const Vec apex = normals.ldlt().solve(right);
  double along = 0.0, sine = 0.0;
  for (const Oriented& o : of) along += (o.p - apex).dot(axis);
  if (along < 0.0) axis = -axis;
  for (const Oriented& o : of) sine += std::abs(o.n.dot(axis)) / static_cast<double>(of.size());
  Shape shape;
  shape.kind = ShapeKind::kCone;
  shape.point = glmOf(apex);
  shape.direction = glmOf(axis);
  shape.half_angle = std::asin(std::min(1.0, sine));
  setHollow(shape, of);
  return shape.half_angle > 1e-6 ? std::optional(shape) : std::nullopt;
}

std::optional<Shape> torusBy(const std::vector<Oriented>& of) {
  const auto axis = revolutionAxis(of);
  if (!axis) return std::nullopt;
  const auto& [direction, point] = *axis;
  // In the half plane: the point that the normals' lines meet.
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> places;
  for (const Oriented& o : of) {
    const Vec from = o.p - point;
    const double t = from.dot(direction);
    const Vec out = from - t * direction;
    const Eigen::Vector2d place(out.norm(), t);
    Eigen::Vector2d n(out.normalized().dot(o.n), direction.dot(o.n));
    places.push_back(place);
    if (n.norm() < 1e-9) continue;
    n.normalize();
    const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - n * n.transpose();
    normal += across;
    right += across * place;
  }
  if (!(std::abs(normal.determinant()) > 1e-14 * std::pow(normal.trace(), 2))) return std::nullopt;
  const Eigen::Vector2d middle = normal.inverse() * right;
  Shape shape;
  shape.kind = ShapeKind::kTorus;
  shape.direction = glmOf(direction);
  shape.point = glmOf(point + middle.y() * direction);
  shape.radius = std::abs(middle.x());
  for (const Eigen::Vector2d& place : places)
    shape.tube_radius += (place - middle).norm() / static_cast<double>(places.size());
  setHollow(shape, of);
  return shape;
}

std::optional<Shape> shapeBy(ShapeKind kind, const std::vector<Oriented>& of) {
  switch (kind) {
    case ShapeKind::kPlane:
      return planeBy(of);
    case ShapeKind::kSphere:
      return sphereBy(of);
    case ShapeKind::kCylinder:
      return cylinderBy(of);
    case ShapeKind::kCone:
      return coneBy(of);
    case ShapeKind::kTorus:
      return torusBy(of);
  }
  return std::nullopt;
}

bool isWhole(const Shape& shape) {
  const double sum = shape.point.x + shape.point.y + shape.point.z + shape.direction.x + shape.direction.y +
                     shape.direction.z + shape.radius + shape.tube_radius + shape.half_angle;
  const auto positive = [](double r) { return r > 1e-9 && r < 1e12; };
  switch (shape.kind) {
    case ShapeKind::kSphere:
    case ShapeKind::kCylinder:
      return std::isfinite(sum) && positive(shape.radius);
    case ShapeKind::kTorus:
      return std::isfinite(sum) && positive(shape.radius) && positive(shape.tube_radius);
    default:
      return std::isfinite(sum);
  }
}

}  // namespace

std::vector<Shape> likelyShapes(const FitSamples::Coarse& coarse, ShapeKind kind, std::size_t most) {
  std::vector<std::pair<double, Shape>> found;
  std::vector<glm::dvec3> judged;
  const std::size_t step = std::max<std::size_t>(1, coarse.points.size() / 400);
  for (std::size_t i = 0; i < coarse.points.size(); i += step) judged.push_back(coarse.points[i]);
  std::vector<double> distances(judged.size());
  const auto judge = [&](const std::optional<Shape>& shape) {
    if (!shape || !isWhole(*shape)) return;
    for (std::size_t i = 0; i < judged.size(); ++i) distances[i] = std::abs(distanceFrom(*shape, judged[i]));
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    if (std::isfinite(*middle)) found.emplace_back(*middle, *shape);
  };
  std::mt19937 random(1);  // the same points each time, whatever the library: only its raw numbers are used
  for (const std::int32_t radius : {1, 3, 8}) {
    std::vector<Oriented> oriented;
    addNormals(coarse, radius, oriented);
    if (oriented.empty()) continue;
    judge(shapeBy(kind, oriented));
    constexpr int kTrials = 100;
    constexpr std::size_t kSome = 6;
    std::vector<Oriented> some(kSome);
    for (int trial = 0; trial < kTrials; ++trial) {
      for (Oriented& o : some) o = oriented[random() % oriented.size()];
      judge(shapeBy(kind, some));
    }
  }
  if (kind == ShapeKind::kPlane && coarse.points.size() >= 3)
    // Few points have no windows: planes through three.
    for (int trial = 0; trial < 300; ++trial) {
      glm::dvec3 p[3];
      for (glm::dvec3& one : p) one = coarse.points[random() % coarse.points.size()];
      const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
      if (!(std::abs(n.z) > 1e-12 * glm::dot(p[1] - p[0], p[1] - p[0]))) continue;
      Shape shape;
      shape.point = p[0];
      shape.direction = glm::normalize(n.z < 0.0 ? -n : n);
      judge(shape);
    }
  std::ranges::stable_sort(found, {}, &std::pair<double, Shape>::first);
  std::vector<Shape> shapes;
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) shapes.push_back(found[i].second);
  return shapes;
}

}  // namespace fettle::engine
