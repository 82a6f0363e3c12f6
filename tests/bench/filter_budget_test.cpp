// What a filter may cost a sample, in instructions: the same on an idle machine and on a busy one, so that a change that makes
// it dearer fails here. Of a release build alone, for processors with AVX2: others have other instructions.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/subjects.h"
#include "bench/instructions.h"
#include "engine/field/builder.h"
#include "engine/field/tile.h"
#include "engine/filter/filter.h"
#include "engine/filter/pass.h"
#include "engine/filter/tile_window.h"

namespace fettle::bench {
namespace {

#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
constexpr bool kReleased = true;
#else
constexpr bool kReleased = false;
#endif

struct FilterBudget {
  const char* name;
  engine::FilterKind kind;
  int window;
  // A sample of a field of one tile, as counted when this was written, with the compiler of Debian 12: planning, borders and
  // writing included. A tenth more fails; so does a quarter less, to be written down here and defended from then on.
  double instructions;
};

constexpr FilterBudget kFilterBudgets[] = {
    {"box11", engine::FilterKind::kBox, 11, 49.3},
    {"Gaussian3", engine::FilterKind::kGaussian, 3, 47.6},
    {"Gaussian11", engine::FilterKind::kGaussian, 11, 86.2},
    {"Gaussian31", engine::FilterKind::kGaussian, 31, 136.6},
    {"median3", engine::FilterKind::kMedian, 3, 59.1},
    {"median5", engine::FilterKind::kMedian, 5, 128.3},
    {"median31", engine::FilterKind::kMedian, 31, 408.7},
    {"Gaussian101", engine::FilterKind::kGaussian, 101, 258.9},
    {"median101", engine::FilterKind::kMedian, 101, 482.9},
};

// The same of a tile's window alone, where it is taken by itself: neither planning nor marks.
struct TileBudget {
  FilterBudget budget;
  std::unique_ptr<engine::TileWindow> (*make)(const engine::FilterSpec&, engine::CpuLevel);
};

constexpr TileBudget kTileBudgets[] = {
    {{"box3", engine::FilterKind::kBox, 3, 5.9}, engine::makeTileBox},
    {{"box5", engine::FilterKind::kBox, 5, 8.2}, engine::makeTileBox},
    {{"Gaussian3", engine::FilterKind::kGaussian, 3, 4.6}, engine::makeTileGaussian},
    {{"Gaussian7", engine::FilterKind::kGaussian, 7, 9.4}, engine::makeTileGaussian},
    {{"median3", engine::FilterKind::kMedian, 3, 6.0}, engine::makeTileMedian},
    {{"median5", engine::FilterKind::kMedian, 5, 20.3}, engine::makeTileMedian},
};

void expectWithin(const FilterBudget& budget, std::int64_t instructions) {
  const double each = static_cast<double>(instructions) / static_cast<double>(engine::kTileSamples);
  std::printf("%s: %.1f instructions a sample\n", budget.name, each);
  testing::Test::RecordProperty("instructions_a_sample", std::to_string(each));
  EXPECT_LE(each, 1.1 * budget.instructions) << budget.name << ": dearer than it was";
  EXPECT_GE(each, 0.75 * budget.instructions) << budget.name << ": cheaper; write the new figure down";
}

class FilterInstructions : public testing::TestWithParam<FilterBudget> {};

TEST_P(FilterInstructions, StayWithinTheirBudget) {
  if (!kReleased) GTEST_SKIP() << "not a release build";
  if (engine::bestCpuLevel() < engine::CpuLevel::kAvx2) GTEST_SKIP() << "the budgets are of AVX2";
  const FilterBudget& budget = GetParam();
  engine::Grid grid;
  grid.width = grid.height = engine::kTileSide;
  std::vector<float> z;
  for (std::int32_t r = 0; r < engine::kTileSide; ++r)
    for (std::int32_t c = 0; c < engine::kTileSide; ++c)
      z.push_back(0.01F * static_cast<float>(c) + 0.02F * static_cast<float>(whiteNoise(1, c, r)));
  const engine::Version field = engine::makeField(grid, z);
  engine::FilterSpec spec;
  spec.kind = budget.kind;
  spec.window = budget.window;
  spec.threads = 1;
  const auto run = [&] {
    engine::JobControl job;
    const auto filtered =
        engine::applyFilter(field, field, spec, engine::FilterTuning{0, engine::CpuLevel::kAvx2}, job);
    ASSERT_TRUE(filtered) << filtered.error().line();
  };
  run();  // what is made once is there
  const auto count = countInstructions(run);
  if (!count.instructions) GTEST_SKIP() << "instructions cannot be counted here";
  expectWithin(budget, *count.instructions);
}

INSTANTIATE_TEST_SUITE_P(Filters, FilterInstructions, testing::ValuesIn(kFilterBudgets),
                         [](const auto& tried) { return std::string(tried.param.name); });

class TileInstructions : public testing::TestWithParam<TileBudget> {};

TEST_P(TileInstructions, StayWithinTheirBudget) {
  if (!kReleased) GTEST_SKIP() << "not a release build";
  if (engine::bestCpuLevel() < engine::CpuLevel::kAvx2) GTEST_SKIP() << "the budgets are of AVX2";
  const FilterBudget& budget = GetParam().budget;
  engine::FilterSpec spec;
  spec.kind = budget.kind;
  spec.window = budget.window;
  const auto window = GetParam().make(spec, engine::CpuLevel::kAvx2);
  ASSERT_NE(window, nullptr);
  // Nine tiles, and room for results.
  std::vector<engine::Tile> tiles(10);
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t i = 0; i < engine::kTileSamples; ++i)
      tiles[k].samples[i] =
          0.02F * static_cast<float>(whiteNoise(1, static_cast<std::int32_t>(i % engine::kTileSide),
                                                static_cast<std::int32_t>(i / engine::kTileSide)));
  engine::TileAround around;
  for (std::size_t k = 0; k < 9; ++k) around[k / 3][k % 3] = tiles[k].samples.data();
  bool taken = false;
  const auto run = [&] { taken = window->run(around, tiles[9].samples.data()); };
  run();
  ASSERT_TRUE(taken);
  const auto count = countInstructions(run);
  if (!count.instructions) GTEST_SKIP() << "instructions cannot be counted here";
  expectWithin(budget, *count.instructions);
}

INSTANTIATE_TEST_SUITE_P(Tiles, TileInstructions, testing::ValuesIn(kTileBudgets),
                         [](const auto& tried) { return std::string(tried.param.budget.name); });

}  // namespace
}  // namespace fettle::bench
