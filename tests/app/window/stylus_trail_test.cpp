#include "app/window/stylus_trail.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using Clock = StylusTrail::Clock;
using std::chrono::milliseconds;

TEST(StylusTrail, is_the_way_of_the_last_second_and_thins_towards_its_end) {
  StylusTrail trail;
  const Clock::time_point start{};
  render::Overlays overlays;
  for (int i = 0; i <= 150; ++i) {
    overlays = {};
    trail.append({0.5 * i, 1.0, 2.0}, 0.1, start + milliseconds(16 * i), overlays);
  }
  // 2.4 s at 0.5 mm each 16 ms: 62 steps are of the last second.
  ASSERT_EQ(overlays.lines.size(), 62U);
  EXPECT_EQ(overlays.lines.back().to_mm, glm::dvec3(75.0, 1.0, 2.0));
  for (std::size_t i = 0; i < overlays.lines.size(); ++i) {
    EXPECT_EQ(overlays.lines[i].depth, render::OverlayLine::Depth::kInScene);
    if (i == 0) continue;
    EXPECT_EQ(overlays.lines[i].from_mm, overlays.lines[i - 1].to_mm) << "in one piece";
    EXPECT_GT(overlays.lines[i].width_px, overlays.lines[i - 1].width_px);
  }
}

TEST(StylusTrail, ends_a_second_after_the_tip_came_to_rest) {
  StylusTrail trail;
  const Clock::time_point start{};
  render::Overlays overlays;
  trail.append({0, 0, 0}, 0.1, start, overlays);
  EXPECT_TRUE(trail.empty());
  trail.append({5, 0, 0}, 0.1, start + milliseconds(100), overlays);
  EXPECT_FALSE(trail.empty());
  ASSERT_EQ(overlays.lines.size(), 1U);
  // Less than a pixel is rest.
  for (int i = 0; i < 60; ++i) {
    overlays = {};
    trail.append({5.05, 0, 0}, 0.1, start + milliseconds(100 + 15 * i), overlays);
  }
  EXPECT_FALSE(trail.empty());
  overlays = {};
  trail.append({5.05, 0, 0}, 0.1, start + milliseconds(1101), overlays);
  EXPECT_TRUE(trail.empty());
  EXPECT_TRUE(overlays.lines.empty());
}

TEST(StylusTrail, is_gone_when_it_is_cleared) {
  StylusTrail trail;
  render::Overlays overlays;
  trail.append({0, 0, 0}, 0.1, Clock::time_point{}, overlays);
  trail.append({5, 0, 0}, 0.1, Clock::time_point{}, overlays);
  trail.clear();
  EXPECT_TRUE(trail.empty());
  overlays = {};
  trail.append({9, 0, 0}, 0.1, Clock::time_point{}, overlays);
  EXPECT_TRUE(overlays.lines.empty()) << "no line from where it was before";
}

}  // namespace
}  // namespace fettle::app
