#include "app/window/view_text.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(ViewText, a_camera_comes_back_as_it_was_noted) {
  render::View view = startView();
  EXPECT_EQ(viewOf(viewText(view)), view);
  view.azimuth_deg = 12.5;
  view.elevation_deg = 90.0;
  view.zoom = 7.25;
  view.centre_x = 0.25;
  view.centre_y = 1.0 / 3.0;
  view.vertical_exaggeration = 3.0;
  view.projection = render::Projection::kPerspective;
  EXPECT_EQ(viewOf(viewText(view)), view);
}

TEST(ViewText, what_is_no_camera_is_the_one_at_the_start) {
  for (const char* text : {"", "no json", "[1, 2]", "{}", "{\"azimuth\": 5}",
                           "{\"azimuth\": 5, \"elevation\": 5, \"zoom\": 2, \"centre\": [1]}"})
    EXPECT_EQ(viewOf(text), startView()) << text;
}

}  // namespace
}  // namespace fettle::app
