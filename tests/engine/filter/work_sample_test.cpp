// What a filter of a whole field will take, from some of its blocks.
#include "engine/filter/work_sample.h"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "engine/filter/pass.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

// Of a median of 5 with one thread, in blocks of 64 x 64.
std::optional<WorkSample> sampled(const Version& field, int passes, const SampleOptions& options = {}) {
  FilterSpec spec = makeSpec(FilterKind::kMedian, 5);
  spec.threads = 1;
  spec.passes = passes;
  const ApplyFilter apply = [&](const FilterSpec& once, FilterWork& work, JobControl& job) {
    FilterTuning tuning;
    tuning.block_side = 64;
    tuning.work = &work;
    return applyFilter(field, field, once, tuning, job);
  };
  JobControl job;
  auto sample = sampleWork(spec, apply, options, job);
  EXPECT_TRUE(sample) << sample.error().line();
  return sample ? *std::move(sample) : std::nullopt;
}

TEST(WorkSample, IsTakenWhereABlockIsASmallShareOfTheWorkOfAllPasses) {
  // 16 blocks: one of them is a 32nd of the work of two passes.
  const Version field =
      toVersion(formed(256, 256, [](int c, int r) { return static_cast<float>((c * 7 + r * 5) % 11); }));
  EXPECT_FALSE(sampled(field, 1));
  const auto two = sampled(field, 2);
  ASSERT_TRUE(two);
  EXPECT_GT(two->seconds, 0.0);
  EXPECT_EQ(two->changed_share, 1.0);
  EXPECT_EQ(two->block.column1 - two->block.column0, 1);
  EXPECT_EQ(two->block.row1 - two->block.row0, 1);
  EXPECT_TRUE(sampled(field, 1, {.most_share = 1.0 / 16.0}));
  EXPECT_FALSE(sampled(field, 1, {.most_share = 1.0 / 17.0}));
}

}  // namespace
}  // namespace fettle::engine::tests
