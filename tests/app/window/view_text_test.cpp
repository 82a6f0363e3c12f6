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
  view.centre_z = -0.0625;
  view.vertical_exaggeration = 3.0;
  view.projection = render::Projection::kPerspective;
  EXPECT_EQ(viewOf(viewText(view)), view);
}

TEST(ViewText, a_camera_of_an_older_session_looks_at_the_middle_of_the_heights) {
  render::View view = startView();
  view.centre_x = 0.25;
  std::string text = viewText(view);
  const std::string centre = "\"centre\":[0.25,0.5,0.0]";
  const auto at = text.find(centre);
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_EQ(viewOf(text.replace(at, centre.size(), "\"centre\":[0.25,0.5]")), view);
}

TEST(ViewText, a_camera_that_no_picture_can_show_is_none) {
  for (const auto& [key, value] : {std::pair{"elevation", "500"},
                                   {"elevation", "-1"},
                                   {"zoom", "0"},
                                   {"zoom", "1e300"},
                                   {"exaggeration", "-2"}}) {
    std::string text = viewText(startView());
    const auto at = text.find(key);
    ASSERT_NE(at, std::string::npos);
    const auto from = text.find(':', at) + 1;
    text.replace(from, text.find_first_of(",}", from) - from, value);
    EXPECT_FALSE(parseView(text)) << text;
  }
}

TEST(ViewText, what_is_no_camera_is_the_one_at_the_start) {
  for (const char* text : {"", "no json", "[1, 2]", "{}", "{\"azimuth\": 5}",
                           "{\"azimuth\": 5, \"elevation\": 5, \"zoom\": 2, \"centre\": [1]}"})
    EXPECT_EQ(viewOf(text), startView()) << text;
}

}  // namespace
}  // namespace fettle::app
