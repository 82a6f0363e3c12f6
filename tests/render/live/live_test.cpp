// The live picture on a device, validation layers on.
#include "render/live/live_picture.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/field/live_field.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

double hash01(int c, int r) {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return (h >> 8U) / 16777216.0;
}

// A machined part in little: slopes, a boss and a groove with steep walls, a dome, some noise.
double part(int c, int r) {
  const double x = c * 0.1, y = r * 0.1;
  double z = 0.02 * x + 0.01 * hash01(c, r);
  if (std::hypot(x - 20, y - 30) < 9) z += 5;
  if (y > 8 && y < 12) z -= 3;
  const double dome = std::hypot(x - 45, y - 25);
  if (dome < 12) z += std::sqrt(144 - dome * dome) * 0.5;
  return z;
}

engine::Version partField(int w = 640, int h = 480) {
  return fieldOf(gridOf(w, h, 0.1, 0.1), part);
}

FrameInput bare(int width = 480, int height = 320) {
  FrameInput input;
  input.view.width = width;
  input.view.height = height;
  input.decoration = Decoration::kNone;
  return input;
}

// The surface at full resolution.
FrameInput full(FrameInput input) {
  input.error_px = 1e-9;
  input.vertex_budget = 1 << 24;
  return input;
}

std::unique_ptr<LivePicture> makePicture(int max_image_side = 0) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.max_image_side = max_image_side;
  auto picture = LivePicture::create(options);
  if (!picture) ADD_FAILURE() << picture.error().line();
  return picture ? *std::move(picture) : nullptr;
}

struct Frame {
  Image image;
  FrameStatistics stats;
};

Frame shoot(LivePicture& picture, const FrameInput& input) {
  Frame frame;
  const auto stats = picture.draw(input, frame.image);
  if (!stats) {
    ADD_FAILURE() << stats.error().line();
    return frame;
  }
  for (const std::string& message : picture.validationMessages()) ADD_FAILURE() << message;
  frame.stats = *stats;
  return frame;
}

// The first frame for which nothing is left to be moved or measured.
Frame settled(LivePicture& picture, const FrameInput& input) {
  Frame frame;
  for (int i = 0; i < 1000; ++i) {
    frame = shoot(picture, input);
    if (frame.stats.upload.pending_tiles == 0) return frame;
  }
  ADD_FAILURE() << "never at rest";
  return frame;
}

std::vector<FrameInput> views() {
  std::vector<FrameInput> all;
  for (const auto& [azimuth, elevation, zoom] :
       {std::tuple{0.0, 90.0, 1.0}, {315.0, 45.0, 1.0}, {20.0, 25.0, 1.0}, {100.0, 60.0, 2.5}}) {
    FrameInput input = bare();
    input.view.azimuth_deg = azimuth;
    input.view.elevation_deg = elevation;
    input.view.zoom = zoom;
    all.push_back(input);
    input.view.projection = Projection::kPerspective;
    all.push_back(input);
  }
  return all;
}

// Pixels of `a` that no pixel of `b` within `radius` equals within `codes` in every channel.
int unmatched(const Image& a, const Image& b, int radius, int codes) {
  int off = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      bool found = false;
      for (int v = std::max(0, y - radius); v <= std::min(a.height - 1, y + radius) && !found; ++v)
        for (int u = std::max(0, x - radius); u <= std::min(a.width - 1, x + radius) && !found; ++u) {
          int worst = 0;
          for (int k = 0; k < 3; ++k)
            worst = std::max(worst, std::abs(pixel(a, x, y)[k] - pixel(b, u, v)[k]));
          found = worst <= codes;
        }
      off += !found;
    }
  return off;
}

TEST(Live, TheCoarsePictureLiesWithinItsBoundOfTheFullOne) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  for (const FrameInput& view : views()) {
    SCOPED_TRACE(testing::Message() << view.view.azimuth_deg << ' ' << view.view.elevation_deg << ' '
                                    << static_cast<int>(view.view.projection));
    const Frame fine = shoot(*picture, full(view));
    EXPECT_LE(fine.stats.bound_px, 1e-9);
    for (const double error : {1.0, 3.0}) {
      FrameInput input = view;
      input.error_px = error;
      input.vertex_budget = 1 << 21;
      const Frame coarse = shoot(*picture, input);
      EXPECT_LE(coarse.stats.bound_px, error);
      EXPECT_LE(coarse.stats.vertices, fine.stats.vertices);
      // A displaced point falls on a pixel at most the bound plus a pixel away; what is seen between two rays
      // is not in the picture at all, so that along edges some pixels have no partner: 2 in a thousand, of
      // noise and walls.
      const int radius = static_cast<int>(std::ceil(error)) + 1;
      const int pixels = coarse.image.width * coarse.image.height;
      EXPECT_LE(unmatched(coarse.image, fine.image, radius, 10), pixels / 500) << error;
      EXPECT_LE(unmatched(fine.image, coarse.image, radius, 10), pixels / 500) << error;
    }
  }
}

TEST(Live, NoGroundShowsInsideTheSurfaceAtAnyMixOfStrides) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  // No holes, so no plate lies under the surface: whatever shines through is the ground.
  for (const engine::Version& field : {partField(), fieldOf(gridOf(700, 500, 0.1, 0.1), [](int c, int r) {
                                         return hash01(c / 90, r / 70) < 0.4 ? 0.8 * hash01(c, r) : 0.002 * c;
                                       })}) {
    ASSERT_TRUE(picture->update(field));
    for (FrameInput input : views()) {
      std::vector<char> solid;      // by pixel: the surface lies there, whatever the strides
      input.theme = Theme::kLight;  // no colour of the surface is as light as its ground
      for (const double error : {1.0, 5.0}) {
        input.error_px = error;
        const Frame frame = shoot(*picture, input);
        const int reach = static_cast<int>(std::ceil(frame.stats.bound_px)) + 1;
        // The ground's own colour, from an empty picture.
        FrameInput away = input;
        away.view.zoom = 1e-3;
        const Frame ground = shoot(*picture, away);
        (void)shoot(*picture, input);
        int inside = 0;
        if (solid.empty())
          for (int y = 0; y < input.view.height; ++y)
            for (int x = 0; x < input.view.width; ++x)
              solid.push_back(picture->pick(x + 0.5, y + 0.5).has_value());
        for (int y = reach; y < input.view.height - reach; ++y)
          for (int x = reach; x < input.view.width - reach; ++x) {
            bool deep = true;
            for (int v = -reach; v <= reach && deep; ++v)
              for (int u = -reach; u <= reach && deep; ++u)
                deep = solid[static_cast<std::size_t>((y + v) * input.view.width + x + u)] != 0;
            if (!deep) continue;
            ++inside;
            ASSERT_FALSE(
                std::equal(pixel(frame.image, x, y), pixel(frame.image, x, y) + 3, pixel(ground.image, 0, 0)))
                << x << ' ' << y << " at " << input.view.azimuth_deg << ' ' << input.view.elevation_deg
                << " error " << error;
          }
        EXPECT_GT(inside, 15000);
      }
    }
  }
}

TEST(Live, AnEditMovesItsRectangleOnlyAndThePictureEqualsAFreshOne) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  const engine::Version before =
      fieldOf(gridOf(640, 480, 0.1, 0.1), part, [](int c, int) { return c % 50 == 0; });
  Shown shown;
  shown.versions = {before};
  shown.marks = MarksOverlay::kShow;
  ASSERT_TRUE(picture->update(shown));
  FrameInput input = bare();
  const Frame first = shoot(*picture, input);
  EXPECT_EQ(first.stats.upload.tiles, 2 * 10 * 8);
  EXPECT_EQ(shoot(*picture, input).stats.upload.bytes, 0);

  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> bump(30 * 30);
  for (std::size_t i = 0; i < bump.size(); ++i) bump[i] = 6.0F + 0.01F * static_cast<float>(i % 7);
  ASSERT_TRUE(live.writeHeights(50, 50, 30, 30, bump.data(), 30));  // four tiles meet at (64, 64)
  ASSERT_TRUE(live.setMark(300, 10, !before.reader().markedAt(300, 10)));
  shown.versions = {live.snapshot()};
  ASSERT_TRUE(picture->update(shown));
  const Frame edited = shoot(*picture, input);
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
      fieldOf(gridOf(640, 480, 0.1, 0.1), [](int c, int r) { return 20.0 + part(c, r); });
  const engine::Version scan =
      fieldOf(gridOf(640, 480, 0.1, 0.1), [](int c, int r) { return 20.0 + 0.98 * part(c, r); });
  const engine::Version another = fieldOf(gridOf(8, 8), [](int c, int) { return c; });
  FrameInput input = bare(480, 320);
  input.decoration = Decoration::kFull;  // with the colour bar
  auto other = makePicture();
  for (const std::int64_t device_bytes : {0, 1'200'000}) {
    SCOPED_TRACE(device_bytes);
    // By need: a part that the pages have room for.
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
      const Frame frame = settled(picture, input);
      EXPECT_TRUE(other->update(another));
      EXPECT_TRUE(other->update(shown));
      const Frame expected = settled(*other, input);
      EXPECT_EQ(frame.stats.residency.by_need, device_bytes > 0);
      EXPECT_EQ(frame.stats.residency.pages_beyond, 0);
      EXPECT_EQ(frame.stats.range, expected.stats.range);
      EXPECT_TRUE(frame.image.rgba == expected.image.rgba);
      return frame;
    };
    Shown shown;
    shown.versions = {field};
    const Frame upright = seen(shown, "as it came");
    const ValueRange range = upright.stats.range;
    EXPECT_GT(range.low, 15.0);
    const std::size_t many = colours(upright.image);
    EXPECT_GT(many, 200U);
    shown.versions = {field.inverted()};
    const Frame inverted = seen(shown, "upside down");
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
  const Frame edited = shoot(*picture, input);
  EXPECT_EQ(edited.stats.range, range);
  ASSERT_TRUE(picture->update(live.snapshot().inverted()));
  EXPECT_EQ(shoot(*picture, input).stats.range, (ValueRange{-range.high, -range.low}));
  ASSERT_TRUE(picture->update(live.snapshot()));
  EXPECT_TRUE(shoot(*picture, input).image.rgba == edited.image.rgba);
}

TEST(Live, AFilterResultComesOverInSharesAndEndsAsAFreshPicture) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.upload_bytes_a_frame = 200000;
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
    z[static_cast<std::size_t>(i)] = static_cast<float>(1.01 * part(i % 640, i / 640));
  ASSERT_TRUE(live.writeHeights(0, 0, 640, 480, z.data(), 640));
  ASSERT_TRUE(picture.update(live.snapshot()));
  int frames = 0;
  Frame frame;
  do {
    frame = shoot(picture, input);
    EXPECT_LE(frame.stats.upload.bytes, 200000 + 18000);
    EXPECT_EQ(frame.stats.upload.stalls, 0);
    // Another edit while it is under way: of a tile still waiting, or one already there.
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

TEST(Live, NoFrameMeasuresMoreTilesThanItMayAndEachBoundHolds) {
  // 33 x 16 tiles: twice what a frame may measure.
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  const engine::Version before = partField(2100, 1000);
  constexpr std::int64_t kTiles = 33 * 16, kMost = kMeasuredAFrame;
  ASSERT_GT(kTiles, 2 * kMost);
  FrameInput input = bare();
  input.range = ValueRange{-3, 9};
  input.view.vertical_exaggeration = 1.0;
  input.vertex_budget = 1 << 22;
  std::optional<Frame> fine;
  const auto settle = [&] {
    // Until a frame is the last one: those before differ from the surface at full resolution by what they
    // say.
    for (int frames = 1; frames < 100; ++frames) {
      const Frame frame = shoot(*picture, input);
      EXPECT_LE(frame.stats.upload.measured_tiles, kMost);
      EXPECT_LE(frame.stats.bound_px, input.error_px);
      EXPECT_TRUE(frame.stats.within_budget);
      if (fine) {
        const int pixels = frame.image.width * frame.image.height;
        EXPECT_LE(unmatched(frame.image, fine->image, 2, 10), pixels / 500) << frames;
        EXPECT_LE(unmatched(fine->image, frame.image, 2, 10), pixels / 500) << frames;
      }
      if (frame.stats.upload.pending_tiles == 0) return std::pair{frames, frame};
      EXPECT_GT(frame.stats.upload.unmeasured_tiles + frame.stats.upload.tiles, 0);
    }
    ADD_FAILURE() << "never at rest";
    return std::pair{0, Frame{}};
  };
  ASSERT_TRUE(picture->update(before));
  const auto [first_frames, first] = settle();
  EXPECT_EQ(first_frames, static_cast<int>((kTiles + kMost - 1) / kMost));

  // A filter changes every sample.
  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> z(2100 * 1000);
  before.reader().readHeights(0, 0, 2100, 1000, z.data(), 2100);
  for (float& height : z) height *= 1.01F;
  ASSERT_TRUE(live.writeHeights(0, 0, 2100, 1000, z.data(), 2100));
  const engine::Version after = live.snapshot();
  ASSERT_TRUE(picture->update(after));
  const auto [frames, at_rest] = settle();
  EXPECT_GT(frames, 2);

  // And ends with the picture of one that never saw another state; the camera's range is that of the first.
  picture->refreshRanges();
  const Frame last = shoot(*picture, input);
  auto fresh = makePicture();
  ASSERT_TRUE(fresh->update(after));
  const Frame other = settled(*fresh, input);
  EXPECT_EQ(at_rest.stats.patches, last.stats.patches);
  EXPECT_EQ(last.stats.patches, other.stats.patches);
  EXPECT_EQ(last.image.rgba, other.image.rgba);

  // While nothing is known, against the surface at full resolution.
  fine = shoot(*fresh, full(input));
  fresh.reset();
  picture = makePicture();
  ASSERT_TRUE(picture->update(after));
  (void)settle();
}

TEST(Live, PagesAndCoarseCopiesGiveTheSamePixelsAsOneImage) {
  const engine::Version field = fieldOf(
      gridOf(1500, 700, 0.1, 0.1),
      [](int c, int r) { return (c * 13 + r * 7) % 401 == 0 ? kNan : part(c, r); },
      [](int c, int r) { return (c + r) % 90 < 4; });
  Shown shown;
  shown.versions = {field};
  shown.original = fieldOf(gridOf(1500, 700, 0.1, 0.1), [](int c, int r) { return 0.98 * part(c, r); });
  shown.marks = MarksOverlay::kShow;
  auto paged = makePicture(128), plain = makePicture();
  ASSERT_TRUE(paged->update(shown));
  ASSERT_TRUE(plain->update(shown));
  for (const double zoom : {0.5, 1.0, 20.0}) {
    FrameInput input = bare();
    input.view.zoom = zoom;
    input.contours = Contours::kShow;
    const Frame a = shoot(*paged, input), b = shoot(*plain, input);
    EXPECT_EQ(a.image.rgba, b.image.rgba) << zoom;
  }
}

TEST(Live, VerticesStayWithinTheBudgetWhateverTheFieldAndTheBoundIsSaid) {
  auto picture = makePicture();
  // Noise as high as hills: nothing coarse is close to it.
  ASSERT_TRUE(
      picture->update(fieldOf(gridOf(2048, 2048, 0.1, 0.1), [](int c, int r) { return 30 * hash01(c, r); })));
  for (const std::int64_t budget : {16384, 98304}) {
    FrameInput input = bare();
    input.view.vertical_exaggeration = 1.0;
    input.vertex_budget = budget;
    const Frame frame = shoot(*picture, input);
    EXPECT_LE(frame.stats.vertices, budget);
    EXPECT_GT(frame.stats.vertices, budget / 2);
    EXPECT_FALSE(frame.stats.within_budget);
    EXPECT_GT(frame.stats.bound_px, 1.0);
  }
  // A plane costs next to nothing at any size.
  ASSERT_TRUE(picture->update(
      fieldOf(gridOf(2048, 2048, 0.1, 0.1), [](int c, int r) { return 0.25 * c + 0.5 * r; })));
  const Frame plane = settled(*picture, bare());
  EXPECT_LT(plane.stats.vertices, 4096);
  EXPECT_LE(plane.stats.bound_px, 1.0);
}

TEST(Live, ASpikeOfASingleSampleIsDrawnFromAnyDistance) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(fieldOf(gridOf(2000, 2000, 0.1, 0.1),
                                      [](int c, int r) { return c == 1003 && r == 997 ? 60.0 : 0.01 * c; })));
  FrameInput input = bare();
  input.view.vertical_exaggeration = 1.0;
  input.view.elevation_deg = 20;
  const Frame frame = settled(*picture, input);
  EXPECT_LE(frame.stats.bound_px, 1.0);
  // The finest patch is there: a spike is not stepped over.
  EXPECT_GT(frame.stats.patches, 8);
}

TEST(Live, PickAndPixelOfAreInverse) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  for (const FrameInput& input : views()) {
    (void)shoot(*picture, input);
    int hits = 0;
    for (int y = 7; y < input.view.height; y += 31)
      for (int x = 5; x < input.view.width; x += 29) {
        const auto picked = picture->pick(x, y);
        if (!picked) continue;
        ++hits;
        const auto at = picture->pixelOf(picked->panel, picked->position_mm);
        ASSERT_TRUE(at);
        EXPECT_NEAR(at->first, x, 1e-6);
        EXPECT_NEAR(at->second, y, 1e-6);
      }
    EXPECT_GT(hits, 20);
  }
}

TEST(Live, SplitShowsOneVersionOnEachSideOfTheLineAndFourShareACamera) {
  auto picture = makePicture();
  const engine::Version a = partField(), b = fieldOf(gridOf(640, 480, 0.1, 0.1),
                                                     [](int c, int r) { return 0.5 * part(c, r); });
  FrameInput input = bare();
  input.view.vertical_exaggeration = 1.0;
  input.range = ValueRange{-3, 9};
  Shown shown;
  shown.versions = {a, b};
  ASSERT_TRUE(picture->update(shown));
  input.arrangement = Arrangement::kSplit;
  input.split = 0.25;
  input.vertex_budget = 1 << 20;
  const Frame split = shoot(*picture, input);
  const auto left = picture->pick(115, 160), right = picture->pick(300, 160);
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->panel, 0);
  EXPECT_EQ(right->panel, 1);
  input.split = 1.0;
  const Image first = shoot(*picture, input).image;
  input.split = 0.0;
  const Image second = shoot(*picture, input).image;
  for (int y = 0; y < 320; y += 3)
    for (int x = 0; x < 480; x += 3) {
      if (std::abs(x - 120) < 3) continue;
      const Image& one = x < 120 ? first : second;
      ASSERT_TRUE(std::equal(pixel(split.image, x, y), pixel(split.image, x, y) + 3, pixel(one, x, y)))
          << x << ' ' << y;
    }
  shown.versions = {a, b, a, b};
  ASSERT_TRUE(picture->update(shown));
  input.arrangement = Arrangement::kSideBySide;
  const Frame four = shoot(*picture, input);
  const auto corner = picture->pixelOf(0, {32, 24, 0}), opposite = picture->pixelOf(2, {32, 24, 0});
  ASSERT_TRUE(corner && opposite);
  const int down = static_cast<int>(std::lround(opposite->second - corner->second));
  EXPECT_NEAR(opposite->first, corner->first, 1e-9);
  EXPECT_GT(down, 100);
  // The viewport's offset is added to a float: an edge may fall on the other side of a ray.
  int other = 0;
  for (int y = 10; y < 140; ++y)
    for (int x = 0; x < 230; ++x)
      other +=
          !std::equal(pixel(four.image, x, y), pixel(four.image, x, y) + 3, pixel(four.image, x, y + down));
  EXPECT_LT(other, 130 * 230 / 200);
}

TEST(Live, OverlaysAreSeenWhereTheyAreAndHiddenByWhatLiesBefore) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  FrameInput input = bare();
  input.view.azimuth_deg = 0;
  input.view.elevation_deg = 30;
  input.view.vertical_exaggeration = 1.0;
  const Frame plain = shoot(*picture, input);
  // A disc far behind the field's middle and deep under it: only the one on top is seen.
  const glm::dvec3 buried{32, 30, -2};
  const auto at = [&] { return *picture->pixelOf(0, buried); };
  OverlayLine disc{buried, buried, {1, 0, 0}, 1.0F, 9.0F};
  disc.depth = OverlayLine::Depth::kInScene;
  input.overlays.lines = {disc};
  const Frame hidden = shoot(*picture, input);
  EXPECT_EQ(hidden.image.rgba, plain.image.rgba);
  input.overlays.lines[0].depth = OverlayLine::Depth::kOnTop;
  const Frame seen = shoot(*picture, input);
  const std::uint8_t* p = pixel(seen.image, static_cast<int>(at().first), static_cast<int>(at().second));
  EXPECT_EQ(p[0], 255);
  EXPECT_EQ(p[1], 0);
  // A ring on the surface, and a stylus in contact.
  input.overlays.lines.clear();
  input.overlays.rings = {{20, 30, 12, {1, 0, 1}, 3}};
  appendStylus({{30, 20, 9}, {30, 20, 3}, {0, 0, 2}, true, 1.5}, 4.0, input.overlays.lines);
  const Frame all = shoot(*picture, input);
  int magenta = 0;
  for (int i = 0; i < 480 * 320; ++i) {
    const std::uint8_t* q = pixel(all.image, i % 480, i / 480);
    magenta += q[0] > 240 && q[1] < 15 && q[2] > 240;
  }
  EXPECT_GT(magenta, 200);
}

TEST(Live, FurnitureThemesLightAndMapsAreDrawnAndRefusedWhenOutOfRange) {
  auto picture = makePicture();
  FrameInput input;
  input.view.width = 960;
  input.view.height = 600;
  Image image;
  EXPECT_FALSE(picture->draw(input, image));  // nothing to show yet
  ASSERT_TRUE(picture->update(partField()));
  input.titles = {"part"};
  const Frame dark = shoot(*picture, input);
  input.light_azimuth_deg = -45;
  const Frame lit = shoot(*picture, input);
  EXPECT_NE(dark.image.rgba, lit.image.rgba);
  for (const auto& wrong : {&FrameInput::error_px, &FrameInput::split, &FrameInput::light_elevation_deg}) {
    FrameInput bad = input;
    bad.*wrong = -1.0;
    const auto refused = picture->draw(bad, image);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
  }
  Shown odd;
  odd.versions = {partField()};
  odd.original = fieldOf(gridOf(8, 8), [](int, int) { return 1; });
  EXPECT_FALSE(picture->update(odd));
  EXPECT_TRUE(picture->draw(input, image));  // what was there still is
}

TEST(Live, FieldsWithoutCellsHolesOnlyAndHugeHeightsAreDrawn) {
  auto picture = makePicture();
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {65, 1}, {64, 64}, {65, 65}}) {
    ASSERT_TRUE(picture->update(fieldOf(gridOf(w, h), [](int c, int r) { return c + r; })));
    EXPECT_GT(shoot(*picture, bare()).stats.patches, 0) << w << " x " << h;
  }
  ASSERT_TRUE(picture->update(fieldOf(gridOf(30, 30), [](int, int) { return kNan; })));
  EXPECT_EQ(shoot(*picture, bare()).stats.patches, 0);
  ASSERT_TRUE(picture->update(fieldOf(gridOf(300, 300), [](int c, int r) {
    return c == 100 && r == 75 ? 1e6 : c == 9 ? -3e30 : 0.1 * (c % 3);
  })));
  EXPECT_LE(shoot(*picture, bare()).stats.vertices, 98304);
}

// Mean over pixels of the largest channel difference, `a` being looked at (dx, dy) pixels aside.
double meanOff(const Image& a, const Image& b, int dx = 0, int dy = 0) {
  double sum = 0.0;
  int n = 0;
  for (int y = 2; y < a.height - 2; ++y)
    for (int x = 2; x < a.width - 2; ++x, ++n) {
      int off = 0;
      for (int k = 0; k < 3; ++k)
        off = std::max(off, std::abs(pixel(a, x + dx, y + dy)[k] - pixel(b, x, y)[k]));
      sum += off;
    }
  return sum / n;
}

// Pixels of `half` with a channel outside what `full` has within three pixels of it, and four codes.
int outside(const Image& half, const Image& full) {
  int n = 0;
  for (int y = 3; y < full.height - 3; ++y)
    for (int x = 3; x < full.width - 3; ++x) {
      bool off = false;
      for (int k = 0; k < 3; ++k) {
        int low = 255, high = 0;
        for (int v = y - 3; v <= y + 3; ++v)
          for (int u = x - 3; u <= x + 3; ++u) {
            low = std::min<int>(low, pixel(full, u, v)[k]);
            high = std::max<int>(high, pixel(full, u, v)[k]);
          }
        const int value = pixel(half, x, y)[k];
        off = off || value < low - 4 || value > high + 4;
      }
      n += off;
    }
  return n;
}

TEST(Live, HalfAsSharpIsTheSamePictureWithoutItsFinestDetail) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  int width = 480;
  for (FrameInput input : views()) {
    SCOPED_TRACE(testing::Message() << input.view.azimuth_deg << ' ' << input.view.elevation_deg << ' '
                                    << static_cast<int>(input.view.projection));
    // Odd sizes as well.
    input.view.width = width++;
    input.view.height = 321;
    const Frame sharp = shoot(*picture, input);
    input.sharpness = Sharpness::kHalf;
    const Frame half = shoot(*picture, input);
    EXPECT_EQ(half.stats.bound_px, sharp.stats.bound_px);
    const double off = meanOff(half.image, sharp.image);
    EXPECT_GT(off, 0.0);
    // Measured 1.3 to 2.7: noise of a code or a few, and what is 50 codes away along edges.
    EXPECT_LT(off, 4.0);
    // It lies where the sharp one does: looked at from a pixel aside it fits worse.
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      EXPECT_GT(meanOff(half.image, sharp.image, dx, dy), off) << dx << ' ' << dy;
    // Interpolated between what the surface shows within two pixels. At its edges a triangle may cover a
    // pixel's middle in one picture alone, and of noise either may show the extreme: of one in a hundred.
    EXPECT_LE(outside(half.image, sharp.image), width * 321 / 100);
  }
}

TEST(Live, HalfAsSharpLeavesFurnitureSharpAndNoTraceInTheFramesAfterIt) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  FrameInput input = bare(640, 400);
  input.decoration = Decoration::kFull;
  OverlayLine on_top{{5, 5, 8}, {40, 40, 8}};
  OverlayLine in_scene{{5, 40, 1}, {60, 10, 1}};
  in_scene.depth = OverlayLine::Depth::kInScene;
  input.overlays.lines = {on_top, in_scene};
  for (const StereoMode mode : {StereoMode::kOff, StereoMode::kSideBySide, StereoMode::kAnaglyph}) {
    SCOPED_TRACE(static_cast<int>(mode));
    input.stereo.mode = mode;
    input.sharpness = Sharpness::kFull;
    auto fresh = makePicture();
    ASSERT_TRUE(fresh->update(partField()));
    const Frame sharp = shoot(*fresh, input);
    input.sharpness = Sharpness::kHalf;
    const Frame half = shoot(*picture, input);
    EXPECT_NE(half.image.rgba, sharp.image.rgba);
    EXPECT_EQ(half.stats.redrawn, 1.0);
    if (mode != StereoMode::kSideBySide) {
      // Colour bar and its numbers are right of the plot, the scale bar below it: no pixel of theirs differs.
      for (int y = 0; y < 400; ++y)
        for (int x = 560; x < 640; ++x)
          ASSERT_TRUE(
              std::equal(pixel(half.image, x, y), pixel(half.image, x, y) + 4, pixel(sharp.image, x, y)))
              << x << ' ' << y;
    }
    input.sharpness = Sharpness::kFull;
    EXPECT_EQ(shoot(*picture, input).image.rgba, sharp.image.rgba);
    // Nor in those that draw a part alone.
    EXPECT_EQ(shoot(*picture, input).image.rgba, sharp.image.rgba);
  }
}

}  // namespace
}  // namespace fettle::render
