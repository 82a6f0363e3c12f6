// Frames over the ones before in the same target: only what differs is written, and every pixel is as in a picture drawn afresh.
#include <cmath>
#include <random>

#include "engine/field/live_field.h"
#include "render/live/overlay_places.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

double share(const Shot& shot) {
  double px = 0.0;
  for (const Rectangle& place : shot.stats.changed) px += double(place.width) * place.height;
  return px / (double(shot.image.width) * shot.image.height);
}

// A pen somewhere, lines through the surface and over it; some of each reach out of the picture, or behind the viewer.
Overlays overlaysAt(std::mt19937& random) {
  std::uniform_real_distribution<double> x(-10.0, 74.0), y(-10.0, 58.0), z(-4.0, 30.0), far(-500.0, 500.0);
  const auto near = [&] { return glm::dvec3(x(random), y(random), z(random)); };
  Overlays overlays;
  if (random() % 4 != 0) {
    overlays.stylus = StylusBody{.tip_mm = near(), .shadow = random() % 3 != 0};
    if (random() % 2 == 0) overlays.stylus->ball_radius_mm = 1.5;
    if (random() % 2 == 0) overlays.stylus->to_tail = near();
  }
  for (auto i = random() % 6; i > 0; --i) {
    const glm::dvec3 from = near();
    const glm::dvec3 to = random() % 5 == 0 ? glm::dvec3(far(random), far(random), far(random)) : near();
    overlays.lines.push_back(
        {.from_mm = from,
         .to_mm = to,
         .width_px = 1.0F + static_cast<float>(random() % 5),
         .depth = random() % 2 == 0 ? OverlayLine::Depth::kInScene : OverlayLine::Depth::kOnTop});
  }
  return overlays;
}

TEST(KeptTarget, OverlaysThatMoveOverEditsLeaveNothingBehind) {
  for (const FrameInput& view : views()) {
    SCOPED_TRACE(view.view.elevation_deg);
    std::mt19937 random(11);
    auto kept = makePicture(), fresh = makePicture();
    engine::LiveField live(partField(), engine::Growth::kAllowed);
    FrameInput input = view;
    input.range = ValueRange{-3, 9};
    ASSERT_TRUE(kept->update(live.snapshot()));
    (void)drawComplete(*kept, input);
    for (int step = 0; step < 24; ++step) {
      if (step % 3 == 0) {
        ASSERT_TRUE(live.setHeight(static_cast<std::int32_t>(random() % 640),
                                   static_cast<std::int32_t>(random() % 480), 4.0F));
      }
      ASSERT_TRUE(kept->update(live.snapshot()));
      input.overlays = overlaysAt(random);
      const Shot now = shoot(*kept, input);
      ASSERT_TRUE(now.stats.continued);
      if (step % 4 != 3) continue;
      FrameInput all = input;
      all.redraw = FrameInput::Redraw::kAll;
      ASSERT_TRUE(fresh->update(live.snapshot()));
      ASSERT_EQ(differing(now.image, drawComplete(*fresh, all).image), 0U) << "step " << step;
    }
  }
}

TEST(KeptTarget, AFrameWritesWhatDiffersAlone) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  FrameInput input = bare();
  EXPECT_EQ(share(shoot(*picture, input)), 1.0) << "the first one";
  (void)drawComplete(*picture, input);
  EXPECT_EQ(share(shoot(*picture, input)), 0.0) << "nothing differs";
  input.overlays.stylus = StylusBody{.tip_mm = {30.0, 20.0, 6.0}, .shadow = false};
  const double pen = share(shoot(*picture, input));
  EXPECT_GT(pen, 0.005);
  EXPECT_LT(pen, 0.15);
  input.overlays.stylus->tip_mm.x += 0.5;
  EXPECT_LT(share(shoot(*picture, input)), 0.2) << "where it was and where it is";
  input.overlays = {};
  EXPECT_NEAR(share(shoot(*picture, input)), pen, 0.05) << "it is gone";
  EXPECT_EQ(share(shoot(*picture, input)), 0.0);
  input.view.zoom = 2.0;
  EXPECT_EQ(share(shoot(*picture, input)), 1.0) << "another view";
}

}  // namespace
}  // namespace fettle::render
