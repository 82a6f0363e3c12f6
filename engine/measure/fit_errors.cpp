#include "engine/measure/fit_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kFitSigmas = 3.0;

// Of Tukey's psi under Gaussian noise of variance 1: its variance, and the square of its mean slope.
struct PsiMoments {
  double variance = 0.0, slope_squared = 0.0;

  // The covariance of two psi of noise of variance 1 and this covariance: a series in its odd powers (Hermite polynomials), of
  // which the first is known and the others are at most as large as if all were the third.
  [[nodiscard]] double shared(double covariance) const noexcept {
    return slope_squared * covariance + (variance - slope_squared) * covariance * covariance * covariance;
  }
};
PsiMoments psiMoments() {
  static const PsiMoments moments = [] {
    PsiMoments sum;
    double slope = 0.0;
    constexpr double kStep = 0.01;
    for (double x = -FitWeights::kTukey; x < FitWeights::kTukey; x += kStep) {
      const double u = x / FitWeights::kTukey, psi = x * (1.0 - u * u) * (1.0 - u * u);
      const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
      sum.variance += kStep * psi * psi * density;
      slope += kStep * psi * x * density;  // the mean of psi' by parts
    }
    sum.slope_squared = slope * slope;
    return sum;
  }();
  return moments;
}

// The noise that counts [scale^2]: of the options, or more where the samples scatter by more.
FitNoise noiseThatCounts(const FitSums& sums, const FitLineSums* lines, const FitOptions& options,
                         double scale, int numbers) {
  const PsiMoments psi = options.robust ? psiMoments() : PsiMoments{1.0, 1.0};
  const double unit = 1.0 / (scale * scale);
  FitNoise noise{options.noise_mm * options.noise_mm * unit};
  if (lines != nullptr) {
    noise.rows = options.rows_mm * options.rows_mm * unit;
    noise.columns = options.columns_mm * options.columns_mm * unit;
  }
  const double of_lines = noise.rows + noise.columns;
  if (sums.used > numbers) {
    const double free = std::max(1.0, static_cast<double>(sums.used - numbers));
    const double scatter = sums.psi_squares / std::max(sums.cosines, 1e-300) *
                           static_cast<double>(sums.used) / free / psi.variance;
    // Lines are few, and their offsets' size is known from as many (noise_lines.h): what that leaves open is no noise of samples.
    double open = 0.0;
    if (lines != nullptr) {
      constexpr double kKnown = 1.0 + 2.63;
      const double rows = noise.rows * noise.rows / lines->rows(),
                   columns = noise.columns * noise.columns / lines->columns();
      open = kFitSigmas * std::sqrt(2.0 * kKnown * (rows + columns));
    }
    const double of_samples = scatter - of_lines - open;
    if (std::isnan(noise.sample) || of_samples > noise.sample * (1.0 + kFitSigmas * std::sqrt(2.0 / free)))
      noise.sample = std::max(0.0, of_samples);
  }
  // Of what counts of robust distances: lines share less of it than of the noise.
  const double whole = noise.sample + of_lines;
  noise.height = whole;
  if (!options.robust || !(whole > 0.0)) return noise;
  noise.rows = whole * psi.shared(noise.rows / whole);
  noise.columns = whole * psi.shared(noise.columns / whole);
  noise.sample = std::max(0.0, whole * psi.variance - noise.rows - noise.columns);
  return noise;
}

// Which number a direction of least information is about.
std::string undeterminedNumber(const FitModel& model, const Vector& direction) {
  Eigen::Index most = 0;
  direction.cwiseAbs().maxCoeff(&most);
  return fmt::format("its {}", model.nameOf(static_cast<int>(most)));
}

}  // namespace

tl::unexpected<Error> undetermined(ShapeKind kind, const std::string& what, const std::string& remedy) {
  return inputError(fmt::format("the samples do not determine {}", what), std::string(infoOf(kind).word),
                    remedy);
}

FitSums fitSums(const FitPoints& points, const FitWeights& weights, const FitModel& model) {
  const int n = model.size();
  constexpr std::size_t kParts = FitParts::kSide * FitParts::kSide;
  const auto make = [n] {
    FitSums sums;
    sums.information = sums.noise = Matrix::Zero(n, n);
    sums.scores.assign(kParts, Vector::Zero(n));
    sums.in_part.assign(kParts, 0);
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
  const FitParts parts(points);
  // At most so many sums at once: the rest is added one after the other.
  constexpr std::size_t kTogether = 64;
  FitSums all = make();
  for (std::size_t first = 0; first < points.groups(); first += kTogether) {
    std::vector<FitSums> some(std::min(kTogether, points.groups() - first));
    tbb::parallel_for(std::size_t{0}, some.size(), [&](std::size_t k) {
      FitSums& sums = some[k] = make();
      FitSamples::Block block;
      FitTerms terms(model, weights);
      for (std::size_t b = points.begin(first + k); b < points.begin(first + k + 1); ++b) {
        points.samples->read(b, block);
        for (int i = 0; i < block.count; ++i) {
          const glm::dvec3 p = block.points[static_cast<std::size_t>(i)] / points.scale;
          if (!terms.take(p)) {
            ++sums.left_out;
            continue;
          }
          const double psi = terms.share * terms.residual, cosine = terms.cosine;
          sums.information.noalias() += terms.slope * terms.row * terms.row.transpose();
          sums.noise.noalias() += cosine * cosine * terms.row * terms.row.transpose();
          const std::size_t part = parts.of(p);
          sums.scores[part] += psi * terms.row;
          ++sums.in_part[part];
          sums.squares += terms.residual * terms.residual;
          sums.psi_squares += psi * psi;
          sums.cosines += cosine * cosine;
          sums.largest = std::max(sums.largest, std::abs(terms.residual));
          ++sums.used;
        }
      }
    });
    for (const FitSums& sums : some) merge(all, sums);
  }
  return all;
}

Result<double> setCovariance(ShapeFit& fit, const FitModel& model, const FitSums& sums,
                             const FitLineSums* lines, const FitOptions& options, double rounding) {
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
  // In parts of the scale.
  FitNoise counts = noiseThatCounts(sums, lines, options, fit.scale, n);
  // As many samples as numbers say nothing of their noise: where it is not known, no error is.
  if (!std::isnan(counts.sample))
    counts.sample = std::max(counts.sample, rounding * rounding / (fit.scale * fit.scale));
  const double independent = counts.sample + counts.rows + counts.columns;
  counts.sample *= std::max(1.0, options.shared);
  Matrix squares = counts.sample * noise;  // J^T C J
  if (lines != nullptr) squares = by * lines->covariance(counts) * by;
  // Sums over parts: what this noise makes of them, and what they are.
  double parts = 0.0;
  Matrix seen = Matrix::Zero(n, n);
  for (std::size_t k = 0; k < sums.scores.size(); ++k) {
    if (sums.in_part[k] == 0) continue;
    parts += 1.0;
    const Vector score = by * sums.scores[k];
    seen += score * score.transpose();
  }
  double excess = 1.0;
  if (parts > 2.0 * n + 4.0 && static_cast<double>(sums.used) > 8.0 * parts && independent > 0.0) {
    // Of independent noise the fit takes the same share of all.
    FitLineSums::Expected expected{squares * ((parts - n) / parts), std::sqrt(2.0 / (n * (parts - n)))};
    if (lines != nullptr) {
      expected = lines->expected(counts, by * inverse * by);
      expected.squares = by * expected.squares * by;
    }
    const double ratio = expected.squares.ldlt().solve(seen).trace() / n;
    if (ratio > 1.0 + kFitSigmas * expected.scatter) excess = ratio;
  }
  squares *= excess;
  fit.correlation = excess;
  if (lines != nullptr || options.shared > 1.0)
    fit.correlation = independent > 0.0 ? (independent * noise).ldlt().solve(squares).trace() / n : 1.0;
  const Matrix covariance = by * (inverse * squares * inverse) * by;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      fit.covariance[static_cast<std::size_t>(a * ShapeFit::kMost + b)] = covariance(a, b);
  return counts.height;
}

Status checkDetermined(const ShapeFit& fit, const FitModel& model) {
  const FitSurface& surface = fit.surface;
  // Without a covariance the figures count as they are.
  const bool known = !std::isnan(fit.covariance.front());
  const auto error = [&](int k) {
    return known ? std::sqrt(std::max(0.0, fit.covariance[static_cast<std::size_t>(k * ShapeFit::kMost + k)]))
                 : 0.0;
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
    if (known && !(fit.shape.radius > kFitSigmas * errors.radius))
      return undetermined(kind, "a ring",
                          "fit a sphere: the ring's radius does not differ from 0 by three standard errors");
    if (!(fit.shape.radius > fit.shape.tube_radius))
      return undetermined(kind, "a ring that does not meet itself", "fit a sphere or a cylinder");
  }
  constexpr double kWorst = 10.0 * std::numbers::pi / 180.0;
  if (kind != ShapeKind::kSphere && known && !(glm::length(errors.direction) < kWorst))
    return undetermined(kind, "its direction",
                        "it is known to 10 degrees or worse: take a larger region or a simpler shape");
  const double all = glm::dot(fit.shape.point, glm::dvec3(1.0)) +
                     glm::dot(fit.shape.direction, glm::dvec3(1.0)) + fit.shape.radius +
                     fit.shape.tube_radius + fit.rms_mm + (known ? glm::length(errors.point) : 0.0);
  if (!std::isfinite(all)) return undetermined(kind, "the shape", "take a larger region or a simpler shape");
  return {};
}

}  // namespace fettle::engine
