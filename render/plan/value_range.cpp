#include "render/plan/value_range.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "engine/simd/kernel.h"
#include "render/config.h"

namespace fettle::render {
namespace {

template <class T>
T percentile(std::vector<T>& values, double share) {
  const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

// Each tile's share of the sample, scattered by a golden-ratio step so that it falls in no row or column
// pattern.
void forSomeOf(std::int64_t tiles, std::int64_t tile_number, const auto& visit) {
  const std::int64_t n = std::clamp<std::int64_t>(kRangeSamples / tiles, 4, engine::kTileSamples);
  constexpr std::int64_t kStep = 2531;  // odd: visits every sample of a tile before repeating one
  for (std::int64_t k = 0; k < n; ++k)
    visit(static_cast<std::size_t>((tile_number * 977 + k * kStep) & (engine::kTileSamples - 1)));
}

// Some of the heights, not sorted.
std::vector<float> someHeights(const engine::FieldReader& reader) {
  const std::int64_t tiles = std::int64_t{reader.tileColumns()} * reader.tileRows();
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(std::min(tiles * engine::kTileSamples, 2 * kRangeSamples)));
  std::int64_t number = 0;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc, ++number) {
      const engine::Tile& tile = reader.tile(tc, tr);
      forSomeOf(tiles, number, [&](std::size_t i) {
        if (!std::isnan(tile.samples[i])) values.push_back(reader.sign() * tile.samples[i]);
      });
    }
  return values;
}

}  // namespace

ValueSpan heightSpan(const engine::Version& field) {
  const engine::FieldReader reader = field.reader();
  const engine::HeightBounds bounds = reader.bounds();
  if (bounds.empty()) return {};
  std::vector<float> values = someHeights(reader);
  ValueSpan span;
  span.empty = false;
  span.extreme = {bounds.min, bounds.max};
  span.robust = span.extreme;
  if (values.size() < 64) return span;  // too few for percentiles
  const double low = percentile(values, 0.002), high = percentile(values, 0.998);
  const double margin = 0.1 * (high - low);
  // The middle is constant and only the ends differ: the range is that of the ends.
  if (!(high > low)) return span;
  span.robust = {std::max(span.extreme.low, low - margin), std::min(span.extreme.high, high + margin)};
  return span;
}

namespace {

#define FETTLE_KERNEL "render/plan/value_range-inl.h"
#include "engine/simd/each_cpu-inl.h"

using plain::kLanes;
const auto kExtremesOf = FETTLE_AT_LEVEL(engine::bestCpuLevel(), extremesOf);

// Result of a row of tiles.
struct RowSpan {
  ValueRange extreme{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::vector<double> changes;
};

// Whether the two share the tile, so that nothing differs in it.
bool shared(const engine::FieldReader& a, const engine::FieldReader& b, std::int32_t tc, std::int32_t tr) {
  return &a.tile(tc, tr) == &b.tile(tc, tr) && a.sign() == b.sign();
}

// `tiles`: that the two do not share, among which the sample is divided.
RowSpan deviationOfRow(const engine::FieldReader& a, const engine::FieldReader& b, std::int32_t tile_row,
                       std::int64_t tiles) {
  RowSpan row;
  for (std::int32_t tc = 0; tc < a.tileColumns(); ++tc) {
    const engine::Tile& ta = a.tile(tc, tile_row);
    const engine::Tile& tb = b.tile(tc, tile_row);
    if (shared(a, b, tc, tile_row)) {
      if (!ta.bounds.empty()) row.extreme = {std::min(row.extreme.low, 0.0), std::max(row.extreme.high, 0.0)};
      continue;
    }
    double low[kLanes], high[kLanes];
    std::fill_n(low, kLanes, row.extreme.low);
    std::fill_n(high, kLanes, row.extreme.high);
    kExtremesOf(ta.samples.data(), tb.samples.data(), a.sign(), b.sign(), low, high);
    row.extreme = {*std::min_element(low, low + kLanes), *std::max_element(high, high + kLanes)};
    forSomeOf(tiles, std::int64_t{tile_row} * a.tileColumns() + tc, [&](std::size_t i) {
      const double d = double{a.sign()} * ta.samples[i] - double{b.sign()} * tb.samples[i];
      if (std::abs(d) > 0.0) row.changes.push_back(d);
    });
  }
  return row;
}

// Of all rows: changes in the order of the tiles.
RowSpan deviationOf(const engine::Version& field, const engine::Version& original,
                    const engine::JobControl* job = nullptr) {
  const engine::FieldReader a = field.reader(), b = original.reader();
  assert(a.width() == b.width() && a.height() == b.height());
  std::int64_t differing = 0;
  for (std::int32_t tr = 0; tr < a.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < a.tileColumns(); ++tc) differing += shared(a, b, tc, tr) ? 0 : 1;
  differing = std::max<std::int64_t>(differing, 1);
  std::vector<RowSpan> rows(static_cast<std::size_t>(a.tileRows()));
  oneapi::tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t r) {
    if (job != nullptr && job->cancelled()) return;
    rows[r] = deviationOfRow(a, b, static_cast<std::int32_t>(r), differing);
  });
  RowSpan all;
  for (const RowSpan& row : rows) {
    all.changes.insert(all.changes.end(), row.changes.begin(), row.changes.end());
    all.extreme = {std::min(all.extreme.low, row.extreme.low), std::max(all.extreme.high, row.extreme.high)};
  }
  return all;
}

}  // namespace

ValueSpan deviationSpan(const engine::Version& field, const engine::Version& original) {
  RowSpan all = deviationOf(field, original);
  ValueSpan span;
  if (!(all.extreme.low <= all.extreme.high)) return span;
  span.empty = false;
  span.extreme = all.extreme;
  std::vector<double>& changes = all.changes;
  for (double& d : changes) d = std::abs(d);
  const double largest = std::max(-span.extreme.low, span.extreme.high);
  double limit = largest;
  if (changes.size() >= 64) {
    const double usual = std::min(percentile(changes, 0.995), kUsualChanges * percentile(changes, 0.5));
    if (largest > 1.25 * usual) limit = usual;
    span.share = static_cast<double>(std::count_if(changes.begin(), changes.end(),
                                                   [limit](double d) { return d <= limit; })) /
                 static_cast<double>(changes.size());
  }
  span.robust = {-limit, limit};
  return span;
}

double ValueSample::quantile(double share) const noexcept {
  const double last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * last + 0.5)];
}

double ValueSample::within(double low, double high) const noexcept {
  if (sorted.empty() || !(low <= high)) return 0.0;
  const auto from = std::lower_bound(sorted.begin(), sorted.end(), low);
  const auto to = std::upper_bound(from, sorted.end(), high);
  return static_cast<double>(to - from) / static_cast<double>(sorted.size());
}

ValueRange ValueSample::middle(double share) const noexcept {
  const double outside = 0.5 * (1.0 - std::clamp(share, 0.0, 1.0));
  return {quantile(outside), quantile(1.0 - outside)};
}

ValueRange ValueSample::symmetric(double share) const noexcept {
  // The smallest limit between two neighbouring magnitudes, by bisection of the sorted values from both sides.
  double low = 0.0, high = std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  for (int i = 0; i < 60 && low < high; ++i) {
    const double half = 0.5 * (low + high);
    (within(-half, half) >= share ? high : low) = half;
  }
  return {-high, high};
}

ValueSample heightSample(const engine::Version& field) {
  const engine::FieldReader reader = field.reader();
  const engine::HeightBounds bounds = reader.bounds();
  ValueSample sample;
  if (bounds.empty()) return sample;
  const std::vector<float> values = someHeights(reader);
  sample.sorted.assign(values.begin(), values.end());
  std::sort(sample.sorted.begin(), sample.sorted.end());
  sample.extreme = {bounds.min, bounds.max};
  return sample;
}

ValueSample deviationSample(const engine::Version& field, const engine::Version& original,
                            const engine::JobControl* job) {
  RowSpan all = deviationOf(field, original, job);
  ValueSample sample;
  sample.sorted = std::move(all.changes);
  std::sort(sample.sorted.begin(), sample.sorted.end());
  if (!sample.sorted.empty()) sample.extreme = all.extreme;
  return sample;
}

ValueSpan negated(const ValueSpan& span) noexcept {
  const auto turned = [](const ValueRange& r) { return ValueRange{0.0 - r.high, 0.0 - r.low}; };
  return {turned(span.robust), turned(span.extreme), span.empty, span.share};
}

ValueSpan join(const ValueSpan& a, const ValueSpan& b) noexcept {
  if (a.empty) return b;
  if (b.empty) return a;
  return {{std::min(a.robust.low, b.robust.low), std::max(a.robust.high, b.robust.high)},
          {std::min(a.extreme.low, b.extreme.low), std::max(a.extreme.high, b.extreme.high)},
          false,
          std::min(a.share, b.share)};
}

}  // namespace fettle::render
