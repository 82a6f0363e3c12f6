// Filled holes and levelled lines beside the field: adopted as they are, gone with the state that they are of.
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/work/form_change.h"
#include "app/work/height_tool.h"
#include "engine/field/live_field.h"
#include "engine/measure/form_fit.h"
#include "tests/app/work/part.h"

namespace fettle::tests {
namespace {

using app::HeightTool;

constexpr std::size_t kHistoryOfPreviews = std::size_t{64} << 20;

class HeightPreview : public testing::Test {
 protected:
  void SetUp() override {
    scan_ = roughPart();
    auto client =
        app::LoopClient::start(engine::History(scan_, kHistoryOfPreviews), scan_, brushScene(), {}, nullptr);
    ASSERT_TRUE(client) << client.error().line();
    client_ = *std::move(client);
    hash_ = engine::contentHash(scan_);
  }
  void TearDown() override {
    heights_.clear();
    for (const app::Notice& notice : notices_) ADD_FAILURE() << notice.what;
  }

  void poll() {
    client_->poll();
    (void)heights_.poll(*client_, notices_);
  }
  // As a window's frames look at it.
  void until(const std::function<bool()>& is) {
    while (!is()) {
      poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void untilRest() {
    until([&] { return !heights_.busy(); });
  }
  void previewAll(const haptic::HeightsMaker& maker) {
    heights_.preview(maker, {engine::allTiles(scan_.grid()), 115, 90});
  }
  [[nodiscard]] std::uint64_t madeBy(const haptic::HeightsMaker& maker) const {
    engine::JobControl job;
    const auto made = haptic::computeHeights(client_->newest(), maker, job);
    EXPECT_TRUE(made);
    return made ? engine::contentHash(made->field) : 0;
  }
  void mark(std::int32_t column) {
    const engine::Version base = client_->upright();
    engine::LiveField field(base, engine::Growth::kAllowed);
    ASSERT_TRUE(field.setMark(column, 20, true));
    ASSERT_TRUE(client_->change(base, field.snapshot(), "Box"));
  }
  [[nodiscard]] std::int64_t steps() const { return client_->history().number(); }

  engine::Version scan_;
  std::uint64_t hash_ = 0;
  std::unique_ptr<app::LoopClient> client_;
  HeightTool heights_;
  std::vector<app::Notice> notices_;
};

TEST_F(HeightPreview, BecomesTheStepAsItIs) {
  heights_.lines.method = engine::LineMethod::kMatching;
  const std::pair<haptic::HeightsMaker, const char*> kMakers[] = {
      {heights_.fill, "Fill holes: least curvature"}, {heights_.lines, "Level rows: matching, form stays"}};
  for (const auto& [maker, name] : kMakers) {
    const std::uint64_t expected = madeBy(maker);
    EXPECT_NE(expected, hash_);
    previewAll(maker);
    EXPECT_TRUE(heights_.busy());
    untilRest();
    ASSERT_TRUE(heights_.previews(maker));
    EXPECT_FALSE(heights_.found().empty());
    EXPECT_EQ(steps(), 0);
    EXPECT_EQ(engine::contentHash(client_->field()), hash_);
    const auto picture = heights_.picture();
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->title, name);
    EXPECT_EQ(engine::contentHash(picture->field), expected);
    if (std::holds_alternative<engine::FillOptions>(maker))
      heights_.fillHoles();
    else
      heights_.levelLines();
    // Nothing is worked out: one look is enough.
    poll();
    EXPECT_EQ(steps(), 1);
    EXPECT_FALSE(heights_.busy());
    EXPECT_EQ(heights_.previewed(), nullptr);
    EXPECT_FALSE(heights_.picture());
    EXPECT_EQ(client_->history().info(1).name, name);
    until([&] { return client_->upright() == client_->history().current(); });
    EXPECT_EQ(engine::contentHash(client_->field()), expected);
    client_->undo();
    until([&] { return engine::contentHash(client_->field()) == hash_; });
  }
}

// "0 of N samples removed" is of the field as it was then: there is no step with which it would go.
TEST_F(HeightPreview, WhatFoundNothingToDoIsForgottenWithAnotherState) {
  mark(30);
  until([&] { return client_->upright() == client_->history().current() && steps() == 1; });
  heights_.remove.heights = engine::RemoveOptions::Heights::kOutside;
  heights_.remove.high = 1e9;
  heights_.removeSamples();
  untilRest();
  EXPECT_TRUE(heights_.found().starts_with("0 of ")) << heights_.found();
  EXPECT_EQ(steps(), 1);
  poll();
  EXPECT_FALSE(heights_.found().empty()) << "nothing has changed";
  client_->undo();
  until([&] { return client_->upright() == client_->history().current() && steps() == 0; });
  until([&] { return heights_.found().empty(); });
}

TEST_F(HeightPreview, ARemovalIsNamedByItsLimitsAsTheyAreTyped) {
  using Heights = engine::RemoveOptions::Heights;
  const std::string unit = scan_.grid().height_unit.name;
  ASSERT_EQ(unit, "mm");
  engine::RemoveOptions remove;
  EXPECT_EQ(app::makerName(remove, scan_), "Remove unmarked samples");
  remove.region = engine::Region::kAll;
  remove.heights = Heights::kOutside;
  remove.high = 2.5;
  EXPECT_EQ(app::makerName(remove, scan_), "Remove all samples above 2.5 mm");
  // Upside down the same samples are chosen by the other limit; the panel shows them upright, and so does the name.
  EXPECT_EQ(app::makerName(engine::upsideDown(remove), scan_.inverted()), "Remove all samples above 2.5 mm");
  remove.low = 0.02;
  EXPECT_EQ(app::makerName(remove, scan_), "Remove all samples below 0.02 mm and above 2.5 mm");
  remove.region = engine::Region::kMarked;
  remove.heights = Heights::kBetween;
  EXPECT_EQ(app::makerName(remove, scan_), "Remove marked samples between 0.02 mm and 2.5 mm");
  remove.low = -0.0004;
  remove.high = 0.0002;
  EXPECT_EQ(app::makerName(remove, scan_), "Remove marked samples between -400 nm and 200 nm");
}

TEST_F(HeightPreview, OfOtherOptionsIsNotTheStep) {
  previewAll(heights_.fill);
  untilRest();
  heights_.fill.method = engine::FillMethod::kMembrane;
  EXPECT_FALSE(heights_.previews(heights_.fill));
  const std::uint64_t expected = madeBy(heights_.fill);
  heights_.fillHoles();
  untilRest();
  EXPECT_EQ(steps(), 1);
  EXPECT_EQ(engine::contentHash(client_->history().current()), expected);
  EXPECT_EQ(heights_.previewed(), nullptr);
}

TEST_F(HeightPreview, OnItsWayBecomesAStepWhenItIsThere) {
  const std::uint64_t expected = madeBy(heights_.fill);
  previewAll(heights_.fill);
  poll();
  heights_.fillHoles();
  untilRest();
  EXPECT_EQ(steps(), 1);
  EXPECT_EQ(heights_.previewed(), nullptr);
  EXPECT_EQ(engine::contentHash(client_->history().current()), expected);
}

TEST_F(HeightPreview, EndsWithTheStateThatItIsOf) {
  previewAll(heights_.fill);
  untilRest();
  ASSERT_TRUE(heights_.previews(heights_.fill));
  mark(40);
  poll();
  EXPECT_EQ(heights_.previewed(), nullptr);
  EXPECT_FALSE(heights_.picture());
  EXPECT_TRUE(heights_.found().empty());
  // On its way, too.
  until([&] { return client_->upright() == client_->history().current(); });
  previewAll(heights_.lines);
  poll();
  mark(50);
  until([&] { return client_->upright() == client_->history().current(); });
  untilRest();
  EXPECT_EQ(heights_.previewed(), nullptr);
  // An undo, and a stroke.
  previewAll(heights_.fill);
  untilRest();
  ASSERT_NE(heights_.previewed(), nullptr);
  client_->undo();
  poll();
  EXPECT_EQ(heights_.previewed(), nullptr);
  until([&] { return client_->upright() == client_->history().current(); });
  previewAll(heights_.fill);
  untilRest();
  ASSERT_NE(heights_.previewed(), nullptr);
  const engine::Grid& grid = scan_.grid();
  client_->setTool(haptic::Tool::kSmooth);
  client_->mouse()->setCursor({100 * grid.spacingXMm(), 25 * grid.spacingYMm(),
                               static_cast<double>(scan_.reader().heightAt(100, 25)) * grid.height_unit.mm});
  client_->mouse()->press(haptic::Tool::kSmooth);
  until([&] { return heights_.previewed() == nullptr; });
  client_->mouse()->release();
  EXPECT_NE(engine::contentHash(client_->field()), hash_);
}

TEST_F(HeightPreview, EndsWithAChangeOfFormShownOrOnItsWay) {
  const auto change = [&](app::FormStep step) {
    engine::JobControl job;
    const auto fit = engine::fitNominalForm(scan_, {}, job);
    ASSERT_TRUE(fit);
    const auto form = step == app::FormStep::kTakeOut ? std::make_shared<const engine::NominalForm>(fit->form)
                                                      : engine::FieldForm();
    auto made = app::makeFormChange(step, form, client_->newest(), client_->scan(), job);
    ASSERT_TRUE(made) << made.error().line();
    ASSERT_TRUE(client_->changeForm(*made));
  };
  for (const haptic::HeightsMaker& maker :
       {haptic::HeightsMaker(heights_.fill), haptic::HeightsMaker(heights_.lines)}) {
    previewAll(maker);
    untilRest();
    ASSERT_TRUE(heights_.previews(maker));
    change(app::FormStep::kTakeOut);
    poll();
    EXPECT_EQ(heights_.previewed(), nullptr);
    EXPECT_FALSE(heights_.picture());
    EXPECT_TRUE(heights_.found().empty());
    until([&] { return client_->field().formOver() != nullptr; });
    // On its way: what would come is of heights that are others now.
    previewAll(maker);
    poll();
    ASSERT_TRUE(heights_.busy());
    change(app::FormStep::kPutBack);
    untilRest();
    EXPECT_EQ(heights_.previewed(), nullptr);
    EXPECT_FALSE(heights_.picture());
    EXPECT_TRUE(heights_.found().empty());
    until([&] { return client_->field().formOver() == nullptr; });
    EXPECT_EQ(engine::contentHash(client_->field()), hash_);
  }
  EXPECT_EQ(steps(), 4) << "forms alone";
}

TEST_F(HeightPreview, EndsWithTheDocumentShownOrOnItsWay) {
  previewAll(heights_.fill);
  untilRest();
  ASSERT_NE(heights_.previewed(), nullptr);
  heights_.clear();
  EXPECT_EQ(heights_.previewed(), nullptr);
  EXPECT_FALSE(heights_.picture());
  EXPECT_TRUE(heights_.found().empty());
  // On its way, with another view.
  previewAll(heights_.fill);
  poll();
  ASSERT_TRUE(heights_.busy());
  heights_.look({{0, 0, 1, 1}, 20, 20});
  poll();
  heights_.clear();
  EXPECT_TRUE(heights_.soFar().empty());
  EXPECT_FALSE(heights_.picture());
  // The next document, with its own field: nothing of the one before comes.
  const engine::Version other = scan_.inverted();
  auto next =
      app::LoopClient::start(engine::History(other, kHistoryOfPreviews), other, brushScene(), {}, nullptr);
  ASSERT_TRUE(next) << next.error().line();
  client_ = *std::move(next);
  untilRest();
  EXPECT_EQ(heights_.previewed(), nullptr);
  EXPECT_FALSE(heights_.picture());
  EXPECT_TRUE(heights_.found().empty());
  EXPECT_EQ(steps(), 0);
  EXPECT_EQ(client_->field().reader().sign(), other.reader().sign());
}

// Large holes take seconds; the camera goes from a small one to one of these.
TEST_F(HeightPreview, FollowsTheCameraWhileTheRestIsWorkedOut) {
  constexpr int kSide = 300, kApart = 600;
  const engine::Version large = fieldOf(
      2 * kApart, 2 * kApart,
      [](int c, int r) {
        const int x = c % kApart - 200, y = r % kApart - 200;
        const bool hole = (x >= 0 && x < kSide && y >= 0 && y < kSide) || (c == 50 && r == 50);
        return hole ? std::nan("") : std::sin(0.01 * c) + std::cos(0.013 * r);
      },
      0.1, 0.1);
  auto client =
      app::LoopClient::start(engine::History(large, kHistoryOfPreviews), large, brushScene(), {}, nullptr);
  ASSERT_TRUE(client) << client.error().line();
  client_ = *std::move(client);
  heights_.preview(heights_.fill, {{0, 0, 2, 2}, 60, 60});
  until([&] { return !heights_.soFar().empty() || !heights_.busy(); });
  EXPECT_EQ(heights_.soFar(), "exact in view");
  EXPECT_TRUE(std::isfinite(heights_.picture()->field.reader().heightAt(50, 50)));
  EXPECT_TRUE(std::isnan(heights_.picture()->field.reader().heightAt(300, 300)));
  until([&] { return heights_.wantsView(); });
  heights_.look({{3, 3, 5, 5}, 350, 350});
  EXPECT_FALSE(heights_.wantsView()) << "not each frame";
  EXPECT_EQ(heights_.soFar(), "to come in view");
  until([&] { return heights_.soFar() != "to come in view" || !heights_.busy(); });
  ASSERT_TRUE(heights_.busy());
  EXPECT_EQ(heights_.soFar().rfind("approximate, off by about ", 0), 0U) << heights_.soFar();
  EXPECT_EQ(heights_.picture()->title, "Fill holes: least curvature: " + heights_.soFar());
  const engine::FieldReader shown = heights_.picture()->field.reader();
  EXPECT_NEAR(static_cast<double>(shown.heightAt(300, 300)), std::sin(3.0) + std::cos(3.9), 0.2);
  EXPECT_TRUE(std::isfinite(shown.heightAt(50, 50))) << "as it was";
  EXPECT_TRUE(std::isnan(shown.heightAt(900, 900))) << "not in view";
  heights_.cancel();
  untilRest();
  EXPECT_FALSE(heights_.picture());
}

TEST_F(HeightPreview, IsDroppedAndCancelled) {
  previewAll(heights_.fill);
  untilRest();
  heights_.dropPreview();
  EXPECT_FALSE(heights_.picture());
  heights_.applyPreview();
  poll();
  EXPECT_EQ(steps(), 0) << "there is none";
  previewAll(heights_.fill);
  poll();
  heights_.cancel();
  untilRest();
  EXPECT_EQ(heights_.previewed(), nullptr);
  EXPECT_FALSE(heights_.picture());
  EXPECT_EQ(steps(), 0);
}

TEST(EarlyState, SaysHowFarAPictureIs) {
  engine::EarlyPicture picture{roughPart(), 1, 0.4251, 0.0, std::nullopt};
  EXPECT_EQ(app::earlyState(picture), "42 % so far");
  picture.exact = 1.0;
  EXPECT_EQ(app::earlyState(picture), "exact in view");
  picture.exact = 0.0;
  picture.off = {0.0123, false};
  EXPECT_EQ(app::earlyState(picture), "approximate, off by 12.3 \u00b5m rms");
  picture.off->estimated = true;
  picture.exact = 0.0;
  EXPECT_EQ(app::earlyState(picture), "approximate, off by about 12.3 \u00b5m rms");
  picture.exact = 0.204;
  picture.untouched = 0.004;
  EXPECT_EQ(app::earlyState(picture), "approximate, off by about 12.3 \u00b5m rms, 20 % exact, 1 % to come");
}

}  // namespace
}  // namespace fettle::tests
