// A day's work on the real program, by mouse and keys, on a display of its own; what is on the screen is
// compared before and after each step, what is saved with what the engine makes of the same.
#include <csignal>
#include <filesystem>

#include "engine/filter/filter.h"
#include "engine/io/raster/marks.h"
#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;
using Place = User::Place;

// Strokes are made from above: where the window shows the field's middle.
constexpr Place kMiddle{330, 400};

TEST_F(WindowTest, a_dropped_scan_is_looked_at_from_all_sides) {
  const std::string dropped = folder.file("Teil ä 1.tif");
  std::filesystem::copy_file(scan, dropped);
  const auto program = start({});
  User user(display, *program, "look");
  program->until("an empty window, with a word of what to do", [](const State& s) {
    return s["path"] == "" && s["texts"].dump().find("Drop a scan here") != std::string::npos;
  });
  const Screen empty = user.look("empty");

  const std::uint32_t window = other.windowOf("fettle");
  ASSERT_NE(window, 0U);
  EXPECT_EQ(other.drop(window, {dropped}), "");
  EXPECT_EQ(opened(*program)["path"], dropped);
  EXPECT_EQ(program->now()["drops"], 1);
  Screen seen = user.changed("dropped", empty, 20000);

  // Each key another picture.
  for (const char* key :
       {"7", "1", "3", "ctrl+KP_1", "ctrl+KP_3", "5", "KP_7", "Left", "Right", "Down", "Up", "shift+Left",
        "shift+Right", "shift+Up", "shift+Down", "Next", "Prior", "KP_Subtract", "KP_Add"}) {
    const State before = program->now();
    const State after = user.key(key);
    EXPECT_TRUE(after["view"] != before["view"] || after["perspective"] != before["perspective"]) << key;
    // From above a turn by "Right" comes back where "Left" came from, but never at once.
    seen = user.changed(std::string("view ") + key, seen, 500);
  }
  // The mouse: turn, move, zoom, wheel.
  (void)user.key("5");
  (void)user.key("Home");
  seen = user.look("home");
  (void)user.drag(2, kMiddle, {kMiddle.x + 90, kMiddle.y - 20}, 4);
  Screen next = user.changed("turned", seen, 2000);
  (void)user.drag(2, kMiddle, {kMiddle.x + 40, kMiddle.y + 30}, 3, "shift");
  seen = user.changed("moved", next, 2000);
  (void)user.drag(2, kMiddle, {kMiddle.x, kMiddle.y - 60}, 3, "ctrl");
  next = user.changed("zoomed by a drag", seen, 2000);
  (void)user.wheel(-4);
  seen = user.changed("zoomed by the wheel", next, 2000);
  (void)user.key("7");
  (void)user.key("Home");
  const Screen above = user.look("above");

  // What is drawn on the surface; each off again leaves nothing behind.
  for (const auto& [key, what] : {std::pair{"c", "contours"}, {"d", "deviation"}}) {
    (void)user.key(key);
    (void)user.changed(what, above, 300);
    (void)user.key(key);
    (void)user.same(std::string("without ") + what, above);
  }
  Screen map = above;
  for (int i = 0; i < 4; ++i) {
    (void)user.key("k");
    // Automatic is viridis or diverging, so that one of the four is no change.
    map = user.look("map");
    EXPECT_GT(differing(above, map, user.surface()) + (i == 0 ? 1000 : 0), 500) << i;
  }
  (void)user.key("k");
  (void)user.same("the first map again", above);
  // The light, by its slider, in a panel that is closed at first.
  for (const char* header : {"Filters", "Display"}) (void)user.click(header);
  const State turned = user.click("135\u00b0");
  EXPECT_NE(turned["light"][0], 135);
  (void)user.changed("light from elsewhere", above, 2000);

  (void)user.press("F1");
  program->until("the list of keys", [](const State& s) {
    return s["dialog"] == "shortcuts" && s["settled"] == true &&
           s["texts"].dump().find("Ctrl+Shift+Z") != std::string::npos;
  });
  (void)user.look("keys");
  (void)user.press("Escape");
  program->until("no list", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });

  // Tab: the picture takes the panels' place, and gives it back.
  const int narrow = program->now()["picture"][2];
  EXPECT_GT(user.key("Tab")["picture"][2], narrow);
  (void)user.look("without panels");
  EXPECT_EQ(user.key("Tab")["picture"][2], narrow);
  const State report = quit(user);
  EXPECT_EQ(report["unsaved_changes"], false);
}

TEST_F(WindowTest, a_scan_is_smoothed_marked_filtered_and_saved_by_hand) {
  const std::string smoothed_path = folder.file("smoothed.tif");
  const std::string filtered_path = folder.file("filtered.tif");
  const std::string exported_path = folder.file("exported.tif");
  const std::string session_path = folder.file("work.fettle");
  const auto program = start({scan});
  User user(display, *program, "work");
  (void)opened(*program);
  const auto save = [&](const char* keys, const std::string& path) {
    (void)user.press(keys);
    program->until("a dialog", [](const State& s) { return s["dialog"] != "none" && s["settled"] == true; });
    user.type(path);
    (void)user.look("dialog to save");
    (void)user.press("Return");
    program->until("written", [&](const State& s) {
      return s["dialog"] == "none" && s["saving"] == false &&
             s["status"].get<std::string>().find(path) != std::string::npos;
    });
  };
  user.at({20, 790});  // where it lies in no picture
  (void)user.key("7");
  const Screen above = user.look("above");

  // Smooth, with a brush set by keys and by numbers.
  EXPECT_EQ(user.key("s")["tool"], "smooth");
  (void)user.press("f");
  user.type("9");
  EXPECT_EQ(user.key("Return")["brush"], 9.0);
  EXPECT_EQ(user.key("bracketleft")["brush"], 8.0);
  EXPECT_EQ(user.key("bracketright")["brush"], 9.0);
  const double depth = program->now()["press_mm"];
  (void)user.press("shift+f");
  user.type("0.5");
  EXPECT_EQ(user.key("Return")["press_mm"], 0.5);
  EXPECT_NE(depth, 0.5);
  (void)user.press("f");
  user.type("30");
  EXPECT_EQ(user.key("Escape")["brush"], 9.0);
  (void)user.press("f");
  user.type("6");
  (void)user.key("Return");
  // Along the ends of two ribs, where smoothing is seen.
  EXPECT_EQ(user.stroke({240, 332}, {440, 332}, 8)["steps"], 1);
  (void)user.look("after smoothing");
  EXPECT_EQ(user.key("Escape")["tool"], "view");
  user.at({20, 790});
  const Screen smoothed = user.changed("smoothed", above);
  EXPECT_EQ(differing(above, smoothed, {4, 60, 640, 200}), 0) << "changed where no stroke was";
  EXPECT_EQ(differing(above, smoothed, {4, 420, 640, 250}), 0) << "changed where no stroke was";
  save("ctrl+s", smoothed_path);

  // Mark, take a part of it back, hide and show.
  EXPECT_EQ(user.key("m")["tool"], "mark");
  (void)user.stroke({590, 320}, {590, 410}, 6);
  (void)user.key("u");
  (void)user.stroke({590, 390}, {590, 410}, 2);
  (void)user.key("Escape");
  user.at({20, 790});
  const Screen marked = user.changed("marked", smoothed);
  EXPECT_EQ(differing(smoothed, marked, {4, 60, 560, 650}), 0) << "marks where no stroke was";
  (void)user.key("h");
  (void)user.same("marks hidden", smoothed);
  (void)user.key("h");
  (void)user.same("marks shown", marked);
  EXPECT_EQ(user.key("i")["inverted"], true);
  (void)user.changed("upside down", marked, 2000);
  EXPECT_EQ(user.key("i")["inverted"], false);
  (void)user.same("right side up", marked);

  // Variants side by side, with the split line and in a row, then the median alone.
  EXPECT_EQ(user.key("n")["filter"], "Gaussian 3 x 3");
  EXPECT_EQ(user.key("p")["variants"], State({"Gaussian 3 x 3"}));
  const Screen split = user.changed("Gaussian behind the split line", marked, 300);
  (void)user.key("shift+p");
  (void)user.changed("Gaussian next to the field", split, 2000);
  EXPECT_EQ(user.key("n")["filter"], "Median 3 x 3");
  EXPECT_EQ(user.click("Add preview")["variants"], State({"Gaussian 3 x 3", "Median 3 x 3"}));
  user.at({20, 790});
  (void)user.changed("two variants", split, 2000);
  EXPECT_EQ(user.key("Escape")["variants"], State::array());
  (void)user.key("shift+p");
  (void)user.same("no preview", marked);
  EXPECT_EQ(user.key("p")["variants"], State({"Median 3 x 3"}));
  const Screen preview = user.changed("median", marked, 300);
  const State applied = user.key("Return");
  EXPECT_EQ(applied["filters_applied"], 1);
  EXPECT_EQ(applied["variants"], State::array());
  // The split line's grip goes with the frame after the one that reports it: another frame.
  (void)user.key("c");
  (void)user.key("c");
  const Screen filtered = user.until("median applied", [&](const Screen& now) {
    return differing(preview, now, user.surface()) > 300 && differing(marked, now, user.surface()) > 300;
  });
  save("ctrl+shift+s", filtered_path);

  // Back and forth through everything.
  const std::int64_t steps = program->now()["steps"];
  EXPECT_EQ(user.key("ctrl+z")["steps"], steps - 1);
  (void)user.same("before the median", marked);
  for (std::int64_t i = steps - 1; i > 1; --i) (void)user.key("ctrl+z");
  (void)user.same("before the marks", smoothed);
  (void)user.key("ctrl+z");
  (void)user.same("the scan", above);
  for (std::int64_t i = 0; i < steps; ++i) (void)user.key("ctrl+shift+z");
  (void)user.same("the median again", filtered);
  save("ctrl+e", exported_path);

  // Into a session, one more stroke, and the power goes.
  save("ctrl+shift+s", session_path);
  (void)user.key("m");
  (void)user.stroke({410, 660}, {500, 660}, 3);
  (void)user.key("Escape");
  user.at({20, 790});
  program->until("on the disk", [&](const State& s) { return s["steps"] == steps + 1 && s["kept"] == true; });
  const Screen last = user.changed("the last stroke", filtered);
  program->signal(SIGKILL);
  EXPECT_EQ(program->wait(), 128 + SIGKILL);

  const auto reopened = start({session_path});
  User later(display, *reopened, "reopened");
  EXPECT_EQ(opened(*reopened)["steps"], steps + 1);
  later.at({20, 790});
  (void)later.key("7");
  (void)later.same("the last stroke", last);
  (void)later.key("ctrl+z");
  (void)later.same("the median", filtered);
  const State report = quit(later);
  EXPECT_EQ(report["steps"], steps);
  EXPECT_EQ(report["unsaved_changes"], false);

  const engine::Version original = load(scan), smoothed_field = load(smoothed_path);
  const engine::Version filtered_field = load(filtered_path);
  const Differences stroke = compare(original, smoothed_field);
  EXPECT_GT(stroke.changed, 200);
  // The stroke is a band: twice the brush's six samples high, and what the hand wavers.
  EXPECT_LT(stroke.last_row - stroke.first_row, 24);

  // What the window saved is what the filter makes of the smoothed and marked field, bit-identical.
  auto kept = engine::importMarks(smoothed_field, folder.file("filtered_marks.png"));
  ASSERT_TRUE(kept) << kept.error().line();
  engine::FilterSpec median;
  median.kind = engine::FilterKind::kMedian;
  engine::JobControl job;
  const auto expected = engine::applyFilter(*kept, original, median, job);
  ASSERT_TRUE(expected);
  EXPECT_EQ(compare(expected->field, filtered_field).changed, 0);
  const Differences median_made = compare(smoothed_field, expected->field);
  EXPECT_GT(median_made.marked, 50);
  EXPECT_EQ(median_made.changed_marked, 0);
  EXPECT_GT(median_made.changed, 10000);
  EXPECT_EQ(compare(filtered_field, load(exported_path)).changed, 0);
}

}  // namespace
}  // namespace fettle::tests
