// Sizes of the window, of its text, and no size at all.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

class SizeTest : public WindowTest {
 protected:
  SizeTest() : WindowTest(1400, 1000) {}

  void resize(std::uint32_t window, int width, int height) const {
    display.hands({"windowsize", std::to_string(window), std::to_string(width), std::to_string(height)});
  }
  // Rows of the first line written at the picture's right end [pixels].
  static int titleHeight(const Screen& seen, const State& picture) {
    const int left = picture[0].get<int>() + 4 * picture[2].get<int>() / 5;
    const int right = picture[0].get<int>() + picture[2].get<int>();
    const auto written = [&](int y) {
      for (int x = left; x < right; ++x) {
        const std::uint8_t* p = seen.at(x, y);
        if (p[0] > 120 && std::abs(p[0] - p[1]) < 12 && std::abs(p[1] - p[2]) < 12) return true;
      }
      return false;
    };
    int top = picture[1];
    while (top < seen.height && !written(top)) ++top;
    int end = top;
    while (end < seen.height && written(end)) ++end;
    return end - top;
  }
  static State sized(ViewProgram& program, int width, int height) {
    return program.until(fmt::format("{} x {}", width, height), [&](const State& s) {
      return s["frame"] == State{width, height} && s["settled"] == true;
    });
  }
};

TEST_F(SizeTest, a_window_changes_its_size_at_any_time) {
  const auto program = start({scan, "--size", "1100x800"});
  User user(display, *program, "size");
  (void)opened(*program);
  (void)user.key("7");
  const std::uint32_t window = other.windowOf("fettle");
  const Screen before = user.look("as opened");
  for (const auto& [width, height] :
       {std::pair{1400, 1000}, {640, 480}, {480, 320}, {200, 120}, {1, 1}, {1400, 200}}) {
    resize(window, width, height);
    (void)sized(*program, width, height);
    (void)user.look(fmt::format("{}x{}", width, height));
  }
  resize(window, 1100, 800);
  (void)sized(*program, 1100, 800);
  (void)user.same("the first size again", before);

  // Minimised: nothing is drawn; afterwards everything is there.
  other.minimise(window);
  program->until("minimised", [](const State& s) { return s["minimised"] == true; });
  other.restore(window);
  program->until("restored", [](const State& s) { return s["minimised"] == false && s["settled"] == true; });
  (void)user.same("restored", before);

  // A storm of sizes while a stroke runs.
  (void)user.key("m");
  user.at({240, 360});
  user.down(1);
  for (int i = 0; i < 40; ++i) {
    resize(window, 700 + 10 * (i % 7), 600 + 10 * (i % 5));
    display.hands({"mousemove", std::to_string(240 + 2 * i), "360"});
  }
  resize(window, 1100, 800);
  (void)program->until("the size after the storm", [](const State& s) {
    return s["frame"] == State{1100, 800};
  });
  user.at({330, 360});
  user.up(1);
  EXPECT_EQ(user.rest()["steps"], 1);
  (void)user.key("Escape");
  user.at({20, 790});
  (void)user.changed("marked in a storm", before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0);
  expectSilence(*program);
}

// Pixels from a place up to the highest one of the picture that differs.
int risesAbove(const Screen& a, const Screen& b, const State& picture, User::Place from) {
  int highest = from.y;
  for (int y = from.y; y > picture[1].get<int>(); --y)
    if (differing(a, b, {picture[0], y, picture[2], 1}) > 0) highest = y;
  return from.y - highest;
}

TEST_F(SizeTest, text_and_panels_grow_with_the_display) {
  int usual_pen = 0;
  for (const auto& [dpi, scale] : {std::pair{96, 1.0}, {120, 1.25}, {144, 1.5}, {192, 2.0}}) {
    other.setResources(fmt::format("Xft.dpi:\t{}\n", dpi));
    const auto program = start({scan, "--size", fmt::format("{}x{}", int(1300 / scale), int(960 / scale))});
    User user(display, *program, fmt::format("dpi{}", dpi));
    const State shown = opened(*program);
    EXPECT_NEAR(shown["scale"].get<double>(), scale, 0.01);
    const Screen seen = user.look("opened");
    // The title of the colour bar, in 13 pixels at scale 1: from the top of the h to the foot of the g is the
    // size of the letters (DejaVu: 0.760 above the line, 0.236 below), rounded at both ends.
    EXPECT_NEAR(titleHeight(seen, shown["picture"]), 13.0 * scale, 1.5) << dpi;
    for (const State& text : shown["texts"]) EXPECT_EQ(text["cut"], false) << dpi << " dpi: " << text.dump();
    // The pen over the surface, and the same without a tool.
    (void)user.key("s");
    const Part surface = user.surface();
    const User::Place middle{surface.x + surface.width / 2, surface.y + surface.height / 2};
    user.at(middle);
    (void)program->until("the pen at the cursor", [](const State& now) {
      return now["settled"] == true && now["under_cursor"].is_array() &&
             std::abs(now["under_cursor"][0].get<int>() - now["stylus_at"][0].get<int>()) <= 1 &&
             std::abs(now["under_cursor"][1].get<int>() - now["stylus_at"][1].get<int>()) <= 1;
    });
    const Screen pen = user.look("a pen");
    (void)user.key("Escape");
    const Screen none = user.changed("no pen", pen);
    const int rises = risesAbove(pen, none, shown["picture"], middle);
    if (dpi == 96) usual_pen = rises;
    EXPECT_NEAR(rises, scale * usual_pen, 4.0 + 0.05 * scale * usual_pen) << dpi;
    EXPECT_GT(usual_pen, 40);
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0);
    expectSilence(*program);
  }
}

// The size that is chosen in the window is there at once, and in the next start; an option goes before it.
TEST_F(SizeTest, the_size_of_texts_is_chosen_in_the_window_and_kept) {
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels",
                                                                    {{"Tool", false},
                                                                     {"Filters", false},
                                                                     {"Steps", false},
                                                                     {"Change since the scan", false},
                                                                     {"Display", true}}}};
  {
    const auto program = start({scan});
    User user(display, *program, "text size");
    EXPECT_NEAR(opened(*program)["scale"].get<double>(), 1.0, 1e-9);
    EXPECT_NEAR(titleHeight(user.look("usual"), program->now()["picture"]), 13.0, 1.5);
    (void)user.click("as the display");
    (void)user.click("150 %");
    const State large = program->until(
        "large texts", [](const State& s) { return s["scale"] == 1.5 && s["settled"] == true; });
    EXPECT_NEAR(titleHeight(user.look("large"), large["picture"]), 1.5 * 13.0, 1.5);
    for (const State& text : large["texts"]) EXPECT_EQ(text["cut"], false) << text.dump();
    (void)user.click("reduced motion");
    EXPECT_EQ(program->now()["reduced_motion"], true);
    // The view is at another place at once: no picture between.
    program->skipToNewest();
    std::set<std::string> views{program->now()["view"].dump()};
    const std::string before = *views.begin();
    display.hands({"key", "--delay", "0", "1"});
    program->until("another view", [&](const State& s) {
      views.insert(s["view"].dump());
      return s["settled"] == true && s["view"].dump() != before;
    });
    EXPECT_EQ(views.size(), 2U);
    (void)quit(user);
  }
  for (const auto& [more, scale] :
       {std::pair{std::vector<std::string>{}, 1.5}, {{"--ui-scale", "0.75"}, 0.75}}) {
    std::vector<std::string> arguments{scan};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto program = start(arguments);
    User user(display, *program, "text size again");
    const State again = opened(*program);
    EXPECT_EQ(again["scale"], scale);
    EXPECT_EQ(again["reduced_motion"], true);
    (void)quit(user);
  }
}

// Of two texts in the panels neither lies on the other.
TEST_F(SizeTest, nothing_in_the_panels_overlaps_however_narrow_they_are) {
  for (const int side : {160, 320}) {
    const std::filesystem::path settings = std::filesystem::path(folder.path()) / "fettle";
    std::filesystem::create_directories(settings);
    std::ofstream(settings / "window.json") << State{{"side_width", side},
                                                     {"panels",
                                                      {{"Tool", true},
                                                       {"Edges", true},
                                                       {"Edge lines", true},
                                                       {"Filters", true},
                                                       {"Steps", true},
                                                       {"Change since the scan", true},
                                                       {"Display", true},
                                                       {"Status", true},
                                                       {"Haptics", true}}}};
    const auto program = start({scan, "--size", "1100x990"});
    User user(display, *program, fmt::format("panels {}", side));
    (void)opened(*program);
    (void)user.key("shift+x");
    (void)user.key("x");
    const State shown = user.rest();
    const int left = shown["picture"][0].get<int>() + shown["picture"][2].get<int>();
    EXPECT_NEAR(shown["frame"][0].get<int>() - left, side, 2);
    // Seen in parts, from top to bottom. The cursor points at the margin: what it explains would lie on the
    // rest.
    user.at({left + 5, 500});
    constexpr int kParts = 10;  // with some to spare
    bool effects = false;       // near the end of the last panel
    State before;
    for (int part = 0; part < kParts && before != program->now()["texts"]; ++part) {
      before = program->now()["texts"];
      effects = effects || user.reads("effects");
      (void)user.look("part");
      for (std::size_t i = 0; i < before.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
          const State &a = before[i]["at"], &b = before[k]["at"];
          if (a[0] < left || b[0] < left) continue;
          const auto shared = [&](int from, int size) {
            return std::min(a[from].get<int>() + a[size].get<int>(),
                            b[from].get<int>() + b[size].get<int>()) -
                   std::max(a[from].get<int>(), b[from].get<int>());
          };
          EXPECT_FALSE(shared(0, 2) > 1 && shared(1, 3) > 2)
              << side << ": " << before[i].dump() << " on " << before[k].dump();
        }
      (void)user.wheel(-8);
    }
    EXPECT_TRUE(effects) << "not seen to the end";
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0);
    expectSilence(*program);
  }
}

}  // namespace
}  // namespace fettle::tests
