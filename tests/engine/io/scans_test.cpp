// The real scans, against the figures that their README took from them with another reader.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/shared_data.h"

namespace fettle::engine {
namespace {

// A check value as the README prints it: equal to as many digits as it has.
#define EXPECT_STORED(field, row, column, value) \
  EXPECT_EQ(stored(field, row, column), static_cast<float>(value))

TEST(Scans, LidarModelWithNanHolesAndCompoundSystem) {
  FETTLE_SCAN_OR_SKIP(path, "dsm_ahn_buildings.tif");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "GTiff");
  EXPECT_EQ(grid.width, 963);
  EXPECT_EQ(grid.height, 840);
  EXPECT_EQ(grid.spacing_x, 0.5);
  EXPECT_EQ(grid.spacing_y, 0.5);
  EXPECT_EQ(grid.origin_x, 73410.25);
  EXPECT_EQ(grid.origin_y, 451653.5 - 839.5 * 0.5);
  EXPECT_EQ(grid.lateral_unit, (LengthUnit{"m", 1000.0}));
  EXPECT_EQ(grid.height_unit, (LengthUnit{"m", 1000.0}));
  EXPECT_NE(grid.crs_wkt.find("Amersfoort / RD New + NAP height"), std::string::npos);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 42475);
  EXPECT_EQ(static_cast<float>(s.min), -0.436F);
  EXPECT_EQ(static_cast<float>(s.max), 43.305F);
  EXPECT_NEAR(s.mean, 6.338, 5e-4);
  EXPECT_STORED(scan.field, 210, 321, 9.792);
  EXPECT_STORED(scan.field, 420, 481, 7.861);
  EXPECT_STORED(scan.field, 630, 642, 10.955);
}

TEST(Scans, NegativeCoordinatesAndAnOverlongNoDataValue) {
  FETTLE_SCAN_OR_SKIP(path, "dsm_village_sjtsk.tif");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(grid.width, 223);
  EXPECT_EQ(grid.height, 175);
  EXPECT_EQ(grid.spacing_x, 1.0);
  EXPECT_EQ(grid.origin_x, -336531.6453 + 0.5);
  EXPECT_EQ(grid.origin_y, -1189032.1189 - 174.5);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 1035);
  EXPECT_NEAR(s.min, 987.2667, 5e-5);
  EXPECT_NEAR(s.max, 1026.1981, 5e-5);
  EXPECT_NEAR(s.mean, 1000.487, 5e-4);
  EXPECT_STORED(scan.field, 43, 74, 1011.068);
  EXPECT_STORED(scan.field, 87, 111, 1000.1425);
  EXPECT_STORED(scan.field, 131, 148, 1004.4005);
}

TEST(Scans, AScanThatLostItsLastBytesIsRefused) {
  FETTLE_SCAN_OR_SKIP(path, "dsm_village_sjtsk.tif");
  const std::string whole = readBytes(path);
  const std::string copy = ::testing::TempDir() + "fettle_scan_cut.tif";
  // The hole value lies last, the names of the coordinate system before it.
  for (const std::size_t lost : {1U, 3U, 20U, 77U, 500U}) {
    writeBytes(copy, whole.substr(0, whole.size() - lost));
    const auto scan = load(copy);
    ASSERT_FALSE(scan) << lost;
    EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    EXPECT_TRUE(scan.error().remedy.starts_with("the file is cut short")) << scan.error().line();
  }
  std::remove(copy.c_str());
}

TEST(Scans, SixteenBitPngWithZeroAsHole) {
  FETTLE_SCAN_OR_SKIP(path, "shapes_plate_u16.png");
  ImportOptions raw;
  raw.no_data = 0.0;
  FETTLE_LOAD(counts, path, raw);
  EXPECT_EQ(counts.format, "PNG");
  EXPECT_EQ(counts.field.grid().width, 744);
  EXPECT_EQ(counts.field.grid().height, 770);
  const FieldSummary s = summarize(counts.field);
  EXPECT_EQ(s.no_data, 108094);
  EXPECT_EQ(s.min, 9732.0);
  EXPECT_EQ(s.max, 11192.0);
  EXPECT_NEAR(s.mean, 10187.54, 5e-3);
  EXPECT_STORED(counts.field, 192, 248, 10292);
  EXPECT_STORED(counts.field, 385, 372, 10298);
  EXPECT_STORED(counts.field, 577, 496, 10044);

  ImportOptions scaled = raw;
  scaled.z_scale = 0.02;
  scaled.spacing = std::pair{0.21585083, 0.20881914};
  scaled.unit = lengthUnitFromName("mm");
  FETTLE_LOAD(scan, path, scaled);
  EXPECT_EQ(scan.field.grid().height_per_count, 0.02);
  EXPECT_EQ(scan.field.grid().spacing_x, 0.21585083);
  EXPECT_EQ(scan.field.grid().spacing_y, 0.20881914);
  EXPECT_EQ(stored(scan.field, 192, 248), static_cast<float>(10292 * 0.02));
  EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();
}

TEST(Scans, AnisotropicSpacingFromResolutionTags) {
  FETTLE_SCAN_OR_SKIP(path, "tray_bags_aniso_u16.tif");
  ImportOptions options;
  options.no_data = 0.0;
  FETTLE_LOAD(scan, path, options);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(grid.width, 1248);
  EXPECT_EQ(grid.height, 673);
  // The tag is 12174243 / 262144 pixels a centimetre, which is 0.215326741 mm to 8 digits.
  EXPECT_EQ(grid.spacing_x, 10.0 / (12174243.0 / 262144.0));
  EXPECT_NEAR(grid.spacing_x, 0.215326741, 1e-8);
  EXPECT_EQ(grid.spacing_y, 0.5);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 394063);
  EXPECT_EQ(s.min, 1265.0);
  EXPECT_EQ(s.max, 9398.0);
  EXPECT_NEAR(s.mean, 4587.37, 5e-3);
  EXPECT_STORED(scan.field, 168, 416, 4868);
  EXPECT_STORED(scan.field, 336, 624, 3320);
  EXPECT_STORED(scan.field, 504, 832, 2804);
}

TEST(Scans, DepthCameraTiffInPackBits) {
  FETTLE_SCAN_OR_SKIP(path, "kinect_boxes_depth_u16.tif");
  ImportOptions options;
  options.no_data = 0.0;
  FETTLE_LOAD(scan, path, options);
  EXPECT_EQ(scan.field.grid().width, 640);
  EXPECT_EQ(scan.field.grid().height, 480);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 35625);
  EXPECT_EQ(s.min, 671.0);
  EXPECT_EQ(s.max, 1713.0);
  EXPECT_NEAR(s.mean, 991.52, 5e-3);
  EXPECT_STORED(scan.field, 120, 213, 1241);
  EXPECT_STORED(scan.field, 240, 320, 854);
  EXPECT_STORED(scan.field, 360, 426, 829);
}

TEST(Scans, AsciiGridWithUpperCaseKeysAndPositiveNoData) {
  FETTLE_SCAN_OR_SKIP(path, "tidal_marsh.asc");
  ImportOptions options;
  options.unit = lengthUnitFromName("m");
  FETTLE_LOAD(scan, path, options);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "AAIGrid");
  EXPECT_EQ(grid.width, 300);
  EXPECT_EQ(grid.height, 452);
  EXPECT_EQ(grid.spacing_x, 2.0);
  EXPECT_EQ(grid.origin_x, 1.0);
  EXPECT_EQ(grid.origin_y, 1.0);
  EXPECT_EQ(grid.lateral_unit.mm, 1000.0);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 35152);
  EXPECT_EQ(static_cast<float>(s.min), -2.609347F);
  EXPECT_EQ(static_cast<float>(s.max), 8.461376F);
  EXPECT_NEAR(s.mean, 1.33909, 5e-6);
  EXPECT_NEAR(stored(scan.field, 113, 100), 1.0982, 5e-6);  // printed with 5 decimals
  EXPECT_NEAR(stored(scan.field, 226, 150), 0.72391, 5e-6);
  EXPECT_NEAR(stored(scan.field, 339, 200), -1.19105, 5e-6);
}

TEST(Scans, FloatTiffWithoutReference) {
  FETTLE_SCAN_OR_SKIP(path, "afm_line_noise_f32.tif");
  ImportOptions options;
  options.unit = lengthUnitFromName("nm");
  options.spacing = std::pair{0.9765625, 0.9765625};
  FETTLE_LOAD(scan, path, options);
  EXPECT_EQ(scan.field.grid().width, 512);
  EXPECT_EQ(scan.field.grid().height, 512);
  EXPECT_DOUBLE_EQ(scan.field.grid().spacingXMm(), 0.9765625e-6);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 0);
  EXPECT_NEAR(s.min, -30.306376, 5e-7);
  EXPECT_NEAR(s.max, 28.892195, 5e-7);
  EXPECT_NEAR(s.mean, -0.0545, 5e-5);
  double squares = 0.0;
  for (const float z : heightsOf(scan.field)) squares += (z - s.mean) * (z - s.mean);
  EXPECT_NEAR(std::sqrt(squares / 512 / 512), 9.94599, 5e-6);
  EXPECT_NEAR(stored(scan.field, 128, 170), -0.7981933, 5e-8);
  EXPECT_NEAR(stored(scan.field, 256, 256), -18.9161644, 1e-6);
  EXPECT_NEAR(stored(scan.field, 384, 341), 6.8369007, 3e-7);
}

TEST(Scans, TextPointsFallOnTheirRasterWithoutCollision) {
  FETTLE_SCAN_OR_SKIP(path, "chip_confocal_points.xyz");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "XYZ");
  EXPECT_EQ(grid.width, 500);
  EXPECT_EQ(grid.height, 472);  // y ends at 11.304 mm, the last 28 rows of the raster hold no point
  EXPECT_EQ(grid.spacing_x, 0.024);
  EXPECT_EQ(grid.spacing_y, 0.024);
  EXPECT_EQ(grid.origin_x, 0.0);
  EXPECT_EQ(grid.origin_y, 0.0);
  ASSERT_TRUE(scan.gridding.has_value());
  EXPECT_TRUE(scan.gridding->lattice);
  EXPECT_EQ(scan.gridding->points, 173544);
  EXPECT_EQ(scan.gridding->multiple_cells, 0);
  EXPECT_EQ(scan.gridding->empty_cells, 500 * 472 - 173544);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 500 * 472 - 173544);
  EXPECT_EQ(s.min, 0.0);
  EXPECT_EQ(static_cast<float>(s.max), 0.3052144F);
  for (int c = 0; c < 500; ++c) EXPECT_EQ(scan.field.reader().heightAt(c, 0), 0.0F);
}

TEST(Scans, BinaryPointsFallOnTheirAnisotropicRaster) {
  FETTLE_SCAN_OR_SKIP(path, "cylinders_cloud_le.ply");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "PLY");
  EXPECT_EQ(grid.width, 482);  // the first 14 columns of the raster of 496 hold no point
  EXPECT_EQ(grid.height, 750);
  EXPECT_EQ(grid.spacing_x, 0.2020202);
  EXPECT_EQ(grid.spacing_y, 0.2);
  EXPECT_NEAR(grid.origin_x, -47.1717, 5e-5);
  EXPECT_EQ(grid.origin_y, 0.0);
  EXPECT_NEAR(grid.origin_x + 481 * grid.spacing_x, 50.0, 5e-6);
  ASSERT_TRUE(scan.gridding.has_value());
  EXPECT_TRUE(scan.gridding->lattice);
  EXPECT_EQ(scan.gridding->points, 212380);
  EXPECT_EQ(scan.gridding->multiple_cells, 0);
  EXPECT_EQ(grid.lateral_unit.name, "mm");
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(static_cast<float>(s.min), 6.454545F);
  EXPECT_EQ(static_cast<float>(s.max), 31.322727F);
}

TEST(Scans, OrganisedCloudOfAStereoCameraStaysItsPixels) {
  FETTLE_SCAN_OR_SKIP(path, "mug_stereo_organized.pcd");
  ImportOptions options;
  options.unit = lengthUnitFromName("m");
  FETTLE_LOAD(scan, path, options);
  EXPECT_EQ(scan.format, "PCD");
  EXPECT_EQ(scan.field.grid().width, 640);
  EXPECT_EQ(scan.field.grid().height, 480);
  EXPECT_TRUE(warned(scan.warnings, "perspective"));
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 97920);
  EXPECT_NEAR(s.min, 0.69001, 5e-6);
  EXPECT_NEAR(s.max, 2.5927, 5e-5);
  EXPECT_NEAR(stored(scan.field, 120, 213), 2.0287, 5e-5);
  EXPECT_NEAR(stored(scan.field, 240, 320), 0.94408, 5e-6);
  EXPECT_NEAR(stored(scan.field, 360, 426), 0.76524, 5e-6);
}

TEST(Scans, AirbornePointsInFeet) {
  FETTLE_SCAN_OR_SKIP(path, "autzen_park.las");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "LAS");
  EXPECT_EQ(grid.lateral_unit.name, "ft");
  EXPECT_EQ(grid.height_unit.name, "ft");
  EXPECT_NE(grid.crs_wkt.find("HARN"), std::string::npos);
  ASSERT_TRUE(scan.gridding.has_value());
  EXPECT_EQ(scan.gridding->points, 110000);
  EXPECT_NEAR(grid.origin_x, 636001.76, 5e-3);
  EXPECT_NEAR(grid.origin_y, 848935.20, 5e-3);
  // The outermost points lie within half a cell of the outermost samples.
  EXPECT_NEAR(grid.origin_x + (grid.width - 1) * grid.spacing_x, 637179.22, 0.51 * grid.spacing_x);
  EXPECT_NEAR(grid.origin_y + (grid.height - 1) * grid.spacing_y, 849497.90, 0.51 * grid.spacing_y);
  ImportOptions highest;
  highest.cell_rule = CellRule::kHighest;
  FETTLE_LOAD(from_above, path, highest);
  EXPECT_NEAR(summarize(from_above.field).max, 520.51, 5e-3);
  EXPECT_GE(summarize(from_above.field).min, 406.26 - 5e-3);
}

TEST(Scans, DigitalSurfWithMissingPoints) {
  FETTLE_SCAN_OR_SKIP(path, "scratched_surface.sur");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "SUR");
  EXPECT_EQ(grid.width, 563);
  EXPECT_EQ(grid.height, 484);
  EXPECT_NEAR(grid.spacingXMm(), 3.484e-3, 1e-9);
  EXPECT_NEAR(grid.spacingYMm(), 3.484e-3, 1e-9);
  const double per_count = 1e-7 / grid.height_unit.mm;  // 0.1 nm
  EXPECT_NEAR(grid.height_per_count, per_count, 1e-9 * per_count);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 117);
  const auto counts = [&](double height) { return height / grid.height_per_count; };
  EXPECT_NEAR(counts(s.min), 89120, 5e-3);
  EXPECT_NEAR(counts(s.max), 103880, 5e-3);
  EXPECT_NEAR(counts(s.mean), 101573.76, 5e-3);
  EXPECT_NEAR(counts(stored(scan.field, 121, 187)), 101624, 5e-3);
  EXPECT_NEAR(counts(stored(scan.field, 242, 281)), 101589, 5e-3);
  EXPECT_NEAR(counts(stored(scan.field, 363, 375)), 101660, 5e-3);
}

TEST(Scans, X3pInAFolderWithAMaskAndNoNameSpace) {
  FETTLE_SCAN_OR_SKIP(path, "bullet_land.x3p");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(scan.format, "X3P");
  EXPECT_EQ(grid.width, 918);
  EXPECT_EQ(grid.height, 256);
  EXPECT_EQ(grid.spacing_x, 2.58e-6);
  EXPECT_EQ(grid.spacing_y, 2.58e-6);
  EXPECT_EQ(grid.height_unit.name, "m");
  EXPECT_TRUE(warned(scan.warnings, "mask"));
  EXPECT_FALSE(warned(scan.warnings, "heights are not"));
  EXPECT_FALSE(warned(scan.warnings, "metres?"));
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 25292);
  EXPECT_NEAR(s.min, -7.947348e-05, 1e-11);
  EXPECT_NEAR(s.max, 5.249858e-05, 1e-11);
  EXPECT_NEAR(s.mean, -5.352e-07, 1e-10);
  EXPECT_NEAR(stored(scan.field, 64, 306), 2.974762e-05, 1e-11);
  EXPECT_NEAR(stored(scan.field, 128, 459), 4.136096e-05, 1e-11);
  EXPECT_NEAR(stored(scan.field, 192, 612), 1.760770e-05, 1e-11);
}

TEST(Scans, X3pWithAnisotropicIncrementsAndOffsets) {
  FETTLE_SCAN_OR_SKIP(path, "ground_surface_aniso.x3p");
  FETTLE_LOAD(scan, path);
  const Grid& grid = scan.field.grid();
  EXPECT_EQ(grid.width, 650);
  EXPECT_EQ(grid.height, 650);
  EXPECT_EQ(grid.spacing_x, 1.27656509837346e-7);
  EXPECT_EQ(grid.spacing_y, 3.14582113527746e-7);
  EXPECT_EQ(grid.origin_x, 7.65614218798151e-5);
  EXPECT_FALSE(warned(scan.warnings, "heights are not"));
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 0);
  EXPECT_NEAR(s.min, -3.144207e-07, 1e-13);
  EXPECT_NEAR(s.max, 2.399155e-07, 1e-13);
  EXPECT_NEAR(stored(scan.field, 162, 216), -4.583059e-08, 1e-14);
  EXPECT_NEAR(stored(scan.field, 325, 325), 6.183361e-08, 1e-14);
  EXPECT_NEAR(stored(scan.field, 487, 433), -7.206429e-08, 1e-14);
}

TEST(Scans, ExrWithTransparencyEverywhereOne) {
  FETTLE_SCAN_OR_SKIP(path, "lunar_ridge.exr");
  ImportOptions options;
  options.spacing = std::pair{200.0, 200.0};
  options.unit = lengthUnitFromName("m");
  FETTLE_LOAD(scan, path, options);
  EXPECT_EQ(scan.format, "EXR");
  EXPECT_EQ(scan.field.grid().width, 256);
  EXPECT_EQ(scan.field.grid().height, 256);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 0);
  EXPECT_NEAR(s.min, 0.3224838, 5e-8);
  EXPECT_NEAR(s.max, 0.5936717, 5e-8);
  EXPECT_NEAR(stored(scan.field, 64, 85), 0.4288903, 5e-8);
  EXPECT_NEAR(stored(scan.field, 128, 128), 0.5508972, 5e-8);
  EXPECT_NEAR(stored(scan.field, 192, 170), 0.4970673, 5e-8);
  EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();
}

TEST(Scans, DepthImageInThePerspectiveOfItsCamera) {
  FETTLE_SCAN_OR_SKIP(path, "kinect_boxes_depth_u16.tif");
  ImportOptions options;
  options.depth_camera = DepthCamera{525.0, 525.0, 319.5, 239.5};
  FETTLE_LOAD(scan, path, options);
  const FieldSummary s = summarize(scan.field);
  EXPECT_EQ(s.no_data, 35625);
  EXPECT_EQ(s.min, 671.0);
  EXPECT_EQ(s.max, 1713.0);
  EXPECT_STORED(scan.field, 120, 213, 1241);
  // 1 mm to 2 mm a pixel at about a metre.
  EXPECT_GT(scan.field.grid().spacing_x, 671.0 / 525.0);
  EXPECT_LT(scan.field.grid().spacing_x, 1713.0 / 525.0);
  EXPECT_TRUE(warned(scan.warnings, "perspective"));
}

TEST(Scans, EveryScanSurvivesTheWayThroughEveryLosslessFormatBitForBit) {
  for (const char* name :
       {"dsm_ahn_buildings.tif", "dsm_village_sjtsk.tif", "shapes_plate_u16.png", "tray_bags_aniso_u16.tif",
        "tidal_marsh.asc", "chip_confocal_points.xyz", "cylinders_cloud_le.ply", "afm_line_noise_f32.tif",
        "kinect_boxes_depth_u16.tif", "mug_stereo_organized.pcd", "autzen_park.las", "scratched_surface.sur",
        "bullet_land.x3p", "ground_surface_aniso.x3p", "lunar_ridge.exr"}) {
    FETTLE_SCAN_OR_SKIP(path, name);
    FETTLE_LOAD(scan, path);
    for (const char* extension : {".tif", ".x3p", ".exr"}) {
      const std::string copy = ::testing::TempDir() + "fettle_scan_copy" + extension;
      const auto written = save(scan.field, copy);
      ASSERT_TRUE(written) << written.error().line();
      FETTLE_LOAD(again, copy);
      EXPECT_EQ(contentHash(again.field), contentHash(scan.field)) << name << extension;
      Grid expected = scan.field.grid();
      Grid got = again.field.grid();
      EXPECT_EQ(expected.crs_wkt.empty(), got.crs_wkt.empty()) << name;
      expected.crs_wkt = got.crs_wkt = "";  // the same system may come back in other words
      EXPECT_EQ(expected, got) << name << extension;
      std::remove(copy.c_str());
    }
  }
}

}  // namespace
}  // namespace fettle::engine
