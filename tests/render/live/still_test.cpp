// Pictures that are drawn once.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <set>
#include <string_view>
#include <thread>

#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

double hills(int c, int r) {
  return 4 * std::sin(c * 0.05) * std::cos(r * 0.07) + 0.3 * std::sin(c * 1.1 + r * 0.9);
}

Still oblique(const engine::Version& field) {
  Still still = mapOf(field, 320, 240);
  still.input.view.azimuth_deg = 330;
  still.input.view.elevation_deg = 40;
  return still;
}

Image ground() {
  // A field seen from far off: only ground.
  Still still = mapOf(fieldOf(gridOf(4, 4), [](int, int) { return 1; }), 64, 64);
  still.input.view.zoom = 0.01;
  Image image{1, 1, {}};
  const Shot shot = shoot(*sharedPicture(), still);
  image.rgba.assign(shot.image.rgba.begin(), shot.image.rgba.begin() + 4);
  return image;
}

TEST(Still, TheSameInputGivesTheSameBitsAgainAndOnAFreshPicture) {
  const Still still = oblique(fieldOf(gridOf(300, 200), hills));
  const Shot first = shoot(*sharedPicture(), still), second = shoot(*sharedPicture(), still);
  EXPECT_EQ(first.image.rgba, second.image.rgba);
  const auto fresh = LivePicture::create();
  ASSERT_TRUE(fresh);
  EXPECT_EQ(first.image.rgba, shoot(**fresh, still).image.rgba);
  EXPECT_EQ(second.stats.upload.tiles, 0);
  EXPECT_GT(first.stats.device_ms, 0.0);
  EXPECT_FALSE((*fresh)->device().empty());
}

TEST(Still, MarksAndOriginalsAreUploadedOnlyWhenAskedFor) {
  const auto picture = LivePicture::create();
  ASSERT_TRUE(picture);
  const engine::Version a = fieldOf(gridOf(128, 128), hills, [](int c, int) { return c == 3; });
  Still still = oblique(a);
  // Copies of every 4th, 16th and 64th sample come with the samples.
  constexpr std::int64_t kSamples = 128 * 128 + 32 * 32 + 8 * 8 + 2 * 2;
  EXPECT_EQ(shoot(**picture, still).stats.upload.bytes, 4 * kSamples);
  still.shown.marks = MarksOverlay::kShow;
  EXPECT_EQ(shoot(**picture, still).stats.upload.bytes, kSamples);
  still.shown.original = fieldOf(gridOf(128, 128), [](int c, int r) { return hills(c, r) + 0.1; });
  EXPECT_EQ(shoot(**picture, still).stats.upload.bytes, 4 * kSamples);
  still.shown.versions = {a.inverted()};
  still.shown.original = still.shown.original->inverted();
  EXPECT_EQ(shoot(**picture, still).stats.upload.bytes, 0);
}

TEST(Still, AStripLongerThanTheImageLimitIsDrawnToItsEnd) {
  // 20000 > 16384; the last columns are a hole, seen at the right end only.
  const Still still =
      mapOf(fieldOf(gridOf(20000, 64, 1, 60), [](int c, int) { return c >= 19000 ? kNan : 1.0F; }), 400, 100);
  const Shot shot = shoot(*sharedPicture(), still);
  const auto lightness = [&](int x) { return pixel(shot.image, x, 50)[0]; };
  const std::uint8_t surface = lightness(100);
  EXPECT_EQ(lightness(370), surface);
  EXPECT_NE(lightness(395), surface);
}

TEST(Still, APatchOfHolesIsNotDrawnAndZoomingInDrawsFewer) {
  const auto rough = [](int c, int r) { return (c * 7 + r * 13) % 5; };
  Still still = mapOf(fieldOf(gridOf(256, 256), rough), 600, 600);
  still.input.view.elevation_deg = 60;
  const std::int64_t all = shoot(*sharedPicture(), still).stats.patches;
  still.shown.versions = {fieldOf(
      gridOf(256, 256), [&](int c, int r) { return c >= 128 && r < 128 ? double{kNan} : rough(c, r); })};
  // Of the 64 patches without a height of their own, 8 reach up to row 128, where the heights begin.
  EXPECT_EQ(all, 256);
  EXPECT_EQ(shoot(*sharedPicture(), still).stats.patches, all - 56);
  still.input.view.zoom = 4;
  EXPECT_LT(shoot(*sharedPicture(), still).stats.patches, all / 2);
}

TEST(Still, FieldsWithoutCellsOrWithoutSamplesStillShowSomething) {
  const Image empty = ground();
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {65, 1}}) {
    const Shot shot =
        shoot(*sharedPicture(), oblique(fieldOf(gridOf(w, h), [](int c, int r) { return c + r; })));
    EXPECT_GT(drawnPixels(shot.image, empty), 50) << w << " x " << h;
    EXPECT_GT(shot.stats.patches, 0);
  }
  const Shot holes = shoot(*sharedPicture(), oblique(fieldOf(gridOf(30, 30), [](int, int) { return kNan; })));
  EXPECT_GT(drawnPixels(holes.image, empty), 1000);  // the grey plate
  EXPECT_EQ(holes.stats.patches, 0);
}

TEST(Still, SpikesHugeHeightsFarOriginsAndDenormalsLeaveTheCameraAlone) {
  const auto plain = [](int c, int r) { return 0.1 * ((c / 10 + r / 10) % 3); };
  Still base = oblique(fieldOf(gridOf(200, 150), plain));
  base.input.range = ValueRange{0.0, 0.2};
  const Image reference = shoot(*sharedPicture(), base).image;
  // A spike changes pixels near itself only: it is cut, and the view is not.
  Still spike = base;
  spike.shown.versions = {
      fieldOf(gridOf(200, 150), [&](int c, int r) { return c == 100 && r == 75 ? 1e6 : plain(c, r); })};
  const Image spiked = shoot(*sharedPicture(), spike).image;
  int changed = 0;
  for (std::size_t i = 0; i < reference.rgba.size(); i += 4)
    changed += std::abs(int{reference.rgba[i + 1]} - int{spiked.rgba[i + 1]}) > 12;
  EXPECT_LT(changed, 320 * 240 / 50);
  // 5e6 m away: a bit-identical picture, since only the field's own coordinates count.
  engine::Grid far = gridOf(200, 150);
  far.origin_x = 5e6;
  far.origin_y = -5e6;
  Still away = base;
  away.shown.versions = {fieldOf(far, plain)};
  EXPECT_EQ(shoot(*sharedPicture(), away).image.rgba, reference.rgba);
  const Image empty = ground();
  for (const double offset : {1e7, -3e30, 1e-40}) {
    Still still = oblique(fieldOf(gridOf(60, 60), [&](int c, int) { return offset * (1 + 0.1 * c); }));
    still.input.view.vertical_exaggeration = 0;  // true heights of 1e7 mm over 60 mm would be a needle
    EXPECT_GT(drawnPixels(shoot(*sharedPicture(), still).image, empty), 1000) << offset;
  }
}

TEST(Still, AnisotropicSpacingKeepsItsProportions) {
  const Image empty = ground();
  const Image image = shoot(*sharedPicture(),
                            mapOf(fieldOf(gridOf(101, 101, 0.2, 0.5), [](int, int) { return 1; }), 400, 200))
                          .image;
  int columns = 0, rows = 0;
  for (int x = 0; x < 400; ++x)
    columns += !std::equal(pixel(image, x, 100), pixel(image, x, 100) + 3, empty.rgba.begin());
  for (int y = 0; y < 200; ++y)
    rows += !std::equal(pixel(image, 200, y), pixel(image, 200, y) + 3, empty.rgba.begin());
  EXPECT_NEAR(columns / static_cast<double>(rows), 0.4, 0.02);
}

TEST(Still, SideBySideOfTheSameFieldIsTwiceTheSamePanel) {
  const engine::Version field = fieldOf(gridOf(90, 90), hills);
  Still still = mapOf(field, 410, 200);  // two panels of 200 and a gap of 16 * 0.6 rounded, the scale here
  still.shown.versions.push_back(field);
  const Shot shot = shoot(*sharedPicture(), still);
  for (int y = 0; y < 200; y += 7)
    for (int x = 0; x < 200; ++x)
      for (int k = 0; k < 3; ++k)
        // One palette step of rounding about another place.
        ASSERT_NEAR(pixel(shot.image, x, y)[k], pixel(shot.image, x + 210, y)[k], 2) << x << ' ' << y;
}

TEST(Still, FieldsOfDifferentSizesStandSideBySideButGiveNoDeviation) {
  const Image empty = ground();
  Still still = mapOf(fieldOf(gridOf(300, 200), hills), 420, 200);
  still.shown.versions.push_back(fieldOf(gridOf(150, 220), hills));
  const Image image = shoot(*sharedPicture(), still).image;
  const auto columns = [&](int from, int to) {
    int n = 0;
    for (int x = from; x < to; ++x)
      n += !std::equal(pixel(image, x, 100), pixel(image, x, 100) + 3, empty.rgba.begin());
    return n;
  };
  // One scale for both.
  EXPECT_NEAR(columns(210, 420) / static_cast<double>(columns(0, 210)), 0.5, 0.03);
  still.shown.original = still.shown.versions[0];
  const engine::Status refused = sharedPicture()->update(still.shown);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
}

TEST(Still, FourRaysAPixelSmoothEdgesAndLeaveFlatColoursAlone) {
  Still still = oblique(fieldOf(gridOf(300, 200), [](int c, int) { return c < 150 ? 0.0 : 60.0; }));
  // What the step hides has a colour of its own.
  still.input.form = {};
  const Image fine = shoot(*sharedPicture(), still).image;
  still.input.sharpness = Sharpness::kFull;
  const Image full = shoot(*sharedPicture(), still).image;
  const auto coloursOf = [](const Image& image) {
    std::set<std::array<std::uint8_t, 3>> all;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      all.insert({image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]});
    return all.size();
  };
  EXPECT_GT(coloursOf(fine), 2 * coloursOf(full));
  int off = 0;
  for (std::size_t i = 0; i < fine.rgba.size(); i += 4) off += std::abs(fine.rgba[i] - full.rgba[i]) > 2;
  EXPECT_LT(off, 320 * 240 / 20);
}

// What a picture cancelled by `cancel` returns, and whether it handed on all of its rows.
struct Cancelled {
  engine::ErrorKind kind;
  int rows = 0;
  std::uint64_t done = 0, total = 0;
};
Cancelled drawCancelled(LivePicture& picture, const Still& still, engine::JobControl& job) {
  Cancelled seen{};
  EXPECT_TRUE(picture.update(still.shown));
  const auto drawn = drawRows(
      picture, still.input,
      [&](const Image& rows) -> engine::Status {
        seen.rows += rows.height;
        return {};
      },
      job);
  EXPECT_FALSE(drawn);
  if (!drawn) seen.kind = drawn.error().kind;
  seen.done = job.done();
  seen.total = job.total();
  return seen;
}

// A window that is closed right after a scan was opened, or a program that ends after a refused picture.
TEST(Still, APictureMayEndWhileItsUploadsAreUnderWay) {
  Shown shown;
  shown.versions = {fieldOf(
      gridOf(700, 500), [](int c, int r) { return c % 7 + r % 5; }, [](int c, int r) { return c == r; })};
  shown.marks = MarksOverlay::kShow;
  for (int i = 0; i < 20; ++i) {
    const auto picture = LivePicture::create();
    ASSERT_TRUE(picture) << picture.error().line();
    EXPECT_TRUE((*picture)->update(shown));
  }
}

TEST(Still, CancelledBeforeItBeginsHandsOnNothingAndTheNextOneIsRight) {
  const auto picture = LivePicture::create();
  ASSERT_TRUE(picture);
  const Still still = oblique(fieldOf(gridOf(200, 100), hills));
  engine::JobControl job;
  job.cancel();
  const Cancelled seen = drawCancelled(**picture, still, job);
  EXPECT_EQ(seen.kind, engine::ErrorKind::kCancelled);
  EXPECT_EQ(seen.rows, 0);
  EXPECT_EQ(shoot(**picture, still).image.rgba, shoot(*sharedPicture(), still).image.rgba);
}

TEST(Still, CancelledWhileDrawingStopsSoonAndTheNextOneIsRight) {
  const auto picture = LivePicture::create();
  ASSERT_TRUE(picture);
  Still still = oblique(fieldOf(gridOf(1500, 1500), hills));
  still.input.view.width = 4096;
  still.input.view.height = 2048;
  engine::JobControl job;
  std::chrono::steady_clock::time_point asked;
  std::thread canceller([&] {
    while (std::string_view(job.stage()) != "drawing" || job.done() == 0)
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    asked = std::chrono::steady_clock::now();
    job.cancel();
  });
  const Cancelled seen = drawCancelled(**picture, still, job);
  const auto returned = std::chrono::steady_clock::now();
  canceller.join();
  EXPECT_EQ(seen.kind, engine::ErrorKind::kCancelled);
  EXPECT_LT(seen.done, seen.total);
  EXPECT_LT(seen.rows, 2048);
  // A part is drawn in some tenths of a second; the rest is for machines that do other work as well.
  EXPECT_LT(std::chrono::duration<double>(returned - asked).count(), 2.0);
  still.input.view.width = 320;
  still.input.view.height = 240;
  EXPECT_EQ(shoot(**picture, still).image.rgba, shoot(*sharedPicture(), still).image.rgba);
}

TEST(Still, DecorationsFitFromSmallToLargePicturesAndSayWhatDoesNot) {
  Still still = oblique(fieldOf(gridOf(80, 60), hills));
  still.input.decoration = Decoration::kFull;
  still.input.titles = {
      "a title far too long for any picture of this size, which has to be cut with an ellipsis somewhere"};
  for (const auto& [w, h] : {std::pair{640, 400}, {1280, 800}, {2560, 1600}}) {
    still.input.view.width = w;
    still.input.view.height = h;
    still.input.sharpness = Sharpness::kFull;
    EXPECT_TRUE(shoot(*sharedPicture(), still).stats.warnings.empty()) << w;
  }
  // Heights beyond the colours ask for a note.
  still.input.range = ValueRange{0.0, 0.5};
  still.input.view.width = 400;
  still.input.view.height = 140;
  EXPECT_FALSE(shoot(*sharedPicture(), still).stats.warnings.empty());
  still.input.view.width = still.input.view.height = 40;
  EXPECT_EQ(shoot(*sharedPicture(), still).image.width, 40);
}

TEST(Still, ADeviceThatIsNotThereIsRefusedWithTheReason) {
  LiveOptions options;
  options.device = "no such device";
  const auto picture = LivePicture::create(options);
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, engine::ErrorKind::kFailed);
  EXPECT_NE(picture.error().what.find("is not the requested one"), std::string::npos)
      << picture.error().line();
}

TEST(Still, WithoutAnyDriverTheErrorNamesThePackageToInstall) {
  // Read by the loader when an instance is made.
  const char* old = std::getenv("VK_ICD_FILENAMES");
  const std::string kept = old != nullptr ? old : "";
  setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
  const auto picture = LivePicture::create();
  if (old != nullptr)
    setenv("VK_ICD_FILENAMES", kept.c_str(), 1);
  else
    unsetenv("VK_ICD_FILENAMES");
  ASSERT_FALSE(picture);
  EXPECT_NE(picture.error().line().find("mesa-vulkan-drivers"), std::string::npos) << picture.error().line();
}

}  // namespace
}  // namespace fettle::render
