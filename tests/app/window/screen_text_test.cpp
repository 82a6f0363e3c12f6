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
  const std::string shown = screenText("1 +- 2 um");
  EXPECT_EQ(screenText(shown), shown) << "what is written so stays";
}

TEST(ScreenText, words_files_and_keys_stay_as_they_are) {
  for (const char* text :
       {"", "the sum of all", "umbrella", "museum", "a vacuum", "let us see", "plus", "/scans/um.tif",
        "/um/a.tif", "part_20um.tif", "20um.tif", "a+-b", "--unit=um", "Ctrl++", "5 +", "- 3"})
    EXPECT_EQ(screenText(text), text);
}

}  // namespace
}  // namespace fettle::app
