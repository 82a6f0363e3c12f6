// Scans that overlap become one, with the form that lies over them.
#include <string>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, a_form_goes_along_with_scans_that_are_joined) {
  openPanels(folder, {"Join", "Form"});
  const std::string drawn = folder.file("drawn.tif"), formed = folder.file("formed.fettle"),
                    west = folder.file("west.fettle"), east = folder.file("east.fettle"),
                    both = folder.file("both.fettle");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", drawn, "--size", "256x160"}).status, 0);
  layOnABall(drawn, 0.3);
  (void)jsonOf({"level", drawn, formed, "--layer", "put", "--form", "sphere"});
  (void)jsonOf({"transform", formed, west, "--crop-samples", "0,0,160,160"});
  (void)jsonOf({"transform", formed, east, "--crop-samples", "0,96,160,160"});
  (void)jsonOf({"mosaic", west, east, both});
  const State before = jsonOf({"info", west})["form_figures"];
  const std::string radius = fmt::format("radius {:.5g} mm", before["radius_mm"].get<double>());
  const auto program = start({west});
  User user(display, *program, "join formed");
  EXPECT_EQ(opened(*program)["form"], "sphere");
  EXPECT_TRUE(user.reads(radius));
  (void)user.press("alt+j");
  user.type(east);
  (void)user.press("Return");
  EXPECT_TRUE(user.reads("east.fettle"));
  (void)user.look("listed");
  (void)user.click("Join them");
  const State joined = program->until("opened", [&](const State& s) {
    return s["settled"] == true &&
           s["status"].get<std::string>().find("west_joined.fettle") != std::string::npos;
  });
  EXPECT_EQ(joined["form"], "sphere");
  EXPECT_TRUE(user.reads(radius));
  (void)user.look("joined");
  (void)quit(user);
  const std::string beside = (folder.path() / "west_joined.fettle").string();
  const State after = jsonOf({"info", beside});
  EXPECT_EQ(after["form"], "sphere");
  // West lies where it lay, but for the place that the overlap decides.
  expectSameBall(after["form_figures"], before, 1e-3);
  EXPECT_EQ(after["form_figures"], jsonOf({"info", both})["form_figures"]);
  EXPECT_EQ(jsonOf({"compare", beside, both})["max_abs"], 0.0);
}

TEST_F(WindowTest, scans_that_overlap_become_one_as_by_the_command) {
  openPanels(folder, {"Join"});
  const std::string drawn = folder.file("drawn.tif"), west = folder.file("west.tif"),
                    east = folder.file("east.tif"), both = folder.file("both.tif");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", drawn, "--size", "256x160"}).status, 0);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "transform", drawn, west, "--crop-samples", "0,0,160,160"}).status,
            0);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "transform", drawn, east, "--crop-samples", "0,96,160,160"}).status,
            0);
  (void)jsonOf({"mosaic", west, east, both});
  const auto program = start({west});
  User user(display, *program, "join");
  (void)opened(*program);
  (void)user.press("alt+j");
  user.type(east);
  (void)user.press("Return");
  EXPECT_TRUE(user.reads("east.tif"));
  (void)user.look("listed");
  (void)user.click("Join them");
  const State joined = program->until("opened", [&](const State& s) {
    return s["settled"] == true &&
           s["status"].get<std::string>().find("west_joined.fettle") != std::string::npos;
  });
  EXPECT_EQ(joined["steps"], 0);
  (void)quit(user);
  EXPECT_EQ(jsonOf({"compare", (folder.path() / "west_joined.fettle").string(), both})["max_abs"], 0.0);
}

}  // namespace
}  // namespace fettle::tests
