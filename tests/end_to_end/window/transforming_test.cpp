// A transformed scan is a session beside it, with the form that lies over it.
#include <string>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, a_transformed_scan_is_a_session_beside_it) {
  openPanels(folder, {"Transform"});
  const auto program = start({scan});
  User user(display, *program, "transform");
  (void)opened(*program);
  (void)user.click("left and right change places");
  (void)user.click("Make a session of it");
  const std::string beside = (folder.path() / "part_transformed.fettle").string();
  (void)program->until("opened", [&](const State& s) {
    return s["settled"] == true &&
           s["status"].get<std::string>().find("part_transformed.fettle") != std::string::npos;
  });
  (void)quit(user);
  const std::string mirrored = folder.file("mirrored.tif");
  (void)jsonOf({"transform", scan, mirrored, "--mirror", "x"});
  EXPECT_EQ(jsonOf({"compare", beside, mirrored})["max_abs"], 0.0);
}

TEST_F(WindowTest, a_form_goes_along_with_what_is_transformed) {
  openPanels(folder, {"Transform", "Form"});
  layOnABall(scan, 0.3);
  const std::string formed = folder.file("formed.fettle"), mirrored = folder.file("mirrored.fettle");
  (void)jsonOf({"level", scan, formed, "--layer", "put", "--form", "sphere"});
  (void)jsonOf({"transform", formed, mirrored, "--mirror", "x"});
  const State before = jsonOf({"info", formed});
  const std::string radius =
      fmt::format("radius {:.5g} mm", before["form_figures"]["radius_mm"].get<double>());
  const auto program = start({formed});
  User user(display, *program, "transform formed");
  EXPECT_EQ(opened(*program)["form"], "sphere");
  EXPECT_TRUE(user.reads(radius));
  (void)user.look("before");
  (void)user.click("left and right change places");
  (void)user.click("Make a session of it");
  const State made = program->until("opened", [&](const State& s) {
    return s["settled"] == true &&
           s["status"].get<std::string>().find("formed_transformed.fettle") != std::string::npos;
  });
  EXPECT_EQ(made["form"], "sphere");
  EXPECT_TRUE(user.reads(radius));
  (void)user.look("after");
  (void)quit(user);
  const std::string beside = (folder.path() / "formed_transformed.fettle").string();
  const State after = jsonOf({"info", beside});
  EXPECT_EQ(after["form"], "sphere");
  // The ball is where it was seen from the other side.
  State expected = before["form_figures"];
  const engine::Grid grid = load(scan).grid();
  expected["point_mm"][0] =
      (grid.width - 1) * grid.spacingXMm() - before["form_figures"]["point_mm"][0].get<double>();
  expectSameBall(after["form_figures"], expected, 1e-9);
  EXPECT_EQ(after["form_figures"], jsonOf({"info", mirrored})["form_figures"]);
  EXPECT_EQ(jsonOf({"compare", beside, mirrored})["max_abs"], 0.0);
}

}  // namespace
}  // namespace fettle::tests
