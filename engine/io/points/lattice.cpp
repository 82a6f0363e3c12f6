#include "engine/io/points/lattice.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "engine/io/height_rule.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kMostDistinct = std::size_t{1} << 20;
constexpr double kLargestResidual = 0.1;  // of the spacing
constexpr double kLeastTaken = 0.25;      // of the positions
constexpr double kLeastSteps = 0.5;       // of the differences between neighbours, that are one step
constexpr double kFarGap = 8.0;           // times the median

// Set of doubles by open addressing. Clouds on a lattice have few distinct values: most look-ups find the
// last value, the others a table that stays in the cache.
class DistinctValues {
 public:
  DistinctValues() : table_(1024, kFree) {}

  // False once there are too many.
  [[nodiscard]] bool add(double value) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(value + 0.0);  // + 0.0: -0 equals 0
    if (bits == last_) return true;
    last_ = bits;
    if (!insert(bits)) return true;
    if (++count_ > kMostDistinct) return false;
    if (count_ * 2 > table_.size()) grow();
    return true;
  }
  [[nodiscard]] std::vector<double> sorted() const {
    std::vector<double> values;
    values.reserve(count_);
    for (const std::uint64_t bits : table_)
      if (bits != kFree) values.push_back(std::bit_cast<double>(bits));
    std::sort(values.begin(), values.end());
    return values;
  }

 private:
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};  // a NaN, never a coordinate

  bool insert(std::uint64_t bits) {
    const std::size_t mask = table_.size() - 1;
    for (std::size_t i = (bits * 0x9e3779b97f4a7c15U) >> 20 & mask;; i = (i + 1) & mask) {
      if (table_[i] == bits) return false;
      if (table_[i] == kFree) {
        table_[i] = bits;
        return true;
      }
    }
  }
  void grow() {
    std::vector<std::uint64_t> old(table_.size() * 2, kFree);
    old.swap(table_);
    for (const std::uint64_t bits : old)
      if (bits != kFree) insert(bits);
  }

  std::vector<std::uint64_t> table_;
  std::size_t count_ = 0;
  std::uint64_t last_ = kFree;
};

// The number with the fewest decimal digits within `tolerance` of `value`.
double fewestDigits(double value, double tolerance) {
  if (std::abs(value) <= tolerance) return 0.0;
  for (int digits = 0; digits < 17; ++digits) {
    const std::string text = fmt::format("{:.{}e}", value, digits);
    double candidate = value;
    std::from_chars(text.data(), text.data() + text.size(), candidate);
    if (std::abs(candidate - value) <= tolerance) return candidate;
  }
  return value;
}

// The differences between neighbouring distinct values, ascending.
std::vector<double> gapsOf(const std::vector<double>& values) {
  std::vector<double> gaps(values.size() - 1);
  for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i] = values[i + 1] - values[i];
  std::sort(gaps.begin(), gaps.end());
  return gaps;
}

// Estimates of the spacing. Rounding splits one position into several values close together; their small gaps
// are excluded at increasing thresholds.
std::vector<double> spacingGuesses(const std::vector<double>& gaps) {
  std::vector<double> guesses;
  for (const double threshold : {0.0, 1e-6, 1e-4, 1e-3, 1e-2, 0.05, 0.2, 0.5}) {
    const auto first = std::lower_bound(gaps.begin(), gaps.end(), threshold * gaps.back());
    const double median = first[(gaps.end() - first) / 2];
    // Only gaps of two and three steps: the step itself is a half or a third of the common one.
    for (const double guess : {median, *first, median / 2, median / 3})
      if (std::find(guesses.begin(), guesses.end(), guess) == guesses.end()) guesses.push_back(guess);
  }
  std::sort(guesses.begin(), guesses.end(),
            std::greater<>());  // the widest lattice that fits is the right one
  return guesses;
}

// Improves an estimate gap by gap, the short ones first: each makes the step accurate enough to count the
// steps of the next longer one. The guess is one of the gaps, or a half or a third of one, so that there is a step.
double refined(const std::vector<double>& gaps, double guess) {
  double length = 0.0, steps = 0.0;
  for (auto gap = std::lower_bound(gaps.begin(), gaps.end(), 0.5 * guess); gap != gaps.end(); ++gap) {
    steps += std::nearbyint(*gap / (steps > 0.0 ? length / steps : guess));
    length += *gap;
  }
  return length / steps;
}

std::optional<AxisLattice> fit(const std::vector<double>& values, double guess) {
  const double range = values.back() - values.front();
  if (!(guess > 0.0) || range / guess > Grid::kMaxSide) return std::nullopt;
  // Positions step by step, so that an error of the estimate does not add up along the axis.
  std::vector<double> index(values.size(), 0.0);
  for (std::size_t i = 1; i < values.size(); ++i)
    index[i] = index[i - 1] + std::nearbyint((values[i] - values[i - 1]) / guess);
  const auto n = static_cast<long double>(values.size());
  long double mean_k = 0.0L;
  long double mean_v = 0.0L;
  for (std::size_t i = 0; i < values.size(); ++i) {
    mean_k += index[i];
    mean_v += static_cast<long double>(values[i]) - values.front();
  }
  mean_k /= n;
  mean_v /= n;
  long double kk = 0.0L;
  long double kv = 0.0L;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const long double dk = index[i] - mean_k;
    kk += dk * dk;
    kv += dk * (static_cast<long double>(values[i]) - values.front() - mean_v);
  }
  if (!(kk > 0.0L)) return std::nullopt;
  const long double slope = kv / kk;
  const long double start = mean_v - slope * mean_k;  // from values.front()
  long double worst = 0.0L;
  long double squares = 0.0L;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const long double residual =
        static_cast<long double>(values[i]) - values.front() - (start + slope * index[i]);
    worst = std::max(worst, std::abs(residual));
    squares += residual * residual;
  }
  const double last = index.back();
  if (!(slope > 0.0L) || worst > kLargestResidual * slope) return std::nullopt;
  // Values of one position count once.
  std::size_t taken = 1, single = 0;
  for (std::size_t i = 1; i < index.size(); ++i) {
    taken += index[i] > index[i - 1] ? 1 : 0;
    single += index[i] == index[i - 1] + 1.0 ? 1 : 0;
  }
  if (static_cast<double>(taken) < kLeastTaken * (last + 1.0) &&
      static_cast<double>(single) < kLeastSteps * static_cast<double>(taken - 1))
    return std::nullopt;

  // Standard errors of slope and intercept (of the intercept at k = 0), and the resolution of a double.
  const double scatter = static_cast<double>(std::sqrt(squares / std::max(1.0L, n - 2.0L)));
  const double ulp = std::max(std::abs(values.front()), std::abs(values.back())) * 0x1p-52;
  // Floats were most likely computed from a spacing that was a float itself: its error is at most half an
  // ulp, in proportion along the axis, which no fit can detect.
  const bool floats =
      std::ranges::all_of(values, [](double v) { return static_cast<double>(HeightRule::toFloat(v)) == v; });
  const double slope_error = 3.0 * scatter / static_cast<double>(std::sqrt(kk)) + 2.0 * ulp / last +
                             (floats ? static_cast<double>(slope) * 0x1p-24 : 0.0);
  const double start_error =
      3.0 * scatter * static_cast<double>(std::sqrt(1.0L / n + mean_k * mean_k / kk)) + 2.0 * ulp;
  AxisLattice lattice;
  lattice.spacing = fewestDigits(static_cast<double>(slope), slope_error);
  lattice.origin = fewestDigits(static_cast<double>(start + values.front()), start_error);
  lattice.count = static_cast<std::int64_t>(last) + 1;
  lattice.one_value_each = taken == values.size();
  lattice.taken = static_cast<std::int64_t>(taken);
  return lattice;
}

}  // namespace

void placeOn(const AxisLattice& x, const AxisLattice& y, Grid& grid) noexcept {
  grid.width = static_cast<std::int32_t>(x.count);
  grid.height = static_cast<std::int32_t>(y.count);
  grid.spacing_x = x.spacing;
  grid.spacing_y = y.spacing;
  grid.origin_x = x.origin;
  grid.origin_y = y.origin;
}

std::int64_t AxisLattice::indexOf(double value) const noexcept {
  if (spacing == 0.0) return 0;
  return std::clamp<std::int64_t>(std::llround((value - origin) / spacing), 0, count - 1);
}

AxisLatticeSearch::AxisLatticeSearch(const std::vector<double>& values) {
  DistinctValues distinct;
  for (const double value : values)
    if (!distinct.add(value)) return;
  values_ = distinct.sorted();
  if (values_.size() < 2) return;
  gaps_ = gapsOf(values_);
  guesses_ = spacingGuesses(gaps_);
}

std::optional<AxisLattice> AxisLatticeSearch::next() {
  if (values_.size() == 1 && at_++ == 0) return AxisLattice{values_.front(), 0.0, 1, true, 1};
  const bool far = !gaps_.empty() && gaps_.back() > kFarGap * gaps_[gaps_.size() / 2];
  while (at_ < guesses_.size()) {
    const double guess = guesses_[at_++];
    // An inaccurate estimate miscounts the steps of a long gap; split positions make the improved one worse.
    auto lattice = far ? fit(values_, refined(gaps_, guess)) : std::nullopt;
    if (!lattice) lattice = fit(values_, guess);
    // A narrower one without more taken positions is the same lattice with gaps.
    if (!lattice || lattice->count > Grid::kMaxSide || lattice->taken <= last_taken_) continue;
    last_taken_ = lattice->taken;
    return lattice;
  }
  return std::nullopt;
}

std::optional<AxisLattice> findAxisLattice(const std::vector<double>& values) {
  return AxisLatticeSearch(values).next();
}

}  // namespace fettle::engine
