// What a person reads of surface parameters.

#include "app/work/areal_table.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/grid.h"
#include "engine/measure/areal.h"
#include "engine/uncertainty/areal_figures.h"

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
    const auto lines = arealLines({report}, {"mm", 1.0});
    const auto found = std::ranges::find(lines, "Std", &ArealLine::name);
    ASSERT_NE(found, lines.end());
    EXPECT_EQ(found->values.front(), "0");
    EXPECT_EQ(found->without.front(), "179.96 +- 0.3");
    EXPECT_NE(arealRows("s.tif", report).find("s.tif,spatial,Std,0,degrees,,179.96,0.3"), std::string::npos)
        << arealRows("s.tif", report);
  }
}

// Beside a scale bar, coordinates and sizes in nm a length in um is a second unit of one quantity.
TEST(ArealTable, LengthsAcrossAreInTheUnitOfTheWindow) {
  engine::Grid grid;
  grid.width = grid.height = 128;
  grid.spacing_x = grid.spacing_y = 4e-9;
  grid.lateral_unit = grid.height_unit = {"m", 1000.0};
  engine::ArealParameters measured;
  measured.samples = 100;
  measured.sq = 2e-8;
  measured.spatial.sal = 2.5e-5;  // mm
  Report report;
  addAreal(report, measured, {}, grid);
  const auto lines = arealLines({report}, unitRead({"nm", 1e9}));
  const auto found = std::ranges::find(lines, "Sal", &ArealLine::name);
  ASSERT_NE(found, lines.end());
  EXPECT_EQ(found->unit, "nm");
  EXPECT_EQ(found->values.front(), "25");
}

// What is not stated with noise is not stated without either, for the reason that it has.
TEST(ArealTable, WithoutNoiseAFigureThatIsNotStatedHasItsOwnReason) {
  engine::Grid grid;
  grid.width = grid.height = 10;
  engine::ArealParameters measured;
  measured.samples = 100;
  measured.spatial.str = std::numeric_limits<double>::quiet_NaN();
  measured.not_stated.push_back({"str", "it stays above 0.2"});
  Report report;
  addAreal(report, measured, {}, grid);
  ArealNoise noise;
  noise.trials = 4;
  noise.effects.resize(engine::arealFigures().size());
  for (engine::NoiseEffect& effect : noise.effects)
    effect = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
              "its error"};
  noise.effects[static_cast<std::size_t>(&engine::arealFigure("str") - engine::arealFigures().data())]
      .why = {};
  addNoise(report, noise, grid);
  for (const Report& figure : report["noise"]["figures"])
    EXPECT_EQ(figure["reason"], figure["parameter"] == "str" ? "it stays above 0.2" : "its error")
        << figure.dump();
}

}  // namespace
}  // namespace fettle::app
