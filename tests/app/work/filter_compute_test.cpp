// Where a filter runs, and what becomes of it when its device fails.
#include "app/work/filter_compute.h"

#include <gtest/gtest.h>

#include "app/terminal.h"
#include "engine/field/difference.h"
#include "tests/engine/filter/cpu_tgv_device.h"
#include "tests/engine/filter/reference.h"

namespace fettle::app {
namespace {

using engine::tests::CpuTgvDevice;

class FilterComputeTest : public testing::Test {
 protected:
  // Warnings are kept instead of printed.
  void SetUp() override { setVoice({.json = true}); }
  void TearDown() override {
    (void)takeWarnings();
    setVoice({});
  }

  static engine::FilterSpec spec() {
    engine::FilterSpec s = engine::tests::makeSpec(engine::FilterKind::kGeneralisedVariation, 3);
    s.range_sigma = 0.1;
    return s;
  }
  engine::Result<engine::Filtered> apply(FilterCompute& compute) {
    engine::JobControl job;
    return compute.apply(field, field, spec(), job);
  }

  engine::Version field = engine::tests::toVersion(engine::tests::hardField("noise"));
  std::uint64_t by_processor = contentHash(engine::tests::filtered(field, spec()).field);
};

// With a device that fails in the middle of its first batch.
FilterCompute computeThatFails(Compute where, CpuTgvDevice*& device) {
  auto made = std::make_unique<CpuTgvDevice>();
  device = made.get();
  made->at_proceed = [] { return engine::Status(engine::failure("computing failed (lost)", "card")); };
  return {where, std::move(made)};
}

TEST_F(FilterComputeTest, uses_the_device_it_was_given) {
  auto made = std::make_unique<CpuTgvDevice>();
  const CpuTgvDevice& device = *made;
  FilterCompute compute(Compute::kAuto, std::move(made));
  const auto result = apply(compute);
  ASSERT_TRUE(result);
  EXPECT_EQ(device.squares, 1U);
  EXPECT_EQ(compute.device(), device.name());
  FilterCompute without(Compute::kAuto, nullptr);
  EXPECT_EQ(contentHash(apply(without)->field), by_processor);
  EXPECT_EQ(without.device(), "");
  EXPECT_TRUE(takeWarnings().empty());
}

TEST_F(FilterComputeTest, by_itself_falls_back_to_the_processor_with_one_warning) {
  CpuTgvDevice* device = nullptr;
  FilterCompute compute = computeThatFails(Compute::kAuto, device);
  for (int scan = 0; scan < 2; ++scan) {
    const auto result = apply(compute);
    ASSERT_TRUE(result) << result.error().line();
    EXPECT_EQ(contentHash(result->field), by_processor);
    EXPECT_EQ(compute.device(), "");
  }
  const std::vector<std::string> warnings = takeWarnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("computing failed (lost), card"), std::string::npos) << warnings[0];
}

TEST_F(FilterComputeTest, on_request_is_an_error_where_the_device_fails) {
  CpuTgvDevice* device = nullptr;
  FilterCompute compute = computeThatFails(Compute::kGpu, device);
  const auto result = apply(compute);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().what, "computing failed (lost)");
  EXPECT_EQ(device->dropped, 1U);
  EXPECT_TRUE(takeWarnings().empty());
}

TEST_F(FilterComputeTest, that_is_cancelled_does_not_begin_again_on_the_processor) {
  auto made = std::make_unique<CpuTgvDevice>();
  engine::JobControl job;
  made->at_proceed = [&job] {
    job.cancel();
    return engine::Status();
  };
  FilterCompute compute(Compute::kAuto, std::move(made));
  const auto result = compute.apply(field, field, spec(), job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, engine::ErrorKind::kCancelled);
  EXPECT_NE(compute.device(), "");
}

}  // namespace
}  // namespace fettle::app
