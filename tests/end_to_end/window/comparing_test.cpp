// Another scan, or a nominal mesh, that the field is compared with.
#include <string>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, a_nominal_mesh_is_compared_as_by_the_command) {
  openPanels(folder, {"Compare"});
  const std::string mesh = folder.file("nominal.stl"), drawn = folder.file("drawn.tif");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", drawn, "--size", "320x320", "--noise", "0"}).status, 0);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "convert", drawn, mesh}).status, 0);
  const State by_command = jsonOf({"compare", scan, mesh, "--tolerance", "0.05 mm"});
  const auto program = start({scan});
  User user(display, *program, "nominal");
  (void)opened(*program);
  (void)user.key("7");
  user.at({20, 790});
  const Screen before = user.look("alone");
  (void)user.click("shift, rotation, tilt");
  (void)user.click("not");
  (void)user.enter("tolerance", "0.05 mm");
  (void)user.click("Choose a scan");
  user.type(mesh);
  (void)user.press("Return");
  const State found = settledWith(*program, "compared", [](const State& s) {
    return s["comparing"] == false && (s["compared_rms_mm"].is_number() || !s["notices"].empty());
  });
  ASSERT_TRUE(found["compared_rms_mm"].is_number()) << found["notices"].dump();
  EXPECT_DOUBLE_EQ(found["compared_rms_mm"].get<double>(), by_command["rms"].get<double>());
  // The line goes on below: it is wider than the panel.
  EXPECT_TRUE(user.reads("within 50 "));
  user.at({20, 790});
  (void)user.changed("deviation", before);
  (void)quit(user);
}

TEST_F(WindowTest, another_scan_is_brought_onto_the_field) {
  openPanels(folder, {"Compare"});
  const std::string turned = folder.file("turned.tif");
  (void)jsonOf({"transform", scan, turned, "--angle", "1.5"});
  const auto program = start({scan});
  User user(display, *program, "compare");
  (void)opened(*program);
  (void)user.key("7");
  user.at({20, 790});
  const Screen before = user.look("alone");
  (void)user.click("Choose a scan");
  user.type(turned);
  (void)user.press("Return");
  const State found = settledWith(*program, "compared", [](const State& s) {
    return s["comparing"] == false && (s["compared_rms_mm"].is_number() || !s["notices"].empty());
  });
  ASSERT_TRUE(found["compared_rotation"].is_number()) << found["notices"].dump();
  EXPECT_NEAR(found["compared_rotation"].get<double>(), -1.5, 0.05);
  user.at({20, 790});
  (void)user.changed("deviation", before);
  EXPECT_TRUE(user.reads("rotation z"));
  EXPECT_EQ(found["steps"], 0);
  (void)user.click("Remove");
  EXPECT_TRUE(settledWith(*program, "alone", [](const State& s) {
                return s["compared_rms_mm"].is_null();
              }).is_object());
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
