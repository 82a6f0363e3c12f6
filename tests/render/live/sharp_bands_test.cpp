// The first sharp picture after one with fewer pixels, band by band.
#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

FrameInput sharpened(FrameInput input, Sharpness sharpness) {
  input.sharpness = sharpness;
  input.redraw = FrameInput::Redraw::kInBands;
  input.range = ValueRange{-3, 9};
  return input;
}

// What a picture that draws nothing else shows.
Shot sharpOf(const engine::Version& field, FrameInput input) {
  input.redraw = FrameInput::Redraw::kAll;
  auto picture = makePicture();
  EXPECT_TRUE(picture->update(field));
  return drawComplete(*picture, input);
}

// A line that the surface hides in part, and a pen.
void addOverlays(Overlays& overlays) {
  for (const double z : {0.0, 4.0})
    overlays.lines.push_back({.from_mm = {5.0, 24.0, z}, .to_mm = {60.0, 24.0, z}});
  overlays.stylus = StylusBody{.tip_mm = {32.0, 24.0, 8.0}};
}

std::size_t differingRows(const Image& a, const Image& b) {
  std::size_t rows = 0;
  const std::size_t bytes = 4 * static_cast<std::size_t>(a.width);
  for (int y = 0; y < a.height; ++y)
    rows += std::memcmp(a.rgba.data() + y * bytes, b.rgba.data() + y * bytes, bytes) != 0 ? 1 : 0;
  return rows;
}

TEST(SharpBands, EndWithTheBitsOfTheSharpPicture) {
  for (const Sharpness before : {Sharpness::kHalf, Sharpness::kQuarter})
    for (FrameInput input : views()) {
      SCOPED_TRACE(testing::Message()
                   << static_cast<int>(before) << ' ' << input.view.azimuth_deg << ' '
                   << input.view.elevation_deg << ' ' << static_cast<int>(input.view.projection));
      input.view.width = 481;
      input.view.height = 323;
      input.decoration = Decoration::kFull;
      input.form = {.filtered_normals = true, .occlusion = 0.8, .cavity = 0.5};
      addOverlays(input.overlays);
      const Shot sharp = sharpOf(partField(), sharpened(input, Sharpness::kFull));
      auto picture = makePicture();
      ASSERT_TRUE(picture->update(partField()));
      const Shot less = drawComplete(*picture, sharpened(input, before));
      ASSERT_GT(differing(less.image, sharp.image), 500U);
      std::size_t rows = differingRows(less.image, sharp.image);
      int sharper = 0;
      for (int left = kSharpBands - 1; left >= 0; --left) {
        const Shot shot = shoot(*picture, sharpened(input, Sharpness::kFull));
        EXPECT_EQ(shot.stats.bands_left, left);
        EXPECT_TRUE(shot.stats.continued);
        EXPECT_LT(shot.stats.redrawn, 1.1 / kSharpBands);
        // Each band makes its rows sharp and leaves those below. Some lie beside the surface.
        const std::size_t still = differingRows(shot.image, sharp.image);
        EXPECT_LE(still, rows) << left;
        if (still < rows) ++sharper;
        EXPECT_EQ(differingRows(shot.image, less.image) + still, differingRows(less.image, sharp.image))
            << left;
        rows = still;
      }
      EXPECT_EQ(rows, 0U);
      EXPECT_GE(sharper, kSharpBands / 2);
      EXPECT_EQ(shoot(*picture, sharpened(input, Sharpness::kFull)).stats.redrawn, 0.0);
    }
}

TEST(SharpBands, OfSeveralPanelsAndOfASplitOneToo) {
  for (const Arrangement arrangement : {Arrangement::kSideBySide, Arrangement::kSplit}) {
    FrameInput input = bare(481, 323);
    input.decoration = Decoration::kFull;
    input.arrangement = arrangement;
    Shown shown;
    shown.versions = {partField(), fieldOf(gridOf(640, 480, 0.1, 0.1), MachinedPart{0.1, 0.03, 40.0})};
    const auto drawn = [&](LivePicture& picture, Sharpness sharpness, FrameInput::Redraw redraw) {
      FrameInput next = sharpened(input, sharpness);
      next.redraw = redraw;
      return shoot(picture, next);
    };
    auto picture = makePicture(), other = makePicture();
    ASSERT_TRUE(picture->update(shown));
    ASSERT_TRUE(other->update(shown));
    for (int i = 0; i < 4; ++i) {
      (void)drawn(*other, Sharpness::kFull, FrameInput::Redraw::kAll);
      (void)drawn(*picture, Sharpness::kHalf, FrameInput::Redraw::kAll);
    }
    for (int left = kSharpBands - 1; left >= 0; --left)
      EXPECT_EQ(drawn(*picture, Sharpness::kFull, FrameInput::Redraw::kInBands).stats.bands_left, left);
    EXPECT_EQ(differing(drawn(*picture, Sharpness::kFull, FrameInput::Redraw::kInBands).image,
                        drawn(*other, Sharpness::kFull, FrameInput::Redraw::kAll).image),
              0U);
  }
}

// With all that is left: a stroke goes on for long, with a pen over rows that have no depth yet.
TEST(SharpBands, AnEditInBetweenIsDrawnAtOnceWithAllThatIsLeft) {
  engine::LiveField live(partField(), engine::Growth::kAllowed);
  FrameInput input = bare();
  addOverlays(input.overlays);
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(live.snapshot()));
  (void)drawComplete(*picture, sharpened(input, Sharpness::kHalf));
  EXPECT_EQ(shoot(*picture, sharpened(input, Sharpness::kFull)).stats.bands_left, kSharpBands - 1);
  const std::vector<float> bump(10, 2.5F);
  for (int edit = 0; edit < 3; ++edit) {
    for (int r = 300; r < 310; ++r)
      ASSERT_TRUE(live.writeHeights(60 * edit + 100, r, 10, 1, bump.data(), 10));
    ASSERT_TRUE(picture->update(live.snapshot()));
    input.overlays.stylus->tip_mm.x += 3.0;
    const Shot edited = shoot(*picture, sharpened(input, Sharpness::kFull));
    EXPECT_EQ(edited.stats.bands_left, 0);
    EXPECT_FALSE(edited.stats.band);
    if (edit == 0) {
      EXPECT_EQ(edited.stats.redrawn, 1.0);
    } else {
      EXPECT_LT(edited.stats.redrawn, 0.1);
    }
    EXPECT_EQ(differing(edited.image, sharpOf(live.snapshot(), sharpened(input, Sharpness::kFull)).image),
              0U);
  }
}

TEST(SharpBands, WhatShowsSomethingElseIsDrawnAsAWhole) {
  const FrameInput input = bare();
  FrameInput turned = input, lit = input, sized = input, coloured = input;
  turned.view.azimuth_deg += 3.0;
  lit.light_azimuth_deg += 90.0;
  sized.view.width += 2;
  coloured.contours = Contours::kShow;
  for (const FrameInput& next : {turned, lit, sized, coloured}) {
    auto picture = makePicture();
    ASSERT_TRUE(picture->update(partField()));
    (void)drawComplete(*picture, sharpened(input, Sharpness::kHalf));
    const Shot whole = shoot(*picture, sharpened(next, Sharpness::kFull));
    EXPECT_EQ(whole.stats.redrawn, 1.0);
    EXPECT_EQ(whole.stats.bands_left, 0);
    EXPECT_EQ(differing(whole.image, sharpOf(partField(), sharpened(next, Sharpness::kFull)).image), 0U);
  }
}

TEST(SharpBands, OfAFieldOnDemandGoOnWhilePagesCome) {
  auto picture = makePicture({.budget = 24 << 20, .bytes_per_frame = 1 << 16});
  ASSERT_TRUE(picture->update(wideField(0.0)));
  const FrameInput input = bareAt(3.0, 0.4, 0.3);
  const Shot less = shoot(*picture, sharpened(input, Sharpness::kHalf));
  Shot shot;
  int coming = 0;
  for (int band = 0; band < kSharpBands; ++band) {
    shot = shoot(*picture, sharpened(input, Sharpness::kFull));
    EXPECT_TRUE(shot.stats.band);
    coming += shot.stats.residency.pages_waiting > 0;
  }
  EXPECT_TRUE(shot.stats.residency.on_demand);
  ASSERT_GT(coming, 1);
  EXPECT_GT(shot.stats.bands_left, 0) << "those that were drawn from other pages";
  // Each row is drawn.
  EXPECT_EQ(differingRows(shot.image, less.image), static_cast<std::size_t>(shot.image.height));
  for (int frames = 0; shot.stats.bands_left > 0 || shot.stats.upload.pending_tiles > 0; ++frames) {
    ASSERT_LT(frames, 2000);
    shot = shoot(*picture, sharpened(input, Sharpness::kFull));
  }
  FrameInput all = sharpened(input, Sharpness::kFull);
  all.redraw = FrameInput::Redraw::kAll;
  EXPECT_EQ(differing(shot.image, shoot(*picture, all).image), 0U);
}

TEST(SharpBands, OfAFieldOnDemandEndWithTheBitsOfTheSharpPicture) {
  auto picture = makePicture({.budget = 24 << 20, .bytes_per_frame = 1 << 18});
  ASSERT_TRUE(picture->update(wideField(0.0)));
  const FrameInput input = bareAt(3.0, 0.4, 0.3);
  (void)drawComplete(*picture, sharpened(input, Sharpness::kHalf));
  Shot shot = shoot(*picture, sharpened(input, Sharpness::kFull));
  EXPECT_TRUE(shot.stats.residency.on_demand);
  EXPECT_TRUE(shot.stats.continued);
  for (int frames = 0; shot.stats.bands_left > 0 || shot.stats.upload.pending_tiles > 0; ++frames) {
    ASSERT_LT(frames, 200);
    shot = shoot(*picture, sharpened(input, Sharpness::kFull));
  }
  FrameInput all = sharpened(input, Sharpness::kFull);
  all.redraw = FrameInput::Redraw::kAll;
  EXPECT_EQ(differing(shot.image, shoot(*picture, all).image), 0U);
}

}  // namespace
}  // namespace fettle::render
