// The line of a section lies on the surface and nowhere else.
#include <algorithm>

#include <gtest/gtest.h>

#include "app/overlay/line_overlay.h"
#include "app/window/overlays.h"
#include "app/work/section_tool.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

// Heights of 200 mm, without those of some columns in the middle.
engine::Version fieldWithGap(int first, int last) {
  return tests::fieldOf(60, 20,
                        [&](int c, int) { return c >= first && c <= last ? double(tests::kHole) : 200.0; });
}

render::Overlays overlaysOf(const engine::Version& field, double from_x, double to_x) {
  SectionTool section;
  section.setFrom({from_x, 10.0});
  section.setTo({to_x, 10.0});
  render::Overlays overlays;
  SectionOverlay().append(field, section, 0.5, overlays);
  return overlays;
}

// A view that is centred there looks at the surface, whose heights need not be about 0.
TEST(SectionOverlay, the_middle_of_what_lies_around_a_hole_is_as_high_as_the_surface) {
  const engine::Version field = fieldWithGap(20, 40);
  const glm::dvec3 middle = middleOnSurface(field.reader(), {10.0, 5.0}, {50.0, 15.0});
  EXPECT_EQ(middle.x, 30.0);
  EXPECT_EQ(middle.y, 10.0);
  EXPECT_EQ(middle.z, 200.0);
  EXPECT_EQ(middleOnSurface(field.reader(), {25.0, 5.0}, {35.0, 15.0}).z, 200.0) << "all of it is a hole";
}

TEST(SectionOverlay, a_line_is_not_drawn_over_a_hole) {
  const render::Overlays seen = overlaysOf(fieldWithGap(20, 40), 2.0, 57.0);
  ASSERT_FALSE(seen.lines.empty());
  for (const render::OverlayLine& piece : seen.lines) {
    EXPECT_EQ(piece.from_mm.z, 200.0) << piece.from_mm.x;
    EXPECT_EQ(piece.to_mm.z, 200.0) << piece.to_mm.x;
    // Two samples to either side are seen from there.
    EXPECT_FALSE(piece.from_mm.x > 23.0 && piece.from_mm.x < 38.0) << piece.from_mm.x;
  }
}

TEST(SectionOverlay, an_end_over_a_hole_is_where_it_was_set_at_the_height_beside_it) {
  const render::Overlays seen = overlaysOf(fieldWithGap(40, 59), 2.0, 55.0);
  EXPECT_TRUE(std::ranges::any_of(seen.lines, [](const render::OverlayLine& piece) {
    return piece.from_mm == piece.to_mm && piece.from_mm == glm::dvec3(55.0, 10.0, 200.0);
  }));
}

}  // namespace
}  // namespace fettle::app
