// Units that cannot be right are doubted, whatever the format; those of real scans never.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// A surface that rises by `step` [height unit] at most from sample to sample.
Version rough(Grid grid, double step) {
  grid.width = grid.height = 40;
  std::vector<float> z;
  for (int i = 0; i < 1600; ++i) z.push_back(static_cast<float>(step * ((i * 7919) % 101) / 101.0));
  return makeField(grid, z);
}

std::vector<std::string> doubts(const Version& field, const ImportOptions& options = {},
                                const std::string& name = "f.tif") {
  const TempFolder folder;
  EXPECT_TRUE(save(field, folder.file(name)));
  const auto scan = load(folder.file(name), options);
  EXPECT_TRUE(scan) << scan.error().line();
  std::vector<std::string> doubts;
  for (const std::string& warning : scan->warnings)
    if (warning.find('?') != std::string::npos) doubts.push_back(warning);
  return doubts;
}

TEST(UnitDoubt, HeightsAThousandTimesTooLargeForTheirSpacingName) {
  Grid grid;
  grid.lateral_unit = {"m", 1000.0};
  grid.height_unit = {"m", 1000.0};
  EXPECT_TRUE(doubts(rough(grid, 0.5)).empty());
  const auto warnings = doubts(rough(grid, 500.0));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(
      warnings[0].starts_with("heights in mm where m is stated or assumed, or a spacing that is not in m?"))
      << warnings[0];
  EXPECT_TRUE(warnings[0].ends_with("give --z-scale 0.001 or --spacing")) << warnings[0];
  // Doing so ends it; so does a spacing, which says that both were thought of.
  ImportOptions scaled;
  scaled.z_scale = 0.001;
  EXPECT_TRUE(doubts(rough(grid, 500.0), scaled).empty());
  ImportOptions spaced;
  spaced.spacing = std::pair{1.0, 1.0};
  EXPECT_TRUE(doubts(rough(grid, 500.0), spaced).empty());
  for (const char* name : {"f.asc", "f.x3p", "f.exr", "f.xyz", "f.ply"})
    EXPECT_FALSE(doubts(rough(grid, 500.0), {}, name).empty()) << name;
}

TEST(UnitDoubt, AFewNeighboursProveNothing) {
  Grid grid;
  grid.width = 4;
  grid.height = 2;
  EXPECT_TRUE(doubts(makeField(grid, {0, 500, 0, 500, 500, 0, 500, 0})).empty());
}

TEST(UnitDoubt, NeighboursInEitherDirectionAndAtEveryBorderCount) {
  // Six by eight samples: lines of six that lie 100 apart in turn. 42 neighbours are steep, across the lines, 40 are level.
  Grid grid;
  std::vector<float> z;
  grid.width = 6;
  grid.height = 8;
  for (int i = 0; i < 48; ++i) z.push_back(i / 6 % 2 == 0 ? 0.0F : 100.0F);
  EXPECT_EQ(doubts(makeField(grid, z)).size(), 1U);
  std::swap(grid.width, grid.height);
  for (int i = 0; i < 48; ++i) z[static_cast<std::size_t>(i)] = i % 8 % 2 == 0 ? 0.0F : 100.0F;
  EXPECT_EQ(doubts(makeField(grid, z)).size(), 1U);
}

TEST(UnitDoubt, NoUnitFitsHeightsThatAreCounts) {
  Grid grid;
  grid.height_unit = {"nm", 1e-6};
  const auto warnings = doubts(rough(grid, 1e9));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(warnings[0].starts_with("heights that are no lengths in nm?")) << warnings[0];
}

// What no warning about coordinates in degrees may propose.
void expectNoScale(const std::vector<std::string>& warnings) {
  for (const std::string& truthError : warnings) {
    EXPECT_EQ(truthError.find("--z-scale"), std::string::npos) << truthError;
    EXPECT_EQ(truthError.find(" nm"), std::string::npos) << truthError;
  }
}

TEST(UnitDoubt, DegreesAreNamedAndNeverGivenAScale) {
  // A digital elevation model in degrees and metres that does not say so, as an ASCII grid without .prj:
  // three arc seconds in the Alps, and next to the corner of the globe's grid.
  for (const auto& [x, y] : {std::pair{7.0, 46.0}, {0.0, 0.0}}) {
    Grid grid;
    grid.spacing_x = grid.spacing_y = 1.0 / 1200.0;
    grid.origin_x = x;
    grid.origin_y = y;
    for (const char* name : {"f.asc", "f.tif"}) {
      const auto warnings = doubts(rough(grid, 60.0), {}, name);
      ASSERT_EQ(warnings.size(), 1U) << name;
      EXPECT_TRUE(warnings[0].starts_with("coordinates in degrees where mm is stated or assumed?"))
          << warnings[0];
      EXPECT_NE(warnings[0].find("0.000833 apart"), std::string::npos) << warnings[0];
      expectNoScale(warnings);
    }
  }
  // Degrees that the file says, with heights that cannot be metres.
  const TempFolder folder;
  std::string rows;
  for (int i = 0; i < 1600; ++i)
    rows += std::to_string((i * 7919) % 101 * 1000) + (i % 40 == 39 ? "\n" : " ");
  writeBytes(folder.file("a.asc"),
             "ncols 40\nnrows 40\nxllcorner 7\nyllcorner 46\ncellsize 0.000833333333\n" + rows);
  writeBytes(folder.file("a.prj"),
             R"(GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],)"
             R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]])");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_TRUE(warned(scan.warnings, "heights that are not in m, or coordinates that are no degrees?"));
  expectNoScale(scan.warnings);
  // A field of metres that is said to be in degrees.
  Grid far = scan.field.grid();
  far.spacing_x = far.spacing_y = 30.0;
  const auto warnings = doubts(rough(far, 60.0));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(warnings[0].starts_with("coordinates that are no degrees?")) << warnings[0];
}

TEST(UnitDoubt, NearTheCornerOfTheGlobesNetDegreesAreGivenNoScaleEither) {
  // Not quite an arc second, rounded as typed by users, next to (0, 0), across it and in the middle of it.
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.00013885, -0.00151615}, {-0.005, -0.005}})
    for (const char* name : {"f.asc", "f.tif", "f.xyz"}) {
      Grid grid;
      grid.spacing_x = grid.spacing_y = 0.0002777;
      grid.origin_x = x;
      grid.origin_y = y;
      const TempFolder folder;
      ASSERT_TRUE(save(rough(grid, 60.0), folder.file(name)));
      FETTLE_LOAD(scan, folder.file(name));
      EXPECT_TRUE(warned(scan.warnings, "coordinates in degrees")) << name;
      EXPECT_TRUE(warned(scan.warnings, "0.000278 apart")) << name;
      expectNoScale(scan.warnings);
    }
  // Where the user says a unit of length they are none.
  ImportOptions options;
  options.unit = lengthUnitFromName("mm");
  Grid grid;
  grid.spacing_x = grid.spacing_y = 0.01;
  const auto warnings = doubts(rough(grid, 1.0), options);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(warnings[0].starts_with("heights in um where mm")) << warnings[0];
}

TEST(UnitDoubt, WholeNumbersMayBeCountsOrBrightness) {
  Grid grid;
  grid.height_per_count = 1.0;  // as of any picture
  const auto warnings = doubts(rough(grid, 250.0));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(warnings[0].starts_with("counts or brightness where heights in mm are stated or assumed?"))
      << warnings[0];
  EXPECT_EQ(warnings[0].find("in um"), std::string::npos) << warnings[0];
  EXPECT_EQ(warnings[0].find("--z-scale 0"), std::string::npos) << warnings[0];
  // What the file itself calls no length is not measured as one.
  grid.height_per_count = 0.0;
  grid.height_unit = {"intensity", 1.0};
  for (const std::string& truthError : doubts(rough(grid, 250.0)))
    EXPECT_NE(truthError.find("not a length"), std::string::npos) << truthError;
}

TEST(UnitDoubt, WhatIsSmallerThanAtomsOrLargerThanPlanets) {
  Grid grid;
  grid.height_unit = {"nm", 1e-6};
  const auto small = doubts(rough(grid, 1e-3));
  ASSERT_EQ(small.size(), 1U);
  EXPECT_NE(small[0].find("less than an atom"), std::string::npos) << small[0];
  EXPECT_TRUE(doubts(rough(grid, 0.0)).empty());  // flat is no doubt

  Grid wide;
  wide.lateral_unit = wide.height_unit = {"m", 1000.0};
  wide.spacing_x = wide.spacing_y = 1e5;
  const auto high = doubts(rough(wide, 2e5));
  ASSERT_EQ(high.size(), 1U);
  EXPECT_NE(high[0].find("more than on any planet"), std::string::npos) << high[0];
  wide.spacing_x = wide.spacing_y = 2e6;
  const auto far = doubts(rough(wide, 1.0));
  ASSERT_EQ(far.size(), 1U);
  EXPECT_NE(far[0].find("km long"), std::string::npos) << far[0];

  Grid close;
  close.height_unit = close.lateral_unit = {"nm", 1e-6};
  close.spacing_x = close.spacing_y = 1e-4;
  const auto near = doubts(rough(close, 2e-4));
  EXPECT_TRUE(warned(near, "nm apart"));
}

TEST(UnitDoubt, RealScansAreNotDoubted) {
  struct Case {
    const char* name;
    ImportOptions options;
  };
  std::vector<Case> cases;
  for (const char* name :
       {"dsm_ahn_buildings.tif", "dsm_village_sjtsk.tif", "shapes_plate_u16.png", "tray_bags_aniso_u16.tif",
        "kinect_boxes_depth_u16.tif", "tidal_marsh.asc", "chip_confocal_points.xyz", "cylinders_cloud_le.ply",
        "mug_stereo_organized.pcd", "autzen_park.las", "bullet_land.x3p", "ground_surface_aniso.x3p",
        "lunar_ridge.exr", "scratched_surface.sur", "afm_line_noise_f32.tif"}) {
    cases.push_back({name, {}});
    cases.push_back({name, {}});
    cases.back().options.no_data = 0.0;
    cases.push_back({name, {}});
    cases.back().options.unit = lengthUnitFromName("m");
  }
  for (const Case& c : cases) {
    FETTLE_SCAN_OR_SKIP(path, c.name);
    FETTLE_LOAD(scan, path, c.options);
    for (const std::string& warning : scan.warnings)
      EXPECT_EQ(warning.find('?'), std::string::npos) << c.name << ": " << warning;
  }
}

}  // namespace
}  // namespace fettle::engine
