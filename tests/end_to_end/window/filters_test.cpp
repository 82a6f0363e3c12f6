// The filters panel by hand: a filter cancelled while it runs, and a largest change that is kept.
#include <cmath>
#include <csignal>
#include <string>

#include <fmt/format.h>

#include "engine/filter/filter.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, a_filter_is_cancelled_while_touch_goes_on) {
  const std::string saved = folder.file("after.tif");
  const auto program = start({scan});
  User user(display, *program, "cancel");
  (void)opened(*program);
  user.at({20, 790});
  (void)user.key("7");
  const Screen before = user.look("before");
  for (int i = 0; i < 3; ++i) (void)user.key("n");
  (void)user.enter("window", "61");
  // Minutes of work: other than a median, it is not done when a pass changes nothing more.
  EXPECT_EQ(user.enter("passes", "1000")["filter"], "Bilateral 61 x 61, 1000 passes");
  user.tap("Apply");
  program->until("filtering", [](const State& s) {
    return s["filtering"] == true && s["texts"].dump().find("\"filtering\"") != std::string::npos;
  });
  // A stroke is a step all the while.
  (void)user.press("s");
  program->until("a tool", [](const State& s) { return s["tool"] == "smooth"; });
  user.draw({240, 332}, {340, 332}, 4);
  program->until("a step while it runs",
                 [](const State& s) { return s["steps"] == 1 && s["filtering"] == true; });
  // After the first seconds its bar says how long it still takes.
  program->until("the time that is left", [](const State& s) {
    const std::string texts = s["texts"].dump();
    const std::size_t bar = texts.find("\"filtering, ");
    return bar != std::string::npos && texts.find(" left\"", bar) < texts.find('"', bar + 1);
  });
  (void)user.look("while it runs");
  user.tap("Cancel");
  const State ended = user.rest("cancelled");
  EXPECT_EQ(ended["filtering"], false);
  EXPECT_EQ(ended["applying"], false);
  EXPECT_EQ(ended["variants"], State::array());
  EXPECT_EQ(ended["filters_applied"], 0);
  EXPECT_EQ(ended["steps"], 1);
  EXPECT_EQ(ended["notices"], State::array());
  EXPECT_FALSE(user.reads("filtering"));
  EXPECT_TRUE(user.reads("Apply"));
  (void)user.key("Escape");
  EXPECT_EQ(user.key("ctrl+z")["steps"], 0);
  user.at({20, 790});
  (void)user.same("as before", before);
  saveAs(user, saved);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  EXPECT_EQ(compare(load(scan), load(saved)).changed, 0);
}

TEST_F(WindowTest, a_largest_change_typed_in_is_kept_by_what_is_applied) {
  constexpr double kMost = 0.015;
  const std::string saved = folder.file("limited.tif");
  const auto program = start({scan});
  User user(display, *program, "limit");
  (void)opened(*program);
  (void)user.click("Tool");  // strokes have a limit, too
  (void)user.key("n");
  (void)user.key("n");
  EXPECT_EQ(user.enter("window", "9")["filter"], "Median 9 x 9");
  EXPECT_TRUE(user.key("x")["max_change"].is_number());
  // In micrometres, as the part's changes are shown.
  EXPECT_EQ(user.enter("keep within", "15")["max_change"], kMost);
  EXPECT_TRUE(user.reads("of the scan")) << "from what it counts";
  (void)user.look("typed");
  EXPECT_EQ(user.click("Apply")["filters_applied"], 1);
  EXPECT_EQ(program->now()["steps"], 1);
  saveAs(user, saved);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);

  const engine::Version original = load(scan), result = load(saved);
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kMedian;
  spec.window = 9;
  engine::JobControl job;
  const auto unlimited = engine::applyFilter(original, original, spec, job);
  ASSERT_TRUE(unlimited);
  EXPECT_GT(compare(original, unlimited->field).most, 2.0 * kMost) << "a limit that limits nothing";
  const Differences made = compare(original, result);
  EXPECT_LE(made.most, kMost);
  EXPECT_GT(made.most, 0.99 * kMost);
  EXPECT_GT(made.changed, 10000);
  spec.max_change = kMost;
  const auto expected = engine::applyFilter(original, original, spec, job);
  ASSERT_TRUE(expected);
  EXPECT_EQ(compare(expected->field, result).changed, 0);
}

// Minutes of a filter: what is seen of it is there at once, says how far it is off, and follows the camera.
TEST_F(WindowTest, a_preview_shows_what_is_seen_first) {
  const std::string large = folder.file("large.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "4096x4096", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "seen first");
  (void)opened(*program);
  user.at({360, 420});
  for (int i = 0; i < 5; ++i) (void)user.key("n");
  EXPECT_EQ(program->now()["filter"], "Generalised variation");
  const auto soFar = [](const State& s) {
    return s["preview_so_far"].is_string() ? s["preview_so_far"].get<std::string>() : std::string();
  };
  (void)user.press("p");
  // In the panel too, with what it is made of.
  const State first = program->until("an approximation", [&](const State& s) {
    return soFar(s).starts_with("approximate") && soFar(s).find("off by") != std::string::npos &&
           s["texts"].dump().find("from means of") != std::string::npos;
  });
  EXPECT_EQ(first["filtering"], true);
  // Where one looks, too: means are smoother than what the filter leaves.
  const char* const coarse = "coarse as yet: smoother than the result";
  EXPECT_NE(first["texts"].dump().find(coarse), std::string::npos);
  (void)user.look("approximate");
  // Near one place: what is seen of it is there long before the rest.
  for (int i = 0; i < 14; ++i) (void)user.press("Prior");
  const State exact =
      program->until("exact where it is seen", [&](const State& s) { return soFar(s) == "exact in view"; });
  EXPECT_EQ(exact["filtering"], true);
  EXPECT_EQ(exact["texts"].dump().find(coarse), std::string::npos);
  (void)user.look("exact");
  user.tap("Cancel");
  const State ended = user.rest("cancelled");
  EXPECT_TRUE(ended["preview_so_far"].is_null());
  EXPECT_EQ(ended["variants"], State::array());
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// What is adopted of a preview that was approximate at first is the filter's result, bit by bit.
TEST_F(WindowTest, a_preview_that_was_approximate_is_adopted_exactly) {
  const std::string large = folder.file("large.tif"), saved = folder.file("filtered.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "1500x1500", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "adopted");
  (void)opened(*program);
  for (int i = 0; i < 2; ++i) (void)user.key("n");
  (void)user.enter("window", "31");
  EXPECT_EQ(user.enter("passes", "60")["filter"], "Median 31 x 31, 60 passes");
  user.tap("Preview");
  program->until("an approximation", [](const State& s) {
    return s["preview_so_far"].is_string() &&
           s["preview_so_far"].get<std::string>().starts_with("approximate");
  });
  EXPECT_EQ(user.rest("previewed")["variants"], State{"Median 31 x 31, 60 passes"});
  EXPECT_EQ(user.key("Return")["filters_applied"], 1);
  saveAs(user, saved);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  const engine::Version original = load(large);
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kMedian;
  spec.window = 31;
  spec.passes = 60;
  engine::JobControl job;
  const auto expected = engine::applyFilter(original, original, spec, job);
  ASSERT_TRUE(expected);
  EXPECT_EQ(compare(expected->field, load(saved)).changed, 0);
}

// A field is changed, and the picture follows; another filter waits for a button that is easy to see, where the other was.
TEST_F(WindowTest, a_preview_follows_its_fields) {
  const auto program = start({scan});
  User user(display, *program, "follows");
  (void)opened(*program);
  user.at({20, 790});
  const Screen alone = user.look("scan");
  for (int i = 0; i < 2; ++i) (void)user.key("n");
  EXPECT_EQ(user.key("p")["variants"], State{"Median 3 x 3"});
  user.at({20, 790});
  const Screen three = user.changed("median of 3", alone, 300);
  EXPECT_EQ(user.enter("window", "11")["variants"], State{"Median 11 x 11"});
  user.at({20, 790});
  const Screen eleven = user.changed("median of 11, without a key", three, 300);
  EXPECT_FALSE(user.reads("Show it"));
  // By keys, too, and what is marked alone.
  EXPECT_EQ(user.key("shift+w")["variants"], State{"Median 9 x 9"});
  EXPECT_EQ(user.key("o")["variants"], State{"Median 9 x 9, only marks"});
  EXPECT_EQ(user.key("o")["preview_is_behind"], false);
  EXPECT_EQ(program->now()["steps"], 0);
  const State another = user.key("n");
  EXPECT_EQ(another["filter"], "Bilateral 3 x 3") << "another filter has numbers of its own";
  EXPECT_EQ(another["variants"], State{"Median 9 x 9"});
  EXPECT_EQ(another["preview_is_behind"], true);
  EXPECT_TRUE(user.reads("Show it"));
  (void)user.look("another filter");
  EXPECT_EQ(user.click("Show it")["variants"], State{"Bilateral 3 x 3"});
  EXPECT_TRUE(user.reads("Preview"));
  (void)quit(user);
}

// Who looks for spikes, rows or holes finds all three at the top of the list, each with its preview.
TEST_F(WindowTest, the_list_of_filters_begins_with_spikes_lines_and_holes) {
  const auto program = start({scan});
  User user(display, *program, "list");
  (void)opened(*program);
  (void)user.click("Tool");
  (void)user.click("Box");
  (void)user.look("list");
  for (const char* heading : {"spikes, lines, holes", "noise, edges get round", "noise, edges stay",
                              "waves by their length (ISO 16610)"})
    EXPECT_TRUE(user.reads(heading)) << heading;
  EXPECT_TRUE(user.click("Outliers")["filter"].get<std::string>().starts_with("Outliers"));
  EXPECT_TRUE(user.reads("by the noise")) << "what the range is from";
  (void)user.click("Outliers");
  EXPECT_EQ(user.click("Level lines (rows or columns) ...")["heights_preview"],
            "Level rows: median, form stays");
  EXPECT_TRUE(user.readsScrolled("For lines that are off by a height each: all"))
      << "which lines that is for";
  (void)user.look("levelled");
  EXPECT_TRUE(user.readsScrolled("Add preview"));
  (void)user.click("Outliers");
  EXPECT_EQ(user.click("Fill holes ...")["heights_preview"], "Fill holes: least curvature");
  (void)user.click("Outliers");
  EXPECT_EQ(user.click("Fill holes ...")["heights_preview"], "Fill holes: least curvature")
      << "a preview that is shown stays";
  (void)quit(user);
}

// What is put beside a preview is the filter that is chosen now, with its own numbers.
TEST_F(WindowTest, a_filter_put_beside_another_has_the_numbers_said_for_it) {
  const auto program = start({scan});
  User user(display, *program, "beside");
  (void)opened(*program);
  (void)user.click("Tool");
  for (int i = 0; i < 2; ++i) (void)user.key("n");
  EXPECT_EQ(user.enter("window", "11")["filter"], "Median 11 x 11");
  EXPECT_EQ(user.key("p")["variants"], State{"Median 11 x 11"});
  (void)user.click("Median");
  EXPECT_EQ(user.click("Gaussian")["filter"], "Gaussian 3 x 3");
  EXPECT_EQ(user.click("Add preview")["variants"], (State{"Median 11 x 11", "Gaussian 3 x 3"}));
  EXPECT_EQ(user.enter("window", "7")["filter"], "Gaussian 7 x 7");
  // Back to the first one, as it was said.
  (void)user.click("Gaussian");
  EXPECT_EQ(user.click("Median")["filter"], "Median 11 x 11");
  (void)quit(user);
}

// Of a large field what is left without a form is seen before all of its samples are fitted.
TEST_F(WindowTest, a_form_of_a_large_field_is_previewed_approximately_first) {
  const std::string large = folder.file("large.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "6000x6000", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "large form");
  (void)opened(*program);
  (void)user.press("ctrl+shift+l");
  const State first = program->until("an approximation", [](const State& s) {
    return s["form_preview"].is_string() && s["form_preview_means_of"].is_number();
  });
  EXPECT_EQ(first["form_preview_means_of"], 6);
  (void)user.look("approximate, if soon enough");
  const State full = user.rest("all of it");
  EXPECT_TRUE(full["form_preview"].is_string());
  EXPECT_TRUE(full["form_preview_means_of"].is_null());
  (void)user.look("all of it");
  EXPECT_TRUE(user.key("ctrl+shift+l")["form_preview"].is_null());
  EXPECT_EQ(program->now()["steps"], 0);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// Enter, Tab and a click elsewhere take what stands in a field, Escape does not; a unit may be typed.
TEST_F(WindowTest, a_number_is_taken_when_its_field_is_left_and_in_the_unit_that_is_typed) {
  const auto program = start({scan});
  User user(display, *program, "typed numbers");
  (void)opened(*program);
  (void)user.click("Tool");
  EXPECT_TRUE(user.key("x")["max_change"].is_number());
  const auto taken = [&](double mm) {
    return program->until(fmt::format("{} mm", mm), [&](const State& s) { return s["max_change"] == mm; });
  };
  EXPECT_EQ(user.enter("keep within", "15")["max_change"], 0.015);
  EXPECT_EQ(user.enter("keep within", "0.25 mm")["max_change"], 0.25);
  EXPECT_EQ(user.enter("keep within", "15 parsecs")["max_change"], 0.25) << "no unit that is known";
  ASSERT_TRUE(user.typeIn("keep within", "40"));
  (void)user.press("Tab");
  (void)taken(0.04);
  (void)user.press("Escape");
  (void)user.rest();
  ASSERT_TRUE(user.typeIn("keep within", "60"));
  user.tap("window");
  (void)taken(0.06);
  (void)user.rest();
  ASSERT_TRUE(user.typeIn("keep within", "80"));
  (void)user.press("Escape");
  EXPECT_EQ(user.rest()["max_change"], 0.06);
  // A key that follows the one that leaves the field is not the field's, however slow the frames are.
  ASSERT_TRUE(user.typeIn("keep within", "90"));
  display.hands({"key", "--delay", "0", "Escape", "ctrl+q"});
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
