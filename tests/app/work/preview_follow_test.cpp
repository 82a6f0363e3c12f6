// Previews that follow the fields that they are of: soon after the last change, and with the bits of the filter.
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "app/work/filter_preview.h"
#include "app/work/height_tool.h"
#include "tests/app/work/part.h"

namespace fettle::tests {
namespace {

using app::FilterPreview;
using app::HeightTool;
using app::PreviewPace;

constexpr std::size_t kHistoryOfFollowing = std::size_t{64} << 20;

class PreviewFollow : public testing::Test {
 protected:
  void SetUp() override {
    scan_ = roughPart();
    auto client =
        app::LoopClient::start(engine::History(scan_, kHistoryOfFollowing), scan_, brushScene(), {}, nullptr);
    ASSERT_TRUE(client) << client.error().line();
    client_ = *std::move(client);
    filters_.spec.kind = engine::FilterKind::kMedian;
  }
  void TearDown() override {
    filters_.finish(*client_);
    heights_.clear();
    for (const app::Notice& notice : notices_) ADD_FAILURE() << notice.what;
  }

  // A frame of the window.
  void poll() {
    client_->poll();
    (void)filters_.poll(*client_, notices_);
    filters_.follow(*client_, [this] { return all(); });
    (void)heights_.poll(*client_, notices_);
    heights_.follow([this] { return all(); });
  }
  void until(const std::function<bool()>& is) {
    while (!is()) {
      poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  // Long enough that what follows would have begun.
  void pollOn() {
    const auto end = PreviewPace::Clock::now() + 2 * PreviewPace::kRest;
    until([&] { return PreviewPace::Clock::now() > end; });
  }
  [[nodiscard]] engine::FieldView all() const { return {engine::allTiles(scan_.grid()), 115, 90}; }
  void preview(FilterPreview::Keep keep = FilterPreview::Keep::kReplace) {
    filters_.compute(*client_, keep, all());
    until([&] { return !filters_.computing(); });
  }
  [[nodiscard]] std::vector<int> windows() const {
    std::vector<int> windows;
    for (const auto& variant : filters_.variants()) windows.push_back(variant.asked.window);
    return windows;
  }

  engine::Version scan_;
  std::unique_ptr<app::LoopClient> client_;
  FilterPreview filters_;
  HeightTool heights_;
  std::vector<app::Notice> notices_;
};

TEST_F(PreviewFollow, ShowsWhatTheFieldsSayAndHasTheBitsOfTheFilter) {
  preview();
  ASSERT_EQ(windows(), std::vector{3});
  poll();
  filters_.spec.window = 7;
  until([&] { return windows() == std::vector{7}; });
  EXPECT_FALSE(filters_.isBehind());
  engine::JobControl job;
  const auto expected = engine::applyFilter(scan_, scan_, filters_.spec, job);
  ASSERT_TRUE(expected);
  EXPECT_EQ(engine::contentHash(filters_.variants().front().result.field),
            engine::contentHash(expected->field));
  EXPECT_EQ(client_->history().number(), 0) << "it is no step";
  filters_.apply(*client_);
  until([&] { return filters_.applied() == 1 && client_->history().number() == 1; });
  EXPECT_EQ(engine::contentHash(client_->history().current()), engine::contentHash(expected->field));
}

TEST_F(PreviewFollow, BeginsWhenTheFieldsRestAndNotBefore) {
  preview();
  poll();
  const auto end = PreviewPace::Clock::now() + 2 * PreviewPace::kRest;
  while (PreviewPace::Clock::now() < end) {
    filters_.spec.window = filters_.spec.window == 9 ? 11 : 9;
    poll();
    ASSERT_TRUE(filters_.awaitsRest());
    ASSERT_FALSE(filters_.computing());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  filters_.spec.window = 13;
  until([&] { return windows() == std::vector{13}; });
  EXPECT_FALSE(filters_.awaitsRest());
}

TEST_F(PreviewFollow, ComputesNothingForValuesThatAreThoseShownAgain) {
  preview();
  poll();
  filters_.spec.window = 5;
  poll();
  filters_.spec.window = 3;
  const engine::Version shown = filters_.variants().front().result.field;
  until([&] { return !filters_.awaitsRest(); });
  EXPECT_FALSE(filters_.computing());
  EXPECT_TRUE(filters_.variants().front().result.field == shown);
}

// What is computed of values that were changed since ends at once, so that the next ones need not wait for it.
TEST_F(PreviewFollow, CancelsWhatIsComputedOfOtherValues) {
  preview();
  poll();
  filters_.spec.window = 301;
  filters_.spec.passes = 1000;
  until([&] { return filters_.computing(); });
  filters_.spec.window = 5;
  filters_.spec.passes = 1;
  poll();
  // Its bar is gone, the buttons are there.
  EXPECT_TRUE(filters_.followsSoon());
  until([&] { return windows() == std::vector{5}; });
  EXPECT_EQ(filters_.variants().front().asked.passes, 1);
}

TEST_F(PreviewFollow, OfSeveralTheNewestFollows) {
  preview();
  filters_.spec.window = 5;
  preview(FilterPreview::Keep::kAdd);
  ASSERT_EQ(windows(), (std::vector{3, 5}));
  poll();
  filters_.spec.window = 9;
  until([&] { return windows() == std::vector{3, 9}; });
  // One that is dropped is not replaced by another.
  filters_.drop(1);
  pollOn();
  EXPECT_EQ(windows(), std::vector{3});
  EXPECT_TRUE(filters_.isBehind());
}

TEST_F(PreviewFollow, AnotherFilterAndOneWithoutAPreviewWait) {
  poll();
  filters_.spec.window = 5;
  pollOn();
  EXPECT_TRUE(filters_.variants().empty());
  EXPECT_FALSE(filters_.isBehind()) << "nothing is shown";
  preview();
  filters_.spec.kind = engine::FilterKind::kGaussian;
  pollOn();
  ASSERT_EQ(filters_.variants().size(), 1U);
  EXPECT_EQ(filters_.variants().front().asked.kind, engine::FilterKind::kMedian);
  EXPECT_TRUE(filters_.isBehind());
}

TEST_F(PreviewFollow, EscapeEndsIt) {
  preview();
  poll();
  filters_.spec.window = 5;
  poll();
  ASSERT_TRUE(filters_.awaitsRest());
  filters_.cancel(*client_);
  pollOn();
  EXPECT_TRUE(filters_.variants().empty());
  EXPECT_FALSE(filters_.computing());
}

// Apply does what the fields say, also before the preview shows it.
TEST_F(PreviewFollow, ApplyTakesTheFieldsAsTheyAre) {
  preview();
  poll();
  filters_.spec.window = 9;
  poll();
  filters_.apply(*client_);
  until([&] { return filters_.applied() == 1; });
  engine::JobControl job;
  const auto expected = engine::applyFilter(scan_, scan_, filters_.spec, job);
  until([&] { return client_->history().number() == 1; });
  EXPECT_EQ(engine::contentHash(client_->history().current()), engine::contentHash(expected->field));
}

TEST_F(PreviewFollow, RemovedSamplesAndFilledHolesFollowTheirFields) {
  heights_.remove = {.heights = engine::RemoveOptions::Heights::kOutside, .low = 0.0};
  heights_.preview(heights_.remove, all());
  until([&] { return heights_.previews(heights_.remove); });
  poll();
  const engine::HeightBounds bounds = scan_.reader().bounds();
  heights_.remove.low = 0.5 * (bounds.min + bounds.max);
  EXPECT_FALSE(heights_.previews(heights_.remove));
  until([&] { return heights_.previews(heights_.remove); });
  engine::JobControl job;
  const auto expected = engine::removeSamples(scan_, heights_.remove, job);
  ASSERT_TRUE(expected);
  ASSERT_GT(expected->counts.removed, 100);
  EXPECT_EQ(engine::contentHash(heights_.picture()->field), engine::contentHash(expected->field));
  // Values that choose everything are no step and no notice: the panel says so.
  heights_.remove.low = 10.0 * bounds.max;
  until([&] { return heights_.found() == "every sample would be removed"; });
  EXPECT_FALSE(heights_.previews(heights_.remove));
  heights_.remove.low = 0.0;
  until([&] { return heights_.previews(heights_.remove); });
  EXPECT_NE(heights_.found().find("removes "), std::string::npos) << heights_.found();
  heights_.preview(heights_.fill, all());
  until([&] { return heights_.previews(heights_.fill); });
  poll();
  heights_.fill.method = engine::FillMethod::kMembrane;
  until([&] { return heights_.previews(heights_.fill); });
  EXPECT_EQ(client_->history().number(), 0);
}

}  // namespace
}  // namespace fettle::tests
