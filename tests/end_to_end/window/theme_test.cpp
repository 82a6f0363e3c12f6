// Light and dark panels: chosen by key, list and command line, kept, and every text of every page readable in both.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/haptic/devices/fake_vendor/shared_page.h"

namespace fettle::tests {
namespace {

using State = User::State;

// High enough for several panels at once.
class ThemeTest : public WindowTest {
 protected:
  ThemeTest() : WindowTest(1300, 1000) {}
};

double luminance(const std::uint8_t* p) {
  const auto light = [](std::uint8_t code) {
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * light(p[0]) + 0.7152 * light(p[1]) + 0.0722 * light(p[2]);
}

// Of the text's ink to what surrounds it. The ground is what most of its pixels have; the ink's full colour is seen where a
// stem fills a pixel.
double contrastOf(const Screen& seen, const State& box) {
  const int left = box[0], top = box[1], right = left + box[2].get<int>(), bottom = top + box[3].get<int>();
  std::map<std::uint32_t, int> colours;
  for (int y = std::max(0, top); y < std::min(bottom, seen.height); ++y)
    for (int x = std::max(0, left); x < std::min(right, seen.width); ++x) {
      const std::uint8_t* const p = seen.at(x, y);
      ++colours[static_cast<std::uint32_t>(p[0] << 16 | p[1] << 8 | p[2])];
    }
  if (colours.empty()) return 21.0;
  const auto ground = std::ranges::max_element(colours, {}, &std::pair<const std::uint32_t, int>::second);
  const auto lightOf = [](std::uint32_t c) {
    const std::uint8_t p[] = {static_cast<std::uint8_t>(c >> 16U), static_cast<std::uint8_t>(c >> 8U),
                              static_cast<std::uint8_t>(c)};
    return luminance(p);
  };
  const double below = lightOf(ground->first);
  double most = 1.0;
  for (const auto& [colour, count] : colours) {
    const double here = lightOf(colour);
    most = std::max(most, (std::max(here, below) + 0.05) / (std::min(here, below) + 0.05));
  }
  return most;
}

// Texts after the one that reads `from`: those of a dialog after its title; empty: all.
void expectReadable(User& user, const std::string& page, const std::string& from = {}) {
  const Screen seen = user.look(page);
  const State now = user.program().now();
  // What cannot be done now is paler than that on purpose.
  constexpr double kDisabled = 2.0;
  int read = 0, pale = 0;
  // A button may be named as the dialog that it opens.
  std::size_t first = 0;
  for (std::size_t i = 0; i < now["texts"].size(); ++i)
    if (!from.empty() && now["texts"][i]["text"] == from) first = i;
  for (std::size_t i = first; i < now["texts"].size(); ++i) {
    const State& text = now["texts"][i];
    // A line at the edge of a panel may show a part of itself.
    if (text["text"].get<std::string>().size() < 3 || text["at"][3] < 12) continue;
    ++read;
    const double contrast = contrastOf(seen, text["at"]);
    EXPECT_GE(contrast, kDisabled) << page << ": " << text.dump();
    pale += contrast < 4.0;
  }
  EXPECT_GT(read, 3) << page;
  EXPECT_LE(pale, read / 3) << page;
}

double brightness(const Screen& seen, const State& picture) {
  // A column of the panels' left margin.
  double sum = 0.0;
  const int x = picture[0].get<int>() + picture[2].get<int>() + 3;
  for (int y = 200; y < 600; ++y) sum += luminance(seen.at(x, y));
  return sum / 400.0;
}

TEST_F(ThemeTest, panels_become_light_by_key_list_and_command_line_and_stay_so) {
  const auto program = start({scan});
  User user(display, *program, "theme");
  const State dark = opened(*program);
  EXPECT_EQ(dark["light_panels"], false);
  user.at({20, 990});
  const Screen before = user.look("dark");
  EXPECT_LT(brightness(before, dark["picture"]), 0.2);
  // What stands around the field has a setting of its own.
  EXPECT_EQ(user.key("alt+g")["light_panels"], true);
  const Screen light = user.look("light");
  EXPECT_GT(brightness(light, dark["picture"]), 0.5);
  EXPECT_EQ(differing(before, light, user.surface()), 0);
  // Found by a word.
  (void)user.key("F1");
  user.write("panels");
  program->until("found", [](const State& s) {
    return s["texts"].dump().find("Light or dark panels") != std::string::npos;
  });
  (void)user.key("Escape");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);

  const auto again = start({scan});
  EXPECT_EQ(opened(*again)["light_panels"], true);
  again->signal(SIGTERM);
  EXPECT_EQ(again->wait(), 0) << again->err();
  const auto said = start({scan, "--theme", "dark"});
  EXPECT_EQ(opened(*said)["light_panels"], false);
  said->signal(SIGTERM);
  EXPECT_EQ(said->wait(), 0) << said->err();
}

TEST_F(ThemeTest, every_page_is_readable_on_light_and_dark_panels) {
  for (const std::string theme : {"light", "dark"}) {
    // The panels as they are at first.
    std::filesystem::remove(folder.path() / "fettle" / "window.json");
    {
      const auto program = start({"--theme", theme});
      User user(display, *program, theme + "_start");
      (void)user.rest();
      expectReadable(user, "start page");
      (void)user.press("ctrl+o");
      (void)user.rest();
      user.type(scan);
      (void)user.rest();
      expectReadable(user, "file dialog", "Open a scan");
      (void)user.click("Read as ...");
      expectReadable(user, "import page", "Read a scan as");
      program->signal(SIGTERM);
      EXPECT_EQ(program->wait(), 0) << program->err();
    }
    const auto program = start({scan, "--theme", theme});
    User user(display, *program, theme);
    (void)opened(*program);
    user.at({20, 990});
    expectReadable(user, "panels");
    (void)user.key("p");
    expectReadable(user, "a preview");
    (void)user.key("shift+v");
    (void)user.key("F1");
    expectReadable(user, "list of keys", "Shortcuts");
    (void)user.key("Escape");
    (void)user.press("ctrl+e");
    (void)user.rest();
    expectReadable(user, "export", "Export");
    (void)user.key("Escape");
    (void)user.press("ctrl+shift+d");
    (void)user.rest();
    expectReadable(user, "device", "Set up the device");
    (void)user.key("Escape");
    for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
    for (const char* header :
         {"Edges", "Edge lines", "Holes and lines", "Form", "Measure", "Section", "Fit", "Features",
          "Transform", "Join", "Compare", "Colours", "Display", "Status", "Haptics"}) {
      (void)user.click(header);
      user.at({20, 990});
      expectReadable(user, header);
      (void)user.click(header);
    }
    (void)user.click("Section");
    (void)user.click("Along the middle row");
    user.at({20, 990});
    expectReadable(user, "a section");
    // Tools around the cursor.
    user.at({400, 400});
    display.hands({"keydown", "space"});
    program->until("tools", [](const State& s) { return s["radial"].is_string(); });
    (void)user.look("tools around the cursor");
    display.hands({"keyup", "space"});
    (void)user.rest();
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
    expectSilence(*program);
  }
}

// Rests on what reads `text`, and waits for a tip that has `part`; then every text of it is read.
void expectTipReadable(User& user, const std::string& text, const std::string& part) {
  ViewProgram& program = user.program();
  const State now = program.now();
  const auto found = std::ranges::find_if(
      now["texts"], [&](const State& t) { return t["text"] == text && t["at"][0] >= now["picture"][2]; });
  ASSERT_NE(found, now["texts"].end()) << text << ": " << now["texts"].dump();
  const State& at = (*found)["at"];
  user.at({at[0].get<int>() + at[2].get<int>() / 2, at[1].get<int>() + at[3].get<int>() / 2});
  const auto says = [&](const State& t) {
    return t["text"].get<std::string>().find(part) != std::string::npos;
  };
  program.until("a tip of " + text, [&](const State& s) { return std::ranges::any_of(s["texts"], says); });
  const Screen seen = user.look("tip of " + text);
  const State shown = program.now();
  // Its lines from there on: tips are written last.
  bool of_tip = false;
  for (const State& t : shown["texts"]) {
    of_tip |= says(t);
    if (!of_tip) continue;
    EXPECT_GE(contrastOf(seen, t["at"]), 4.5) << t.dump();
    // The tip is as wide as it needs, also after another one.
    const int x = t["at"][0], y = t["at"][1], wide = t["at"][2], high = t["at"][3];
    const std::uint8_t *const above = seen.at(x - 2, y + high / 2), *const behind =
                                                                        seen.at(x + wide + 2, y + high / 2);
    EXPECT_TRUE(std::equal(above, above + 3, behind)) << t.dump();
  }
  EXPECT_TRUE(of_tip);
}

TEST_F(ThemeTest, tips_are_readable_on_light_and_dark_panels) {
  for (const std::string theme : {"light", "dark"}) {
    std::filesystem::remove(folder.path() / "fettle" / "window.json");
    const auto program = start({scan, "--theme", theme});
    User user(display, *program, theme + "_tips");
    (void)opened(*program);
    for (int i = 0; i < 3; ++i) (void)user.key("n");
    expectTipReadable(user, "Smooth", "Takes noise off");
    expectTipReadable(user, "range sigma", "Heights that differ");
    expectTipReadable(user, "Add preview", "Keeps what is shown");
    expectTipReadable(user, "keep marks", "\"keep marks\":");
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
    expectSilence(*program);
  }
}

// With a replacement of a maker's library: what a page of a real device says while it is measured and afterwards.
TEST_F(ThemeTest, the_page_of_a_real_device_is_readable_on_light_and_dark_panels) {
  for (const std::string theme : {"light", "dark"}) {
    std::filesystem::remove(folder.path() / "fettle" / "window.json");
    const std::string file = folder.file("page_" + theme);
    fake::SharedPage* const page = fake::SharedPage::map(file.c_str());
    ASSERT_NE(page, nullptr);
    const auto program = start({scan, "--device", "forcedimension", "--theme", theme},
                               {{"FETTLE_LIBDHD", FETTLE_FAKE_DHD}, {"FAKE_VENDOR_PAGE", file}});
    User user(display, *program, theme + "_device");
    program->until("the device",
                   [](const State& s) { return s.contains("device") && s["connected"] == true; });
    (void)opened(*program);
    const auto handTo = [&](double right_mm, double away_mm, double up_mm) {
      page->right_mm = right_mm;
      page->away_mm = away_mm;
      page->up_mm = up_mm;
      program->until("the hand", [&](const State& s) {
        return std::abs(s["device_mm"][0].get<double>() - right_mm) < 1e-3 &&
               std::abs(s["device_mm"][1].get<double>() - away_mm) < 1e-3 &&
               std::abs(s["device_mm"][2].get<double>() - up_mm) < 1e-3;
      });
    };
    const char* const title = "Set up the device";
    (void)user.press("ctrl+shift+d");
    (void)user.rest();
    expectReadable(user, "device, nothing measured", title);
    (void)user.press("r");
    program->until("a reach", [](const State& s) { return s["device_check"].contains("reach_mm"); });
    for (const double side : {-1.0, 1.0}) {
      handTo(50.0 * side, 50.0 * side, 40.0 * side);
      program->until("the reach", [&](const State& s) {
        return s["device_check"]["reach_mm"][side < 0.0 ? 0 : 1] ==
               State({50.0 * side, 50.0 * side, 40.0 * side});
      });
    }
    expectReadable(user, "device, reach", title);
    (void)user.press("r");
    program->until("its end", [](const State& s) { return s["device_check"]["running"] == false; });
    // As expected, and the wrong way.
    for (const bool right : {true, false}) {
      handTo(0.0, 0.0, 30.0);
      (void)user.press(right ? "1" : "3");
      program->until("asked", [](const State& s) { return s["device_check"]["running"] == true; });
      handTo(right ? 30.0 : 0.0, 0.0, right ? 30.0 : 5.0);
      program->until("a direction",
                     [&](const State& s) { return s["device_check"].contains(right ? "right" : "up"); });
    }
    (void)user.press("t");
    program->until("the rest", [](const State& s) {
      return s["device_check"].contains("rest") && s["device_check"]["running"] == false;
    });
    handTo(0.0, 0.0, 10.0);  // a frame later
    expectReadable(user, "device, all measured", title);
    (void)user.press("Escape");
    program->until("no page", [](const State& s) { return s["dialog"] == "none"; });
    for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan", "Haptics"})
      (void)user.click(header);
    user.at({20, 990});
    expectReadable(user, "panel of a device");
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
    expectSilence(*program);
  }
}

}  // namespace
}  // namespace fettle::tests
