// Several states of such a field, their marks and their original.
#include "render/residency/residency.h"

#include <cstdio>
#include <random>

#include "engine/field/live_field.h"
#include "engine/marks/change_marks.h"
#include "render/residency/page_table.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

TEST(Residency, PreviewsAndTheOriginalShareEqualPagesAndShowWhatTheyShould) {
  const engine::Version original = largeField();
  engine::LiveField live(original, engine::Growth::kAllowed);
  std::vector<float> z(120 * 90);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = 1.0F + 0.001F * static_cast<float>(i % 97);
  ASSERT_TRUE(live.writeHeights(700, 500, 120, 90, z.data(), 120));
  const engine::Version edited = live.snapshot();
  ASSERT_TRUE(live.writeHeights(760, 560, 100, 30, z.data(), 100));
  const engine::Version preview = live.snapshot();
  auto tight = makePicture({.budget = 3300000}), whole = makePicture();
  Shown shown;
  shown.versions = {edited};
  shown.marks = MarksOverlay::kShow;
  FrameInput input = bareAt(9);
  const auto compare = [&](const char* what) {
    SCOPED_TRACE(what);
    EXPECT_TRUE(tight->update(shown));
    EXPECT_TRUE(whole->update(shown));
    const Shot a = drawComplete(*tight, input), b = drawComplete(*whole, input);
    EXPECT_EQ(a.stats.residency.pages_over_budget, 0);
    EXPECT_EQ(differing(a.image, b.image), 0U);
    return a.stats.residency;
  };
  (void)compare("one version");
  shown.versions = {edited, preview};
  shown.original = original;
  input.range.reset();
  // Three states are looked at, but where they are alike there is one page. (What an earlier view asked for
  // is still there as well.)
  const ResidencyStatistics shared = compare("a preview and the deviation from the original");
  EXPECT_LT(shared.pages_used, shared.pages_requested * 3 / 4);
  // Both continue, independent of each other: what one of them changes is not the other's.
  ASSERT_TRUE(live.writeHeights(690, 530, 60, 60, z.data(), 60));
  shown.versions = {live.snapshot(), edited};
  (void)compare("an edit in pages that were shared");
  shown.versions = {edited, live.snapshot()};
  (void)compare("the other way round");
  shown.versions = {original};
  shown.original.reset();
  input.range = ValueRange{-3, 9};
  (void)compare("back to one");
}

// States of one field of which no two have a tile in common, as filters make them of every sample.
std::vector<engine::Version> statesOf(const engine::Version& field, std::size_t count) {
  const int width = field.grid().width, height = field.grid().height;
  std::vector<engine::Version> states{field};
  std::vector<float> row(static_cast<std::size_t>(width));
  for (std::size_t i = 1; i < count; ++i) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    for (int r = 0; r < height; ++r) {
      field.reader().readHeights(0, r, width, 1, row.data(), width);
      for (float& z : row) z *= 1.0F + 0.01F * static_cast<float>(i);
      if (!live.writeHeights(0, r, width, 1, row.data(), width)) ADD_FAILURE() << "no memory";
    }
    states.push_back(live.snapshot());
  }
  return states;
}

TEST(Residency, FourStatesSideBySideComeAsNearAsASinglePicture) {
  // Of a million samples, marks shown, three such states are there as a whole and four on demand.
  const engine::Version field =
      fieldOf(gridOf(1000, 850, 0.05, 0.05), kLargePart, [](int c, int r) { return (c + 2 * r) % 190 < 5; });
  auto picture = makePicture();
  Shown shown;
  shown.marks = MarksOverlay::kShow;
  shown.versions = {field};
  ASSERT_TRUE(picture->update(shown));
  FrameInput input = bareAt(1);
  // Four panels whose colours come from every sample: all of each state is asked for.
  input.view.width = 1100;
  input.view.height = 760;
  constexpr std::int64_t kRest = std::int64_t{1} << 20;
  input.panel_vertices = {kRest};
  const Shot one = drawComplete(*picture, input);
  ASSERT_EQ(one.stats.panels.size(), 1U);
  EXPECT_LE(one.stats.panels[0].bound_px, 1.0);
  const std::vector<engine::Version> states = statesOf(field, 5);
  for (const std::size_t count : {4U, 5U}) {
    SCOPED_TRACE(count);
    shown.versions.assign(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(count));
    // The last ones with a deviation map: an original is one more. Pages that are there are kept.
    if (count == states.size()) shown.original = field;
    ASSERT_TRUE(picture->update(shown));
    input.panel_vertices.assign(count, kRest);
    const Shot rest = drawComplete(*picture, input);
    EXPECT_TRUE(rest.stats.residency.on_demand);
    EXPECT_EQ(rest.stats.residency.pages_over_budget, 0);
    ASSERT_EQ(rest.stats.panels.size(), count);
    for (const PanelDetail& panel : rest.stats.panels) {
      EXPECT_LE(panel.bound_px, 1.0);
      EXPECT_EQ(panel.limit, DetailLimit::kNone);
    }
  }
  // As one sees it who opens all of them at once.
  auto other = makePicture();
  ASSERT_TRUE(other->update(shown));
  picture->refreshRanges();
  EXPECT_EQ(differing(drawComplete(*picture, input).image, drawComplete(*other, input).image), 0U);
}

TEST(Residency, WhatDoesNotFitIsSharedOutAmongThePanelsAndTheLimitSaid) {
  // A twelfth of what four states take.
  auto tight = makePicture({.budget = 2'400'000});
  Shown shown;
  shown.versions = statesOf(fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), kLargePart), 4);
  ASSERT_TRUE(tight->update(shown));
  FrameInput input = bareAt(1);
  input.view.width = 640;
  input.view.height = 400;
  input.error_px = 0.1;
  input.panel_vertices.assign(4, std::int64_t{1} << 20);
  const Shot rest = drawComplete(*tight, input);
  EXPECT_LE(rest.stats.residency.device_bytes, 2'400'000);
  EXPECT_GT(rest.stats.residency.pages_over_budget, 0);
  double best = 1e9, worst = 0.0;
  for (const PanelDetail& panel : rest.stats.panels) {
    EXPECT_EQ(panel.limit, DetailLimit::kMemory);
    best = std::min(best, panel.bound_px);
    worst = std::max(worst, panel.bound_px);
  }
  EXPECT_GT(best, 0.1);
  EXPECT_LT(worst, 2.0 * best);
  EXPECT_EQ(rest.stats.bound_px, worst);
  // And of vertices.
  auto whole = makePicture();
  ASSERT_TRUE(whole->update(shown.versions.front()));
  input.panel_vertices.assign(1, 4096);
  const Shot few = drawComplete(*whole, input);
  EXPECT_EQ(few.stats.panels.front().limit, DetailLimit::kVertices);
  // One number a panel, or none.
  Image image;
  input.panel_vertices.assign(2, 4096);
  EXPECT_FALSE(whole->draw(input, image));
  input.panel_vertices.assign(1, 0);
  EXPECT_FALSE(whole->draw(input, image));
}

TEST(Residency, SuggestedMarksHaveAColourOfTheirOwnAndLoseItWhenAccepted) {
  const engine::Version field = largeField();
  engine::JobControl job;
  const auto inverted = engine::invertMarks(field, job);
  ASSERT_TRUE(inverted);
  for (const double zoom : {1.0, 9.0}) {
    SCOPED_TRACE(zoom);
    auto tight = makePicture({.budget = 3300000}), whole = makePicture();
    const FrameInput input = bareAt(zoom);
    // From pages as from a whole, and as if nothing had been shown before.
    const auto seen = [&](const Shown& shown, const char* what) {
      SCOPED_TRACE(what);
      auto fresh = makePicture();
      for (auto* picture : {&tight, &whole, &fresh}) EXPECT_TRUE((*picture)->update(shown));
      const Shot a = drawComplete(*tight, input), b = drawComplete(*whole, input),
                 c = drawComplete(*fresh, input);
      EXPECT_EQ(differing(a.image, b.image), 0U);
      EXPECT_EQ(differing(b.image, c.image), 0U);
      return b.image;
    };
    Shown shown;
    shown.versions = {field};
    shown.marks = MarksOverlay::kShow;
    const Image before = seen(shown, "the marks there are");
    shown.versions = {*inverted};
    shown.accepted = field;
    const Image suggested = seen(shown, "suggested");
    EXPECT_GT(differing(before, suggested), 20000U);
    // The very same version, and no tile of it changes.
    shown.accepted = *inverted;
    const Image taken = seen(shown, "taken");
    EXPECT_GT(differing(suggested, taken), 20000U);
    shown.accepted.reset();
    EXPECT_EQ(differing(seen(shown, "marks like any others"), taken), 0U);
    shown.accepted = field;
    EXPECT_EQ(differing(seen(shown, "suggested again"), suggested), 0U);
    shown.versions = {field};
    shown.accepted.reset();
    EXPECT_EQ(differing(seen(shown, "dropped"), before), 0U);
  }
  // Of another field it says nothing.
  auto picture = makePicture();
  Shown shown;
  shown.versions = {field};
  shown.accepted = largeField();
  EXPECT_FALSE(picture->update(shown));
}

TEST(Residency, MoreVersionsMayTurnAWholeFieldIntoOneByNeedAndMarksMayComeLater) {
  const engine::Version field = largeField();
  engine::LiveField live(field, engine::Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(750, 550, 3.0F));
  // One fits, two do not.
  auto picture = makePicture({.budget = 10000000}), whole = makePicture();
  Shown shown;
  shown.versions = {field};
  ASSERT_TRUE(picture->update(shown));
  FrameInput input = bareAt(8);
  EXPECT_FALSE(drawComplete(*picture, input).stats.residency.on_demand);
  shown.versions = {live.snapshot(), field};
  ASSERT_TRUE(picture->update(shown));
  ASSERT_TRUE(whole->update(shown));
  const Shot two = drawComplete(*picture, input);
  EXPECT_TRUE(two.stats.residency.on_demand);
  EXPECT_EQ(differing(two.image, drawComplete(*whole, input).image), 0U);
  shown.versions = {field};
  shown.marks = MarksOverlay::kShow;
  ASSERT_TRUE(picture->update(shown));
  ASSERT_TRUE(whole->update(shown));
  const Shot one = drawComplete(*picture, input);
  EXPECT_TRUE(one.stats.residency.on_demand);
  EXPECT_LE(one.stats.residency.device_bytes, 10000000);
  EXPECT_EQ(differing(one.image, drawComplete(*whole, input).image), 0U);
  // A field of its own is looked at afresh.
  ASSERT_TRUE(picture->update(fieldOf(gridOf(300, 300, 0.05, 0.05), kLargePart)));
  EXPECT_FALSE(drawComplete(*picture, input).stats.residency.on_demand);
}

// What looking pages up costs, for the record; time is not judged here.

TEST(Residency, ALargePictureFromPagesIsTheSameAndItsTimeIsTold) {
  auto tight = makePicture({.budget = 5800000}), whole = makePicture();
  ASSERT_TRUE(tight->update(largeField()));
  ASSERT_TRUE(whole->update(largeField()));
  FrameInput input = bareAt(4);
  input.view.width = 1280;
  input.view.height = 800;
  const Shot a = drawComplete(*tight, input), b = drawComplete(*whole, input);
  EXPECT_EQ(a.stats.residency.pages_over_budget, 0);
  EXPECT_EQ(differing(a.image, b.image), 0U);
  const auto median = [](std::vector<double> ms) {
    std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
    return ms[ms.size() / 2];
  };
  std::vector<double> device[2], host[2];
  for (int i = 0; i < 9; ++i) {
    // A picture of which nothing changes would not be drawn again.
    input.view.azimuth_deg += 0.01;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      const auto stats = (k == 0 ? whole : tight)->drawAndWait(input);
      ASSERT_TRUE(stats);
      device[k].push_back(stats->device_ms);
      host[k].push_back(stats->select_ms + stats->record_ms);
    }
  }
  std::printf(
      "1280 x 800, medians of 9: whole %.1f ms drawing, %.2f ms on the host; on demand %.1f ms, %.2f ms\n",
      median(device[0]), median(host[0]), median(device[1]), median(host[1]));
}

TEST(Residency, ABudgetThatHoldsNotEvenTheCoarseCopiesIsRefused) {
  auto tight = makePicture({.budget = 40000});
  const auto refused = tight->update(largeField());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kFailed);
  // The picture is drawn with what fits.
  ASSERT_TRUE(tight->update(fieldOf(gridOf(64, 64, 1, 1), kLargePart)));
  EXPECT_FALSE(shoot(*tight, bareAt(1)).stats.residency.on_demand);
}

}  // namespace
}  // namespace fettle::render
