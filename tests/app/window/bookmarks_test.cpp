#include "app/window/bookmarks.h"

#include <gtest/gtest.h>

#include "app/window/view_text.h"

namespace fettle::app {
namespace {

TEST(Bookmarks, come_back_from_their_text_under_their_numbers) {
  Bookmarks bookmarks;
  EXPECT_EQ(bookmarks.count(), 0U);
  render::View view = startView();
  view.zoom = 3.5;
  view.centre_z = 0.02;
  bookmarks.set(2, view);
  view.azimuth_deg = 90.0;
  view.width = 55;  // of a window
  bookmarks.set(0, view);
  EXPECT_EQ(bookmarks.count(), 2U);
  Bookmarks other;
  other.restore(bookmarks.text());
  EXPECT_EQ(other.count(), 2U);
  for (std::size_t i = 0; i < Bookmarks::kCount; ++i) EXPECT_EQ(other.at(i), bookmarks.at(i)) << i;
  EXPECT_EQ(other.at(0)->azimuth_deg, 90.0);
  EXPECT_FALSE(other.at(1));
}

TEST(Bookmarks, a_text_that_is_none_leaves_none) {
  for (const char* text : {"", "7", "{}", "[1, \"x\", {}]", "[null]", "[{\"azimuth\": 1}]"}) {
    Bookmarks bookmarks;
    bookmarks.set(1, startView());
    bookmarks.restore(text);
    EXPECT_EQ(bookmarks.count(), 0U) << text;
  }
  Bookmarks more;
  const std::string view = viewText(startView());
  more.restore("[" + view + "," + view + "," + view + "," + view + "," + view + "]");
  EXPECT_EQ(more.count(), Bookmarks::kCount);
}

}  // namespace
}  // namespace fettle::app
