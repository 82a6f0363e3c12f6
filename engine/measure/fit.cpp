#include "engine/measure/fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <glm/geometric.hpp>

#include "engine/measure/fit_solve.h"
#include "engine/measure/fit_start.h"

namespace fettle::engine {

namespace {

constexpr double kFitUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kFitSigmas = 3.0;

std::string nameOfShape(ShapeKind kind) {
  return std::string(infoOf(kind).word);
}

tl::unexpected<Error> undetermined(ShapeKind kind, const std::string& what, const std::string& remedy) {
  return inputError(fmt::format("the samples do not determine {}", what), nameOfShape(kind), remedy);
}

double medianSize(std::vector<float> residuals) {
  if (residuals.empty()) return 0.0;
  for (float& r : residuals) r = std::abs(r);
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  return double{*middle};
}

double robustScale(const FitPoints& points, const FitWeights& weights, const FitSurface& surface,
                   double least) {
  return std::max(1.4826 * medianSize(residualsOf(points, weights, surface)), least);
}

// A few rounds from a base, each with the scale and the weights of what the one before left.
bool roundsOf(const FitPoints& points, FitWeights weights, bool robust, double least, FitModel& model,
              JobControl& job) {
  const int rounds = robust ? 20 : weights.vertical ? 4 : 1;
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

std::optional<FitModel> startOf(const CoarseFit& on, ShapeKind kind, const FitWeights& weights, bool robust,
                                double least, JobControl& job) {
  std::vector<FitModel> starts;
  for (const Shape& shape : likelyShapes(on.coarse, kind, 3))
    starts.push_back({kind, FitSurface::of(shape, on.describedAt(shape))});
  // A cone of hardly any angle, a ring of hardly any curvature: near to what they contain.
  if (kind == ShapeKind::kCone || kind == ShapeKind::kTorus) {
    const ShapeKind simpler = kind == ShapeKind::kCone ? ShapeKind::kCylinder : ShapeKind::kCone;
    if (auto near = startOf(on, simpler, weights, robust, least, job)) starts.push_back({kind, near->base});
    if (kind == ShapeKind::kTorus)
      if (auto near = startOf(on, ShapeKind::kCylinder, weights, robust, least, job)) {
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
    if (!roundsOf(on.points, weights, robust, least, start, job)) continue;
    const double cost = costOf(on.points, weights, start.base, robust);
    if (!(cost < least_cost)) continue;
    least_cost = cost;
    best = start;
  }
  return best;
}

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// What the samples say about a solution, summed over them.
struct FitSums {
  Matrix information, noise;   // of derivatives: by psi's, by what independent noise in height does
  std::vector<Vector> scores;  // of each part of the region
  std::vector<std::int64_t> in_part;
  double squares = 0.0, psi_squares = 0.0, cosines = 0.0, largest = 0.0;
  std::int64_t used = 0, left_out = 0;
};

constexpr int kParts = 12;  // of the region along each side

FitSums sumsOf(const FitPoints& points, const FitWeights& weights, const FitModel& model) {
  const int n = model.size();
  const FitModel::Rows rows(model, Vector::Zero(n));
  const auto make = [n] {
    FitSums sums;
    sums.information = sums.noise = Matrix::Zero(n, n);
    sums.scores.assign(kParts * kParts, Vector::Zero(n));
    sums.in_part.assign(kParts * kParts, 0);
    return sums;
  };
  const auto merge = [](FitSums& into, const FitSums& from) {
    into.information += from.information;
    into.noise += from.noise;
    for (std::size_t k = 0; k < into.scores.size(); ++k) {
      into.scores[k] += from.scores[k];
      into.in_part[k] += from.in_part[k];
    }
    into.squares += from.squares;
    into.psi_squares += from.psi_squares;
    into.cosines += from.cosines;
    into.largest = std::max(into.largest, from.largest);
    into.used += from.used;
    into.left_out += from.left_out;
  };
  const glm::dvec2 low = points.samples->low(), size = points.samples->high() - low;
  const auto partOf = [&](const glm::dvec3& p) {
    const auto place = [](double from, double whole) {
      return whole > 0.0 ? std::clamp(static_cast<int>(from / whole * kParts), 0, kParts - 1) : 0;
    };
    return static_cast<std::size_t>(kParts * place(p.y * points.scale - low.y, size.y) +
                                    place(p.x * points.scale - low.x, size.x));
  };
  // At most so many sums at once: the rest is added one after the other.
  constexpr std::size_t kTogether = 64;
  FitSums all = make();
  for (std::size_t first = 0; first < points.groups(); first += kTogether) {
    std::vector<FitSums> some(std::min(kTogether, points.groups() - first));
    tbb::parallel_for(std::size_t{0}, some.size(), [&](std::size_t k) {
      FitSums& sums = some[k] = make();
      FitSamples::Block block;
      Vector row(n);
      for (std::size_t b = points.begin(first + k); b < points.begin(first + k + 1); ++b) {
        points.samples->read(b, block);
        for (int i = 0; i < block.count; ++i) {
          const glm::dvec3 p = block.points[static_cast<std::size_t>(i)] / points.scale;
          const FitSurface::At at = rows.surface().at(p);
          const double factor = weights.factor(at.gradient.z), residual = factor * at.distance;
          const double share = weights.share(residual);
          if (share == 0.0) {
            ++sums.left_out;
            continue;
          }
          rows.derivatives(at, p, row.data());
          row *= factor;
          double slope = 1.0;
          if (weights.robust_scale > 0.0) {
            const double x2 = std::pow(residual / (FitWeights::kTukey * weights.robust_scale), 2);
            slope = (1.0 - x2) * (1.0 - 5.0 * x2);
          }
          // What noise in height is of a distance.
          const double cosine = factor * std::max(std::abs(at.gradient.z), FitWeights::kSteepest);
          const double psi = share * residual;
          sums.information.noalias() += slope * row * row.transpose();
          sums.noise.noalias() += cosine * cosine * row * row.transpose();
          const std::size_t part = partOf(p);
          sums.scores[part] += psi * row;
          ++sums.in_part[part];
          sums.squares += residual * residual;
          sums.psi_squares += psi * psi;
          sums.cosines += cosine * cosine;
          sums.largest = std::max(sums.largest, std::abs(residual));
          ++sums.used;
        }
      }
    });
    for (const FitSums& sums : some) merge(all, sums);
  }
  return all;
}

// The variance of Tukey's psi under Gaussian noise of variance 1.
double psiVariance() {
  static const double variance = [] {
    double sum = 0.0;
    constexpr double kStep = 0.01;
    for (double x = -FitWeights::kTukey; x < FitWeights::kTukey; x += kStep) {
      const double u = x / FitWeights::kTukey, psi = x * (1.0 - u * u) * (1.0 - u * u);
      sum += kStep * psi * psi * std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    }
    return sum;
  }();
  return variance;
}

// Which number a direction of least information is about.
std::string undeterminedNumber(const FitModel& model, const Vector& direction) {
  Eigen::Index most = 0;
  direction.cwiseAbs().maxCoeff(&most);
  return fmt::format("its {}", model.nameOf(static_cast<int>(most)));
}

Status setCovariance(ShapeFit& fit, const FitModel& model, const FitSums& sums, const FitOptions& options,
                     double rounding) {
  const int n = model.size();
  Vector sizes(n);
  for (int k = 0; k < n; ++k) sizes[k] = std::sqrt(std::max(sums.noise(k, k), 1e-300));
  const Matrix by = sizes.cwiseInverse().asDiagonal();
  const Matrix scaled = by * sums.information * by, noise = by * sums.noise * by;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(noise);
  constexpr double kLeast = 1e-13;
  if (!(eigen.eigenvalues()[0] > kLeast * eigen.eigenvalues()[n - 1]) ||
      !(sums.noise.diagonal().minCoeff() > 0.0)) {
    Vector direction = by * eigen.eigenvectors().col(0);
    for (int k = 0; k < n; ++k)
      if (!(sums.noise(k, k) > 1e-24 * sums.noise(0, 0))) direction = Vector::Unit(n, k);
    return undetermined(model.kind, undeterminedNumber(model, direction),
                        "take a larger region or a simpler shape");
  }
  const Matrix inverse = scaled.completeOrthogonalDecomposition().pseudoInverse();
  const double free = std::max(1.0, static_cast<double>(sums.used - n));
  // In parts of the scale.
  const double of_psi = options.robust ? psiVariance() : 1.0;
  double variance = options.noise_mm * options.noise_mm / (fit.scale * fit.scale) * of_psi;
  if (sums.used > n) {
    const double scatter =
        sums.psi_squares / std::max(sums.cosines, 1e-300) * static_cast<double>(sums.used) / free;
    if (std::isnan(variance) || scatter > variance * (1.0 + kFitSigmas * std::sqrt(2.0 / free)))
      variance = scatter;
  }
  variance = std::fmax(variance, rounding * rounding / (fit.scale * fit.scale));
  // Sums over parts: what independent noise makes of them, and what they are.
  double parts = 0.0;
  Matrix seen = Matrix::Zero(n, n);
  for (std::size_t k = 0; k < sums.scores.size(); ++k) {
    if (sums.in_part[k] == 0) continue;
    parts += 1.0;
    const Vector score = by * sums.scores[k];
    seen += score * score.transpose();
  }
  if (parts > 2.0 * n + 4.0 && static_cast<double>(sums.used) > 8.0 * parts && variance > 0.0) {
    seen *= parts / (parts - n);
    const double excess = (variance * noise).ldlt().solve(seen).trace() / n;
    if (excess > 1.0 + kFitSigmas * std::sqrt(2.0 / (n * (parts - n)))) fit.correlation = excess;
  }
  const Matrix covariance = by * (inverse * (fit.correlation * variance * noise) * inverse) * by;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      fit.covariance[static_cast<std::size_t>(a * ShapeFit::kMost + b)] = covariance(a, b);
  return {};
}

Status checkDetermined(const ShapeFit& fit, const FitModel& model) {
  const FitSurface& surface = fit.surface;
  const auto error = [&](int k) {
    return std::sqrt(std::max(0.0, fit.covariance[static_cast<std::size_t>(k * ShapeFit::kMost + k)]));
  };
  // With exact samples the rounding of sums is left.
  const auto differs = [](double value, double by) {
    return std::abs(value) > std::max(kFitSigmas * by, 1e-7);
  };
  const ShapeKind kind = model.kind;
  const char* plane = "fit a plane: the curvature does not differ from 0 by three standard errors";
  if (kind == ShapeKind::kSphere && !differs(surface.tube, error(3)))
    return undetermined(kind, "a radius", plane);
  if (kind == ShapeKind::kCylinder && !differs(surface.ring, error(4)))
    return undetermined(kind, "a radius", plane);
  if (kind == ShapeKind::kCone || kind == ShapeKind::kTorus) {
    if (!differs(surface.ring, error(4)))
      return undetermined(kind, "an axis",
                          "fit a plane or a cylinder: it does not differ from one by three standard errors");
    if (kind == ShapeKind::kCone && !differs(surface.theta, error(5)))
      return undetermined(kind, "an apex",
                          "fit a cylinder: the angle does not differ from 0 by three standard errors");
    if (kind == ShapeKind::kTorus && !differs(surface.tube, error(6)))
      return undetermined(kind, "a radius of the tube",
                          "fit a cone or a cylinder: it does not differ from one by three standard errors");
  }
  const ShapeFit::Errors errors = fit.errors();
  if (kind == ShapeKind::kTorus) {
    if (!(fit.shape.radius > kFitSigmas * errors.radius))
      return undetermined(kind, "a ring",
                          "fit a sphere: the ring's radius does not differ from 0 by three standard errors");
    if (!(fit.shape.radius > fit.shape.tube_radius))
      return undetermined(kind, "a ring that does not meet itself", "fit a sphere or a cylinder");
  }
  constexpr double kWorst = 10.0 * std::numbers::pi / 180.0;
  if (kind != ShapeKind::kSphere && !(glm::length(errors.direction) < kWorst))
    return undetermined(kind, "its direction",
                        "it is known to 10 degrees or worse: take a larger region or a simpler shape");
  const double all = glm::dot(fit.shape.point, glm::dvec3(1.0)) +
                     glm::dot(fit.shape.direction, glm::dvec3(1.0)) + fit.shape.radius +
                     fit.shape.tube_radius + fit.rms_mm + glm::length(errors.point);
  if (!std::isfinite(all)) return undetermined(kind, "the shape", "take a larger region or a simpler shape");
  return {};
}

Result<ShapeFit> fitted(const FitSamples& samples, ShapeKind kind, const FitOptions& options,
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
  const CoarseFit coarse(samples, fit.scale);
  auto model = startOf(coarse, kind, weights, options.robust, least, job);
  if (job.cancelled()) return cancelled();
  if (!model)
    return undetermined(
        kind,
        kind == ShapeKind::kPlane ? "its direction: they lie on one line" : std::string(infoOf(kind).text),
        "take a larger region or a simpler shape");
  const FitPoints points{&samples, fit.scale};
  if (!roundsOf(points, weights, options.robust, least, *model, job)) {
    if (job.cancelled()) return cancelled();
    return undetermined(kind, std::string(infoOf(kind).text),
                        "no finite shape is nearest to the samples; try --robust");
  }
  if (options.robust) weights.robust_scale = robustScale(points, weights, model->base, least);
  const FitSums sums = sumsOf(points, weights, *model);
  fit.surface = model->base;
  fit.middle = samples.middle();
  fit.shape.kind = kind;
  fit.shape = fit.moved({});
  fit.samples = static_cast<std::int64_t>(samples.size());
  fit.left_out = sums.left_out;
  fit.rms_mm = sums.used > 0 ? fit.scale * std::sqrt(sums.squares / static_cast<double>(sums.used)) : 0.0;
  fit.largest_mm = fit.scale * sums.largest;
  if (auto status = setCovariance(fit, *model, sums, options, samples.rounding()); !status)
    return tl::unexpected(status.error());
  if (auto status = checkDetermined(fit, *model); !status) return tl::unexpected(status.error());
  return fit;
}

}  // namespace

Shape ShapeFit::moved(const std::array<double, kMost>& by) const noexcept {
  const FitModel model{shape.kind, surface};
  Vector numbers_by(model.size());
  for (int k = 0; k < model.size(); ++k) numbers_by[k] = by[static_cast<std::size_t>(k)];
  Shape result = model.moved(numbers_by).shape(shape.kind, glm::dvec3(0.0), shape.direction);
  result.point = middle + scale * result.point;
  result.radius *= scale;
  result.tube_radius *= scale;
  return result;
}

namespace {

// Calls take(k, shape moved by a small step up, down, 1 / their difference) for each number.
template <class Take>
void forEachNumber(const ShapeFit& fit, Take&& take) {
  for (int k = 0; k < fit.numbers; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double error = std::sqrt(std::max(0.0, fit.covariance[at * ShapeFit::kMost + at]));
    // Small beside the error, over which figures are straight, and large beside rounding.
    const double step = std::clamp(0.01 * error, 1e-8, 1e-4);
    std::array<double, ShapeFit::kMost> by{};
    by[at] = step;
    const Shape up = fit.moved(by);
    by[at] = -step;
    take(k, up, fit.moved(by), 0.5 / step);
  }
}

double varianceBy(const ShapeFit& fit, const std::array<double, ShapeFit::kMost>& slopes) noexcept {
  double sum = 0.0;
  for (std::size_t a = 0; a < ShapeFit::kMost; ++a)
    for (std::size_t b = 0; b < ShapeFit::kMost; ++b)
      sum += slopes[a] * slopes[b] * fit.covariance[a * ShapeFit::kMost + b];
  return std::max(0.0, sum);
}

}  // namespace

ShapeFit::Errors ShapeFit::errors() const noexcept {
  std::array<std::array<double, kMost>, 9> slopes{};
  const auto figures = [](const Shape& s) {
    return std::array<double, 9>{s.point.x,     s.point.y, s.point.z,     s.direction.x, s.direction.y,
                                 s.direction.z, s.radius,  s.tube_radius, s.half_angle};
  };
  forEachNumber(*this, [&](int k, const Shape& up, const Shape& down, double per) {
    const auto a = figures(up), b = figures(down);
    for (std::size_t f = 0; f < a.size(); ++f) slopes[f][static_cast<std::size_t>(k)] = (a[f] - b[f]) * per;
  });
  std::array<double, 9> e{};
  for (std::size_t f = 0; f < e.size(); ++f) e[f] = std::sqrt(varianceBy(*this, slopes[f]));
  return {{e[0], e[1], e[2]}, {e[3], e[4], e[5]}, e[6], e[7], e[8]};
}

Result<ShapeFit> fitShape(const FitSamples& samples, ShapeKind kind, const FitOptions& options,
                          JobControl& job) {
  return fitted(samples, kind, options, job);
}

double residualAt(const ShapeFit& fit, const glm::dvec3& point, bool vertical) noexcept {
  const FitSurface::At at = fit.surface.at((point - fit.middle) / fit.scale);
  return fit.scale * at.distance * FitWeights{vertical, 0.0}.factor(at.gradient.z);
}

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
    auto fit = fitted(*some, kind, options, job);
    if (!fit && fit.error().kind != ErrorKind::kInput) return tl::unexpected(fit.error());
    if (!fit && !first_refusal) first_refusal = fit.error();
    chosen.tried.push_back({kind, fit ? fit->rms_mm : kFitUnknown, fit ? std::string() : fit.error().what});
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
  auto whole = fitted(*some, kind, options, job);
  if (!whole) return tl::unexpected(whole.error());
  chosen.fit = *std::move(whole);
  return chosen;
}

namespace {

constexpr double kToDegrees = 180.0 / std::numbers::pi;

bool hasAxis(ShapeKind kind) {
  return kind == ShapeKind::kCylinder || kind == ShapeKind::kCone;
}

// Angle, distance, distance of axes, of two shapes; `middle` of the samples of each.
std::array<double, 3> relationFigures(const Shape& a, const Shape& b, const glm::dvec3& middle_a,
                                      const glm::dvec3& middle_b) {
  std::array<double, 3> figures{kFitUnknown, kFitUnknown, kFitUnknown};
  const bool plane_a = a.kind == ShapeKind::kPlane, plane_b = b.kind == ShapeKind::kPlane;
  if (a.kind != ShapeKind::kSphere && b.kind != ShapeKind::kSphere) {
    const double sine = glm::length(glm::cross(a.direction, b.direction));
    const double angle = std::atan2(sine, std::abs(glm::dot(a.direction, b.direction))) * kToDegrees;
    figures[0] = plane_a == plane_b ? angle : 90.0 - angle;
  }
  const auto placeOf = [](const Shape& s, const glm::dvec3& middle) {
    if (!hasAxis(s.kind)) return s.point;
    return s.point + glm::dot(middle - s.point, s.direction) * s.direction;
  };
  const auto fromAxis = [](const Shape& s, const glm::dvec3& p) {
    return glm::length(glm::cross(p - s.point, s.direction));
  };
  if (plane_a)
    figures[1] = glm::dot(placeOf(b, middle_b) - a.point, a.direction);
  else if (plane_b)
    figures[1] = glm::dot(placeOf(a, middle_a) - b.point, b.direction);
  else if (hasAxis(a.kind))
    figures[1] = fromAxis(a, placeOf(b, middle_b));
  else if (hasAxis(b.kind))
    figures[1] = fromAxis(b, placeOf(a, middle_a));
  else
    figures[1] = glm::length(b.point - a.point);
  if (hasAxis(a.kind) && hasAxis(b.kind)) {
    const glm::dvec3 across = glm::cross(a.direction, b.direction);
    const double sine = glm::length(across);
    if (sine > 0.0) figures[2] = std::abs(glm::dot(b.point - a.point, across)) / sine;
  }
  return figures;
}

}  // namespace

ShapeRelation relationOf(const ShapeFit& first, const ShapeFit& second) noexcept {
  const auto of = [&](const Shape& a, const Shape& b) {
    return relationFigures(a, b, first.middle, second.middle);
  };
  const std::array<double, 3> value = of(first.shape, second.shape);
  std::array<double, 3> variance{};
  for (const bool of_first : {true, false}) {
    std::array<std::array<double, ShapeFit::kMost>, 3> slopes{};
    forEachNumber(of_first ? first : second, [&](int k, const Shape& up, const Shape& down, double per) {
      const auto a = of_first ? of(up, second.shape) : of(first.shape, up),
                 b = of_first ? of(down, second.shape) : of(first.shape, down);
      for (std::size_t f = 0; f < 3; ++f) slopes[f][static_cast<std::size_t>(k)] = (a[f] - b[f]) * per;
    });
    for (std::size_t f = 0; f < 3; ++f) variance[f] += varianceBy(of_first ? first : second, slopes[f]);
  }
  ShapeRelation relation;
  relation.angle_deg = {value[0], std::sqrt(variance[0])};
  relation.distance_mm = {value[1], std::sqrt(variance[1])};
  relation.between_axes_mm = {value[2], std::sqrt(variance[2])};
  if (!(value[0] > 3.0 * relation.angle_deg.error)) relation.between_axes_mm = {kFitUnknown, kFitUnknown};
  return relation;
}

}  // namespace fettle::engine
