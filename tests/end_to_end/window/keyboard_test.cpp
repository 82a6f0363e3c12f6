// Fields, lists and headers by keyboard alone, and panels that come into sight when they open.
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

bool writes(const State& state, const std::string& what) {
  for (const State& text : state["texts"])
    if (text["text"].get<std::string>().find(what) != std::string::npos) return true;
  return false;
}

// Where the header of a panel is [pixels from the top]; below 0: not on the screen.
int topOf(const State& state, const std::string& header) {
  for (const State& text : state["texts"])
    if (text["text"] == header) return text["at"][1];
  return -1;
}

// Into the field that has the keyboard.
State writeThere(User& user, const std::string& text) {
  user.write(text);
  return user.program().until(
      text, [&](const State& s) { return s["field_text"] == text && s["settled"] == true; });
}

void openOnly(const TempFolder& folder, const std::vector<std::string>& names) {
  State panels;
  for (const char* other : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[other] = false;
  for (const std::string& name : names) panels[name] = true;
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels", panels}};
}

TEST_F(WindowTest, tab_goes_on_from_a_header_to_the_fields_of_its_panel) {
  openOnly(folder, {"Filters"});
  const auto program = start({scan});
  User user(display, *program, "tab");
  (void)opened(*program);
  (void)user.key("F6");
  (void)user.click("Compare");
  // Past the lists of the panel to its first field that is typed into: from the panel's header, not from the first one.
  for (int i = 0; i < 8 && program->now()["text_field"] != true; ++i) (void)user.key("Tab");
  EXPECT_EQ(program->now()["field_text"], "0: none") << "of a tolerance";
  (void)writeThere(user, "0.125");
  const State typed = user.key("Return");
  (void)user.look("typed");
  EXPECT_TRUE(writes(typed, "125 ")) << typed["texts"].dump();
  (void)user.key("Escape");  // out of the panels
  (void)quit(user);
}

TEST_F(WindowTest, tab_comes_by_the_unit_of_the_page_of_a_scan_to_be_read) {
  const std::string counts = folder.file("counts.asc");
  std::ofstream out(counts);
  out << "ncols 48\nnrows 32\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  for (int i = 0; i < 48 * 32; ++i)
    out << static_cast<int>(std::lround(120.0 + 20.0 * std::sin(0.2 * (i % 48))))
        << ((i + 1) % 48 ? ' ' : '\n');
  out.close();
  const auto program = start({});
  User user(display, *program, "tab on the page");
  program->until("an empty window", [](const State& s) { return writes(s, "Drop a scan here"); });
  (void)user.press("ctrl+o");
  program->until("the dialog", [](const State& s) { return s["dialog"] == "open" && s["settled"] == true; });
  user.type(counts);
  (void)user.rest("the preview");
  (void)user.click("Read as ...");
  program->until("the page", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  user.writeOver("1 in the file", "0.05");
  (void)user.key("Tab");  // the rows
  (void)user.key("Tab");  // the unit
  (void)user.look("at the unit");
  (void)user.key("Tab");
  const State typed = writeThere(user, "0.001");
  (void)user.look("the z scale");
  EXPECT_TRUE(writes(typed, "z scale 0.001")) << typed["texts"].dump();
  // A number for holes that no sample has is said; what looks like holes stays.
  (void)user.key("Tab");
  const State doubted = writeThere(user, "0.02");
  EXPECT_TRUE(writes(doubted, "no sample has the no-data value 0.02")) << doubted["texts"].dump();
  (void)user.key("Escape");
  (void)user.key("Escape");
  (void)quit(user);
}

TEST_F(WindowTest, the_panel_of_a_scan_to_compare_with_comes_into_sight) {
  openOnly(folder, {"Tool", "Filters", "Steps", "Change since the scan"});
  const auto program = start({scan});
  User user(display, *program, "into sight");
  (void)opened(*program);
  EXPECT_LT(topOf(program->now(), "it is moved"), 0);
  (void)user.press("F1");
  program->until("F1", [](const State& s) { return s["dialog"].is_string() && s["settled"] == true; });
  (void)user.key("Escape");
  (void)user.press("alt+b");
  const State asked = program->until(
      "the dialog", [](const State& s) { return s["dialog"] == "compare" && s["settled"] == true; });
  user.type(scan);
  (void)user.press("Return");
  const State found = program->until("compared", [](const State& s) {
    return s["settled"] == true && s["comparing"] == false && s["compared_rms_mm"].is_number();
  });
  (void)user.look("compared");
  EXPECT_GT(topOf(found, "it is moved"), 0) << found["texts"].dump();
  EXPECT_TRUE(writes(found, "deviation: rms")) << found["texts"].dump();
  (void)quit(user);
}

TEST_F(WindowTest, what_a_lasso_waits_for_fits_its_line_with_large_letters) {
  for (const char* scale : {"1", "1.5", "2"}) {
    const auto program = start({scan, "--ui-scale", scale});
    User user(display, *program, std::string("lasso at ") + scale);
    (void)opened(*program);
    for (const char* key : {"l", "b"}) {
      const State now = user.key(key);
      user.at({300, 400});
      const State state = user.rest("the lasso");
      (void)user.look(key);
      int lines = 0;
      for (const State& text : state["texts"]) {
        const std::string what = text["text"];
        if (what.find("Esc ends") == std::string::npos &&
            what.find("another tool ends it") == std::string::npos)
          continue;
        ++lines;
        EXPECT_EQ(text["cut"], false) << scale << ": " << text.dump();
        EXPECT_LE(text["at"][0].get<int>() + text["at"][2].get<int>(), width_) << text.dump();
      }
      EXPECT_EQ(lines, 1) << scale << ": " << state["texts"].dump();
      (void)user.key("Escape");
    }
    (void)quit(user);
  }
}

}  // namespace
}  // namespace fettle::tests
