#include "render/plan/picture.h"

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "engine/field/live_field.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

double hills(int c, int r) {
  return 4 * std::sin(c * 0.05) * std::cos(r * 0.07) + 0.3 * std::sin(c * 1.1 + r * 0.9);
}

PictureSpec oblique(const engine::Version& field) {
  PictureSpec spec = mapOf(field, 320, 240);
  spec.view.azimuth_deg = 330;
  spec.view.elevation_deg = 40;
  return spec;
}

Image ground() {
  // A field of nothing but holes, seen along a hair of its plate from far off: only ground.
  Image image{1, 1, {}};
  const Shot shot = [] {
    PictureSpec spec = mapOf(fieldOf(gridOf(4, 4), [](int, int) { return 1; }), 64, 64);
    spec.view.zoom = 0.01;
    return shoot(*sharedRenderer(), spec);
  }();
  image.rgba.assign(shot.image.rgba.begin(), shot.image.rgba.begin() + 4);
  return image;
}

TEST(Picture, TheSameSpecGivesTheSameBitsAgainAndOnAFreshRenderer) {
  const PictureSpec spec = oblique(fieldOf(gridOf(300, 200), hills));
  const Shot first = shoot(*sharedRenderer(), spec), second = shoot(*sharedRenderer(), spec);
  EXPECT_EQ(first.image.rgba, second.image.rgba);
  auto fresh = Renderer::create();
  ASSERT_TRUE(fresh);
  EXPECT_EQ(first.image.rgba, shoot(**fresh, spec).image.rgba);
  EXPECT_EQ(second.report.tiles_uploaded, 0);
  EXPECT_GT(first.report.frame_ms, 0.0);
  EXPECT_FALSE(first.report.device.empty());
}

TEST(Picture, AfterAnEditOnlyTheChangedTilesMoveAndThePixelsEqualAFreshUpload) {
  auto renderer = Renderer::create({Validation::kOn, "", 0});
  ASSERT_TRUE(renderer) << renderer.error().line();
  const engine::Version before = fieldOf(gridOf(500, 400), hills, [](int c, int) { return c % 50 == 0; });
  PictureSpec spec = oblique(before);
  spec.marks = MarksOverlay::kShow;
  EXPECT_EQ(shoot(**renderer, spec).report.tiles_uploaded, 2 * 8 * 7);

  engine::LiveField live(before, engine::Growth::kAllowed);
  const std::vector<float> bump(30 * 30, 6.0F);
  ASSERT_TRUE(live.writeHeights(50, 50, 30, 30, bump.data(), 30));  // four tiles meet at (64, 64)
  ASSERT_TRUE(live.setMark(300, 10, !before.reader().markedAt(300, 10)));
  spec.field = live.snapshot();
  const Shot edited = shoot(**renderer, spec);
  EXPECT_EQ(edited.report.tiles_uploaded, 4 + 1);
  EXPECT_EQ(edited.report.bytes_uploaded, 4 * 64 * 64 * 4 + 64 * 64);

  auto fresh = Renderer::create();
  ASSERT_TRUE(fresh);
  EXPECT_EQ(edited.image.rgba, shoot(**fresh, spec).image.rgba);

  // Back again, as undo does; and upside down, which moves nothing.
  spec.field = before;
  EXPECT_EQ(shoot(**renderer, spec).report.tiles_uploaded, 5);
  spec.field = before.inverted();
  const Shot inverted = shoot(**renderer, spec);
  EXPECT_EQ(inverted.report.tiles_uploaded, 0);
  EXPECT_EQ(inverted.image.rgba, shoot(**fresh, spec).image.rgba);
}

TEST(Picture, MarksAndOriginalsAreUploadedOnlyWhenAskedFor) {
  auto renderer = Renderer::create();
  ASSERT_TRUE(renderer);
  const engine::Version a = fieldOf(gridOf(128, 128), hills, [](int c, int) { return c == 3; });
  const engine::Version b = fieldOf(gridOf(128, 128), [](int c, int r) { return hills(c, r) + 0.1; });
  PictureSpec spec = oblique(a);
  EXPECT_EQ(shoot(**renderer, spec).report.bytes_uploaded, 4 * 16384);
  spec.marks = MarksOverlay::kShow;
  EXPECT_EQ(shoot(**renderer, spec).report.bytes_uploaded, 4 * 4096);
  spec.deviation_from = b;
  EXPECT_EQ(shoot(**renderer, spec).report.bytes_uploaded, 4 * 16384);
  // Side by side with its own original: nothing is sent twice.
  spec.marks = MarksOverlay::kHide;
  spec.compare = b;
  EXPECT_EQ(shoot(**renderer, spec).report.bytes_uploaded, 0);
}

TEST(Picture, PagesOfAnImageArrayGiveTheSamePixelsAsOneImage) {
  PictureSpec spec = oblique(fieldOf(
      gridOf(700, 300), [](int c, int r) { return (c * 13 + r * 7) % 401 == 0 ? kNan : hills(c, r); },
      [](int c, int r) { return (c + r) % 90 < 4; }));
  spec.marks = MarksOverlay::kShow;
  spec.deviation_from = fieldOf(gridOf(700, 300), [](int c, int r) { return 0.98 * hills(c, r); });
  auto paged = Renderer::create({Validation::kOn, "", 128});
  ASSERT_TRUE(paged) << paged.error().line();
  EXPECT_EQ(shoot(**paged, spec).image.rgba, shoot(*sharedRenderer(), spec).image.rgba);
}

TEST(Picture, AStripLongerThanTheImageLimitIsDrawnToItsEnd) {
  // 20000 > 16384; the last 100 columns are a hole, seen at the right end only.
  PictureSpec spec =
      mapOf(fieldOf(gridOf(20000, 64, 1, 60), [](int c, int) { return c >= 19000 ? kNan : 1.0F; }), 400, 100);
  const Shot shot = shoot(*sharedRenderer(), spec);
  const auto lightness = [&](int x) { return pixel(shot.image, x, 50)[0]; };
  const std::uint8_t surface = lightness(100);
  EXPECT_EQ(lightness(370), surface);
  EXPECT_NE(lightness(395), surface);
  EXPECT_EQ(shot.report.tiles_uploaded, 313);
}

TEST(Picture, FieldsWithoutCellsOrWithoutSamplesStillShowSomething) {
  const Image empty = ground();
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {65, 1}}) {
    const Shot shot =
        shoot(*sharedRenderer(), oblique(fieldOf(gridOf(w, h), [](int c, int r) { return c + r; })));
    EXPECT_GT(drawnPixels(shot.image, empty), 50) << w << " x " << h;
    EXPECT_GT(shot.report.patches, 0);
  }
  const Shot holes =
      shoot(*sharedRenderer(), oblique(fieldOf(gridOf(30, 30), [](int, int) { return kNan; })));
  EXPECT_GT(drawnPixels(holes.image, empty), 1000);  // the grey plate
  EXPECT_EQ(holes.report.patches, 0);
}

TEST(Picture, SpikesHugeHeightsFarOriginsAndDenormalsLeaveTheCameraAlone) {
  const auto plain = [](int c, int r) { return 0.1 * ((c / 10 + r / 10) % 3); };
  const PictureSpec base = oblique(fieldOf(gridOf(200, 150), plain));
  const Image reference = shoot(*sharedRenderer(), base).image;
  // A spike changes pixels near itself only: it is cut, and the view is not.
  PictureSpec spike = oblique(
      fieldOf(gridOf(200, 150), [&](int c, int r) { return c == 100 && r == 75 ? 1e6 : plain(c, r); }));
  const Image spiked = shoot(*sharedRenderer(), spike).image;
  int changed = 0;
  for (std::size_t i = 0; i < reference.rgba.size(); i += 4)
    changed += std::abs(int{reference.rgba[i + 1]} - int{spiked.rgba[i + 1]}) > 12;
  EXPECT_LT(changed, 320 * 240 / 50);
  // 5e6 m away: the same picture to the bit, since only the field's own coordinates count.
  engine::Grid far = gridOf(200, 150);
  far.origin_x = 5e6;
  far.origin_y = -5e6;
  EXPECT_EQ(shoot(*sharedRenderer(), oblique(fieldOf(far, plain))).image.rgba, reference.rgba);
  const Image empty = ground();
  for (const double offset : {1e7, -3e30, 1e-40}) {
    PictureSpec spec = oblique(fieldOf(gridOf(60, 60), [&](int c, int) { return offset * (1 + 0.1 * c); }));
    spec.view.vertical_exaggeration = 0;  // true heights of 1e7 mm over 60 mm would be a needle
    EXPECT_GT(drawnPixels(shoot(*sharedRenderer(), spec).image, empty), 1000) << offset;
  }
}

TEST(Picture, AnisotropicSpacingKeepsItsProportions) {
  const Image empty = ground();
  const Image image = shoot(*sharedRenderer(),
                            mapOf(fieldOf(gridOf(101, 101, 0.2, 0.5), [](int, int) { return 1; }), 400, 200))
                          .image;
  int columns = 0, rows = 0;
  for (int x = 0; x < 400; ++x)
    columns += !std::equal(pixel(image, x, 100), pixel(image, x, 100) + 3, empty.rgba.begin());
  for (int y = 0; y < 200; ++y)
    rows += !std::equal(pixel(image, 200, y), pixel(image, 200, y) + 3, empty.rgba.begin());
  EXPECT_NEAR(columns / static_cast<double>(rows), 0.4, 0.02);
}

TEST(Picture, SideBySideOfTheSameFieldIsTwiceTheSamePanel) {
  const engine::Version field = fieldOf(gridOf(90, 90), hills);
  PictureSpec spec =
      mapOf(field, 416, 200);  // two panels of 200 and a gap of 16 * 0.6 rounded, scale 0.6 at this size
  spec.view.width = 410;
  spec.compare = field;
  const Shot shot = shoot(*sharedRenderer(), spec);
  for (int y = 0; y < 200; y += 7)
    for (int x = 0; x < 200; ++x)
      ASSERT_TRUE(
          std::equal(pixel(shot.image, x, y), pixel(shot.image, x, y) + 4, pixel(shot.image, x + 210, y)))
          << x << ' ' << y;
  EXPECT_EQ(shot.report.tiles_uploaded, 4);
}

TEST(Picture, CancelledBeforeItBeginsLeavesTheImageAloneAndTheNextOneIsRight) {
  auto renderer = Renderer::create();
  ASSERT_TRUE(renderer);
  const PictureSpec spec = oblique(fieldOf(gridOf(200, 100), hills));
  engine::JobControl job;
  job.cancel();
  Image image{3, 3, std::vector<std::uint8_t>(36, 9)};
  const auto result = (*renderer)->render(spec, image, job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, engine::ErrorKind::kCancelled);
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(shoot(**renderer, spec).image.rgba, shoot(*sharedRenderer(), spec).image.rgba);
}

TEST(Picture, PixelsDoNotDependOnThePiecesTheyAreDrawnIn) {
  PictureSpec spec = oblique(fieldOf(
      gridOf(300, 200), [](int c, int r) { return c > 90 && c < 120 && r < 50 ? kNan : hills(c, r); }));
  spec.compare = fieldOf(gridOf(150, 220), hills);
  spec.decoration = Decoration::kFull;
  spec.samples_per_side = 2;
  RendererOptions options{Validation::kOn, "", 0};
  options.piece_ms = std::numeric_limits<double>::infinity();
  auto at_once = Renderer::create(options);
  options.piece_ms = 1e-9;  // bands of single patches throughout
  auto bit_by_bit = Renderer::create(options);
  ASSERT_TRUE(at_once && bit_by_bit);
  for (const double zoom : {1.0, 9.0}) {
    spec.view.zoom = zoom;
    EXPECT_EQ(shoot(**at_once, spec).image.rgba, shoot(**bit_by_bit, spec).image.rgba) << zoom;
  }
}

TEST(Picture, CancelledWhileDrawingStopsSoonLeavesTheImageAloneAndTheNextOneIsRight) {
  auto renderer = Renderer::create();
  ASSERT_TRUE(renderer);
  PictureSpec spec = oblique(fieldOf(gridOf(1500, 1500), hills));
  spec.view.width = 1280;
  spec.view.height = 800;
  spec.samples_per_side = 2;
  spec.cell_px = 1.0;
  Image image{3, 3, std::vector<std::uint8_t>(36, 9)};
  engine::JobControl job;
  std::chrono::steady_clock::time_point asked;
  std::thread canceller([&] {
    while (std::string_view(job.stage()) != "drawing" || job.done() == 0)
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    asked = std::chrono::steady_clock::now();
    job.cancel();
  });
  const auto result = (*renderer)->render(spec, image, job);
  const auto returned = std::chrono::steady_clock::now();
  canceller.join();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, engine::ErrorKind::kCancelled);
  EXPECT_LT(job.done(), job.total());
  // A piece is meant to take 50 ms; the rest is for machines that do other work as well.
  EXPECT_LT(std::chrono::duration<double>(returned - asked).count(), 0.5);
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.rgba, std::vector<std::uint8_t>(36, 9));

  engine::JobControl again;
  const auto report = (*renderer)->render(spec, image, again);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->tiles_uploaded, 0);
  EXPECT_EQ(again.done(), again.total());
  EXPECT_EQ(image.rgba, shoot(*sharedRenderer(), spec).image.rgba);
}

TEST(Picture, FurnitureFitsFromSmallToLargePicturesAndSaysWhatDoesNot) {
  PictureSpec spec = oblique(fieldOf(gridOf(80, 60), hills));
  spec.decoration = Decoration::kFull;
  spec.title_left =
      "a title far too long for any picture of this size, which has to be cut with an ellipsis somewhere";
  for (const auto& [w, h] : {std::pair{640, 400}, {1280, 800}, {2560, 1600}}) {
    spec.view.width = w;
    spec.view.height = h;
    spec.samples_per_side = 1;
    EXPECT_TRUE(shoot(*sharedRenderer(), spec).report.warnings.empty()) << w;
  }
  spec.view.width = spec.view.height = 40;
  EXPECT_EQ(shoot(*sharedRenderer(), spec).image.width, 40);
}

TEST(Renderer, ADeviceThatIsNotThereIsRefusedWithTheReason) {
  const auto renderer = Renderer::create({Validation::kOff, "no such device", 0});
  ASSERT_FALSE(renderer);
  EXPECT_EQ(renderer.error().kind, engine::ErrorKind::kFailed);
  EXPECT_NE(renderer.error().what.find("is not the one asked for"), std::string::npos)
      << renderer.error().line();
}

TEST(Renderer, WithoutAnyDriverTheErrorNamesThePackageToInstall) {
  // Read by the loader when an instance is made.
  const char* old = std::getenv("VK_ICD_FILENAMES");
  const std::string kept = old != nullptr ? old : "";
  setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
  const auto renderer = Renderer::create();
  if (old != nullptr)
    setenv("VK_ICD_FILENAMES", kept.c_str(), 1);
  else
    unsetenv("VK_ICD_FILENAMES");
  ASSERT_FALSE(renderer);
  EXPECT_NE(renderer.error().line().find("mesa-vulkan-drivers"), std::string::npos)
      << renderer.error().line();
}

}  // namespace
}  // namespace fettle::render
