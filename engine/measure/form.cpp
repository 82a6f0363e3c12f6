#include "engine/measure/form.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "engine/compare/tile_select.h"
#include "engine/compare/tile_sums.h"
#include "engine/measure/form_solve.h"
#include "engine/measure/least_trimmed.h"
#include "engine/measure/lowered.h"

namespace fettle::engine {

namespace {

constexpr int kMost = PolynomialForm::kMostDegree;
// The product of two polynomials of the basis is half the sum of those of the sum and the difference of their degrees.
constexpr int kProducts = 2 * kMost + 1;

// Sums over samples of weight T_a(u) T_b(v), a and b to twice the degree, and of weight height T_a(u) T_b(v).
struct FormSums {
  std::array<std::array<CompensatedSum, kProducts>, kProducts> weight;
  std::array<std::array<CompensatedSum, kMost + 1>, kMost + 1> height;
  std::int64_t samples = 0;
  std::int64_t counted = 0;                                                         // with a weight above 0
  CompensatedSum square, counted_square;                                            // of residuals
  std::int32_t left = Grid::kMaxSide, right = -1, low = Grid::kMaxSide, high = -1;  // of these samples

  void add(const FormSums& other) noexcept {
    for (std::size_t a = 0; a < weight.size(); ++a)
      for (std::size_t b = 0; b < weight.size(); ++b) weight[a][b].add(other.weight[a][b]);
    for (std::size_t a = 0; a < height.size(); ++a)
      for (std::size_t b = 0; b < height.size(); ++b) height[a][b].add(other.height[a][b]);
    samples += other.samples;
    counted += other.counted;
    square.add(other.square);
    counted_square.add(other.counted_square);
    left = std::min(left, other.left);
    right = std::max(right, other.right);
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] FormProducts products() const noexcept {
    FormProducts values;
    for (std::size_t a = 0; a < weight.size(); ++a)
      for (std::size_t b = 0; b < weight.size(); ++b) values.weight[a][b] = weight[a][b].value();
    for (std::size_t a = 0; a < height.size(); ++a)
      for (std::size_t b = 0; b < height.size(); ++b) values.height[a][b] = height[a][b].value();
    return values;
  }
  [[nodiscard]] FormAxes axes() const noexcept { return {{left, right - left + 1}, {low, high - low + 1}}; }
};

// How much a sample counts by its distance from the last form: all the same, or Tukey's biweight.
struct Weighting {
  double scale = 0.0;  // [height_unit]; 0: all the same

  double operator()(double residual) const noexcept {
    if (scale == 0.0) return 1.0;
    constexpr double kReach = 4.685;  // 95 % of the efficiency of least squares on Gaussian noise
    const double x = residual / (kReach * scale);
    return std::abs(x) < 1.0 ? (1.0 - x * x) * (1.0 - x * x) : 0.0;
  }
};

// The sums of one row of tiles, columns side by side so that they go through vector registers.
class TileRowSums {
 public:
  TileRowSums(const Version& field, const FormOptions& options, const FormAxes& axes,
              const PolynomialForm& last, Weighting weighting)
      : field_(field.reader()), options_(options), axes_(axes), last_(last), weighting_(weighting) {}

  void add(const SampleRect& rect, FormSums& sums) const noexcept {
    float z[kTileSamples];
    double form[kTileSamples];
    readRegion(field_, options_.region, rect, z, kTileSide);
    last_.readHeights(rect, form, kTileSide);
    const int degree = options_.degree, products = 2 * degree + 1;
    double weight[kProducts][kTileSide] = {};
    double height[kMost + 1][kTileSide] = {};
    for (int r = 0; r < rect.rows; ++r) {
      double w[kTileSide], wz[kTileSide], square = 0.0, counted_square = 0.0;
      int here = 0, first = kTileSide, last = -1;  // samples that count
      for (int c = 0; c < rect.columns; ++c) {
        const double h = z[r * kTileSide + c];
        const bool counts = !std::isnan(h);
        const double residual = counts ? h - form[r * kTileSide + c] : 0.0;
        w[c] = counts ? weighting_(residual) : 0.0;
        wz[c] = counts ? w[c] * (h - last_.base) : 0.0;
        square += residual * residual;
        if (!counts) continue;
        ++sums.samples;
        if (w[c] > 0.0) {
          ++sums.counted;
          counted_square += residual * residual;
        }
        ++here;
        first = std::min(first, c);
        last = c;
      }
      if (here > 0) {
        sums.left = std::min(sums.left, rect.column + first);
        sums.right = std::max(sums.right, rect.column + last);
        sums.low = std::min(sums.low, rect.row + r);
        sums.high = std::max(sums.high, rect.row + r);
      }
      sums.square.add(square);
      sums.counted_square.add(counted_square);
      double t[kProducts];
      PolynomialForm::chebyshev(axes_.rows.scaled(rect.row + r), products - 1, t);
      for (int b = 0; b < products; ++b)
        for (int c = 0; c < rect.columns; ++c) weight[b][c] += t[b] * w[c];
      for (int b = 0; b <= degree; ++b)
        for (int c = 0; c < rect.columns; ++c) height[b][c] += t[b] * wz[c];
    }
    double weights[kProducts][kProducts] = {};
    double heights[kMost + 1][kMost + 1] = {};
    for (int c = 0; c < rect.columns; ++c) {
      double t[kProducts];
      PolynomialForm::chebyshev(axes_.columns.scaled(rect.column + c), products - 1, t);
      for (int a = 0; a < products; ++a)
        for (int b = 0; b < products; ++b) weights[a][b] += t[a] * weight[b][c];
      for (int a = 0; a <= degree; ++a)
        for (int b = 0; b <= degree; ++b) heights[a][b] += t[a] * height[b][c];
    }
    for (std::size_t a = 0; a < static_cast<std::size_t>(products); ++a)
      for (std::size_t b = 0; b < static_cast<std::size_t>(products); ++b)
        sums.weight[a][b].add(weights[a][b]);
    for (std::size_t a = 0; a <= static_cast<std::size_t>(degree); ++a)
      for (std::size_t b = 0; b <= static_cast<std::size_t>(degree); ++b)
        sums.height[a][b].add(heights[a][b]);
  }

 private:
  FieldReader field_;
  FormOptions options_;
  FormAxes axes_;
  const PolynomialForm& last_;
  Weighting weighting_;
};

// Over all tiles, in an order that does not depend on the number of threads.
Result<FormSums> sumsOf(const Version& field, const FormOptions& options, const FormAxes& axes,
                        const PolynomialForm& last, Weighting weighting, JobControl& job) {
  const FieldReader reader = field.reader();
  const TileRowSums tiles(field, options, axes, last, weighting);
  job.begin("fitting the form", tileCount(reader));
  std::vector<FormSums> rows(static_cast<std::size_t>(reader.tileRows()));
  tbb::parallel_for(std::int32_t{0}, reader.tileRows(), [&](std::int32_t tr) {
    for (std::int32_t tc = 0; tc < reader.tileColumns() && !job.cancelled(); ++tc) {
      tiles.add(tileRect(reader, std::int64_t{tr} * reader.tileColumns() + tc),
                rows[static_cast<std::size_t>(tr)]);
      job.advance();
    }
  });
  if (job.cancelled()) return cancelled();
  FormSums all;
  for (const FormSums& row : rows) all.add(row);
  return all;
}

// The normalised median distance of the region's samples from a form.
double medianDistance(const Version& field, Region region, const PolynomialForm& form, JobControl& job) {
  constexpr double kOfGaussian = 1.4826;
  const FieldReader reader = field.reader();
  job.begin("fitting the form", kSelectPasses * tileCount(reader));
  return kOfGaussian * selectFromTiles(
                           reader, job, [](std::int64_t n) { return (n - 1) / 2; },
                           [&](const SampleRect& rect, auto&& take) {
                             float z[kTileSamples];
                             double heights[kTileSamples];
                             readRegion(reader, region, rect, z, kTileSide);
                             form.readHeights(rect, heights, kTileSide);
                             for (int r = 0; r < rect.rows; ++r)
                               for (int i = r * kTileSide; i < r * kTileSide + rect.columns; ++i)
                                 take(std::abs(z[i] - heights[i]));
                           })
                           .value;
}

// Up to some kSpread x kSpread samples of a region, evenly spread.
std::vector<FormSample> spreadSamples(const Version& field, Region region) {
  constexpr int kSpread = 64;
  const FieldReader reader = field.reader();
  const std::int32_t columns = std::max(1, reader.width() / kSpread),
                     rows = std::max(1, reader.height() / kSpread);
  std::vector<FormSample> samples;
  for (std::int32_t r = rows / 2; r < reader.height(); r += rows)
    for (std::int32_t c = columns / 2; c < reader.width(); c += columns) {
      float z = 0.0F;
      readRegion(reader, region, {c, r, 1, 1}, &z, 1);
      if (!std::isnan(z)) samples.push_back({static_cast<double>(c), static_cast<double>(r), z});
    }
  return samples;
}

// The plane with the least median distance of all that go through three of the samples tried, as height, slope by
// column and slope by row; nothing where no three of them span one.
std::optional<std::array<double, 3>> leastMedianPlane(const std::vector<FormSample>& samples) {
  // With half of the samples on the plane all of 300 triples miss it once in 1e17 times.
  constexpr int kTrials = 300;
  if (samples.size() < 3) return std::nullopt;
  std::mt19937_64 random(1);  // its numbers are the standard's: the same on every machine
  std::optional<std::array<double, 3>> best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> distances(samples.size());
  for (int trial = 0; trial < kTrials; ++trial) {
    const FormSample& p = samples[random() % samples.size()];
    const FormSample& q = samples[random() % samples.size()];
    const FormSample& s = samples[random() % samples.size()];
    const double area = (q.column - p.column) * (s.row - p.row) - (s.column - p.column) * (q.row - p.row);
    if (area == 0.0) continue;
    const double by_column = ((q.z - p.z) * (s.row - p.row) - (s.z - p.z) * (q.row - p.row)) / area;
    const double by_row = ((s.z - p.z) * (q.column - p.column) - (q.z - p.z) * (s.column - p.column)) / area;
    const double height = p.z - by_column * p.column - by_row * p.row;
    for (std::size_t i = 0; i < samples.size(); ++i)
      distances[i] =
          std::abs(samples[i].z - height - by_column * samples[i].column - by_row * samples[i].row);
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < least) {
      least = *middle;
      best = {height, by_column, by_row};
    }
  }
  return best;
}

// The same for the mean height: the sample with the least median distance from all others is near the middle of the
// shorter half; the median is near enough.
double medianHeight(std::vector<FormSample> samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::ranges::nth_element(samples, middle, {}, &FormSample::z);
  return middle->z;
}

// The rounding of heights: of most of them, since one spike may be as high as all others' rounding is less.
double roundingOf(const std::vector<FormSample>& samples, double range) {
  constexpr double kRounding = std::numeric_limits<float>::epsilon();
  if (samples.empty()) return kRounding * range;
  std::vector<double> heights;
  heights.reserve(samples.size());
  for (const FormSample& sample : samples) heights.push_back(sample.z);
  const auto quantile = [&](std::size_t twentieths) {
    const auto at = heights.begin() + static_cast<std::ptrdiff_t>((heights.size() - 1) * twentieths / 20);
    std::ranges::nth_element(heights, at);
    return *at;
  };
  const double low = quantile(1), high = quantile(19);
  // Where most are of one height it has none to speak of.
  return kRounding * std::max(high - low, kRounding * range);
}

// Coefficients of a lower degree as those of a higher one.
std::vector<double> raised(const std::vector<double>& coefficients, int degree, int higher) {
  std::vector<double> result;
  std::size_t k = 0;
  for (int i = 0; i <= higher; ++i)
    for (int j = 0; i + j <= higher; ++j) result.push_back(i + j <= degree ? coefficients[k++] : 0.0);
  return result;
}

double largestChange(const std::vector<double>& a, const std::vector<double>& b) noexcept {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// Weighted fits of one degree until the coefficients rest; `scale` from the median distance before.
Status refine(const Version& field, const FormOptions& options, const FormAxes& axes, double least,
              FormFit& fit, Weighting& weighting, JobControl& job) {
  constexpr int kMostRounds = 20;
  constexpr double kRest = 1e-6;  // of the scale
  const double scale = std::max(medianDistance(field, options.region, fit.form, job), least);
  if (job.cancelled()) return cancelled();
  weighting.scale = scale;
  for (int round = 0; round < kMostRounds; ++round) {
    const auto sums = sumsOf(field, options, axes, fit.form, {scale}, job);
    if (!sums) return tl::unexpected(sums.error());
    std::vector<double> better = solveForm(sums->products(), options.degree, axes, field.grid()).coefficients;
    const double change = largestChange(better, fit.form.coefficients);
    fit.form.coefficients = std::move(better);
    ++fit.rounds;
    if (change <= kRest * scale) break;
  }
  return {};
}

// What stands on a bent surface may be nearer to the plane of before than the surface is: then a form that was found without
// planes is nearer to most samples, and the fit starts again from that.
Status refineFromTrimmed(const Version& field, const FormOptions& options, const FormAxes& axes,
                         const std::vector<FormSample>& samples, double least, FormFit& fit,
                         Weighting& weighting, JobControl& job) {
  constexpr double kClearly = 0.8;  // of the median distance: both start near the same form else
  if (options.degree < 2 || samples.empty()) return {};
  PolynomialForm other = leastTrimmedForm(samples, fit.form, axes, field.grid());
  if (!(medianDistance(samples, other) < kClearly * medianDistance(samples, fit.form))) return {};
  fit.form = std::move(other);
  for (int pass = 0; pass < 2; ++pass)
    if (auto done = refine(field, options, axes, least, fit, weighting, job); !done) return done;
  return {};
}

// From the plane with the least median distance to the degree asked for, one degree after the other: what the lower one
// leaves decides which samples the next one sees.
Status fitRobustly(const Version& field, const FormOptions& options, const FormAxes& axes, double range,
                   FormFit& fit, Weighting& weighting, JobControl& job) {
  const std::vector<FormSample> samples = spreadSamples(field, options.region);
  const double least = roundingOf(samples, range);
  PolynomialForm& form = fit.form;
  const int first = std::min(options.degree, 1);
  form.degree = first;
  if (const auto plane = first == 1 ? leastMedianPlane(samples) : std::nullopt; plane) {
    const auto [height, by_column, by_row] = *plane;
    const double half_width = 0.5 * (form.width - 1), half_height = 0.5 * (form.height - 1);
    form.coefficients = {height + by_column * half_width + by_row * half_height - form.base,
                         by_row * half_height, by_column * half_width};
  } else if (!samples.empty()) {
    form.coefficients.assign(static_cast<std::size_t>(PolynomialForm::terms(first)), 0.0);
    form.coefficients.front() = medianHeight(samples) - form.base;
  } else {
    // A region between the spread samples: equal weights have to do.
    form.coefficients = raised(form.coefficients, options.degree, options.degree);
    form.degree = options.degree;
  }
  for (int degree = form.degree; degree <= options.degree; ++degree) {
    form.coefficients = raised(form.coefficients, form.degree, degree);
    form.degree = degree;
    FormOptions now = options;
    now.degree = degree;
    // Twice: the scale after the first is that of samples on the form.
    for (int pass = 0; pass < 2; ++pass)
      if (auto done = refine(field, now, axes, least, fit, weighting, job); !done) return done;
  }
  return refineFromTrimmed(field, options, axes, samples, least, fit, weighting, job);
}

}  // namespace

Result<FormFit> fitForm(const Version& field, const FormOptions& options, JobControl& job) {
  if (options.degree < 0 || options.degree > kMost)
    return inputError(fmt::format("a form of degree {} is not possible", options.degree), "form",
                      fmt::format("take 0 to {}", kMost));
  const Grid& grid = field.grid();
  FormFit fit;
  fit.form.degree = options.degree;
  fit.form.width = grid.width;
  fit.form.height = grid.height;
  fit.form.coefficients.assign(static_cast<std::size_t>(PolynomialForm::terms(options.degree)), 0.0);
  const HeightBounds bounds = field.reader().bounds();
  const double range = bounds.empty() ? 0.0 : double{bounds.max} - bounds.min;
  fit.form.base = bounds.empty() ? 0.0 : bounds.min + 0.5 * range;

  FormAxes axes{{0, grid.width}, {0, grid.height}};
  auto sums = sumsOf(field, options, axes, fit.form, {}, job);
  if (!sums) return tl::unexpected(sums.error());
  if (sums->samples == 0) return nothingIn(options.region, "");
  SolvedForm solved = solveForm(sums->products(), options.degree, axes, grid);
  // On a small part of the field the terms hardly differ but about that part's middle.
  const FormAxes own = sums->axes();
  const bool small = 2 * own.columns.count < grid.width || 2 * own.rows.count < grid.height;
  if (options.degree > 0 && !(own == axes) && (small || !solved.open.empty())) {
    axes = own;
    sums = sumsOf(field, options, axes, fit.form, {}, job);
    if (!sums) return tl::unexpected(sums.error());
    solved = solveForm(sums->products(), options.degree, axes, grid);
  }
  fit.terms = solved.terms;
  fit.decided = solved.decided;
  fit.open = std::move(solved.open);
  fit.form.coefficients = std::move(solved.coefficients);
  Weighting weighting;
  if (options.robust && range > 0.0)
    if (auto done = fitRobustly(field, options, axes, range, fit, weighting, job); !done)
      return tl::unexpected(done.error());
  sums = sumsOf(field, options, axes, fit.form, weighting, job);
  if (!sums) return tl::unexpected(sums.error());
  fit.samples = sums->samples;
  fit.rms = std::sqrt(sums->square.value() / static_cast<double>(sums->samples));
  fit.rms_counted =
      std::sqrt(sums->counted_square.value() / static_cast<double>(std::max<std::int64_t>(sums->counted, 1)));
  return fit;
}

Result<Version> withoutForm(const Version& field, const NominalForm& form, JobControl& job) {
  assert(form.width() == field.grid().width && form.height() == field.grid().height);
  return lowered(
      field, "removing the form",
      [&](const SampleRect& rect, double* out) { form.readHeights(rect, out, kTileSide); }, job);
}

}  // namespace fettle::engine
