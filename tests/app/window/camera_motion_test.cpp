#include "app/window/camera_motion.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using render::Sharpness;
using std::chrono::milliseconds;

TEST(CameraMotion, IsHalfAsSharpWhileTheViewMovesAndSharpWhenItRests) {
  CameraMotion motion;
  render::View view;
  const CameraMotion::Clock::time_point start{};
  EXPECT_EQ(motion.see(view, false, start), Sharpness::kFull);
  EXPECT_FALSE(motion.sharpPending());
  view.azimuth_deg += 1.0;
  EXPECT_EQ(motion.see(view, false, start + milliseconds(10)), Sharpness::kHalf);
  EXPECT_TRUE(motion.sharpPending());
  // A frame between two events of the wheel is no rest.
  EXPECT_EQ(motion.see(view, false, start + milliseconds(30)), Sharpness::kHalf);
  view.zoom = 2.0;
  EXPECT_EQ(motion.see(view, false, start + milliseconds(50)), Sharpness::kHalf);
  EXPECT_EQ(motion.see(view, false, start + milliseconds(82)), Sharpness::kHalf);
  EXPECT_EQ(motion.see(view, false, start + milliseconds(83)), Sharpness::kFull);
  EXPECT_FALSE(motion.sharpPending());
  EXPECT_EQ(motion.see(view, false, start + milliseconds(84)), Sharpness::kFull);
}

TEST(CameraMotion, WaitsLongerWhileAHandHoldsTheView) {
  CameraMotion motion;
  render::View view;
  const CameraMotion::Clock::time_point start{};
  (void)motion.see(view, true, start);
  view.centre_x = 0.6;
  EXPECT_EQ(motion.see(view, true, start), Sharpness::kHalf);
  EXPECT_EQ(motion.see(view, true, start + milliseconds(99)), Sharpness::kHalf);
  EXPECT_EQ(motion.see(view, true, start + milliseconds(100)), Sharpness::kFull);
  view.centre_x = 0.7;
  EXPECT_EQ(motion.see(view, true, start + milliseconds(110)), Sharpness::kHalf);
  // Let go.
  EXPECT_EQ(motion.see(view, false, start + milliseconds(150)), Sharpness::kFull);
}

}  // namespace
}  // namespace fettle::app
