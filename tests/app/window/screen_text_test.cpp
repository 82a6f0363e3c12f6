#include "app/window/screen_text.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(ScreenText, units_and_errors_are_written_one_way) {
  EXPECT_EQ(screenText("radius 5.02 +- 0.01 um"), "radius 5.02 \u00b1 0.01 \u00b5m");
  EXPECT_EQ(screenText("off by 12 um rms, up to 40um; in um."),
            "off by 12 \u00b5m rms, up to 40\u00b5m; in \u00b5m.");
  EXPECT_EQ(screenText("z 3 um (um) [um]\num"), "z 3 \u00b5m (\u00b5m) [\u00b5m]\n\u00b5m");
  EXPECT_EQ(screenText("area 2 um^2"), "area 2 \u00b5m^2");
  EXPECT_EQ(screenText("+-3 mm, without noise, +- its standard error"),
            "\u00b13 mm, without noise, \u00b1 its standard error");
  EXPECT_EQ(screenText("33.4 us, p99 50 us"), "33.4 \u00b5s, p99 50 \u00b5s");
  EXPECT_EQ(screenText("12 mm2, 3 um3/um2, 0.5 1/mm2 (nm2 um)"),
            "12 mm\u00b2, 3 \u00b5m\u00b3/\u00b5m\u00b2, 0.5 1/mm\u00b2 (nm\u00b2 \u00b5m)");
  EXPECT_EQ(screenText("tilted 0.5 +- 0.1 degrees along x, turn 90 degrees"),
            "tilted 0.5 \u00b1 0.1\u00b0 along x, turn 90\u00b0");
  const std::string shown = screenText("1 +- 2 um, 3 mm2, 4 degrees");
  EXPECT_EQ(screenText(shown), shown) << "what is written so stays";
}

TEST(ScreenText, words_files_and_keys_stay_as_they_are) {
  for (const char* text : {"",
                           "the sum of all",
                           "umbrella",
                           "museum",
                           "a vacuum",
                           "let us see",
                           "plus",
                           "/scans/um.tif",
                           "/um/a.tif",
                           "a/mm2.tif",
                           "/scans/mm2/a.tif",
                           "part_20mm2.tif",
                           "in degrees",
                           "part_20um.tif",
                           "20um.tif",
                           "a+-b",
                           "--unit=um",
                           "Ctrl++",
                           "5 +",
                           "- 3"})
    EXPECT_EQ(screenText(text), text);
}

}  // namespace
}  // namespace fettle::app
