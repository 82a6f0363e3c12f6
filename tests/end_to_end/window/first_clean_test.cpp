// The way of a person who saw the window for the first time, from a scan without units to a cleaned and exported part, by what
// stands on the screen: the middle one of three such trials, without its wrong turns.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

constexpr int kColumns = 160, kRows = 120, kMargin = 16, kStepAt = 80;
constexpr double kCount_mm = 0.02, kSpacing_mm = 0.2;
constexpr int kLow = 1000, kHigh = 1400;  // counts, on both sides of a wall
constexpr int kNone = 9999;               // in a margin that was not measured, and in small holes

bool isHole(int c, int r) {
  const bool inside = c < kColumns - 1 && r > 0 && r < kRows - 1;  // a hole at the border stays one
  return (inside && (c + 3 * r) % 211 == 0) || std::hypot(c - 30, r - 60) < 2.5;
}

bool isSpike(int c, int r) {
  return (5 * c + 7 * r) % 401 == 0;
}

// Counts with noise of some, lone spikes and small holes, in a file that says neither unit nor what 9999 means.
std::string writeBlock(const std::string& path) {
  std::ofstream file(path);
  file << "ncols " << kColumns << "\nnrows " << kRows << "\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  std::uint32_t noise = 1;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      noise = noise * 1664525U + 1013904223U;
      const int height = (c < kStepAt ? kLow : kHigh) + static_cast<int>(noise >> 27U) - 16;
      file << (c < kMargin || isHole(c, r) ? kNone : isSpike(c, r) ? height + 900 : height) << " ";
    }
    file << "\n";
  }
  return path;
}

// The rms of what remains beside the middle height of each side, at least some samples off the wall; and the farthest off.
struct Rest {
  double rms_mm = 0.0, most_mm = 0.0;
  int holes = 0;
};
Rest restOf(const engine::Version& field, double unit_mm) {
  const engine::FieldReader reader = field.reader();
  Rest rest;
  double squares = 0.0;
  int count = 0;
  for (int r = 0; r < kRows; ++r)
    for (int c = kMargin + 2; c < kColumns; ++c) {
      const double z = static_cast<double>(reader.heightAt(c, r)) * unit_mm;
      rest.holes += std::isnan(z) ? 1 : 0;
      if (std::isnan(z) || std::abs(c - kStepAt) < 3) continue;
      const double off = z - (c < kStepAt ? kLow : kHigh) * kCount_mm;
      squares += off * off;
      rest.most_mm = std::max(rest.most_mm, std::abs(off));
      ++count;
    }
  rest.rms_mm = std::sqrt(squares / count);
  return rest;
}

TEST_F(WindowTest, a_scan_without_units_is_cleaned_and_exported_in_some_forty_actions) {
  const std::string counts = writeBlock(folder.file("counts.asc")), out = folder.file("clean.tif");
  const auto program = start({});
  User user(display, *program, "first clean");
  program->until("the start page", [](const State& s) {
    return std::any_of(s["texts"].begin(), s["texts"].end(),
                       [](const State& text) { return text["text"] == "Open a scan"; });
  });
  int actions = 0;
  const auto press = [&](const char* key) {
    ++actions;
    (void)user.press(key);
  };
  const auto click = [&](const char* what) {
    ++actions;
    return user.click(what);
  };
  const auto enter = [&](const char* name, const char* value) {
    actions += 3;  // a click, what is typed, Enter
    return user.enter(name, value);
  };
  // Open, and say what the file does not.
  click("Open a scan");
  program->until("the dialog", [](const State& s) { return s["dialog"] == "open" && s["settled"] == true; });
  ++actions;
  user.type(counts);
  (void)user.rest();
  press("Return");
  program->until("the page", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  click("9999 are holes");
  user.writeOver("as in the file, else 1", "0.02");
  user.writeOver("1 in the file", "0.2");
  actions += 6;
  (void)user.look("the page");
  press("Return");
  program->until("the scan", [&](const State& s) { return s["path"] == counts && s["settled"] == true; });
  // Small holes, with a look first.
  press("ctrl+h");
  program->until("a preview", [](const State& s) {
    return s["heights_preview"] == "Fill holes: least curvature" && s["settled"] == true;
  });
  press("Return");
  program->until("filled", [](const State& s) { return s["steps"] == 1 && s["settled"] == true; });
  // Spikes, then noise.
  const auto choose = [&](const std::string& filter) {
    for (int tries = 0; tries < 20 && !program->now()["filter"].get<std::string>().starts_with(filter);
         ++tries) {
      ++actions;
      (void)user.key("n");
    }
    EXPECT_TRUE(program->now()["filter"].get<std::string>().starts_with(filter));
  };
  choose("Outliers");
  // By its key: the panel of holes, which came into sight, has a button of that name, too.
  const auto preview = [&] {
    ++actions;
    return user.key("p");
  };
  EXPECT_GT(preview()["variants"].size(), 0U);
  (void)user.look("outliers");
  EXPECT_EQ(click("Apply")["steps"], 2);
  choose("Median");
  enter("window", "5");
  (void)preview();
  (void)user.look("median");
  EXPECT_EQ(click("Apply")["steps"], 3);
  (void)user.look("clean");
  // Out.
  press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  ++actions;
  user.type(out);
  (void)user.rest();
  press("Return");
  program->until("written", [&](const State& s) { return s["status"] == "written: " + out; });
  EXPECT_LE(actions, 60);
  (void)quitWithoutSaving(user);

  const engine::Version clean = load(out);
  const engine::Grid& grid = clean.grid();
  EXPECT_NEAR(grid.spacingXMm(), kSpacing_mm, 1e-12);
  const Rest rest = restOf(clean, grid.height_unit.mm);
  EXPECT_EQ(rest.holes, 0);
  // 32 counts of noise deviate by 0.18 mm; a median of 25 leaves a quarter, a spike would be 18 mm off.
  EXPECT_LT(rest.rms_mm, 0.08);
  EXPECT_LT(rest.most_mm, 0.5);
  // The wall is where it was.
  const engine::FieldReader reader = clean.reader();
  for (int r = 5; r < kRows - 5; ++r) {
    EXPECT_LT(reader.heightAt(kStepAt - 2, r) * grid.height_unit.mm, kLow * kCount_mm + 1.0) << r;
    EXPECT_GT(reader.heightAt(kStepAt + 1, r) * grid.height_unit.mm, kHigh * kCount_mm - 1.0) << r;
  }
}

}  // namespace
}  // namespace fettle::tests
