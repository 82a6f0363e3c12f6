#include "engine/measure/least_trimmed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

namespace fettle::engine {
namespace {

constexpr int kDraws = 500;
constexpr std::size_t kMostSamples = 1024;
constexpr std::size_t kBest = 5;  // of the draws, followed until they rest
constexpr int kFirstSteps = 2, kMostSteps = 20;

using Indices = std::vector<std::size_t>;

// The first `count` of a shuffled list: a plain Fisher-Yates, since std::shuffle differs between libraries.
void drawInto(Indices& indices, std::size_t count, std::mt19937_64& random) {
  for (std::size_t i = 0; i < count; ++i) std::swap(indices[i], indices[i + random() % (indices.size() - i)]);
}

class TrimmedFits {
 public:
  TrimmedFits(std::vector<FormSample> samples, const PolynomialForm& form, const FormAxes& axes,
              const Grid& grid)
      : samples_(std::move(samples)), form_(form), axes_(axes), grid_(grid), distances_(samples_.size()) {}

  [[nodiscard]] std::size_t size() const noexcept { return samples_.size(); }

  [[nodiscard]] std::vector<double> through(std::span<const std::size_t> chosen) const {
    FormProducts sums;
    const auto products = static_cast<std::size_t>(2 * form_.degree + 1);
    const auto terms = static_cast<std::size_t>(form_.degree + 1);
    double u[2 * PolynomialForm::kMostDegree + 1], v[2 * PolynomialForm::kMostDegree + 1];
    for (const std::size_t i : chosen) {
      const FormSample& s = samples_[i];
      PolynomialForm::chebyshev(axes_.columns.scaled(s.column), 2 * form_.degree, u);
      PolynomialForm::chebyshev(axes_.rows.scaled(s.row), 2 * form_.degree, v);
      for (std::size_t a = 0; a < products; ++a)
        for (std::size_t b = 0; b < products; ++b) sums.weight[a][b] += u[a] * v[b];
      for (std::size_t a = 0; a < terms; ++a)
        for (std::size_t b = 0; b < terms; ++b) sums.height[a][b] += u[a] * v[b] * (s.z - form_.base);
    }
    return solveForm(sums, form_.degree, axes_, grid_).coefficients;
  }

  // The form of the half that is nearest to one.
  [[nodiscard]] std::vector<double> ofNearerHalf(const std::vector<double>& coefficients) {
    measure(coefficients);
    Indices order(samples_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto half = order.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2 + 1);
    std::nth_element(order.begin(), half - 1, order.end(),
                     [&](std::size_t a, std::size_t b) { return distances_[a] < distances_[b]; });
    return through({order.begin(), half});
  }

  [[nodiscard]] double median(const std::vector<double>& coefficients) {
    measure(coefficients);
    const auto middle = distances_.begin() + static_cast<std::ptrdiff_t>(distances_.size() / 2);
    std::nth_element(distances_.begin(), middle, distances_.end());
    return *middle;
  }

 private:
  void measure(const std::vector<double>& coefficients) {
    form_.coefficients = coefficients;
    std::ranges::transform(samples_, distances_.begin(), [&](const FormSample& s) {
      return std::abs(s.z - form_.heightAt(s.column, s.row));
    });
  }

  std::vector<FormSample> samples_;
  PolynomialForm form_;
  FormAxes axes_;
  const Grid& grid_;
  std::vector<double> distances_;
};

}  // namespace

double medianDistance(std::span<const FormSample> samples, const PolynomialForm& form) {
  if (samples.empty()) return 0.0;
  std::vector<double> distances;
  distances.reserve(samples.size());
  for (const FormSample& s : samples) distances.push_back(std::abs(s.z - form.heightAt(s.column, s.row)));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

PolynomialForm leastTrimmedForm(std::span<const FormSample> samples, const PolynomialForm& form,
                                const FormAxes& axes, const Grid& grid) {
  PolynomialForm best = form;
  const auto terms = static_cast<std::size_t>(PolynomialForm::terms(form.degree));
  best.coefficients.assign(terms, 0.0);
  if (samples.size() <= terms) return best;
  std::mt19937_64 random(1);  // its numbers are the standard's: the same on every machine
  Indices indices(samples.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  const std::size_t used = std::min(samples.size(), kMostSamples);
  drawInto(indices, used, random);
  std::vector<FormSample> few;
  few.reserve(used);
  for (std::size_t i = 0; i < used; ++i) few.push_back(samples[indices[i]]);
  TrimmedFits fits(std::move(few), form, axes, grid);

  std::vector<std::pair<double, std::vector<double>>> tried;
  tried.reserve(kDraws);
  Indices draw(fits.size());
  std::iota(draw.begin(), draw.end(), std::size_t{0});
  for (int k = 0; k < kDraws; ++k) {
    drawInto(draw, terms, random);
    std::vector<double> now = fits.through(std::span(draw).first(terms));
    for (int step = 0; step < kFirstSteps; ++step) now = fits.ofNearerHalf(now);
    const double median = fits.median(now);
    tried.emplace_back(median, std::move(now));
  }
  const auto some = tried.begin() + static_cast<std::ptrdiff_t>(std::min(kBest, tried.size()));
  std::partial_sort(tried.begin(), some, tried.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  double least = std::numeric_limits<double>::infinity();
  for (auto it = tried.begin(); it != some; ++it) {
    auto& [median, now] = *it;
    for (int step = 0; step < kMostSteps; ++step) {
      std::vector<double> next = fits.ofNearerHalf(now);
      const double then = fits.median(next);
      if (!(then < median)) break;
      median = then;
      now = std::move(next);
    }
    if (median < least) {
      least = median;
      best.coefficients = now;
    }
  }
  return best;
}

}  // namespace fettle::engine
