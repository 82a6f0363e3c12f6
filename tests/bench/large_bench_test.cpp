// The whole way with a small field: every stage is there, what was saved is what was filtered, and a field in
// a store has the same bits.
#include "bench/large_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "bench/large_scan.h"
#include "engine/field/tile_store.h"
#include "engine/formats/formats.h"
#include "tests/support/temp_folder.h"

namespace fettle::bench {
namespace {

class Policy {
 public:
  explicit Policy(const engine::StorePolicy& policy) { engine::setStorePolicy(policy); }
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  ~Policy() { engine::setStorePolicy({}); }
};

LargeOptions small(const tests::TempFolder& folder) {
  LargeOptions options;
  options.side = 320;
  options.folder = folder.path().string();
  options.effort = 0.01;
  options.picture = false;
  return options;
}

TEST(LargeBench, GoesTheWholeWayAndLeavesNothingBehind) {
  const tests::TempFolder folder;
  engine::JobControl job;
  const auto report = benchLarge(small(folder), job);
  ASSERT_TRUE(report) << report.error().line();
  for (const char* name : {"make the scan", "open", "feel", "brush stroke", "snapshot", "undo the stroke",
                           "redo the stroke", "median 3 x 3", "undo the filter", "box 11 x 11", "save"})
    EXPECT_TRUE(std::ranges::any_of(report->stages, [&](const LargeStage& s) { return s.name == name; }))
        << name;
  for (const LargeStage& s : report->stages) {
    EXPECT_GT(s.seconds, 0.0) << s.name;
    EXPECT_GE(s.peak, s.own) << s.name;
    EXPECT_GT(s.resident, 320U * 320U * 4U) << s.name;
    EXPECT_EQ(s.plain.empty(), s.plain_seconds == 0.0) << s.name;
  }
  EXPECT_EQ(report->ticks.size(), 2U);
  EXPECT_GT(report->stroke_tiles, 0);
  EXPECT_GT(report->file_bytes, largeScanBytes(320));
  EXPECT_GT(report->saved_bytes, 1000U);
  EXPECT_EQ(report->stored_bytes, 0U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(LargeBench, AStoreGivesTheSameBits) {
  const tests::TempFolder folder;
  if (const auto store = engine::TileStore::create(folder.path().string(), 0); !store)
    GTEST_SKIP() << store.error().line();
  engine::JobControl job;
  const auto in_memory = benchLarge(small(folder), job);
  ASSERT_TRUE(in_memory) << in_memory.error().line();
  const Policy stored({.folder = folder.path().string(), .always = true});
  const auto in_store = benchLarge(small(folder), job);
  ASSERT_TRUE(in_store) << in_store.error().line();
  EXPECT_EQ(in_store->hash, in_memory->hash);
  EXPECT_EQ(in_store->stroke_tiles, in_memory->stroke_tiles);
  EXPECT_GT(in_store->stored_bytes, 320U * 320U * 4U);
  EXPECT_GE(in_store->loop.ticks, 100U);
  EXPECT_GT(in_store->loop.prefetched, 0U);
  EXPECT_EQ(in_memory->loop.not_prefetched, 0U);
}

TEST(LargeBench, TheScanIsASquareOfTheSizeAsked) {
  const tests::TempFolder folder;
  engine::JobControl job;
  const std::string path = folder.file("scan.tif");
  ASSERT_TRUE(writeLargeScan(path, 300, job));
  const auto scan = engine::importField(path, {}, job);
  ASSERT_TRUE(scan) << scan.error().line();
  const engine::Grid& grid = scan->field.grid();
  EXPECT_EQ(grid.width, 300);
  EXPECT_EQ(grid.height, 300);
  EXPECT_DOUBLE_EQ(grid.spacing_x, 0.05);
  EXPECT_DOUBLE_EQ(grid.spacing_y, 0.05);
  const engine::FieldSummary summary = engine::summarize(scan->field);
  EXPECT_EQ(summary.no_data, 0);
  EXPECT_GT(summary.max - summary.min, 1.5);
  EXPECT_LT(summary.max, 1.8);
}

TEST(LargeBench, WhatCannotBeIsRefusedBeforeAnythingIsWritten) {
  const tests::TempFolder folder;
  engine::JobControl job;
  LargeOptions options = small(folder);
  options.side = 100;
  EXPECT_EQ(benchLarge(options, job).error().kind, engine::ErrorKind::kInput);
  options = small(folder);
  options.effort = 2.0;
  EXPECT_EQ(benchLarge(options, job).error().kind, engine::ErrorKind::kInput);
  options = small(folder);
  options.folder = folder.file("none");
  EXPECT_EQ(benchLarge(options, job).error().kind, engine::ErrorKind::kInput);
  options = small(folder);
  job.cancel();
  EXPECT_EQ(benchLarge(options, job).error().kind, engine::ErrorKind::kCancelled);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace fettle::bench
