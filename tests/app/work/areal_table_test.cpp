// What a person reads of surface parameters.

#include "app/work/areal_table.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

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
    const auto lines = arealLines({report}, {"mm", 1.0}, std::nullopt);
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
  const auto lines = arealLines({report}, unitRead({"nm", 1e9}), unitRead({"nm", 1e9}));
  const auto found = std::ranges::find(lines, "Sal", &ArealLine::name);
  ASSERT_NE(found, lines.end());
  EXPECT_EQ(found->unit, "nm");
  EXPECT_EQ(found->values.front(), "25");
}

engine::ArealParameters heightsOf(double sq, double sz, double vmp) {
  engine::ArealParameters measured;
  measured.samples = 100;
  measured.sq = measured.sa = sq;
  measured.sp = measured.sv = measured.sz = sz;
  measured.ratio.vmp = vmp;
  return measured;
}

// The unit and the numbers of Sq, Sz and Vmp [mm] beside a colour bar in `window`.
std::vector<std::string> shownHeights(const engine::ArealParameters& measured, const ReadAs& window) {
  engine::Grid grid;
  grid.width = grid.height = 10;
  Report report;
  addAreal(report, measured, {}, grid);
  std::vector<std::string> shown;
  for (const ArealLine& line : arealLines({report}, {"mm", 1.0}, window))
    for (const char* name : {"Sq", "Sz", "Vmp"})
      if (line.name == name) shown.push_back(line.values.front() + " " + line.unit);
  return shown;
}

// Heights are in the unit of the colour bar, not in one of Sq's own.
TEST(ArealTable, HeightsAreInTheUnitOfTheWindowWhereAllAreReadableInIt) {
  EXPECT_EQ(shownHeights(heightsOf(0.5, 12.0, 0.01), {"mm", 1.0}),
            (std::vector<std::string>{"0.5 mm", "12 mm", "0.01 mm3/mm2"}));
  EXPECT_EQ(shownHeights(heightsOf(0.5, 12.0, 0.01), {"um", 1e-3}),
            (std::vector<std::string>{"500 um", "12000 um", "10 um3/um2"}));
}

TEST(ArealTable, HeightsAreInAnotherUnitWhereMoreAreReadable) {
  // A filter leaves micrometres of millimetres.
  EXPECT_EQ(shownHeights(heightsOf(5e-4, 3e-3, 2e-5), {"mm", 1.0}),
            (std::vector<std::string>{"0.5 um", "3 um", "0.02 um3/um2"}));
  // One spike.
  EXPECT_EQ(shownHeights(heightsOf(0.9, 140.0, 0.02), {"um", 1e-3}),
            (std::vector<std::string>{"0.9 mm", "140 mm", "0.02 mm3/mm2"}));
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
