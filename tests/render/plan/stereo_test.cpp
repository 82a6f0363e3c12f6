// A picture for each eye: where things lie in them, and that they are drawn as such.
#include "render/plan/stereo.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include <glm/geometric.hpp>

#include "engine/field/live_field.h"
#include "render/live/live_picture.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

const Box kShown{{-40, -30, -5}, {40, 30, 5}};
const Rectangle kPlot{10, 20, 640, 400};

Camera cameraOf(Projection projection, double azimuth, double elevation, double zoom) {
  View view;
  view.projection = projection;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  view.zoom = zoom;
  view.centre_x = 0.6;
  return Camera::fit(view, kShown, kShown, kPlot);
}

class Points {
 public:
  glm::dvec3 next() {
    const auto in = [this](double low, double high) {
      return low + (high - low) * std::generate_canonical<double, 32>(random_);
    };
    const double x = in(-40, 40), y = in(-30, 30);
    return {x, y, in(-5, 5)};
  }

 private:
  std::mt19937 random_{7};
};

// Where two lines come nearest to each other: the middle between them, and how far apart they are.
std::pair<glm::dvec3, double> meeting(const Ray& a, const Ray& b) {
  const glm::dvec3 w = a.from - b.from;
  const double ab = glm::dot(a.along, b.along), s = 1.0 - ab * ab;
  const double ta = (ab * glm::dot(b.along, w) - glm::dot(a.along, w)) / s;
  const double tb = (glm::dot(b.along, w) - ab * glm::dot(a.along, w)) / s;
  const glm::dvec3 p = a.from + ta * a.along, q = b.from + tb * b.along;
  return {0.5 * (p + q), glm::length(p - q)};
}

TEST(StereoCamera, PointsOfTheWindowAreSeenAtOnePlaceNearOnesCrossedFarOnesApart) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic})
    for (const double window : {0.8, 1.0, 1.3}) {
      const Camera middle = cameraOf(projection, 30, 35, 1.5);
      const std::array<Camera, 2> eyes = eyesOf(middle, {}, window);
      Points points;
      for (int i = 0; i < 200; ++i) {
        const glm::dvec3 p = points.next();
        const double at = middle.windowOf(p);
        // No point is higher for one eye than for the other, wherever it is.
        ASSERT_NEAR(eyes[0].pixelOf(p).y, eyes[1].pixelOf(p).y, 1e-9);
        ASSERT_NEAR(eyes[0].pixelOf(p).y, middle.pixelOf(p).y, 1e-9);
        if (std::abs(at - window) > 1e-3) {
          ASSERT_EQ(parallaxOf(eyes, p) > 0.0, at > window) << at;
        }
        // The same point moved onto the window along the view.
        const glm::dvec3 on =
            p + (at - window) * (middle.toViewer() / (at - middle.windowOf(p + middle.toViewer())));
        ASSERT_NEAR(middle.windowOf(on), window, 1e-12);
        ASSERT_NEAR(parallaxOf(eyes, on), 0.0, 1e-9);
        ASSERT_NEAR(eyes[0].pixelOf(on).x, middle.pixelOf(on).x, 1e-9);
      }
    }
}

TEST(StereoCamera, AnEyeSeesAPointWhereItsLineOfSightCrossesTheWindow) {
  const Camera middle = cameraOf(Projection::kPerspective, 300, 50, 2.0);
  const double window = 1.1, share = 0.04;
  const Camera eye = middle.aside(share, window);
  // Every ray of the middle camera comes from where the viewer is; the eye is that, aside.
  const glm::dvec3 viewer = meeting(middle.rayAt({100, 50}), middle.rayAt({500, 380})).first;
  const double distance = 1.0 / (middle.windowOf(glm::dvec3(0.0)) - middle.windowOf(middle.toViewer()));
  const glm::dvec3 place = viewer + share * distance * middle.right();
  EXPECT_NEAR(middle.windowOf(viewer), 0.0, 1e-9);
  Points points;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p = points.next();
    const double t = window / middle.windowOf(p);  // from the eye, at 0, to p
    const glm::dvec3 crossing = place + t * (p - place);
    const glm::dvec2 expected = middle.pixelOf(crossing), seen = eye.pixelOf(p);
    // Rounding: coordinates of some 1000 px, a few hundred operations at 1e-16.
    ASSERT_NEAR(seen.x, expected.x, 1e-8);
    ASSERT_NEAR(seen.y, expected.y, 1e-8);
  }
}

TEST(StereoCamera, TheTwoEyesLinesOfSightMeetAtThePointTheyShow) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    const std::array<Camera, 2> eyes = eyesOf(cameraOf(projection, 120, 40, 1.0), {}, 1.0);
    Points points;
    for (int i = 0; i < 100; ++i) {
      const glm::dvec3 p = points.next();
      const auto [at, apart] = meeting(eyes[0].rayAt(eyes[0].pixelOf(p)), eyes[1].rayAt(eyes[1].pixelOf(p)));
      // The lines meet at a thirtieth of a radian, so that rounding is some thirty times larger along them.
      ASSERT_NEAR(glm::length(at - p), 0.0, 1e-7);
      ASSERT_NEAR(apart, 0.0, 1e-9);
    }
  }
}

TEST(StereoCamera, MillimetresOnTheScreenAreWhatFarPointsAreApart) {
  const Camera middle = cameraOf(Projection::kPerspective, 0, 20, 1.0);
  Stereo stereo;
  stereo.eye_separation_mm = 63.0;
  stereo.mm_per_pixel = 0.3;
  const std::array<Camera, 2> eyes = eyesOf(middle, stereo, 1.2);
  const glm::dvec3 far = -1e9 * middle.toViewer();
  EXPECT_NEAR(parallaxOf(eyes, far), 63.0 / 0.3, 1e-3);
}

TEST(StereoCamera, WhatAMoveShowsStaysWithinTheBoundForBothEyes) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    const std::array<Camera, 2> eyes = eyesOf(cameraOf(projection, 75, 25, 3.0), {}, 0.9);
    Points points;
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 low = points.next(), step = 0.02 * points.next();
      const Box box{low, low + glm::dvec3(1.0)};
      for (const Camera& eye : eyes) {
        const glm::dvec2 a = eye.pixelOf(low + glm::dvec3(0.5)),
                         b = eye.pixelOf(low + glm::dvec3(0.5) + step);
        // What is outside the plot has no bound.
        if (std::abs(a.x - 330) > 320 || std::abs(a.y - 220) > 200) continue;
        ASSERT_LE(glm::length(b - a), eye.movesAtMost(step, box) * (1.0 + 1e-9));
      }
    }
  }
}

TEST(StereoCamera, ValuesOutOfRangeAreRefused) {
  EXPECT_TRUE(check(Stereo{}));
  const auto refused = [](auto change) {
    Stereo stereo;
    change(stereo);
    const engine::Status status = check(stereo);
    return !status && status.error().kind == engine::ErrorKind::kInput;
  };
  EXPECT_TRUE(refused([](Stereo& s) { s.eye_separation = 0.0; }));
  EXPECT_TRUE(refused([](Stereo& s) { s.eye_separation = std::nan(""); }));
  EXPECT_TRUE(refused([](Stereo& s) { s.eye_separation_mm = -1.0; }));
  EXPECT_TRUE(refused([](Stereo& s) { s.mm_per_pixel = 0.0; }));
  EXPECT_TRUE(refused([](Stereo& s) { s.screen_distance = 0.01; }));
}

// Slopes, walls, holes.
engine::Version part(bool holes) {
  return fieldOf(
      gridOf(500, 400, 0.1, 0.1),
      [&](int c, int r) {
        if (holes && (std::hypot(c - 300.0, r - 150.0) < 20 || (c > 480 && r > 370))) return double{kNan};
        const double x = 0.1 * c, y = 0.1 * r;
        return 0.05 * x + 1.5 * std::sin(0.4 * x) * std::cos(0.3 * y) + (y > 15 && y < 19 ? -3.0 : 0.0) +
               (std::hypot(x - 15, y - 28) < 6 ? 4.0 : 0.0);
      },
      [](int c, int r) { return (c + r) % 120 < 6; });
}

std::unique_ptr<LivePicture> makePicture(std::int64_t memory = 0) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.memory_budget_bytes = memory;
  auto picture = LivePicture::create(options);
  if (!picture) ADD_FAILURE() << picture.error().line();
  return picture ? *std::move(picture) : nullptr;
}

FrameInput frameOf(StereoMode mode, int width = 640, int height = 240) {
  FrameInput input;
  input.view.width = width;
  input.view.height = height;
  input.view.projection = Projection::kPerspective;
  input.view.elevation_deg = 35;
  input.view.vertical_exaggeration = 1.0;
  input.range = ValueRange{-4, 8};
  input.stereo.mode = mode;
  return input;
}

Image shoot(LivePicture& picture, const FrameInput& input, FrameStatistics* out = nullptr) {
  Image image;
  // Until all pages are there, where they come on demand.
  for (int i = 0; i < 50; ++i) {
    const auto stats = picture.draw(input, image);
    if (!stats) {
      ADD_FAILURE() << stats.error().line();
      return image;
    }
    if (out != nullptr) *out = *stats;
    if (stats->upload.pending_tiles == 0 && stats->residency.pages_loaded == 0) break;
  }
  for (const std::string& message : picture.validationMessages()) ADD_FAILURE() << message;
  return image;
}

std::size_t differing(const Image& a, const Image& b) {
  if (a.rgba.size() != b.rgba.size()) return a.rgba.size();
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4)
    n += !std::equal(a.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                     a.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 4,
                     b.rgba.begin() + static_cast<std::ptrdiff_t>(i));
  return n;
}

Image half(const Image& whole, int which) {
  Image image;
  image.width = whole.width / 2;
  image.height = whole.height;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = pixel(whole, which * image.width, y);
    image.rgba.insert(image.rgba.end(), from, from + std::ptrdiff_t{4} * image.width);
  }
  return image;
}

TEST(StereoPicture, OnePassForBothEyesDrawsWhatTwoPassesDoBitForBit) {
  for (const bool on_demand : {false, true}) {
    // By need: 0.8 MB of heights and 0.2 MB of marks for each of three states do not fit.
    auto picture = makePicture(on_demand ? 1300000 : 0);
    ASSERT_TRUE(picture);
    Shown shown;
    shown.versions = {part(true)};
    shown.marks = MarksOverlay::kShow;
    for (const int what : {0, 1, 2}) {
      SCOPED_TRACE(testing::Message() << (on_demand ? "on demand " : "whole ") << what);
      if (what == 1) shown.versions = {part(true), part(false)};
      if (what == 2) shown.original = part(false);
      ASSERT_TRUE(picture->update(shown));
      for (const StereoMode mode : {StereoMode::kSideBySide, StereoMode::kAnaglyph}) {
        FrameInput input = frameOf(mode);
        if (what == 1) input.view.projection = Projection::kOrthographic;
        if (what == 2) input.range.reset();
        input.contours = what == 0 ? Contours::kShow : Contours::kHide;
        input.overlays.rings = {{20, 22, 5, {1, 1, 1}, 2}};
        appendStylus({{12, 18, 9}, {12, 18, 5}, {0, 0, 2}, true, 1.0}, 1.0, input.overlays.lines);
        // All of the field is in the plot: nothing is clipped, which not every driver does right for two
        // views.
        input.stereo.passes = Stereo::Passes::kOne;
        const Image one = shoot(*picture, input);
        input.stereo.passes = Stereo::Passes::kTwo;
        EXPECT_EQ(differing(shoot(*picture, input), one), 0U);
        EXPECT_GT(differing(half(one, 0), half(one, 1)), 1000U);
      }
    }
  }
}

TEST(StereoPicture, WhatCrossesThePlotsEdgeIsInBothEyesPictures) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(part(true)));
  FrameInput input = frameOf(StereoMode::kSideBySide);
  input.view.zoom = 2.5;
  const Image best = shoot(*picture, input);
  input.stereo.passes = Stereo::Passes::kTwo;
  EXPECT_EQ(differing(shoot(*picture, input), best), 0U);
  // Each eye's picture shows about as much ground as that of the camera between them: no wall and no plate is
  // missing in one.
  FrameInput one = frameOf(StereoMode::kOff, 320);
  one.view.zoom = 2.5;
  const Image mono = shoot(*picture, one);
  const auto ground = [&](const Image& image) {
    int n = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      n += std::equal(image.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                      image.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 3, mono.rgba.begin());
    return n;
  };
  for (const int eye : {0, 1}) EXPECT_NEAR(ground(half(best, eye)), ground(mono), 320 * 240 / 50) << eye;
}

TEST(StereoPicture, EyesAtOnePlaceSeeThePictureOfOneEye) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(part(true)));
  FrameInput input = frameOf(StereoMode::kOff, 320);
  const Image mono = shoot(*picture, input);
  FrameInput both = frameOf(StereoMode::kSideBySide, 640);
  // So close that no coordinate differs in single precision.
  both.stereo.eye_separation = 1e-14;
  const Image pair = shoot(*picture, both);
  EXPECT_EQ(differing(half(pair, 0), mono), 0U);
  EXPECT_EQ(differing(half(pair, 1), mono), 0U);
  // And what follows is as if there had been no stereo.
  EXPECT_EQ(differing(shoot(*picture, input), mono), 0U);
  FrameInput glasses = frameOf(StereoMode::kAnaglyph, 320);
  for (const Stereo::Passes passes : {Stereo::Passes::kOne, Stereo::Passes::kTwo}) {
    glasses.stereo.passes = passes;
    EXPECT_GT(differing(shoot(*picture, glasses), mono), 1000U);
    EXPECT_EQ(differing(shoot(*picture, input), mono), 0U);
  }
}

TEST(StereoPicture, AnAnaglyphIsMadeOfTheTwoEyesPictures) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(part(true)));
  const Image eyes = shoot(*picture, frameOf(StereoMode::kSideBySide, 640));
  const Image anaglyph = shoot(*picture, frameOf(StereoMode::kAnaglyph, 320));
  // Dubois 2001, as in shaders/stereo.frag; rows are red, green, blue of the anaglyph.
  constexpr double kLeft[3][3] = {{0.4561, 0.500484, 0.176381},
                                  {-0.0400822, -0.0378246, -0.0157589},
                                  {-0.0152161, -0.0205971, -0.00546856}};
  constexpr double kRight[3][3] = {{-0.0434706, -0.0879388, -0.00155529},
                                   {0.378476, 0.73364, -0.0184503},
                                   {-0.0721527, -0.112961, 1.2264}};
  const auto linear = [](std::uint8_t code) {
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  double worst = 0.0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const std::uint8_t *l = pixel(eyes, x, y), *r = pixel(eyes, x + 320, y), *a = pixel(anaglyph, x, y);
      for (int k = 0; k < 3; ++k) {
        double c = 0.0;
        for (int j = 0; j < 3; ++j) c += kLeft[k][j] * linear(l[j]) + kRight[k][j] * linear(r[j]);
        c = std::clamp(c, 0.0, 1.0);
        // Linear light that the code above and the one below stand for.
        const double below = linear(static_cast<std::uint8_t>(std::max(0, a[k] - 1)));
        const double above = linear(static_cast<std::uint8_t>(std::min(255, a[k] + 1)));
        worst = std::max({worst, below - c, c - above});
      }
    }
  // Besides that code, a device's own conversion from sRGB may be off by as much as half a code near the top,
  // which is 1/220 in linear light there, and so may the matrices' products be.
  EXPECT_LE(worst, 1.0 / 220.0);
}

// What two eyes cost, for the record; time is not judged here.
TEST(StereoPicture, TheEyesOfALargePictureDifferAndTheirTimeIsTold) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(part(true)));
  FrameInput inputs[4];
  for (FrameInput& input : inputs) input = frameOf(StereoMode::kAnaglyph, 1280, 800);
  inputs[0].stereo.mode = StereoMode::kOff;
  inputs[1].stereo.passes = Stereo::Passes::kOne;
  inputs[2].stereo.passes = Stereo::Passes::kTwo;
  inputs[3].stereo.mode = StereoMode::kSideBySide;
  EXPECT_GT(differing(shoot(*picture, inputs[0]), shoot(*picture, inputs[2])), 10000U);
  std::vector<double> ms[4];
  for (int i = 0; i < 7; ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      // A picture of which nothing changes would not be drawn again.
      inputs[k].view.azimuth_deg += 0.01;
      const auto stats = picture->drawAndWait(inputs[k]);
      ASSERT_TRUE(stats);
      ms[k].push_back(stats->select_ms + stats->record_ms + stats->device_ms);
    }
  for (std::vector<double>& all : ms) std::nth_element(all.begin(), all.begin() + 3, all.end());
  std::printf(
      "1280 x 800, medians of 7: one eye %.1f ms, anaglyph %.2f times that in one pass, %.2f in two, "
      "side by side %.2f\n",
      ms[0][3], ms[1][3] / ms[0][3], ms[2][3] / ms[0][3], ms[3][3] / ms[0][3]);
}

TEST(StereoPicture, BothEyesPickThePointTheyShowAndADiscIsDrawnThere) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(part(false)));
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    FrameInput input = frameOf(StereoMode::kSideBySide);
    input.view.projection = projection;
    input.decoration = Decoration::kNone;
    (void)shoot(*picture, input);
    int agreed = 0, hidden = 0;
    glm::dvec3 shown{0.0};
    for (int y = 30; y < 220; y += 17)
      for (int x = 20; x < 300; x += 23) {
        const auto left = picture->pick(x, y);
        if (!left) continue;
        const auto at = picture->pixelOf(0, left->position_mm, Eye::kRight);
        ASSERT_TRUE(at);
        EXPECT_NEAR(at->second, y, 1e-6);
        const auto right = picture->pick(at->first, at->second);
        // What is before it for the right eye alone hides it.
        const bool same = right && glm::length(right->position_mm - left->position_mm) < 1e-6;
        ++(same ? agreed : hidden);
        if (same && agreed == 20) shown = left->position_mm;
      }
    EXPECT_GT(agreed, 45);
    EXPECT_LT(hidden, agreed / 10);
    input.overlays.lines = {{shown, shown, {1, 0, 0}, 1.0F, 9.0F}};
    const Image image = shoot(*picture, input);
    for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
      const auto at = picture->pixelOf(0, shown, eye);
      ASSERT_TRUE(at);
      const std::uint8_t* p = pixel(image, static_cast<int>(at->first), static_cast<int>(at->second));
      EXPECT_EQ(p[0], 255);
      EXPECT_EQ(p[1], 0);
    }
  }
}

TEST(StereoPicture, TheWindowStandsAtTheSurfaceInTheMiddleUnlessSaidOtherwise) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(part(false)));
  FrameInput input = frameOf(StereoMode::kSideBySide);
  input.decoration = Decoration::kNone;
  input.view.zoom = 6.0;
  const auto parallax = [&] {
    (void)shoot(*picture, input);
    const auto middle = picture->pick(160, 120);
    EXPECT_TRUE(middle);
    const auto left = picture->pixelOf(0, middle->position_mm, Eye::kLeft);
    return picture->pixelOf(0, middle->position_mm, Eye::kRight)->first - 320 - left->first;
  };
  EXPECT_NEAR(parallax(), 0.0, 0.5);
  input.stereo.screen_distance = 1.2;
  EXPECT_LT(parallax(), -2.0);
  input.stereo.screen_distance = 0.8;
  EXPECT_GT(parallax(), 2.0);
  input.stereo.screen_distance = -1.0;
  Image image;
  const auto refused = picture->draw(input, image);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
}

}  // namespace
}  // namespace fettle::render
