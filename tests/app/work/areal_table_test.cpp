// What a person reads of surface parameters.

#include "app/work/areal_table.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/grid.h"
#include "engine/measure/areal.h"

namespace fettle::app {
namespace {

// A direction is below 180 degrees also where its digits are rounded: 0 and 180 are one.
TEST(ArealTable, ARoundedDirectionIsBelow180Degrees) {
  engine::Grid grid;
  grid.width = grid.height = 10;
  for (const double degrees : {179.99999999999, 0.0}) {
    engine::ArealParameters measured;
    measured.samples = 100;
    measured.spatial.lay = degrees;
    Report report;
    addAreal(report, measured, {}, grid);
    report["noise"] = {
        {"figures", Report::array({{{"parameter", "std"}, {"without", 179.96}, {"error", 0.3}}})}};
    const auto lines = arealLines({report});
    const auto found = std::ranges::find(lines, "Std", &ArealLine::name);
    ASSERT_NE(found, lines.end());
    EXPECT_EQ(found->values.front(), "0");
    EXPECT_EQ(found->without.front(), "179.96 +- 0.3");
    EXPECT_NE(arealRows("s.tif", report).find("s.tif,spatial,Std,0,degrees,,179.96,0.3"), std::string::npos)
        << arealRows("s.tif", report);
  }
}

}  // namespace
}  // namespace fettle::app
