// Lengths of one scan read in one unit wherever they stand, from an atomic force microscope to a mountain.
#include <cmath>
#include <csignal>
#include <fstream>
#include <regex>
#include <set>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

// A text raster without a unit: waves `span` high, samples `cell` apart, its corner at `origin`.
void writeWaves(const std::string& path, double cell, double span, double origin) {
  constexpr int kSide = 128;
  std::ofstream file(path);
  file << fmt::format("ncols {0}\nnrows {0}\nxllcenter {1}\nyllcenter {1}\ncellsize {2}\n", kSide, origin,
                      cell);
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c)
      file << fmt::format("{:.9g} ", 0.5 * span * (1.0 + std::sin(0.11 * c) * std::cos(0.07 * r)));
    file << "\n";
  }
}

// Units of the lengths that are on the screen; forces for each millimetre are none.
std::set<std::string> unitsRead(const State& state) {
  static const std::regex kLength("[0-9] \\[?(nm|\u00b5m|um|mm|cm|m|km)(?![a-z/])");
  std::set<std::string> units;
  for (const State& text : state["texts"]) {
    const std::string what = text["text"];
    for (std::sregex_iterator at(what.begin(), what.end(), kLength), end; at != end; ++at)
      units.insert((*at)[1].str());
  }
  return units;
}

// Everything that is written, a text after the other.
std::string written(const State& state) {
  std::string all;
  for (const State& text : state["texts"]) all += text["text"].get<std::string>() + " ";
  return all;
}

bool says(const State& state, const std::string& what) {
  return written(state).find(what) != std::string::npos;
}

struct Scale {
  const char* name;
  double cell_m, span_m, origin_m;
  const char* unit;    // that everything is to be read in
  const char* height;  // a text in the status bar that shows it, as a pattern
  const char* typed;   // a limit of change
  double most_m;       // it stands for
  const char* depth;   // of the brush, in the unit that is shown ...
  double depth_mm;
  const char* other_depth;  // ... and in one that is typed
  double other_mm;
};

class UnitsTest : public WindowTest, public ::testing::WithParamInterface<Scale> {};

TEST_P(UnitsTest, lengths_of_one_scan_read_in_one_unit) {
  const Scale& scale = GetParam();
  const std::string waves = folder.file("waves.asc");
  writeWaves(waves, scale.cell_m, scale.span_m, scale.origin_m);
  // So that the change is in view below the tool.
  std::ofstream(folder.path() / "fettle" / "window.json")
      << State{{"panels", State{{"Steps", false}, {"Status", false}, {"Filters", false}}}};
  const auto program = start({waves, "--unit", "m"});
  User user(display, *program, scale.name);
  const State shown = opened(*program);
  // A cell deep is half as hard as there is, however large a cell is.
  EXPECT_TRUE(says(shown, "(50 %")) << written(shown);
  // Where the cursor is, without any tool.
  user.at({400, 400});
  const std::regex place(scale.height);
  program->until("the place under the cursor",
                 [&](const State& s) { return std::regex_search(written(s), place); });
  (void)user.key("s");
  user.draw({380, 400}, {460, 400}, 6);
  const State stroked = user.rest("a stroke");
  EXPECT_TRUE(says(stroked, "Sq before, now"));
  EXPECT_EQ(unitsRead(stroked), std::set<std::string>{scale.unit}) << written(stroked);
  // What is typed is in the unit that stands beside it, or in the one behind it. No key twice: to GLFW two
  // presses of one key within a millisecond are one, and this hand is that quick.
  for (const auto& [typed, mm] :
       {std::pair{scale.depth, scale.depth_mm}, {scale.other_depth, scale.other_mm}}) {
    (void)user.press("shift+f");
    program->until("the depth", [](const State& s) { return s["adjusting"] == "depth"; });
    user.write(typed);
    // A lambda has no structured binding.
    const double expected = mm;
    program->until(typed, [expected](const State& s) {
      return std::abs(s["press_mm"].get<double>() - expected) < 1e-3 * expected;
    });
    (void)user.key("Return");
    program->until("that it is taken", [](const State& s) { return s["adjusting"] != "depth"; });
  }
  (void)user.press("shift+f");
  program->until("the depth", [](const State& s) { return s["adjusting"] == "depth"; });
  user.write("12q");
  (void)user.press("Return");
  program->until("that it waits", [](const State& s) {
    return s["adjusting"] == "depth" && says(s, "[not understood: 12q]");
  });
  (void)user.look("depth");
  for (int i = 0; i < 3; ++i) (void)user.press("BackSpace");
  user.write("98km");
  program->until("that it is at its largest", [](const State& s) { return says(s, "(the largest) [98km]"); });
  EXPECT_EQ(user.key("Escape")["press_mm"], scale.other_mm);
  (void)user.click("Tool");  // strokes have a limit, too
  (void)user.click("Filters");
  EXPECT_TRUE(user.key("x")["max_change"].is_number());
  const double taken = user.enter("keep within", scale.typed)["max_change"];
  EXPECT_NEAR(taken, scale.most_m, 1e-12 * scale.most_m);
  (void)user.look("typed");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// Texture is one of heights, in Change as in Measure, however finely changes are read.
TEST_F(WindowTest, texture_reads_in_one_unit_in_each_panel) {
  const std::string waves = folder.file("waves.asc");
  writeWaves(waves, 2e-4, 3e-2, 0.0);
  std::ofstream(folder.path() / "fettle" / "window.json")
      << State{{"panels", State{{"Tool", false}, {"Steps", false}, {"Filters", false}, {"Measure", true}}}};
  const auto program = start({waves, "--unit", "m"});
  User user(display, *program, "texture");
  (void)opened(*program);
  (void)user.click("Measure now");
  const State measured = program->until("texture", [](const State& s) {
    return s["settled"] == true && !s["parameters"].is_null() && says(s, "mm, ");
  });
  (void)user.look("both");
  static const std::regex kChange("Sq before, now ([0-9.]+) (nm|\u00b5m|mm|m), ");
  std::smatch found;
  const std::string all = written(measured);
  ASSERT_TRUE(std::regex_search(all, found, kChange)) << all;
  EXPECT_EQ(found[2], "mm") << all;
  EXPECT_TRUE(says(measured, "99 % within 0 \u00b5m")) << "it is known without measuring: " << all;
  EXPECT_TRUE(user.readsScrolled("Std"));
  (void)user.wheel(-2);
  EXPECT_TRUE(user.reads("\u00b0"));
  EXPECT_FALSE(user.reads("degrees"));
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

INSTANTIATE_TEST_SUITE_P(
    From130nmTo5000m, UnitsTest,
    ::testing::Values(Scale{"microscope", 4e-9, 1.3e-7, 0.0, "nm",
                            "x [0-9]+\\.[0-9] y [0-9]+\\.[0-9] nm z [0-9]+\\.[0-9]{2} nm", "2.5", 2.5e-9,
                            "12", 12e-6, ",014um", 14e-6},
                      Scale{"mountain", 10.0, 5000.0, 5e6, "m",
                            "x 50[0-9]{5} y 50[0-9]{5} m z [0-9]+\\.[0-9] m", "2.5", 2.5, "12", 12e3, "650cm",
                            6500.0}),
    [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace fettle::tests
