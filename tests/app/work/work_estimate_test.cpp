#include "app/work/work_estimate.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/memory.h"
#include "engine/field/builder.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

engine::Version plane() {
  engine::Grid grid;
  grid.width = grid.height = 256;
  return engine::makeField(grid, std::vector<float>(std::size_t{256} * 256, 1.0F));
}

// Work whose numbers alone matter.
class Room : public testing::Test {
 protected:
  [[nodiscard]] engine::Status check(const WorkEstimate& estimate, const std::string& out) {
    const PlannedWork work{field, field, {PlannedFilter{spec, compute}}, out, ".tif", {}};
    return checkRoom(estimate, work);
  }
  engine::Version field = plane();
  engine::FilterSpec spec;
  FilterCompute compute{Compute::kCpu, nullptr};
  tests::TempFolder folder;
};

TEST_F(Room, WhatFitsIsNotRefused) {
  WorkEstimate estimate;
  estimate.memory_bytes = engine::residentMemory().now + (1U << 20);
  estimate.disk_bytes = 1U << 20;
  EXPECT_TRUE(check(estimate, folder.file("o.tif")));
  EXPECT_TRUE(check(estimate, folder.file("no/such/folder/yet/o.tif")));
}

TEST_F(Room, AResultThatTheDiskCannotHoldIsRefusedWithBothFiguresAndARemedy) {
  WorkEstimate estimate;
  estimate.disk_bytes = std::uint64_t{1} << 60;
  const auto refused = check(estimate, folder.file("o.tif"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kFailed);
  EXPECT_NE(refused.error().line().find("about 1152921504.6 GB of disk"), std::string::npos)
      << refused.error().line();
  EXPECT_NE(refused.error().remedy.find("another disk"), std::string::npos);
  EXPECT_TRUE(check(estimate, "-")) << "standard output has no disk";
}

TEST_F(Room, KeptWorkCountsToTheDisk) {
  WorkEstimate estimate;
  estimate.kept_bytes = std::uint64_t{1} << 60;
  EXPECT_FALSE(check(estimate, folder.file("o.tif")));
}

TEST_F(Room, MemoryThatIsNotThereIsRefused) {
  if (engine::availableMemory() == 0) GTEST_SKIP() << "the system does not say how much there is";
  WorkEstimate estimate;
  estimate.memory_bytes = std::uint64_t{1} << 60;
  const auto refused = check(estimate, folder.file("o.tif"));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().remedy.find("--store"), std::string::npos);
}

TEST(WorkEstimateText, SaysTimeMemoryAndDisk) {
  WorkEstimate estimate;
  estimate.work_seconds = 250.0;
  estimate.write_seconds = 50.0;
  estimate.memory_bytes = 9'400'000'000;
  estimate.disk_bytes = 4'000'000'000;
  EXPECT_EQ(textOf(estimate), "about 5 min, 9.4 GB of memory and 4.0 GB of disk");
  estimate.store_bytes = 600'000'000;
  estimate.work_seconds = 20'000.0;
  EXPECT_EQ(textOf(estimate), "about 5.6 h, 9.4 GB of memory and 4.0 GB of disk, 600 MB of the store's");
}

TEST(WorkEstimate, OfAConstantFieldIsNoTimeAndNoTile) {
  const engine::Version field = plane();
  engine::FilterSpec spec;
  FilterCompute compute(Compute::kCpu, nullptr);
  const tests::TempFolder folder;
  engine::JobControl job;
  const PlannedWork work{field, field, {PlannedFilter{spec, compute}}, folder.file("o.tif"), ".tif",
                         {},    true};
  const auto estimate = estimateWork(work, true, job);
  ASSERT_TRUE(estimate);
  ASSERT_TRUE(estimate->has_value());
  EXPECT_EQ((*estimate)->kept_bytes, 0U);
  EXPECT_GE((*estimate)->disk_bytes, 256U * 256U * 4U);
  EXPECT_LT((*estimate)->disk_bytes, 300'000U);
  job.cancel();
  const auto cancelled = estimateWork(work, true, job);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().kind, engine::ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::app
