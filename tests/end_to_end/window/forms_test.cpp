// The form of a bent part: taken out of what is seen and touched, put back, made heights.
#include <csignal>
#include <fstream>
#include <vector>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

double spanOf(const State& state) {
  return state["colours"][1].get<double>() - state["colours"][0].get<double>();
}

// The scan of the fixture on a bent plate, a hundred times as deep as its steps.
void bend(const std::string& scan) {
  const engine::Version part = load(scan);
  const engine::Grid& grid = part.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  part.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double u = 2.0 * c / (grid.width - 1) - 1.0, v = 2.0 * r / (grid.height - 1) - 1.0;
      z[static_cast<std::size_t>(r * grid.width + c)] +=
          static_cast<float>(6.0 * u * u - 4.0 * u * v + 3.0 * v);
    }
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(engine::makeField(grid, z, {}), scan, {}, job));
}

TEST_F(WindowTest, a_form_is_taken_out_touched_without_and_put_back_exactly) {
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels",
                                                                    {{"Form", true},
                                                                     {"Filters", false},
                                                                     {"Tool", false},
                                                                     {"Status", false},
                                                                     {"Change since the scan", false}}}};
  bend(scan);
  const std::string session = folder.file("work.fettle"), without = folder.file("without.tif"),
                    stroked = folder.file("stroked.tif");
  {
    const auto program = start({scan});
    User user(display, *program, "form");
    const State first = opened(*program);
    EXPECT_TRUE(first["form"].is_null());
    user.at({20, 790});
    const Screen bent = user.look("bent");
    (void)user.click("plane");
    (void)user.click("polynomial 2");
    // Before: by colours, over the surface as it is, and gone again without a trace.
    const State previewed = user.key("ctrl+shift+l");
    EXPECT_EQ(previewed["form_preview"], "poly2");
    EXPECT_EQ(previewed["steps"], 0);
    EXPECT_TRUE(previewed["form"].is_null());
    EXPECT_LT(spanOf(previewed), 0.8 * spanOf(first));
    EXPECT_TRUE(user.reads("preview: colours are heights without the"));
    user.at({20, 790});
    (void)user.changed("preview", bent);
    // It follows the form that is chosen.
    (void)user.click("polynomial 2");
    EXPECT_EQ(user.click("polynomial 3")["form_preview"], "poly3");
    (void)user.click("polynomial 3");
    EXPECT_EQ(user.click("polynomial 2")["form_preview"], "poly2");
    EXPECT_TRUE(user.key("Escape")["form_preview"].is_null());
    EXPECT_TRUE(user.click("Preview")["form_preview"].is_string());
    const State dropped = user.click("Drop preview");
    EXPECT_TRUE(dropped["form_preview"].is_null());
    EXPECT_EQ(dropped["steps"], 0);
    EXPECT_EQ(dropped["colours"], first["colours"]);
    user.at({20, 790});
    (void)user.same("preview dropped", bent);
    (void)user.click("Preview");
    const State fitted = user.click("Fit");
    EXPECT_TRUE(fitted["form_rms"].is_number());
    EXPECT_EQ(fitted["steps"], 0);
    EXPECT_TRUE(user.reads("rms of what is left"));
    const State out = user.click("Take out");
    EXPECT_EQ(out["form"], "poly2");
    EXPECT_EQ(out["steps"], 1);
    EXPECT_TRUE(out["form_preview"].is_null());  // it is what is seen now
    EXPECT_LT(spanOf(out), 0.8 * spanOf(first));
    EXPECT_TRUE(user.reads("taken out: polynomial of degree 2"));
    EXPECT_TRUE(user.reads("Form out: polynomial of degree 2"));
    user.at({20, 790});
    const Screen flat = user.changed("without its form", bent);
    // Felt where it is seen: a stroke is a step.
    (void)user.key("7");
    (void)user.press("s");
    (void)program->until("a tool", [](const State& s) { return s["tool"] == "smooth"; });
    EXPECT_EQ(user.stroke({240, 332}, {340, 332}, 6)["steps"], 2);
    (void)user.look("stroke");
    (void)user.key("Escape");
    (void)saveAs(user, stroked);
    EXPECT_EQ(user.key("ctrl+z")["steps"], 1);
    const State back = user.key("ctrl+l");
    EXPECT_TRUE(back["form"].is_null());
    EXPECT_EQ(back["steps"], 2);
    EXPECT_TRUE(user.reads("Form back: polynomial of degree 2"));
    EXPECT_NEAR(spanOf(back), spanOf(first), 1e-6 * spanOf(first));
    (void)saveAs(user, without);
    const State again = user.key("ctrl+z");
    EXPECT_EQ(again["form"], "poly2");
    EXPECT_EQ(again["steps"], 1);
    (void)saveAs(user, session);
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
    expectSilence(*program);
  }
  // What was not touched has its bits, with the form.
  EXPECT_EQ(compare(load(scan), load(without)).changed, 0);
  const Differences strokes = compare(load(scan), load(stroked));
  EXPECT_GT(strokes.changed, 0);
  EXPECT_LT(strokes.last_row - strokes.first_row, 60);
  EXPECT_LT(strokes.changed, 320 * 320 / 10);
  {
    // Opened again it is seen as it was left; its heights are made.
    const auto program = start({session});
    User user(display, *program, "formed");
    const State seen = opened(*program);
    EXPECT_EQ(seen["form"], "poly2");
    EXPECT_EQ(seen["notices"], State::array());
    const State heights = user.key("alt+l");
    EXPECT_TRUE(heights["form"].is_null());
    EXPECT_EQ(heights["steps"], 2);
    EXPECT_NEAR(spanOf(heights), spanOf(seen), 1e-6 * spanOf(seen));
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
    expectSilence(*program);
  }
}

// Three points of the surface name the plane: clicked, by a key at the cursor, or typed.
TEST_F(WindowTest, a_plane_goes_through_three_points_of_the_surface) {
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels",
                                                                    {{"Form", true},
                                                                     {"Filters", false},
                                                                     {"Tool", false},
                                                                     {"Steps", false},
                                                                     {"Change since the scan", false}}}};
  bend(scan);
  const std::string work = folder.file("work.fettle");
  const auto program = start({scan});
  User user(display, *program, "three points");
  const State first = opened(*program);
  EXPECT_TRUE(first["plane_point"].is_null());
  EXPECT_EQ(first["plane_points"].size(), 0U);
  (void)user.key("7");
  user.at({20, 790});
  const Screen alone = user.look("scan");
  const State begun = user.key("alt+d");
  EXPECT_EQ(begun["plane_point"], 1);
  EXPECT_EQ(begun["plane_points"].size(), 3U);
  EXPECT_TRUE(user.reads("click point 1 of 3"));
  const auto click = [&](int x, int y) {
    user.at({x, y});
    user.down(1);
    user.up(1);
    return user.rest();
  };
  EXPECT_EQ(click(230, 250)["plane_point"], 2);
  // A drag turns the view, and sets nothing.
  EXPECT_EQ(user.drag(1, {300, 300}, {360, 300}, 6)["plane_point"], 2);
  (void)user.key("7");
  user.at({540, 260});
  EXPECT_EQ(user.key("shift+d")["plane_point"], 3);
  (void)user.look("two of three");
  // Esc leaves the points, and the form, as they were.
  const State left = user.key("Escape");
  EXPECT_TRUE(left["plane_point"].is_null());
  EXPECT_EQ(left["plane_points"].size(), 0U);
  EXPECT_TRUE(user.reads("plane"));
  // All three: the plane is previewed.
  (void)user.key("alt+d");
  (void)click(230, 250);
  (void)click(540, 260);
  const State set = click(380, 470);
  EXPECT_TRUE(set["plane_point"].is_null());
  const State shown = program->until(
      "a preview", [](const State& s) { return s["form_preview"] == "plane" && s["settled"] == true; });
  EXPECT_EQ(shown["steps"], 0);
  EXPECT_TRUE(user.reads("tilted"));
  user.at({20, 790});
  (void)user.changed("preview", alone);
  // A typed number moves a point, and the preview follows.
  const double rms = shown["form_rms"];
  const State typed = user.enter("y of point 3", "2 mm");
  EXPECT_NEAR(typed["plane_points"][2][1].get<double>(), 2.0, 1e-9);
  (void)program->until("followed", [&](const State& s) {
    return s["settled"] == true && s["form_rms"].is_number() && s["form_rms"] != rms;
  });
  const State out = user.click("Take out");
  EXPECT_EQ(out["form"], "plane");
  EXPECT_EQ(out["steps"], 1);
  const State points = out["plane_points"];
  saveAs(user, work);
  (void)quit(user);
  // As the command does it with these points.
  const auto pair = [&](int i) {
    return points[static_cast<std::size_t>(i)][0].dump() + "," +
           points[static_cast<std::size_t>(i)][1].dump();
  };
  const std::string recipe_text = runProcess({FETTLE_PROGRAM, "recipe", work}).out;
  EXPECT_NE(recipe_text.find("through"), std::string::npos) << recipe_text;
  const std::string by_command = folder.file("level.fettle");
  const Outcome level = runProcess({FETTLE_PROGRAM, "level", scan, by_command, "--layer", "put", "--through",
                                    pair(0) + ":" + pair(1) + ":" + pair(2)});
  ASSERT_EQ(level.status, 0) << level.err;
  // Points are told to a millionth of a millimetre, on a slope of less than 1: a few units in the last place.
  const Differences seen = compare(load(work), load(by_command));
  EXPECT_LT(seen.most, 1e-5);
}

}  // namespace
}  // namespace fettle::tests
