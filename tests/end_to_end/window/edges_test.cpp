// Suggested edges by hand: seen in a colour of their own next to the marks there are, and in theirs once
// taken.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Pixels of the surface that are tinted by a colour [sRGB], wholly opaque and shaded by the light: of its
// hue, and no brighter.
int tinted(const Screen& seen, const Part& part, double red, double green, double blue) {
  int found = 0;
  for (int y = part.y; y < part.y + part.height; ++y)
    for (int x = part.x; x < part.x + part.width; ++x) {
      const std::uint8_t* p = seen.at(x, y);
      const double light = p[0] / red;
      found += light > 0.5 && light < 1.05 && std::abs(p[1] - light * green) < 24 &&
               std::abs(p[2] - light * blue) < 24;
    }
  return found;
}

TEST_F(WindowTest, suggested_edges_have_a_colour_of_their_own_until_they_are_taken) {
  // As opaque as can be: the colours themselves.
  const std::filesystem::path settings = folder.path() / "fettle";
  std::filesystem::create_directories(settings);
  std::ofstream(settings / "window.json") << State{{"marks_opacity", 1.0}, {"edge_lines", false}};
  const auto program = start({scan});
  User user(display, *program, "edges");
  (void)opened(*program);
  user.at({20, 790});
  (void)user.key("7");
  const auto marks = [&](const Screen& seen) { return tinted(seen, user.surface(), 0xFF, 0x3B, 0x1F); };
  const auto suggestions = [&](const Screen& seen) { return tinted(seen, user.surface(), 0xFF, 0x9D, 0xF5); };
  (void)user.key("m");
  (void)user.stroke({240, 360}, {340, 360}, 4);
  (void)user.key("Escape");
  user.at({20, 790});
  const Screen before = user.until("marked", [&](const Screen& s) { return marks(s) > 300; });
  EXPECT_EQ(suggestions(before), 0);
  const int marked = marks(before);

  (void)user.press("e");
  program->until("a suggestion", [](const State& s) { return s["suggested"] > 0 && s["settled"] == true; });
  const Screen suggested = user.until("suggested", [&](const Screen& s) { return suggestions(s) > 1000; });
  EXPECT_NEAR(marks(suggested), marked, 0.02 * marked) << "marks that are there keep their colour";
  EXPECT_EQ(program->now()["steps"], 1);
  // Hidden with the marks, and dropped without a trace.
  (void)user.key("h");
  (void)user.until("hidden", [&](const Screen& s) { return suggestions(s) == 0 && marks(s) == 0; });
  (void)user.key("h");
  (void)user.same("suggested again", suggested);
  (void)user.key("Escape");
  (void)user.same("dropped", before);

  (void)user.press("e");
  program->until("a suggestion", [](const State& s) { return s["suggested"] > 0 && s["settled"] == true; });
  (void)user.same("suggested as before", suggested);
  EXPECT_EQ(user.key("Return")["steps"], 2);
  const Screen taken = user.until("taken", [&](const Screen& s) { return suggestions(s) == 0; });
  EXPECT_NEAR(marks(taken), marked + suggestions(suggested), 0.05 * (marked + suggestions(suggested)));
  EXPECT_EQ(user.key("ctrl+z")["steps"], 1);
  (void)user.same("undone", before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
