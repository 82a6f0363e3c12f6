#include "bench/filter_bounds.h"

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "bench/repeats.h"
#include "engine/field/node_pool.h"
#include "engine/filter/gaussian_weights.h"
#include "engine/filter/merge.h"
#include "engine/simd/kernel.h"

namespace fettle::bench {

namespace {

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

}  // namespace

double operationsOf(const engine::FilterSpec& spec) {
  if (spec.kind == engine::FilterKind::kGaussian)
    return 2.0 * (2.0 * static_cast<double>(engine::gaussianHalfWeights(spec).size()) - 1.0);
  // Of 3 x 3: five to sort a column that two windows below each other share and twelve for three of these. Of 5 x 5: four windows take
  // 244 of the networks in median_small-inl.h: 72 to sort rows, 60 for pairs of them, 72 for the middle ranks of both fours, 40 at the end.
  if (spec.kind == engine::FilterKind::kMedian && spec.window == 3) return 17.0;
  if (spec.kind == engine::FilterKind::kMedian && spec.window == 5) return 61.0;
  return 0.0;
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
  constexpr int kRounds = 2'000'000;
  constexpr double kProducts = kRounds * 8.0 * 8.0, kExtrema = kRounds * 8.0 * 16.0;
  const bool products = spec.kind == engine::FilterKind::kGaussian;
  std::vector<double> filter, written, operations;
  volatile double kept = 0.0;
  for (int i = -1; i < repeats; ++i) {  // the first one obtains memory
    engine::JobControl own;
    engine::Result<engine::Filtered> result;
    const double whole = secondsFor([&] { result = engine::applyFilter(field, field, spec, own); });
    if (!result) return tl::unexpected(result.error());
    const double merged = secondsFor([&] { tiles.fill(reader, level); });
    const double counted = secondsFor([&] {
      kept = products ? FETTLE_AT_LEVEL(level, productsAlone)(kRounds)
                      : FETTLE_AT_LEVEL(level, extremaAlone)(kRounds);
    });
    if (job.cancelled()) return engine::cancelled();
    if (i < 0) continue;
    filter.push_back(whole / samples);
    written.push_back(merged / samples);
    operations.push_back(operationsOf(spec) * counted / (products ? kProducts : kExtrema));
  }
  return FilterBound{median(filter), median(written), median(operations)};
}

}  // namespace fettle::bench
