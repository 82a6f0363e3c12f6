#include "engine/measure/line_offsets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include "engine/compare/tile_sums.h"
#include "engine/measure/line_form.h"

namespace fettle::engine {

namespace {

constexpr int kLineTerms = LineOptions::kMostDegree + 1;
using Terms = std::array<double, kLineTerms>;
using ScanLine = std::span<const float>;

constexpr double kReach = 4.685;        // scales: 95 % of the efficiency of least squares on Gaussian noise
constexpr double kOfGaussian = 1.4826;  // standard deviation by the median distance
constexpr int kMostRounds = 20;
constexpr double kRest = 1e-6;  // change of scales that ends the rounds

// Tukey's biweight: 1 in the middle, 0 from 1 on.
double biweight(double x) noexcept {
  return std::abs(x) < 1.0 ? (1.0 - x * x) * (1.0 - x * x) : 0.0;
}

// Legendre's polynomials of degree 0 .. 3 at x.
Terms legendre(double x) noexcept {
  return {1.0, x, 0.5 * (3.0 * x * x - 1.0), 0.5 * x * (5.0 * x * x - 3.0)};
}

// Place of a sample of a line in -1 .. 1.
double along(double index, std::int32_t length) noexcept {
  return length > 1 ? 2.0 * index / (length - 1) - 1.0 : 0.0;
}

double valueOf(const Terms& coefficients, int terms, const Terms& basis) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(terms); ++k) sum += coefficients[k] * basis[k];
  return sum;
}

// The middle one, or the mean of the two middle ones; reorders. Not empty.
double median(std::vector<double>& values) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 != 0) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

// Which samples of a line are looked at: all, or those at some places.
struct Places {
  std::span<const std::int32_t> some;
  std::size_t length = 0;

  [[nodiscard]] std::size_t count() const noexcept { return some.empty() ? length : some.size(); }
  template <typename F>
  void each(F&& f) const {
    if (some.empty())
      for (std::size_t i = 0; i < length; ++i) f(i);
    for (const std::int32_t i : some) f(static_cast<std::size_t>(i));
  }
};

// Samples of a line that count, and the basis there.
struct LineSamples {
  std::vector<double> z;  // less `base`
  std::vector<Terms> basis;
  double base = 0.0;
};

void take(ScanLine line, const Places& places, LineSamples& out) {
  out.z.clear();
  out.basis.clear();
  out.base = 0.0;
  const auto length = static_cast<std::int32_t>(line.size());
  places.each([&](std::size_t i) {
    const float z = line[i];
    if (std::isnan(z)) return;
    if (out.z.empty()) out.base = z;  // so that sums are of differences, however far the heights are from 0
    out.z.push_back(z - out.base);
    out.basis.push_back(legendre(along(static_cast<double>(i), length)));
  });
}

// Weighted least squares; of least size where the samples do not determine the terms.
Terms leastSquares(const LineSamples& samples, const std::vector<double>& weights, int terms) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  for (std::size_t i = 0; i < samples.z.size(); ++i) {
    const double w = weights.empty() ? 1.0 : weights[i];
    if (w == 0.0) continue;
    for (int p = 0; p < terms; ++p) {
      const double wp = w * samples.basis[i][static_cast<std::size_t>(p)];
      right(p) += wp * samples.z[i];
      for (int q = p; q < terms; ++q) normal(p, q) += wp * samples.basis[i][static_cast<std::size_t>(q)];
    }
  }
  for (int p = 0; p < terms; ++p)
    for (int q = 0; q < p; ++q) normal(p, q) = normal(q, p);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(1e-13);
  decomposition.compute(normal);
  const Eigen::VectorXd solution = decomposition.solve(right);
  Terms result{};
  for (int p = 0; p < terms; ++p) result[static_cast<std::size_t>(p)] = solution(p);
  return result;
}

// Of those through as many samples as it has terms, the polynomial with the least median distance.
Terms leastMedian(const LineSamples& samples, int terms, std::uint64_t seed) {
  // With half of the samples on the polynomial all of 150 sets of four miss it once in 16,000 lines, where Tukey's weights
  // begin at the next best.
  constexpr int kTrials = 150;
  constexpr std::size_t kSpread = 128;  // samples that judge
  const std::size_t n = samples.z.size(), step = std::max<std::size_t>(1, n / kSpread);
  std::mt19937_64 random(seed);  // its numbers are the standard's: the same on every machine
  Terms best{};
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> distances;
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::MatrixXd equations(terms, terms);
    Eigen::VectorXd right(terms);
    for (int p = 0; p < terms; ++p) {
      const std::size_t i = random() % n;
      right(p) = samples.z[i];
      for (int q = 0; q < terms; ++q) equations(p, q) = samples.basis[i][static_cast<std::size_t>(q)];
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(equations);
    if (!lu.isInvertible()) continue;
    const Eigen::VectorXd solution = lu.solve(right);
    Terms tried{};
    for (int p = 0; p < terms; ++p) tried[static_cast<std::size_t>(p)] = solution(p);
    distances.clear();
    for (std::size_t i = step / 2; i < n; i += step)
      distances.push_back(std::abs(samples.z[i] - valueOf(tried, terms, samples.basis[i])));
    const double middle = median(distances);
    if (middle < least) {
      least = middle;
      best = tried;
    }
  }
  return best;
}

Terms robustPolynomial(const LineSamples& samples, int terms, std::uint64_t seed) {
  Terms now = leastMedian(samples, terms, seed);
  double range = 0.0;
  for (const double z : samples.z) range = std::max(range, std::abs(z));
  const double least = std::numeric_limits<float>::epsilon() * std::max(range, std::abs(samples.base));
  std::vector<double> weights(samples.z.size()), distances(samples.z.size());
  // Twice: the scale after the first is that of samples on the polynomial.
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < samples.z.size(); ++i)
      distances[i] = std::abs(samples.z[i] - valueOf(now, terms, samples.basis[i]));
    const double scale = std::max(kOfGaussian * median(distances), least);
    if (!(scale > 0.0)) return now;
    for (int round = 0; round < kMostRounds; ++round) {
      for (std::size_t i = 0; i < samples.z.size(); ++i) {
        weights[i] = biweight((samples.z[i] - valueOf(now, terms, samples.basis[i])) / (kReach * scale));
      }
      const Terms better = leastSquares(samples, weights, terms);
      double change = 0.0;
      for (std::size_t p = 0; p < kLineTerms; ++p) change = std::max(change, std::abs(better[p] - now[p]));
      now = better;
      if (change <= kRest * scale) break;
    }
  }
  return now;
}

// Step from line `a` to line `b` by the median of differences.
double medianStep(ScanLine a, ScanLine b, const Places& places, std::vector<double>& scratch) {
  scratch.clear();
  places.each([&](std::size_t i) {
    const double d = double{b[i]} - a[i];
    if (!std::isnan(d)) scratch.push_back(d);
  });
  return scratch.empty() ? 0.0 : median(scratch);
}

// What a step between two lines is found from, kept from line to line so that memory is asked for once.
struct StepSamples {
  std::vector<double> steps;       // of the samples that count
  std::vector<double> alike;       // of each of them: how alike the slopes are there, 0 .. 1
  std::vector<double> for_median;  // is reordered
};

// The same by a weighted mean: less of a sample whose difference is far from most others', or where the slopes differ.
double matchedStep(ScanLine a, ScanLine b, const Places& places, StepSamples& samples) {
  double now = medianStep(a, b, places, samples.for_median);
  if (samples.for_median.empty()) return now;
  for (double& d : samples.for_median) d = std::abs(d - now);
  const double scale = kOfGaussian * median(samples.for_median);
  if (scale == 0.0) return now;  // half of the samples agree to the last bit
  samples.steps.clear();
  samples.alike.clear();
  const std::size_t last = a.size() - 1;
  double squares = 0.0;
  places.each([&](std::size_t i) {
    double unlike = 0.0;
    if (i != 0 && i != last) unlike = (double{b[i + 1]} - b[i - 1]) - (double{a[i + 1]} - a[i - 1]);
    if (std::isnan(unlike)) unlike = 0.0;
    squares += unlike * unlike;
    const double step = double{b[i]} - a[i];
    if (std::isnan(step)) return;
    samples.steps.push_back(step);
    samples.alike.push_back(unlike);
  });
  // The rounds ask for the same weights of slopes: an exponential for each sample, once.
  const double variance = squares / static_cast<double>(places.count());
  for (double& d : samples.alike) d = variance > 0.0 ? std::exp(-d * d / (2.0 * variance)) : 1.0;
  for (int round = 0; round < kMostRounds; ++round) {
    double sum = 0.0, weights = 0.0;
    for (std::size_t k = 0; k < samples.steps.size(); ++k) {
      const double weight = biweight((samples.steps[k] - now) / (kReach * scale)) * samples.alike[k];
      sum += weight * samples.steps[k];
      weights += weight;
    }
    if (weights == 0.0) return now;
    const double better = sum / weights;
    const double change = std::abs(better - now);
    now = better;
    if (change <= kRest * scale) break;
  }
  return now;
}

class LineSearch {
 public:
  LineSearch(const Version& field, const LineOptions& options, std::span<const std::int32_t> places,
             JobControl& job)
      : field_(field.reader()), options_(options), job_(job) {
    const bool rows = options.axis == ScanAxis::kX;
    found_.axis = options.axis;
    found_.lines = rows ? field_.height() : field_.width();
    found_.length = rows ? field_.width() : field_.height();
    found_.degree = options.method == LineMethod::kPolynomial ? options.degree : 0;
    found_.coefficients.assign(static_cast<std::size_t>(found_.lines) * terms(), 0.0);
    counts_.assign(static_cast<std::size_t>(found_.lines), 0);
    const auto length = static_cast<std::size_t>(found_.length);
    places_ = {places, length};
    read_.assign(length, places.empty() ? 1 : 0);
    // Beside each place its neighbours, for slopes.
    for (const std::int32_t place : places)
      for (std::int32_t i = std::max(place - 1, 0); i <= std::min(place + 1, found_.length - 1); ++i)
        read_[static_cast<std::size_t>(i)] = 1;
  }

  Result<LineOffsets> run() {
    const bool chain = options_.method == LineMethod::kDifference || options_.method == LineMethod::kMatching;
    overStrips([&](std::int32_t first, std::int32_t count) {
      if (chain)
        countAndStep(first, count);
      else
        countAndFit(first, count);
    });
    if (job_.cancelled()) return cancelled();
    found_.empty = static_cast<std::int32_t>(std::ranges::count(counts_, 0));
    if (found_.empty == found_.lines) return nothingIn(options_.region, "");
    if (chain) {
      if (found_.empty > 0) stepOverEmpty();
      if (job_.cancelled()) return cancelled();
      double sum = 0.0;
      for (std::int32_t l = 0; l < found_.lines; ++l)
        if (counts_[static_cast<std::size_t>(l)] > 0)
          found_.coefficients[static_cast<std::size_t>(l)] = sum +=
              found_.coefficients[static_cast<std::size_t>(l)];
    }
    if (options_.form_degree) leaveForm(found_, counts_, *options_.form_degree);
    fillEmpty();
    centre();
    return std::move(found_);
  }

 private:
  [[nodiscard]] std::size_t terms() const noexcept { return static_cast<std::size_t>(found_.degree) + 1; }

  // Strips as wide as a tile, at the same lines for any number of threads.
  void overStrips(const auto& work) {
    const std::int32_t strips = (found_.lines + kTileSide - 1) / kTileSide;
    job_.begin("levelling lines", static_cast<std::uint64_t>(strips));
    tbb::parallel_for(std::int32_t{0}, strips, [&](std::int32_t s) {
      if (job_.cancelled()) return;
      work(s * kTileSide, std::min<std::int32_t>(kTileSide, found_.lines - s * kTileSide));
      job_.advance();
    });
  }

  // `count` <= kTileSide lines from `first`, one after the other; samples that are not looked at may be left out.
  void readLines(std::int32_t first, std::int32_t count, std::vector<float>& out) const {
    const auto length = static_cast<std::size_t>(found_.length);
    out.resize(static_cast<std::size_t>(count) * length);
    for (std::int32_t i = 0; i < found_.length; i += kTileSide) {
      const std::int32_t part = std::min<std::int32_t>(kTileSide, found_.length - i);
      if (found_.axis == ScanAxis::kX) {
        readRegion(field_, options_.region, {i, first, part, count}, out.data() + i, found_.length);
        continue;
      }
      float z[kTileSamples];
      readRegion(field_, options_.region, {first, i, count, part}, z, kTileSide);
      for (std::int32_t k = 0; k < part; ++k) {
        if (read_[static_cast<std::size_t>(i + k)] == 0) continue;
        for (std::int32_t l = 0; l < count; ++l)
          out[static_cast<std::size_t>(l) * length + static_cast<std::size_t>(i + k)] = z[k * kTileSide + l];
      }
    }
  }
  [[nodiscard]] ScanLine lineOf(const std::vector<float>& lines, std::int32_t index) const noexcept {
    return ScanLine(lines).subspan(static_cast<std::size_t>(index) * static_cast<std::size_t>(found_.length),
                                   static_cast<std::size_t>(found_.length));
  }

  [[nodiscard]] std::int64_t countIn(ScanLine line) const noexcept {
    std::int64_t there = 0;
    places_.each([&](std::size_t i) { there += std::isnan(line[i]) ? 0 : 1; });
    return there;
  }

  void countAndFit(std::int32_t first, std::int32_t count) {
    std::vector<float> lines;
    readLines(first, count, lines);
    LineSamples samples;
    for (std::int32_t l = 0; l < count; ++l) {
      const ScanLine line = lineOf(lines, l);
      const auto at = static_cast<std::size_t>(first + l);
      counts_[at] = countIn(line);
      if (counts_[at] == 0) continue;
      take(line, places_, samples);
      Terms c{};
      if (options_.method == LineMethod::kMedian)
        c[0] = median(samples.z);
      else if (options_.robust)
        c = robustPolynomial(samples, static_cast<int>(terms()), static_cast<std::uint64_t>(at) + 1);
      else
        c = leastSquares(samples, {}, static_cast<int>(terms()));
      c[0] += samples.base;
      std::copy_n(c.begin(), terms(),
                  found_.coefficients.begin() + static_cast<std::ptrdiff_t>(at * terms()));
    }
  }

  double stepBetween(ScanLine a, ScanLine b, StepSamples& samples) const {
    return options_.method == LineMethod::kDifference ? medianStep(a, b, places_, samples.for_median)
                                                      : matchedStep(a, b, places_, samples);
  }

  // Of each line the step from the one before it: no other where no line is empty, so that one pass is enough.
  void countAndStep(std::int32_t first, std::int32_t count) {
    std::vector<float> lines, before;
    readLines(first, count, lines);
    if (first > 0) readLines(first - 1, 1, before);
    StepSamples samples;
    for (std::int32_t l = 0; l < count; ++l) {
      const ScanLine line = lineOf(lines, l);
      const auto at = static_cast<std::size_t>(first + l);
      counts_[at] = countIn(line);
      if (counts_[at] == 0 || at == 0) continue;
      found_.coefficients[at] = stepBetween(l == 0 ? ScanLine(before) : lineOf(lines, l - 1), line, samples);
    }
  }

  // After empty lines the step is from the last line that has samples.
  void stepOverEmpty() {
    std::vector<std::pair<std::int32_t, std::int32_t>> steps;  // from, to
    std::int32_t last = -1;
    for (std::int32_t l = 0; l < found_.lines; ++l) {
      if (counts_[static_cast<std::size_t>(l)] == 0) continue;
      if (last >= 0 && last != l - 1) steps.emplace_back(last, l);
      last = l;
    }
    job_.begin("levelling lines", steps.size());
    tbb::parallel_for(std::size_t{0}, steps.size(), [&](std::size_t k) {
      if (job_.cancelled()) return;
      std::vector<float> from, to;
      readLines(steps[k].first, 1, from);
      readLines(steps[k].second, 1, to);
      StepSamples samples;
      found_.coefficients[static_cast<std::size_t>(steps[k].second)] =
          stepBetween(lineOf(from, 0), lineOf(to, 0), samples);
      job_.advance();
    });
  }

  void fillEmpty() {
    std::int32_t before = -1;
    for (std::int32_t l = 0; l <= found_.lines; ++l) {
      if (l < found_.lines && counts_[static_cast<std::size_t>(l)] == 0) continue;
      for (std::int32_t e = before + 1; e < l; ++e) {
        const std::int32_t low = before < 0 ? l : before;
        const std::int32_t high = l == found_.lines ? before : l;
        const double share = high > low ? static_cast<double>(e - low) / (high - low) : 0.0;
        for (std::size_t k = 0; k < terms(); ++k)
          coefficient(e, k) = (1.0 - share) * coefficient(low, k) + share * coefficient(high, k);
      }
      before = l;
    }
  }

  void centre() {
    CompensatedSum sum, square;
    for (std::int32_t l = 0; l < found_.lines; ++l) sum.add(coefficient(l, 0));
    const double mean = sum.value() / found_.lines;
    for (std::int32_t l = 0; l < found_.lines; ++l) {
      coefficient(l, 0) -= mean;
      square.add(coefficient(l, 0) * coefficient(l, 0));
    }
    found_.rms = std::sqrt(square.value() / found_.lines);
  }

  double& coefficient(std::int32_t line, std::size_t k) noexcept {
    return found_.coefficients[static_cast<std::size_t>(line) * terms() + k];
  }

  FieldReader field_;
  LineOptions options_;
  JobControl& job_;
  LineOffsets found_;
  Places places_;
  std::vector<std::uint8_t> read_;    // of each place along a line: whether it is read
  std::vector<std::int64_t> counts_;  // samples that count, of each line
};

}  // namespace

void LineOffsets::readHeights(const SampleRect& rect, double* out) const noexcept {
  const bool rows = axis == ScanAxis::kX;
  const std::int32_t across = rows ? rect.rows : rect.columns, first_line = rows ? rect.row : rect.column;
  const std::int32_t part = rows ? rect.columns : rect.rows, first = rows ? rect.column : rect.row;
  const std::ptrdiff_t by_line = rows ? kTileSide : 1, by_sample = rows ? 1 : kTileSide;
  const auto terms = static_cast<std::size_t>(degree) + 1;
  for (std::int32_t i = 0; i < part; ++i) {
    const Terms basis = legendre(along(first + i, length));
    for (std::int32_t l = 0; l < across; ++l) {
      const double* c = coefficients.data() + static_cast<std::size_t>(first_line + l) * terms;
      double sum = 0.0;
      for (std::size_t k = 0; k < terms; ++k) sum += c[k] * basis[k];
      out[l * by_line + i * by_sample] = sum;
    }
  }
}

double LineOffsets::takenAt(std::int32_t line, double place) const noexcept {
  const Terms basis = legendre(along(place, length));
  const auto terms = static_cast<std::size_t>(degree) + 1;
  const double* c = coefficients.data() + static_cast<std::size_t>(line) * terms;
  double sum = 0.0;
  for (std::size_t k = 0; k < terms; ++k) sum += c[k] * basis[k];
  return sum;
}

Result<LineOffsets> findLineOffsets(const Version& field, const LineOptions& options, JobControl& job) {
  return findLineOffsets(field, options, {}, job);
}

Result<LineOffsets> findLineOffsets(const Version& field, const LineOptions& options,
                                    std::span<const std::int32_t> places, JobControl& job) {
  if (options.degree < 0 || options.degree > LineOptions::kMostDegree)
    return inputError(fmt::format("a line's polynomial of degree {} is not possible", options.degree),
                      "lines", fmt::format("take 0 to {}", LineOptions::kMostDegree));
  if (const int form = options.form_degree.value_or(0); form < 0 || form > LineOptions::kMostFormDegree)
    return inputError(fmt::format("a form of degree {} across the lines is not possible", form), "lines",
                      fmt::format("take 0 to {}", LineOptions::kMostFormDegree));
  return LineSearch(field, options, places, job).run();
}

}  // namespace fettle::engine
