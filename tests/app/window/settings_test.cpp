#include "app/window/settings.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

TEST(Settings, come_back_as_they_were_saved) {
  const tests::TempFolder folder;
  const std::string path = (folder.path() / "window.json").string();
  Settings settings;
  settings.display.split_at = 0.25;
  settings.display.map = render::ColourMap::kCividis;
  settings.display.heights = {RangeRule::Kind::kAll, 0.99};
  settings.display.changes = {RangeRule::Kind::kShare, 0.9};
  settings.display.colour_steps = true;
  settings.display.theme = render::Theme::kLight;
  settings.display.light_azimuth_deg = 20.0F;
  settings.display.form.material = render::Material::kWax;
  settings.display.form.value_colours = 0.4;
  settings.display.half_in_motion = false;
  settings.display.smooth_at_rest = false;
  settings.display.stylus = {.pen = false, .shadow = false, .force = false, .trail = true};
  settings.display.vertices = 131072;
  settings.display.axes = false;
  settings.display.flights = false;
  settings.display.reduced_motion = true;
  settings.ui_scale = 1.75;
  settings.habits = Habits::kMeshLib;
  settings.panels_theme = render::Theme::kLight;
  settings.side_panel = false;
  settings.side_width = 401.0F;
  settings.panels = {{"Tool", false}, {"Haptics", true}};
  settings.pen = {false, 2.5};
  settings.loudness = {0.25F, true};
  settings.ask_before_quitting = false;
  settings.devices["omega.3, 10406"] = {DeviceReach{{-60.5, -70.0, -50.0}, {61.0, 72.0, 53.0}}, 0.4, 0};
  settings.devices["Touch"].giveMenu(2);
  settings.save(path);
  EXPECT_EQ(Settings::load(path), settings);
  EXPECT_FALSE(Settings() == settings);
  EXPECT_TRUE(Settings::load(path).display.reduced_motion);
  EXPECT_EQ(Settings::load(path).ui_scale, 1.75);
  EXPECT_EQ(Settings::load(path).pen.firmness, 2.5);
  EXPECT_EQ(Settings::load(path).devices, settings.devices);
}

TEST(Settings, reduced_motion_stops_flights_and_the_trail_and_keeps_what_was_said_of_them) {
  Display display;
  display.stylus.trail = true;
  EXPECT_TRUE(display.flies());
  EXPECT_TRUE(display.stylusLook().trail);
  display.reduced_motion = true;
  EXPECT_FALSE(display.flies());
  EXPECT_FALSE(display.stylusLook().trail);
  EXPECT_TRUE(display.stylusLook().pen);
  display.reduced_motion = false;
  EXPECT_TRUE(display.flies() && display.stylusLook().trail);
}

TEST(Settings, marks_that_are_hidden_are_seen_again_in_the_next_start) {
  const tests::TempFolder folder;
  const std::string path = (folder.path() / "window.json").string();
  Settings settings;
  settings.display.marks = false;
  settings.save(path);
  EXPECT_TRUE(Settings::load(path).display.marks);
}

TEST(Settings, ends_of_colours_that_were_typed_belong_to_the_scan) {
  const tests::TempFolder folder;
  const std::string path = (folder.path() / "window.json").string();
  Settings settings;
  settings.display.changes.kind = RangeRule::Kind::kTyped;
  settings.save(path);
  EXPECT_EQ(Settings::load(path).display.changes.kind, RangeRule::Kind::kAutomatic);
}

TEST(Settings, what_is_missing_wrong_or_out_of_range_stays_as_it_is_by_itself) {
  const tests::TempFolder folder;
  const std::string path = (folder.path() / "window.json").string();
  EXPECT_EQ(Settings::load(path), Settings());
  for (const char* text :
       {"", "no json", "[1, 2]",
        "{\"split_at\": 7, \"light_elevation\": -3, \"vertices\": 12, \"mouse\": \"cat\"}",
        "{\"change_range\": \"typed\", \"change_share\": 0, \"panels\": {\"Tool\": 5}, \"side_width\": "
        "\"wide\", \"colours\": 4}",
        "{\"volume\": 1.5, \"muted\": \"no\"}", "{\"ui_scale\": 0.1, \"reduced_motion\": 1}",
        "{\"ui_scale\": 40}", "{\"material\": \"gold\", \"material_colours\": 2}"}) {
    std::ofstream(path) << text;
    EXPECT_EQ(Settings::load(path), Settings()) << text;
  }
  // A box in which no hand fits, numbers that are none, a motion out of range.
  std::ofstream(path)
      << R"({"devices": {"A": {"low_mm": [0, 0, 0], "high_mm": [100, 100, 5], "motion": 7, "clutch_buttons": -1, "menu_buttons": "x"},
                         "B": {"low_mm": [0, 0], "high_mm": [1e9, 1, 1]}, "C": 5}})";
  EXPECT_EQ(Settings::load(path).devices, (DeviceSetups{{"A", {}}, {"B", {}}}));
  std::ofstream(path) << "{\"mouse\": \"meshlab\", \"split_at\": 7e9}";
  EXPECT_EQ(Settings::load(path).habits, Habits::kMeshLab);
}

TEST(Settings, a_folder_that_is_not_there_is_no_error) {
  Settings().save("");
  Settings().save("/nowhere/at/all/window.json");
  EXPECT_EQ(Settings::load("/nowhere/at/all/window.json"), Settings());
}

}  // namespace
}  // namespace fettle::app
