// The ways in which frames reach a display: memory that its server shares, else Vulkan's own.
#include <cstdlib>

#include <utility>
#include <vector>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Frames of which only parts changed: lines over all of the surface, a stroke, a menu that opens and closes.
void changeParts(User& user) {
  (void)user.key("7");
  (void)user.key("c");
  (void)user.key("s");
  const Part surface = user.surface();
  const int x = surface.x + surface.width / 2, y = surface.y + surface.height / 2;
  (void)user.stroke({x - 60, y}, {x + 60, y + 30}, 8);
  (void)user.key("Escape");
  user.at({20, 790});
  (void)user.rest();
}

TEST_F(WindowTest, parts_of_frames_add_up_to_the_whole_on_a_display_that_shares_memory) {
  const auto program = start({scan});
  User user(display, *program, "shared");
  (void)opened(*program);
  changeParts(user);
  const Screen parts = user.look("in parts");
  const Part all{0, 0, parts.width, parts.height};
  other.coverAndUncover();
  (void)user.until("the whole frame again",
                   [&](const Screen& now) { return differing(parts, now, all, 0) == 0; });
  EXPECT_EQ(quitWithoutSaving(user)["shown_through"], "shared memory");
}

TEST_F(WindowTest, a_display_that_shares_no_memory_shows_the_same) {
  std::vector<Screen> screens;
  const TempFolder apart;
  const Display plain(width_, height_, apart.path(), {"-extension", "MIT-SHM"});
  for (const Display* on : {&std::as_const(display), &plain}) {
    setenv("DISPLAY", on->name().c_str(), 1);
    const auto program = start({scan});
    User user(*on, *program, on == &plain ? "plain" : "shared");
    (void)opened(*program);
    (void)user.key("7");
    if (program->now()["contours"] == false) (void)user.key("c");  // the second has the first one's settings
    user.at({20, 790});
    (void)user.rest();
    screens.push_back(user.look("contour lines from above"));
    EXPECT_EQ(quit(user)["shown_through"], on == &plain ? "Vulkan" : "shared memory");
  }
  EXPECT_EQ(differing(screens[0], screens[1], {0, 0, width_, height_}, 0), 0);
}

}  // namespace
}  // namespace fettle::tests
