// Surface texture parameters and the section in the window: of what was chosen, before and after, cancelled, outdated.
#include <cmath>
#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/measure/areal.h"
#include "engine/measure/form.h"
#include "engine/measure/scale_filter.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Only this panel is open.
void openPanel(const TempFolder& folder, const char* name) {
  State panels;
  for (const char* other : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[other] = false;
  panels[name] = true;
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"edge_lines", false}, {"panels", panels}};
}

// Skewness of a whole field about its plane, as `fettle measure` prints it.
std::string skewnessOf(const engine::Version& field) {
  engine::JobControl job;
  const auto fit = engine::fitForm(field, {}, job);
  EXPECT_TRUE(fit);
  engine::ArealOptions height;
  height.hybrid = height.functional = height.spatial = height.feature = false;
  const auto measured = engine::measureAreal(field, fit->form, height, job);
  EXPECT_TRUE(measured);
  return fmt::format("{:.5g}", measured->ssk);
}

// The skewness of the S-L surface of `field`.
std::string skewnessBetween(const engine::Version& field, double s_mm, double l_mm) {
  engine::JobControl job;
  const auto filtered = [&](const engine::Version& of, double length, engine::Waves waves) {
    engine::FilterSpec spec;
    spec.kind = engine::FilterKind::kArealGaussian;
    spec.nesting_mm = length;
    return *engine::scaleFiltered(of, spec, waves, job);
  };
  const engine::Version smooth = filtered(field, s_mm, engine::Waves::kLong);
  const auto fit = engine::fitForm(smooth, {}, job);
  EXPECT_TRUE(fit);
  const engine::Version rough =
      filtered(*engine::withoutForm(smooth, fit->form, job), l_mm, engine::Waves::kShort);
  engine::ArealOptions height;
  height.hybrid = height.functional = height.spatial = height.feature = false;
  const engine::PolynomialForm level{0, rough.grid().width, rough.grid().height, 0.0, {0.0}};
  const auto measured = engine::measureAreal(rough, level, height, job);
  EXPECT_TRUE(measured);
  return fmt::format("{:.5g}", measured->ssk);
}

TEST_F(WindowTest, parameters_are_measured_of_the_s_l_surface) {
  openPanel(folder, "Measure");
  const auto program = start({scan});
  User user(display, *program, "measure-scales");
  (void)opened(*program);
  const State all = user.click("Measure now");
  EXPECT_EQ(all["parameters"]["Ssk"], State::array({skewnessOf(load(scan))}));
  (void)user.click("S- and L-filter");
  EXPECT_EQ(user.click("Measure now")["parameters"]["Ssk"], all["parameters"]["Ssk"])
      << "no length is typed yet";
  (void)user.enter("S-filter", "1 mm");
  (void)user.enter("L-filter", "10 mm");
  const State between = user.click("Measure now");
  EXPECT_EQ(between["parameters"]["Ssk"], State::array({skewnessBetween(load(scan), 1.0, 10.0)}));
  EXPECT_TRUE(user.reads("S-L surface"));
  user.at({20, 790});
  (void)user.look("S-L surface");
  // A longer S-filter leaves nothing: said, and what was measured stays.
  (void)user.enter("S-filter", "12 mm");
  const State none = user.click("Measure now");
  EXPECT_EQ(none["notices"].size(), 1U);
  EXPECT_EQ(none["parameters"], between["parameters"]);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(WindowTest, parameters_are_measured_of_what_is_chosen_before_and_after) {
  openPanel(folder, "Measure");
  const std::string stroked = folder.file("stroked.tif");
  const auto program = start({scan});
  User user(display, *program, "measure");
  const State first = opened(*program);
  EXPECT_TRUE(first["parameters"].empty());
  const State all = user.click("Measure now");
  EXPECT_EQ(all["parameters"]["Ssk"], State::array({skewnessOf(load(scan))}))
      << "of a scan without a change one value";
  const int known = all["parameters_of"];
  EXPECT_GT(known, 100'000) << "all but holes";
  EXPECT_EQ(all["parameters_outdated"], false);
  EXPECT_TRUE(user.reads("ISO 25178-2"));
  user.at({20, 790});
  (void)user.look("all");
  // Sdc is one more row.
  EXPECT_FALSE(all["parameters"].contains("Sdc"));
  (void)user.click("own ratios");
  (void)user.click("height between two ratios");
  const State between = user.click("Measure now");
  EXPECT_TRUE(between["parameters"].contains("Sdc"));
  EXPECT_EQ(between["parameters"]["Ssk"], all["parameters"]["Ssk"]);
  (void)user.click("own ratios");
  // Of what is visible: nearer, there is less.
  (void)user.key("7");
  user.at({300, 400});
  (void)user.wheel(6);
  (void)user.click("all samples");
  (void)user.click("what is visible");
  const State part = user.click("Measure now");
  EXPECT_LT(part["parameters_of"].get<int>(), known / 2);
  EXPECT_GT(part["parameters_of"].get<int>(), 100);
  EXPECT_NE(part["parameters"]["Ssk"], all["parameters"]["Ssk"]);
  // Marked samples, of which there are none.
  (void)user.click("what is visible");
  (void)user.click("marked samples");
  const State none = user.click("Measure now");
  EXPECT_EQ(none["notices"].size(), 1U);
  EXPECT_EQ(none["parameters"], part["parameters"]) << "what was measured stays";
  // After a stroke what was measured is old; measured again it stands beside the scan's.
  (void)user.press("s");
  (void)program->until("a tool", [](const State& s) { return s["tool"] == "smooth"; });
  const State touched = user.stroke({240, 332}, {340, 332}, 6);
  EXPECT_EQ(touched["parameters_outdated"], true);
  (void)user.key("Escape");
  saveAs(user, stroked);
  (void)user.click("marked samples");
  (void)user.click("all samples");
  const State both = user.click("Measure now");
  EXPECT_EQ(both["parameters"]["Ssk"], State::array({skewnessOf(load(scan)), skewnessOf(load(stroked))}));
  EXPECT_EQ(both["parameters_outdated"], false);
  EXPECT_TRUE(user.reads("scan"));
  user.at({20, 790});
  (void)user.look("before and after");
  // The curves of both over each other.
  EXPECT_EQ(both["curves"], 2);
  EXPECT_TRUE(user.readsScrolled("material ratio [%] 0 to 100"));
  (void)user.look("material ratio");
  EXPECT_EQ(both["steps"], 1) << "measuring changes nothing";
  EXPECT_EQ(user.key("ctrl+z")["parameters_outdated"], true);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// In a window as high as the panel with all of its curves.
class MeasureCurves : public WindowTest {
 protected:
  MeasureCurves() : WindowTest(1100, 1500) {}
};

TEST_F(MeasureCurves, each_curve_of_the_scan_and_of_the_field_is_drawn) {
  openPanel(folder, "Measure");
  const auto program = start({scan});
  User user(display, *program, "curves");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.press("s");
  (void)program->until("a tool", [](const State& s) { return s["tool"] == "smooth"; });
  (void)user.stroke({240, 632}, {340, 632}, 6);
  (void)user.key("Escape");
  const State both = user.click("Measure now");
  ASSERT_EQ(both["curves"], 2) << both["notices"].dump();
  user.at({20, 1490});
  EXPECT_TRUE(user.reads("material ratio [%] 0 to 100"));
  (void)user.look("material ratio");
  const char* shown = "material ratio (Abbott)";
  for (const auto& [curve, axis] :
       {std::pair("autocorrelation", "autocorrelation"), {"power spectrum", "frequency [1/mm]"}}) {
    (void)user.click(shown);
    (void)user.click(curve);
    user.at({20, 1490});
    (void)user.look(curve);
    EXPECT_TRUE(user.reads(axis)) << curve;
    shown = curve;
  }
  (void)quitWithoutSaving(user);
}

// Seventeen measurements of 1.4 million samples take seconds; a key ends them.
TEST_F(WindowTest, measuring_is_cancelled_and_the_hand_goes_on_meanwhile) {
  openPanel(folder, "Measure");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "1200x1200"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({scan});
  User user(display, *program, "measure cancelled");
  (void)opened(*program);
  (void)user.click("without noise, with errors");
  user.tap("Measure now");
  (void)program->until("measuring", [](const State& s) { return s["measuring"] == true; });
  (void)user.press("Escape");
  const State ended = program->until("cancelled", [](const State& s) { return s["measuring"] == false; });
  EXPECT_TRUE(ended["parameters"].empty());
  EXPECT_EQ(ended["notices"], State::array());
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(WindowTest, a_section_follows_line_field_and_cursors) {
  openPanel(folder, "Section");
  const auto program = start({scan});
  User user(display, *program, "section");
  EXPECT_TRUE(opened(*program)["section_mm"].is_null());
  (void)user.key("7");
  user.at({220, 332});
  const Screen before = user.look("without");
  (void)user.key("q");
  EXPECT_TRUE(user.reads("point at its other end")) << "one end is no line without heights";
  user.at({560, 332});
  (void)user.key("shift+q");
  const State taken = program->until("a section", [](const State& s) {
    return s["section_mm"].is_number() && s["taking_section"] == false;
  });
  EXPECT_GT(taken["section_mm"].get<double>(), 0.0);
  EXPECT_EQ(taken["section_before"], false);
  EXPECT_TRUE(taken["section_dz_mm"].is_number());
  user.at({20, 790});
  (void)user.changed("with its line", before);
  EXPECT_TRUE(user.reads("dx"));
  // A stroke along it: the scan stands beside, and goes with the stroke.
  (void)user.press("s");
  (void)program->until("a tool", [](const State& s) { return s["tool"] == "smooth"; });
  (void)user.stroke({300, 332}, {480, 332}, 8);
  (void)user.key("Escape");
  (void)program->until(
      "both", [](const State& s) { return s["section_before"] == true && s["taking_section"] == false; });
  EXPECT_TRUE(user.readsScrolled("the same of the scan:"));
  user.at({20, 790});
  (void)user.look("before and after");
  (void)user.key("ctrl+z");
  (void)program->until("the scan alone", [](const State& s) {
    return s["section_before"] == false && s["taking_section"] == false;
  });
  // Typed: half as long.
  const double length = taken["section_mm"];
  (void)user.click("Remove");
  (void)program->until("none", [](const State& s) { return s["section_mm"].is_null(); });
  const State whole = [&] {
    (void)user.click("Along the middle row");
    return program->until("along a row", [](const State& s) {
      return s["section_mm"].is_number() && s["taking_section"] == false;
    });
  }();
  EXPECT_GT(whole["section_mm"].get<double>(), length);
  // The angle between the lines of two stretches.
  EXPECT_FALSE(whole["section_figures"].contains("angle"));
  (void)user.click("angle");
  const State angle = program->until("an angle", [](const State& s) {
    return s["section_figures"].contains("angle") && s["settled"] == true;
  });
  EXPECT_NEAR(angle["section_figures"]["angle"]["included_deg"].get<double>(),
              180.0 - std::abs(angle["section_figures"]["angle"]["turn_deg"].get<double>()), 1e-9);
  (void)user.wheel(-8);
  EXPECT_TRUE(user.reads("angle turn"));
  (void)user.look("angle between two stretches");
  (void)user.wheel(8);
  // Not behind the border, where it could be neither seen nor taken hold of.
  (void)user.enter("from y", "5000");
  (void)user.enter("to y", "5000");
  (void)program->until("along the border", [](const State& s) {
    return s["section_mm"].is_number() && s["taking_section"] == false && s["settled"] == true;
  });
  EXPECT_TRUE(user.reads("99.69 mm")) << "319 times 0.3125 mm";
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
