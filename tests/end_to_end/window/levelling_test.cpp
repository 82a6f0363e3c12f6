// Lines that are levelled by what does not fit the scan.
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, a_preview_of_levelled_lines_says_that_they_lie_further_apart) {
  // A plate that takes a changing share of the rows: the median of each makes steps of it.
  const std::string plate = folder.file("plate.asc");
  std::ofstream out(plate);
  out << "ncols 64\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
  for (int r = 0; r < 64; ++r) {
    for (int c = 0; c < 64; ++c)
      out << (c < (r > 20 && r < 40 ? 44 : 24) ? 5.0 : 0.0) + 0.01 * ((c * 7 + r * 13) % 5) << ' ';
    out << '\n';
  }
  out.close();
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels", {{"Holes and lines", true}}}};
  const auto program = start({plate, "--unit", "mm"});
  User user(display, *program, "levelling");
  (void)opened(*program);
  for (const char* header : {"Tool", "Filters"}) (void)user.click(header);
  const auto found = [&] { return program->now()["heights_found"].get<std::string>(); };
  (void)user.key("ctrl+r");
  EXPECT_NE(found().find(" times as far "), std::string::npos) << found();
  EXPECT_NE(found().find(" now: try matching or difference"), std::string::npos) << found();
  (void)user.look("by the median");
  // Which way suits is measured, and taken by a click.
  const State measured = user.click("Suggest");
  (void)user.look("suggested");
  const std::string suggested = measured["lines_suggested"];
  EXPECT_NE(suggested.find("median "), std::string::npos) << "the figures of all: " << suggested;
  EXPECT_EQ(suggested.find("suggested: median"), std::string::npos) << suggested;
  EXPECT_EQ(measured["lines_by"], "median") << "until it is taken";
  if (suggested.starts_with("suggested: ")) {
    const std::string by = user.click("Take it")["lines_by"];
    EXPECT_TRUE(suggested.starts_with("suggested: " + by + ":")) << by << ", " << suggested;
    (void)user.click(by);
    (void)user.click("median");
  }
  (void)user.click("median");
  (void)user.click("difference");
  program->until("the preview follows", [](const State& s) {
    return s["settled"] == true && s["heights_preview"].is_string() &&
           s["heights_preview"].get<std::string>().find("difference") != std::string::npos;
  });
  EXPECT_EQ(found().find(" times as far "), std::string::npos) << found();
  quit(user);
}

}  // namespace
}  // namespace fettle::tests
