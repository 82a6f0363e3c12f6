// What an edit, an inversion or a result changes in the picture.
#include <random>

#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

TEST(Live, AnEditMovesItsRectangleOnlyAndThePictureEqualsAFreshOne) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  const engine::Version before =
      fieldOf(gridOf(640, 480, 0.1, 0.1), kPart, [](int c, int) { return c % 50 == 0; });
  Shown shown;
  shown.versions = {before};
  shown.marks = MarksOverlay::kShow;
  ASSERT_TRUE(picture->update(shown));
  FrameInput input = bare();
  const Shot first = shoot(*picture, input);
  EXPECT_EQ(first.stats.upload.tiles, 2 * 10 * 8);
  EXPECT_EQ(shoot(*picture, input).stats.upload.bytes, 0);

  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> bump(30 * 30);
  for (std::size_t i = 0; i < bump.size(); ++i) bump[i] = 6.0F + 0.01F * static_cast<float>(i % 7);
  ASSERT_TRUE(live.writeHeights(50, 50, 30, 30, bump.data(), 30));  // four tiles meet at (64, 64)
  ASSERT_TRUE(live.setMark(300, 10, !before.reader().markedAt(300, 10)));
  shown.versions = {live.snapshot()};
  ASSERT_TRUE(picture->update(shown));
  const Shot edited = shoot(*picture, input);
  EXPECT_EQ(edited.stats.upload.tiles, 4 + 1);
  EXPECT_EQ(edited.stats.upload.changed_samples, 900 + 1);
  EXPECT_EQ(edited.stats.upload.stalls, 0);
  EXPECT_EQ(edited.stats.upload.pending_tiles, 0);
  // At most a fifth more than the rectangles themselves, coarse copies included.
  EXPECT_LE(static_cast<double>(edited.stats.upload.bytes), 1.2 * (900 * 4 + 4));
  EXPECT_NE(edited.image.rgba, first.image.rgba);

  auto fresh = makePicture();
  ASSERT_TRUE(fresh->update(shown));
  // The colours' range is that of the field first seen: the same one for both.
  input.range = edited.stats.range;
  input.view.vertical_exaggeration = 1.0;
  EXPECT_EQ(shoot(*picture, input).image.rgba.size(), edited.image.rgba.size());
  picture->refreshRanges();
  EXPECT_EQ(shoot(*picture, input).image.rgba, shoot(*fresh, input).image.rgba);

  // Back again, as undo does; and upside down, which moves nothing.
  shown.versions = {before};
  ASSERT_TRUE(picture->update(shown));
  EXPECT_EQ(shoot(*picture, input).stats.upload.tiles, 5);
  shown.versions = {before.inverted()};
  ASSERT_TRUE(picture->update(shown));
  EXPECT_EQ(shoot(*picture, input).stats.upload.tiles, 0);
}

// Colours of a picture, counted coarsely: 32 steps of a channel.
std::size_t colours(const Image& image) {
  std::vector<int> codes;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    codes.push_back(image.rgba[i] >> 3 << 10 | image.rgba[i + 1] >> 3 << 5 | image.rgba[i + 2] >> 3);
  std::sort(codes.begin(), codes.end());
  return static_cast<std::size_t>(std::unique(codes.begin(), codes.end()) - codes.begin());
}

TEST(Live, AFieldTurnedUpsideDownIsSeenLikeOneThatCameSoAndBackAgain) {
  // Heights of which none is its own opposite: a range that stayed would leave nothing to be seen.
  const engine::Version field =
      fieldOf(gridOf(640, 480, 0.1, 0.1), [](int c, int r) { return 20.0 + kPart(c, r); });
  const engine::Version scan =
      fieldOf(gridOf(640, 480, 0.1, 0.1), [](int c, int r) { return 20.0 + 0.98 * kPart(c, r); });
  const engine::Version another = fieldOf(gridOf(8, 8), [](int c, int) { return c; });
  FrameInput input = bare(480, 320);
  input.decoration = Decoration::kFull;  // with the colour bar
  auto other = makePicture();
  for (const std::int64_t device_bytes : {0, 1'200'000}) {
    SCOPED_TRACE(device_bytes);
    // By need: a kPart that the pages have room for.
    if (device_bytes > 0) input.view.zoom = 6.0;
    LiveOptions options;
    options.validation = Validation::kOn;
    options.memory_budget_bytes = device_bytes;
    auto created = LivePicture::create(options);
    ASSERT_TRUE(created);
    LivePicture& picture = **created;
    // As it is seen now, and as one sees it who opens just this.
    const auto seen = [&](const Shown& shown, const char* what) {
      SCOPED_TRACE(what);
      EXPECT_TRUE(picture.update(shown));
      const Shot frame = drawComplete(picture, input);
      EXPECT_TRUE(other->update(another));
      EXPECT_TRUE(other->update(shown));
      const Shot expected = drawComplete(*other, input);
      EXPECT_EQ(frame.stats.residency.on_demand, device_bytes > 0);
      EXPECT_EQ(frame.stats.residency.pages_over_budget, 0);
      EXPECT_EQ(frame.stats.range, expected.stats.range);
      EXPECT_TRUE(frame.image.rgba == expected.image.rgba);
      return frame;
    };
    Shown shown;
    shown.versions = {field};
    const Shot upright = seen(shown, "as it came");
    const ValueRange range = upright.stats.range;
    EXPECT_GT(range.low, 15.0);
    const std::size_t many = colours(upright.image);
    EXPECT_GT(many, 200U);
    shown.versions = {field.inverted()};
    const Shot inverted = seen(shown, "upside down");
    EXPECT_EQ(inverted.stats.range, (ValueRange{-range.high, -range.low}));
    EXPECT_GT(colours(inverted.image), many / 2);
    if (device_bytes == 0) {
      // The deviation map on and off while it is.
      shown.original = scan.inverted();
      (void)seen(shown, "the deviation upside down");
      shown.original.reset();
      EXPECT_TRUE(seen(shown, "upside down without the deviation").image.rgba == inverted.image.rgba);
    }
    shown.versions = {field};
    EXPECT_TRUE(seen(shown, "back again").image.rgba == upright.image.rgba);
    if (device_bytes == 0) {
      shown.original = scan;
      (void)seen(shown, "the deviation");
      shown.versions = {field.inverted()};
      shown.original = scan.inverted();
      (void)seen(shown, "field and scan upside down");
      shown.original.reset();
    }
    // One state of each sign: both are within the colours.
    shown.versions = {field.inverted(), field};
    EXPECT_EQ(seen(shown, "one of each").stats.range, (ValueRange{-range.high, range.high}));
    shown.versions = {field, field.inverted()};
    EXPECT_EQ(seen(shown, "the other way round").stats.range, (ValueRange{-range.high, range.high}));
    shown.versions = {field};
    EXPECT_TRUE(seen(shown, "and one alone").image.rgba == upright.image.rgba);
  }
}

TEST(Live, ColoursDoNotSwimUnderABrushAndInvertingTwiceLeavesThemAsTheyWere) {
  const engine::Version field = partField();
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(field));
  const FrameInput input = bare();
  const ValueRange range = shoot(*picture, input).stats.range;
  engine::LiveField live(field, engine::Growth::kAllowed);
  const std::vector<float> high(100 * 100, 30.0F);
  ASSERT_TRUE(live.writeHeights(200, 200, 100, 100, high.data(), 100));
  ASSERT_TRUE(picture->update(live.snapshot()));
  const Shot edited = shoot(*picture, input);
  EXPECT_EQ(edited.stats.range, range);
  ASSERT_TRUE(picture->update(live.snapshot().inverted()));
  EXPECT_EQ(shoot(*picture, input).stats.range, (ValueRange{-range.high, -range.low}));
  ASSERT_TRUE(picture->update(live.snapshot()));
  EXPECT_TRUE(shoot(*picture, input).image.rgba == edited.image.rgba);
}

TEST(Live, AFilterResultComesOverInSharesAndEndsAsAFreshPicture) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.upload_bytes_per_frame = 200000;
  auto created = LivePicture::create(options);
  ASSERT_TRUE(created);
  LivePicture& picture = **created;
  const engine::Version before = partField();
  ASSERT_TRUE(picture.update(before));
  FrameInput input = bare();
  input.view.vertical_exaggeration = 1.0;
  input.range = ValueRange{-3, 9};
  (void)shoot(picture, input);
  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> z(640 * 480);
  for (int i = 0; i < 640 * 480; ++i)
    z[static_cast<std::size_t>(i)] = static_cast<float>(1.01 * kPart(i % 640, i / 640));
  ASSERT_TRUE(live.writeHeights(0, 0, 640, 480, z.data(), 640));
  ASSERT_TRUE(picture.update(live.snapshot()));
  int frames = 0;
  Shot frame;
  do {
    frame = shoot(picture, input);
    EXPECT_LE(frame.stats.upload.bytes, 200000 + 18000);
    EXPECT_EQ(frame.stats.upload.stalls, 0);
    // Another edit during the upload: of a tile still waiting, or one already there.
    if (frames == 2) {
      ASSERT_TRUE(live.setHeight(5, 5, 8.0F) && live.setHeight(600, 470, 8.0F));
      ASSERT_TRUE(picture.update(live.snapshot()));
    }
    ASSERT_LT(++frames, 100);
  } while (frame.stats.upload.pending_tiles > 0);
  EXPECT_GT(frames, 4);
  picture.refreshRanges();
  auto fresh = makePicture();
  ASSERT_TRUE(fresh->update(live.snapshot()));
  EXPECT_EQ(shoot(picture, input).image.rgba, shoot(*fresh, input).image.rgba);
}

TEST(Live, PagesAndCoarseCopiesGiveTheSamePixelsAsOneImage) {
  const engine::Version field = fieldOf(
      gridOf(1500, 700, 0.1, 0.1),
      [](int c, int r) { return (c * 13 + r * 7) % 401 == 0 ? kNan : kPart(c, r); },
      [](int c, int r) { return (c + r) % 90 < 4; });
  Shown shown;
  shown.versions = {field};
  shown.original = fieldOf(gridOf(1500, 700, 0.1, 0.1), [](int c, int r) { return 0.98 * kPart(c, r); });
  shown.marks = MarksOverlay::kShow;
  auto paged = makePicture({.max_side = 128}), plain = makePicture();
  ASSERT_TRUE(paged->update(shown));
  ASSERT_TRUE(plain->update(shown));
  for (const double zoom : {0.5, 1.0, 20.0}) {
    FrameInput input = bare();
    input.view.zoom = zoom;
    input.contours = Contours::kShow;
    const Shot a = shoot(*paged, input), b = shoot(*plain, input);
    EXPECT_EQ(a.image.rgba, b.image.rgba) << zoom;
  }
}

}  // namespace
}  // namespace fettle::render
