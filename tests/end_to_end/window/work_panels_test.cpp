// Panels that work on the whole scan: sections kept with the session, holes and lines as steps, another scan to compare or join with, transforms.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "engine/measure/levelled_lines.h"
#include "engine/measure/line_offsets.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Only these panels are open.
void openPanels(const TempFolder& folder, const std::vector<std::string>& names) {
  State panels;
  for (const char* other : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[other] = false;
  for (const std::string& name : names) panels[name] = true;
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"edge_lines", false}, {"panels", panels}};
}

State settledWith(ViewProgram& program, const char* what, const std::function<bool(const State&)>& is) {
  return program.until(what, [&](const State& s) { return s["settled"] == true && is(s); });
}

State jsonOf(const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {FETTLE_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--json", "--quiet"});
  const Outcome outcome = runProcess(all);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.status == 0 ? State::parse(outcome.out) : State::object();
}

// As the panel does it; `form`: what stays.
engine::Version levelledRows(const engine::Version& field, std::optional<int> form) {
  engine::JobControl job;
  const auto offsets = engine::findLineOffsets(field, {.form_degree = form}, job);
  EXPECT_TRUE(offsets);
  return *engine::levelledLines(field, *offsets, engine::allTiles(field.grid()), job);
}

TEST_F(WindowTest, sections_are_measured_as_by_the_command_and_kept_with_the_session) {
  openPanels(folder, {"Section"});
  const std::string work = folder.file("work.fettle");
  State figures;
  {
    const auto program = start({scan});
    User user(display, *program, "sections");
    (void)opened(*program);
    (void)user.key("7");
    user.at({220, 332});
    (void)user.key("q");
    user.at({560, 332});
    (void)user.key("shift+q");
    (void)user.click("step");
    (void)user.click("roughness");
    const State one = settledWith(*program, "figures", [](const State& s) {
      return s["taking_section"] == false && s["section_figures"].contains("roughness");
    });
    EXPECT_EQ(one["sections"], 1);
    EXPECT_TRUE(one["section_figures"].contains("cursors"));
    EXPECT_TRUE(user.reads("between the cursors:"));
    (void)user.key("alt+q");
    user.at({300, 250});
    (void)user.key("q");
    user.at({420, 420});
    (void)user.key("shift+q");
    const State two = settledWith(*program, "another", [](const State& s) {
      return s["sections"] == 2 && s["section"] == 2 && s["section_mm"].is_number() &&
             s["taking_section"] == false;
    });
    EXPECT_FALSE(two["section_figures"].contains("roughness")) << "each has its own";
    user.at({20, 790});
    (void)user.look("two sections");
    (void)user.key("ctrl+shift+q");
    figures = settledWith(*program, "the first again", [](const State& s) {
      return s["section"] == 1 && s["taking_section"] == false && s["section_figures"].contains("roughness");
    })["section_figures"];
    saveAs(user, work);
    (void)quit(user);
  }
  const State kept = jsonOf({"section", work, "--kept"});
  ASSERT_EQ(kept["sections"].size(), 2U) << kept.dump();
  for (const auto& [key, value] : figures.items()) EXPECT_EQ(kept["sections"][0][key], value) << key;
  const auto program = start({work});
  User user(display, *program, "sections again");
  (void)opened(*program);
  const State again = settledWith(*program, "kept sections", [](const State& s) {
    return s["sections"] == 2 && s["taking_section"] == false && s["section_figures"].contains("roughness");
  });
  EXPECT_EQ(again["section_figures"], figures);
  (void)user.click("Remove");
  EXPECT_EQ(settledWith(*program, "one", [](const State& s) { return s["sections"] == 1; })["section"], 1);
  (void)quit(user);
  EXPECT_EQ(jsonOf({"section", work, "--kept"})["sections"].size(), 1U);
}

TEST_F(WindowTest, a_section_is_dragged_by_its_ends_or_as_a_whole) {
  openPanels(folder, {"Section"});
  const auto program = start({scan});
  User user(display, *program, "a dragged section");
  (void)opened(*program);
  (void)user.key("7");
  user.at({220, 332});
  (void)user.key("q");
  user.at({560, 332});
  (void)user.key("shift+q");
  const auto length = [&](const char* what) {
    const State now = settledWith(*program, what, [](const State& s) {
      return s["taking_section"] == false && s["section_mm"].is_number();
    });
    return now["section_mm"].get<double>();
  };
  const double first = length("a section");
  const State view = program->now()["view"];
  user.at({20, 790});
  const Screen before = user.look("a section");

  // An end goes where it is put, from its middle to half of the line; nothing else moves.
  (void)user.drag(1, {560, 332}, {390, 332}, 6);
  EXPECT_NEAR(length("half of it"), 0.5 * first, 0.01 * first);
  EXPECT_EQ(program->now()["view"], view);
  user.at({20, 790});
  (void)user.changed("half of a section", before);
  (void)user.drag(1, {390, 332}, {560, 332}, 6);
  EXPECT_NEAR(length("all of it again"), first, 0.005 * first);

  // Not out of the field, where nothing could take hold of it again.
  (void)user.drag(1, {560, 332}, {760, 332}, 6);
  user.at({20, 790});
  (void)length("up to the border");
  EXPECT_TRUE(user.reads("99.69 mm")) << "the field's last column, 319 times 0.3125 mm";
  (void)user.drag(1, {672, 332}, {560, 332}, 6);
  EXPECT_NEAR(length("back from the border"), first, 0.01 * first);

  // Escape puts it back, with the button still down.
  const double again = length("before Escape");
  user.at({560, 332});
  user.down(1);
  user.at({300, 300});
  EXPECT_LT(length("shorter"), 0.5 * again);
  (void)user.key("Escape");
  EXPECT_EQ(length("put back"), again);
  user.up(1);

  // Beside its ends a line does not hold the view; Ctrl+Shift takes hold of all of it.
  (void)user.drag(1, {330, 332}, {380, 372}, 6);
  EXPECT_NE(program->now()["view"], view);
  EXPECT_EQ(length("the view turned"), again);
  (void)user.key("7");
  (void)user.drag(1, {390, 332}, {390, 392}, 6, "ctrl+shift");
  EXPECT_NEAR(length("moved"), again, 1e-6 * again);

  // A click on another section chooses it.
  (void)user.key("alt+q");
  user.at({300, 500});
  (void)user.key("q");
  user.at({500, 500});
  (void)user.key("shift+q");
  (void)length("another");
  EXPECT_EQ(program->now()["section"], 2);
  user.at({350, 392});
  user.down(1);
  user.up(1);
  EXPECT_EQ(settledWith(*program, "the first", [](const State& s) { return s["section"] == 1; })["sections"],
            2);
  EXPECT_NEAR(length("the first's length"), again, 1e-6 * again);

  // With a tool a press at an end is the tool's.
  (void)user.key("m");
  (void)user.stroke({560, 392}, {540, 420}, 6);
  EXPECT_NEAR(length("not dragged"), again, 1e-6 * again);
  (void)quitWithoutSaving(user);
}

TEST_F(WindowTest, the_wheel_goes_on_with_the_panels_where_a_list_ends) {
  openPanels(folder, {"Steps", "Change since the scan", "Colours", "Display"});
  const auto program = start({scan});
  User user(display, *program, "wheel");
  (void)opened(*program);
  for (int i = 0; i < 12; ++i) (void)user.key("ctrl+i");
  const auto undo = [&] {
    const State now = program->now();
    for (const State& text : now["texts"])
      if (text["text"] == "Undo") return User::Place{text["at"][0], text["at"][1]};
    ADD_FAILURE() << "no button Undo: " << program->now()["texts"].dump();
    return User::Place{};
  };
  // The newest step is at the list's end.
  const User::Place before = undo();
  user.at({before.x, before.y + 60});
  (void)user.wheel(1);
  EXPECT_EQ(undo().y, before.y) << "the list alone";
  (void)user.wheel(-1);
  EXPECT_EQ(undo().y, before.y) << "back to its end";
  (void)user.look("at its end");
  (void)user.wheel(-1);
  EXPECT_LT(undo().y, before.y) << "and on with the panels";
  (void)quitWithoutSaving(user);
}

TEST_F(WindowTest, holes_are_filled_and_lines_levelled_as_steps) {
  openPanels(folder, {"Holes and lines"});
  const Outcome made =
      runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "300x200", "--dropouts", "0.002"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string work = folder.file("work.fettle"), filled = folder.file("filled.tif");
  const auto program = start({scan});
  User user(display, *program, "heights");
  (void)opened(*program);
  const State after = user.click("Fill holes");
  EXPECT_EQ(after["steps"], 1) << after["notices"].dump();
  EXPECT_NE(after["heights_found"].get<std::string>().find("holes filled"), std::string::npos);
  EXPECT_EQ(user.key("alt+r")["steps"], 2);
  (void)user.key("ctrl+z");
  const State undone = user.key("ctrl+z");
  EXPECT_EQ(undone["steps"], 0);
  EXPECT_EQ(undone["heights_found"], "") << "nothing is filled any more";
  (void)user.key("ctrl+shift+z");
  saveAs(user, work);
  user.at({20, 790});
  (void)user.look("filled");
  (void)quit(user);
  // A scan that was just opened has the small holes filled, as the panel says; the others are counted.
  const engine::Grid grid = load(scan).grid();
  const double extent_mm = 20.0 * std::max(grid.spacingXMm(), grid.spacingYMm());
  const State by_command = jsonOf({"fill", scan, filled, "--max-extent", fmt::format("{} mm", extent_mm)});
  const State in_session = jsonOf({"info", work});
  EXPECT_EQ(in_session["no_data"], by_command["no_data"]);
  EXPECT_EQ(in_session["filled"], by_command["filled"]);
  const State replayed = jsonOf({"replay", work, folder.file("again.tif")});
  EXPECT_EQ(jsonOf({"compare", folder.file("again.tif"), filled})["max_abs"], 0.0);
}

TEST_F(WindowTest, filled_holes_and_levelled_lines_are_previewed_beside_the_scan) {
  openPanels(folder, {"Holes and lines"});
  const Outcome made =
      runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "300x200", "--dropouts", "0.002"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string saved = folder.file("levelled.tif");
  const auto program = start({scan});
  User user(display, *program, "heights");
  (void)opened(*program);
  user.at({20, 790});
  const Screen alone = user.look("scan");
  const State shown = user.click("Preview");
  EXPECT_EQ(shown["heights_preview"], "Fill holes: least curvature") << shown["notices"].dump();
  EXPECT_EQ(shown["steps"], 0);
  EXPECT_NE(shown["heights_found"].get<std::string>().find("holes filled"), std::string::npos);
  EXPECT_TRUE(user.reads("Drop preview"));
  user.at({20, 790});
  (void)user.changed("filled beside the scan", alone);
  const State filled = user.click("Fill holes");
  EXPECT_EQ(filled["steps"], 1);
  EXPECT_TRUE(filled["heights_preview"].is_null());
  const State undone = user.key("ctrl+z");
  EXPECT_EQ(undone["steps"], 0);
  EXPECT_EQ(undone["heights_found"], "");
  EXPECT_EQ(user.key("ctrl+r")["heights_preview"], "Level rows: median, form stays");
  // The preview follows the field.
  (void)user.click("stays");
  user.tap("goes, too");
  (void)program->until("without its form",
                       [](const State& s) { return s["heights_preview"] == "Level rows: median"; });
  user.at({20, 790});
  (void)user.look("levelled beside the scan");
  EXPECT_TRUE(user.key("Escape")["heights_preview"].is_null());
  (void)user.key("ctrl+r");
  EXPECT_TRUE(user.key("ctrl+r")["heights_preview"].is_null());
  (void)user.key("ctrl+r");
  const State levelled = user.key("Return");
  EXPECT_EQ(levelled["steps"], 1);
  EXPECT_TRUE(levelled["heights_preview"].is_null());
  // By a key the panel of removed samples comes, too; what holes gave stands with the holes.
  const auto hasPanel = [](const State& s, const char* name) {
    return std::ranges::find(s["panels"], name) != s["panels"].end();
  };
  EXPECT_FALSE(hasPanel(program->now(), "Remove samples"));
  EXPECT_TRUE(hasPanel(user.key("ctrl+x"), "Remove samples"));
  (void)user.key("ctrl+x");
  (void)user.key("ctrl+h");
  const State texts = program->now()["texts"];
  const auto topOf = [&](const std::string& words) {
    for (const State& t : texts)
      if (t["text"].get<std::string>().find(words) != std::string::npos) return t["at"][1].get<int>();
    ADD_FAILURE() << words << " is not there: " << texts.dump();
    return 0;
  };
  EXPECT_GT(topOf("holes filled"), topOf("only holes up to"));
  EXPECT_TRUE(user.key("Escape")["heights_preview"].is_null());
  saveAs(user, saved);
  (void)quit(user);
  EXPECT_EQ(compare(levelledRows(load(scan), std::nullopt), load(saved)).changed, 0);
}

// How many would go is read before anything is done; what is marked goes when it is named, and undo brings all back.
TEST_F(WindowTest, samples_are_removed_by_height_and_by_mark) {
  openPanels(folder, {"Remove samples"});
  const std::string work = folder.file("work.fettle"), removed = folder.file("removed.tif");
  const engine::Version field = load(scan);
  const engine::HeightBounds bounds = field.reader().bounds();
  const double limit = 0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max));
  const std::string typed = fmt::format("{:.4f} mm", limit * field.grid().height_unit.mm);
  const State by_command = jsonOf({"remove", scan, removed, "--below", typed});
  const auto program = start({scan});
  User user(display, *program, "remove");
  (void)opened(*program);
  user.at({20, 790});
  const Screen alone = user.look("scan");
  EXPECT_EQ(user.enter("lower than", typed)["would_remove"], by_command["removed"]);
  EXPECT_TRUE(user.reads("would go"));
  EXPECT_EQ(program->now()["steps"], 0);
  const State shown = user.click("Preview");
  EXPECT_EQ(shown["heights_preview"],
            fmt::format("Remove unmarked samples below {:.6g} mm", std::stod(typed)))
      << shown["notices"].dump();
  user.at({20, 790});
  const Screen holes = user.changed("without them, beside the scan", alone);
  // The preview follows.
  EXPECT_NE(user.enter("lower than", fmt::format("{} mm", bounds.min))["would_remove"],
            by_command["removed"]);
  user.at({20, 790});
  (void)user.changed("another limit", holes);
  (void)user.enter("lower than", typed);
  const State after = user.click("Remove");
  EXPECT_EQ(after["steps"], 1) << after["notices"].dump();
  EXPECT_NE(after["heights_found"].get<std::string>().find(" samples removed"), std::string::npos)
      << "it is done: " << after["heights_found"];
  EXPECT_EQ(user.key("ctrl+z")["steps"], 0);
  user.at({20, 790});
  (void)user.same("undone", alone);
  EXPECT_EQ(user.key("ctrl+shift+z")["steps"], 1);
  // By mark: nothing is marked yet.
  EXPECT_NE(user.key("ctrl+Delete")["notices"].dump().find("nothing is marked"), std::string::npos);
  EXPECT_EQ(program->now()["steps"], 1);
  EXPECT_EQ(user.key("ctrl+i")["steps"], 2) << "all is marked";
  EXPECT_EQ(program->now()["would_remove"], 0) << "and stays unless it is named";
  (void)user.key("alt+m");
  saveAs(user, work);
  (void)quit(user);
  (void)jsonOf({"replay", work, folder.file("again.tif")});
  EXPECT_EQ(compare(load(folder.file("again.tif")), load(removed)).changed, 0);
  EXPECT_EQ(jsonOf({"info", folder.file("again.tif")})["no_data"], by_command["no_data"]);
  // Its recipe has the step, with the bits of the command.
  const Outcome recipe = runProcess({FETTLE_PROGRAM, "recipe", work});
  EXPECT_NE(recipe.out.find("do = \"remove\""), std::string::npos) << recipe.out;
}

TEST_F(WindowTest, what_is_marked_is_removed_by_a_key_and_comes_back) {
  openPanels(folder, {});
  const auto program = start({scan});
  User user(display, *program, "remove marked");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("b");
  (void)user.drag(1, {240, 300}, {340, 400}, 6);
  user.at({20, 790});
  const Screen marked = user.look("marked");
  EXPECT_EQ(program->now()["steps"], 1);
  const State gone = user.key("ctrl+Delete");
  EXPECT_EQ(gone["steps"], 2) << gone["notices"].dump();
  (void)user.changed("a hole", marked, 2000);
  EXPECT_EQ(user.key("ctrl+z")["steps"], 1);
  (void)user.same("marked again", marked);
  // The panel is where one looks for it: the menu opens it.
  EXPECT_FALSE(user.reads("would go"));
  (void)user.key("alt+x");
  EXPECT_TRUE(user.reads("Limits of the colours"));
  (void)user.look("panel");
  (void)quitWithoutSaving(user);
}

// Of a large field an approximation comes first, which says how far it is off; the step is the exact one.
TEST_F(WindowTest, levelled_lines_of_a_large_field_are_approximated_first) {
  openPanels(folder, {"Holes and lines"});
  const std::string large = folder.file("large.tif"), saved = folder.file("levelled.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "4096x4096", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "large heights");
  (void)opened(*program);
  (void)user.press("ctrl+r");
  const State first = program->until("an approximation", [](const State& s) {
    return s["heights_so_far"].get<std::string>().starts_with("approximate, off by about");
  });
  EXPECT_EQ(first["computing_heights"], true);
  (void)user.look("approximate, if soon enough");
  const State full = user.rest("all of it");
  EXPECT_EQ(full["heights_preview"], "Level rows: median, form stays");
  EXPECT_EQ(full["heights_so_far"], "");
  (void)user.look("all of it");
  EXPECT_EQ(user.key("Return")["steps"], 1);
  saveAs(user, saved);
  (void)quit(user);
  EXPECT_EQ(compare(levelledRows(load(large), engine::LineOptions::kUsualFormDegree), load(saved)).changed,
            0);
}

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

// The scan on a ball four times as wide, whose top is at `from` of its width.
void layOnABall(const std::string& scan, double from) {
  const engine::Version part = load(scan);
  const engine::Grid& grid = part.grid();
  const double mm = grid.height_unit.mm, radius = 4.0 * grid.width * grid.spacingXMm();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  part.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double x = (c - from * grid.width) * grid.spacingXMm(),
                   y = (r - 0.5 * grid.height) * grid.spacingYMm();
      z[static_cast<std::size_t>(r * grid.width + c)] +=
          static_cast<float>((std::sqrt(radius * radius - x * x - y * y) - radius) / mm);
    }
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(engine::makeField(grid, z, {}), scan, {}, job));
}

void expectSameBall(const State& a, const State& b, double within) {
  EXPECT_NEAR(a["radius_mm"].get<double>(), b["radius_mm"].get<double>(), within);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(a["point_mm"][k].get<double>(), b["point_mm"][k].get<double>(), within) << k;
}

TEST_F(WindowTest, a_form_goes_along_with_scans_that_are_joined) {
  openPanels(folder, {"Join", "Form"});
  const std::string drawn = folder.file("drawn.tif"), formed = folder.file("formed.fettle"),
                    west = folder.file("west.fettle"), east = folder.file("east.fettle"),
                    both = folder.file("both.fettle");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", drawn, "--size", "256x160"}).status, 0);
  layOnABall(drawn, 0.3);
  (void)jsonOf({"level", drawn, formed, "--layer", "put", "--form", "sphere"});
  (void)jsonOf({"transform", formed, west, "--crop-samples", "0,0,160,160"});
  (void)jsonOf({"transform", formed, east, "--crop-samples", "0,96,160,160"});
  (void)jsonOf({"mosaic", west, east, both});
  const State before = jsonOf({"info", west})["form_figures"];
  const std::string radius = fmt::format("radius {:.5g} mm", before["radius_mm"].get<double>());
  const auto program = start({west});
  User user(display, *program, "join formed");
  EXPECT_EQ(opened(*program)["form"], "sphere");
  EXPECT_TRUE(user.reads(radius));
  (void)user.press("alt+j");
  user.type(east);
  (void)user.press("Return");
  EXPECT_TRUE(user.reads("east.fettle"));
  (void)user.look("listed");
  (void)user.click("Join them");
  const State joined = program->until("opened", [&](const State& s) {
    return s["settled"] == true &&
           s["status"].get<std::string>().find("west_joined.fettle") != std::string::npos;
  });
  EXPECT_EQ(joined["form"], "sphere");
  EXPECT_TRUE(user.reads(radius));
  (void)user.look("joined");
  (void)quit(user);
  const std::string beside = (folder.path() / "west_joined.fettle").string();
  const State after = jsonOf({"info", beside});
  EXPECT_EQ(after["form"], "sphere");
  // West lies where it lay, but for the place that the overlap decides.
  expectSameBall(after["form_figures"], before, 1e-3);
  EXPECT_EQ(after["form_figures"], jsonOf({"info", both})["form_figures"]);
  EXPECT_EQ(jsonOf({"compare", beside, both})["max_abs"], 0.0);
}

TEST_F(WindowTest, scans_that_overlap_become_one_as_by_the_command) {
  openPanels(folder, {"Join"});
  const std::string drawn = folder.file("drawn.tif"), west = folder.file("west.tif"),
                    east = folder.file("east.tif"), both = folder.file("both.tif");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", drawn, "--size", "256x160"}).status, 0);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "transform", drawn, west, "--crop-samples", "0,0,160,160"}).status,
            0);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "transform", drawn, east, "--crop-samples", "0,96,160,160"}).status,
            0);
  (void)jsonOf({"mosaic", west, east, both});
  const auto program = start({west});
  User user(display, *program, "join");
  (void)opened(*program);
  (void)user.press("alt+j");
  user.type(east);
  (void)user.press("Return");
  EXPECT_TRUE(user.reads("east.tif"));
  (void)user.look("listed");
  (void)user.click("Join them");
  const State joined = program->until("opened", [&](const State& s) {
    return s["settled"] == true &&
           s["status"].get<std::string>().find("west_joined.fettle") != std::string::npos;
  });
  EXPECT_EQ(joined["steps"], 0);
  (void)quit(user);
  EXPECT_EQ(jsonOf({"compare", (folder.path() / "west_joined.fettle").string(), both})["max_abs"], 0.0);
}

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
