// A range from the noise is that of the scan as it was opened, also where filters have taken most of it away.
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "app/work/filter_preview.h"
#include "engine/filter/noise_range.h"
#include "tests/app/work/part.h"

namespace fettle::tests {
namespace {

using app::FilterPreview;

constexpr std::size_t kHistoryOfRanges = std::size_t{64} << 20;

class FilterRange : public testing::Test {
 protected:
  void SetUp() override {
    scan_ = roughPart();
    auto client =
        app::LoopClient::start(engine::History(scan_, kHistoryOfRanges), scan_, brushScene(), {}, nullptr);
    ASSERT_TRUE(client) << client.error().line();
    client_ = *std::move(client);
  }
  void TearDown() override {
    filters_.finish(*client_);
    for (const app::Notice& notice : notices_) ADD_FAILURE() << notice.what;
  }
  void until(const std::function<bool()>& is) {
    while (!is()) {
      client_->poll();
      (void)filters_.poll(*client_, notices_);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  [[nodiscard]] double measured(const engine::Version& field) const {
    engine::JobControl job;
    const auto ready = engine::withMeasuredRange(planes(), field, job);
    EXPECT_TRUE(ready);
    return ready ? ready->range_sigma : 0.0;
  }
  static engine::FilterSpec planes() {
    engine::FilterSpec spec;
    spec.kind = engine::FilterKind::kPlanes;
    return spec;
  }

  engine::Version scan_;
  std::unique_ptr<app::LoopClient> client_;
  FilterPreview filters_;
  std::vector<app::Notice> notices_;
};

TEST_F(FilterRange, IsThatOfTheScanAfterOtherFilters) {
  filters_.spec.kind = engine::FilterKind::kGaussian;
  filters_.spec.window = 5;
  EXPECT_FALSE(filters_.rangeOfNoise(*client_)) << "it has none";
  filters_.apply(*client_);
  until([&] { return filters_.applied() == 1 && client_->upright() == client_->history().current(); });
  EXPECT_EQ(client_->history().number(), 1);
  const double of_scan = measured(scan_);
  ASSERT_LT(measured(client_->newest()), 0.3 * of_scan) << "a filter that leaves most of the noise";
  // Before the number is known, and as it is then shown.
  filters_.spec = planes();
  filters_.compute(*client_, FilterPreview::Keep::kReplace);
  until([&] { return !filters_.computing(); });
  ASSERT_EQ(filters_.variants().size(), 1U);
  EXPECT_EQ(filters_.variants().front().spec.range_sigma, of_scan);
  EXPECT_EQ(filters_.variants().front().asked.range_sigma, 0.0);
  const std::uint64_t hash = engine::contentHash(filters_.variants().front().result.field);
  until([&] { return filters_.rangeOfNoise(*client_).has_value(); });
  EXPECT_EQ(*filters_.rangeOfNoise(*client_), of_scan);
  filters_.compute(*client_, FilterPreview::Keep::kReplace);
  until([&] { return !filters_.computing(); });
  EXPECT_EQ(filters_.variants().front().spec.range_sigma, of_scan);
  EXPECT_EQ(engine::contentHash(filters_.variants().front().result.field), hash);
  EXPECT_TRUE(filters_.isCurrent(filters_.variants().front())) << "the field still says 0";
  // What is typed is taken.
  filters_.spec.range_sigma = 0.25;
  filters_.compute(*client_, FilterPreview::Keep::kReplace);
  until([&] { return !filters_.computing(); });
  EXPECT_EQ(filters_.variants().front().spec.range_sigma, 0.25);
}

}  // namespace
}  // namespace fettle::tests
