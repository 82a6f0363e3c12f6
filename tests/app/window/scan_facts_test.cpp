#include "app/window/panels/scan_facts.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

ScanThumbnail scanOf(double spacing, const engine::LengthUnit& unit) {
  engine::Grid grid;
  grid.width = grid.height = 256;
  grid.spacing_x = grid.spacing_y = spacing;
  grid.lateral_unit = grid.height_unit = unit;
  ScanThumbnail scan;
  scan.grid = grid;
  return scan;
}

// A spacing in m beside an extent in km, and in km in the status line, was two units of one quantity.
TEST(ScanFacts, extent_and_spacing_are_in_the_unit_that_the_window_has_across_a_field) {
  const ScanThumbnail mountain = scanOf(200.0, {"m", 1000.0});
  EXPECT_EQ(extentText(mountain), "51.2 x 51.2 km, 0.2 x 0.2 km apart");
  EXPECT_EQ(spacingText(*mountain.grid), "0.2 x 0.2 km");
  EXPECT_EQ(cursorText(mountain, {.column = 128, .row = 64, .height = 1500.0F}),
            "x 25.6  y 12.8 km  z 1500 m");
  const ScanThumbnail chip = scanOf(0.024, {"mm", 1.0});
  EXPECT_EQ(extentText(chip), "6.144 x 6.144 mm, 0.024 x 0.024 mm apart");
  const ScanThumbnail film = scanOf(4e-9, {"m", 1000.0});
  EXPECT_EQ(extentText(film), "1.024 x 1.024 \u00b5m, 0.004 x 0.004 \u00b5m apart");
}

}  // namespace
}  // namespace fettle::app
