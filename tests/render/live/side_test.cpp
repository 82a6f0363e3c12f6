// Views from the side, at 0 degrees: a line of sight along the horizon is no special case of a low one.
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

FrameInput fromSide(double azimuth, Projection projection, double zoom = 1.0) {
  FrameInput input = bare();
  input.view.azimuth_deg = azimuth;
  input.view.elevation_deg = 0.0;
  input.view.projection = projection;
  input.view.zoom = zoom;
  return input;
}

TEST(Side, TheCoarsePictureLiesWithinItsBoundOfTheFullOne) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
    for (const double azimuth : {0.0, 90.0, 201.0}) {
      SCOPED_TRACE(testing::Message() << azimuth << ' ' << static_cast<int>(projection));
      const FrameInput view = fromSide(azimuth, projection);
      const Shot fine = shoot(*picture, full(view));
      FrameInput input = view;
      input.vertex_budget = 1 << 21;
      const Shot coarse = shoot(*picture, input);
      EXPECT_LE(coarse.stats.bound_px, 1.0);
      // As for other views [bounds_test.cpp].
      const int pixels = coarse.image.width * coarse.image.height;
      EXPECT_LE(unmatched(coarse.image, fine.image, 2, 10), pixels / 500);
      EXPECT_LE(unmatched(fine.image, coarse.image, 2, 10), pixels / 500);
    }
}

TEST(Side, TheTopOfAPlaneIsOneRow) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(fieldOf(gridOf(200, 160), [](int, int) { return 3.0; })));
  for (const double azimuth : {0.0, 90.0, 180.0, 270.0}) {
    const Shot shot = shoot(*picture, fromSide(azimuth, Projection::kOrthographic));
    // From the middle column: ground, then the side of the block in one colour, then ground.
    const int x = shot.image.width / 2;
    const auto at = [&](int y) {
      const std::uint8_t* p = &shot.image.rgba[4 * (static_cast<std::size_t>(y) * shot.image.width + x)];
      return std::tuple{p[0], p[1], p[2]};
    };
    int changes = 0;
    for (int y = 1; y < shot.image.height; ++y) changes += at(y) != at(y - 1);
    EXPECT_GE(changes, 2) << azimuth;
    EXPECT_LE(changes, 4) << azimuth << ": at most one row of the top, at each end one that is mixed";
  }
}

TEST(Side, OnDemandRequestsNoMorePagesThanALowView) {
  auto picture = makePicture({16 << 20});
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(wideField(0.0)));
  const auto requested = [&](double elevation) {
    FrameInput input = fromSide(30.0, Projection::kOrthographic, 2.0);
    input.view.elevation_deg = elevation;
    input.pages = FrameInput::Pages::kAll;
    return shoot(*picture, input).stats.residency.pages_requested;
  };
  const std::int64_t low = requested(3.0), side = requested(0.0);
  EXPECT_LE(side, 2 * low + 16);
}

}  // namespace
}  // namespace fettle::render
