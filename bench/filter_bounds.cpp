#include "bench/filter_bounds.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "bench/repeats.h"
#include "bench/rolled_work.h"
#include "engine/field/node_pool.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/gaussian_weights.h"
#include "engine/filter/merge.h"
#include "engine/simd/kernel.h"

namespace fettle::bench {

namespace {

/// What medians by ranks and sets work on, in the nearest cache.
struct RankPlaces {
  static constexpr std::size_t kRanks = 256, kWords = 128, kSets = 5;
  static constexpr unsigned kDigitBits = 11;
  struct Item {
    std::uint32_t key, place;
  };

  RankPlaces() {
    std::uint32_t random = 1;
    for (std::size_t i = 0; i < kRanks; ++i) {
      random = random * 1664525U + 1013904223U;
      ranks[i] = (random >> 8) % (64 * kWords);
      items[i] = {random ^ (random >> 13), static_cast<std::uint32_t>(i)};
    }
    // Every fifth bit in each, so that together they have all.
    for (std::size_t s = 0; s < kSets; ++s)
      for (std::size_t bit = s; bit < 64 * kWords; bit += kSets)
        sets[s * kWords + bit / 64] |= std::uint64_t{1} << (bit % 64);
  }

  alignas(64) std::array<std::uint32_t, kRanks> ranks;
  alignas(64) std::array<Item, kRanks> items, moved{};
  alignas(64) std::array<std::uint64_t, kSets * kWords> sets{};
  alignas(64) std::array<std::uint64_t, kWords> shared{};
  alignas(64) std::array<float, 64 * kWords> heights{};
  alignas(64) std::array<float, kRanks> medians{};
  alignas(64) std::array<std::uint32_t, 3U << kDigitBits> counters{};
};

#define FETTLE_KERNEL "bench/filter_bounds-inl.h"
#include "engine/simd/each_cpu-inl.h"

double secondsFor(auto&& work) {
  const double begin = processorSeconds();
  work();
  return processorSeconds() - begin;
}

// Tiles of a pool are taken before the clock runs, as many as the field has: the least is written into memory that no cache holds.
class NewTiles {
 public:
  bool take(std::size_t count) {
    while (tiles_.size() < count) {
      engine::TileRef tile = engine::TileRef::adopt(memory_->bulk().acquire());
      if (!tile) return false;
      tiles_.push_back(std::move(tile));
    }
    return true;
  }

  void fill(const engine::FieldReader& reader, engine::CpuLevel level) {
    alignas(64) static constexpr std::array<float, engine::kTileSamples> kResults{};
    std::size_t i = 0;
    for (std::int32_t r = 0; r < reader.tileRows(); ++r)
      for (std::int32_t c = 0; c < reader.tileColumns(); ++c) {
        const engine::Tile* ahead = c + 1 < reader.tileColumns() ? &reader.tile(c + 1, r) : nullptr;
        (void)engine::mergeTile(reader.tile(c, r), kResults.data(), engine::kTileSide, 1.0F,
                                engine::FilterScope::kKeepMarks, *tiles_[i++], level, ahead);
      }
  }

 private:
  std::shared_ptr<engine::FieldMemory> memory_ = std::make_shared<engine::FieldMemory>();
  std::vector<engine::TileRef> tiles_;
};

// Seconds that one operation takes alone, for each kind that a filter has.
class OperationTimes {
 public:
  OperationTimes() {
    floats_.fill(1.0F);
    doubles_.fill(1.0);
  }

  void measure(const std::vector<Operations>& ways, engine::CpuLevel level) {
    const auto any = [&](double Operations::*kind) {
      return std::ranges::any_of(ways, [&](const Operations& way) { return way.*kind > 0.0; });
    };
    const auto add = [&](double Operations::*kind, std::vector<double>& times, double in_a_round,
                         auto&& work) {
      if (any(kind)) times.push_back(secondsFor([&] { kept_ = work(); }) / (kRounds * in_a_round));
    };
    add(&Operations::products, products_, FETTLE_AT_LEVEL(level, kProductsAtOnce),
        [&] { return FETTLE_AT_LEVEL(level, productsAlone)(kRounds); });
    add(&Operations::extrema, extrema_, FETTLE_AT_LEVEL(level, kExtremaAtOnce),
        [&] { return FETTLE_AT_LEVEL(level, extremaAlone)(kRounds); });
    add(&Operations::chords, chords_, FETTLE_AT_LEVEL(level, kChordsAtOnce),
        [&] { return FETTLE_AT_LEVEL(level, chordsAlone)(floats_.data(), kRounds); });
    add(&Operations::sums, sums_, FETTLE_AT_LEVEL(level, kSumsAtOnce),
        [&] { return FETTLE_AT_LEVEL(level, sumsAlone)(doubles_.data(), kRounds); });
    add(&Operations::tests, tests_, FETTLE_AT_LEVEL(level, kTestsAtOnce), [&] {
      return FETTLE_AT_LEVEL(level, testsAlone)(floats_.data(), floats_.data() + kMostPlaces * kMostLanes,
                                                kRounds);
    });
    add(&Operations::moves, moves_, 1.0,
        [&] { return FETTLE_AT_LEVEL(level, movesAlone)(*ranks_, kRounds); });
    add(&Operations::flips, flips_, 1.0,
        [&] { return FETTLE_AT_LEVEL(level, flipsAlone)(*ranks_, kRounds); });
    add(&Operations::selections, selections_, 1.0,
        [&] { return FETTLE_AT_LEVEL(level, selectionsAlone)(*ranks_, kRounds); });
    add(&Operations::sorts, sorts_, 1.0,
        [&] { return FETTLE_AT_LEVEL(level, sortsAlone)(*ranks_, kRounds); });
  }

  // Of the repeats until now; only of what was measured.
  [[nodiscard]] double of(const Operations& way) const {
    const auto part = [](double count, const std::vector<double>& times) {
      return count > 0.0 ? count * median(times) : 0.0;
    };
    return part(way.products, products_) + part(way.extrema, extrema_) + part(way.chords, chords_) +
           part(way.sums, sums_) + part(way.tests, tests_) + part(way.moves, moves_) +
           part(way.flips, flips_) + part(way.selections, selections_) + part(way.sorts, sorts_);
  }
  void forget() {
    for (auto* times :
         {&products_, &extrema_, &chords_, &sums_, &tests_, &moves_, &flips_, &selections_, &sorts_})
      times->clear();
  }

 private:
  static constexpr int kRounds = 2'000'000;
  static constexpr std::size_t kMostPlaces = 64, kMostChains = 8, kMostLanes = 16;

  alignas(64) std::array<float, 4 * (kMostPlaces + kMostChains) * kMostLanes> floats_;
  alignas(64) std::array<double, kMostPlaces * 8> doubles_;
  std::unique_ptr<RankPlaces> ranks_ = std::make_unique<RankPlaces>();
  std::vector<double> products_, extrema_, chords_, sums_, tests_, moves_, flips_, selections_, sorts_;
  volatile double kept_ = 0.0;
};

// Sixteen windows side by side, `window` columns each: those at the sides are in as many sets as the numbers 1 .. 15 have bits set.
Operations sharedSets(int window) {
  constexpr double kWindows = 16.0, kAtTheSides = 2.0 * 15.0, kSetsOfThese = 2.0 * 32.0;
  // Into the windows and out of them again, for one row of their results.
  return {.moves = 2.0 * (window + 15.0) / kWindows,
          .flips = 2.0 * (kSetsOfThese - kAtTheSides) / kWindows,
          .selections = 1.0,
          .sorts = 1.0};
}

}  // namespace

std::vector<Operations> operationsOf(const engine::Version& field, const engine::FilterSpec& spec) {
  if (spec.kind == engine::FilterKind::kBox) return {Operations{}};
  if (spec.kind == engine::FilterKind::kGaussian)
    return {Operations{
        .products = 2.0 * (2.0 * static_cast<double>(engine::gaussianHalfWeights(spec).size()) - 1.0)}};
  // Of 3 x 3: five to sort a column that two windows below each other share and twelve for three of these. Of 5 x 5: four windows take
  // 244 of the networks in median_small-inl.h: 72 to sort rows, 60 for pairs of them, 72 for the middle ranks of both fours, 40 at the end.
  if (spec.kind == engine::FilterKind::kMedian && spec.window == 3) return {Operations{.extrema = 17.0}};
  if (spec.kind == engine::FilterKind::kMedian && spec.window == 5) return {Operations{.extrema = 61.0}};
  if (spec.kind == engine::FilterKind::kMedian && spec.window > 16) return {sharedSets(spec.window)};
  if (!engine::filterOf(spec.kind).has_element || spec.element == engine::Element::kSquare) return {};
  if (spec.element == engine::Element::kDisk)
    return {Operations{.chords = static_cast<double>(chordsOfDisk(spec, field.grid()))}};
  const BallPairs all = pairsOfBall(field, spec);
  const auto [heights, eroded] = touchesOfBall(field, spec);
  // The first erosion is of floats, the second one of doubles.
  return {Operations{.chords = 3.0 * static_cast<double>(all.pairs),
                     .sums = 2.0 * static_cast<double>(all.depths)},
          Operations{.sums = heights.sums + eroded.sums, .tests = heights.tests + eroded.tests}};
}

engine::Result<FilterBound> filterBound(const engine::Version& field, const engine::FilterSpec& spec,
                                        int repeats, engine::JobControl& job) {
  const engine::CpuLevel level = engine::bestCpuLevel();
  const engine::FieldReader reader = field.reader();
  const double samples = static_cast<double>(field.grid().samples());
  NewTiles tiles;
  if (!tiles.take(static_cast<std::size_t>(reader.tileColumns()) *
                  static_cast<std::size_t>(reader.tileRows())))
    return engine::failure("memory for the bound could not be had", "bench filters");
  const std::vector<Operations> ways = operationsOf(field, spec);
  OperationTimes times;
  std::vector<double> filter, written;
  for (int i = -1; i < repeats; ++i) {  // the first one obtains memory
    engine::JobControl own;
    engine::Result<engine::Filtered> result;
    const double whole = secondsFor([&] { result = engine::applyFilter(field, field, spec, own); });
    if (!result) return tl::unexpected(result.error());
    const double merged = secondsFor([&] { tiles.fill(reader, level); });
    if (i == 0) times.forget();
    times.measure(ways, level);
    if (job.cancelled()) return engine::cancelled();
    if (i < 0) continue;
    filter.push_back(whole / samples);
    written.push_back(merged / samples);
  }
  FilterBound bound{median(filter), median(written), 0.0, {}, !ways.empty()};
  if (bound.whole) {
    bound.counted = std::ranges::min(ways, {}, [&](const Operations& way) { return times.of(way); });
    bound.operations = times.of(bound.counted);
  }
  return bound;
}

}  // namespace fettle::bench
