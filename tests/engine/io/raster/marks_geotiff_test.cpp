// Masks of other programs, laid on a scan by their position.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <cpl_conv.h>
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include "engine/io/geo/geo_reference.h"
#include "engine/io/raster/marks.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

std::string systemOf(int epsg) {
  OGRSpatialReferenceH crs = OSRNewSpatialReference(nullptr);
  EXPECT_EQ(OSRImportFromEPSG(crs, epsg), OGRERR_NONE);
  char* text = nullptr;
  OSRExportToWkt(crs, &text);
  std::string wkt = text;
  CPLFree(text);
  OSRDestroySpatialReference(crs);
  return wkt;
}

// Five columns and three rows in UTM, 2 m x 3 m apart.
Grid utmGrid() {
  Grid grid = gridOf(5, 3);
  grid.spacing_x = 2.0;
  grid.spacing_y = 3.0;
  grid.origin_x = 500001.0;
  grid.origin_y = 5000001.5;
  grid.lateral_unit = {"m", 1000.0};
  grid.crs_wkt = systemOf(32633);
  return grid;
}
Version utmField() {
  return makeField(utmGrid(), std::vector<float>(15, 1.0F));
}

struct Mask {
  int width = 5, height = 3;
  std::vector<double> pixels = std::vector<double>(15, 0.0);  // first stored row first
  GeoTransform transform = geoTransformOf(utmGrid());
  int epsg = 32633;  // 0: none
  GDALDataType type = GDT_Byte;
  std::optional<double> no_data;
};

void write(const Mask& mask, const std::string& path) {
  GDALAllRegister();
  GDALDatasetH dataset =
      GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), mask.width, mask.height, 1, mask.type, nullptr);
  ASSERT_NE(dataset, nullptr);
  std::array<double, 6> gt = mask.transform;
  GDALSetGeoTransform(dataset, gt.data());
  if (mask.epsg != 0) GDALSetProjection(dataset, systemOf(mask.epsg).c_str());
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  if (mask.no_data) GDALSetRasterNoDataValue(band, *mask.no_data);
  std::vector<double> pixels = mask.pixels;
  ASSERT_EQ(GDALRasterIO(band, GF_Write, 0, 0, mask.width, mask.height, pixels.data(), mask.width,
                         mask.height, GDT_Float64, 0, 0),
            CE_None);
  GDALClose(dataset);
}

// The marks as text, highest row first.
std::string pictureOf(const Version& field) {
  std::string text;
  for (std::int32_t r = field.grid().height - 1; r >= 0; --r) {
    for (std::int32_t c = 0; c < field.grid().width; ++c) text += field.reader().markedAt(c, r) ? '#' : '.';
    text += '\n';
  }
  return text;
}

class MarksGeoTiff : public ::testing::Test {
 protected:
  [[nodiscard]] std::string read(const Mask& mask) {
    write(mask, path);
    const auto marked = importMarks(utmField(), path);
    return marked ? pictureOf(*marked) : marked.error().line();
  }
  TempFolder folder;
  std::string path = folder.file("m.tif");
};

TEST_F(MarksGeoTiff, HasThePositionAndTheSystemOfTheScan) {
  ASSERT_TRUE(exportMarks(makeField(utmGrid(), std::vector<float>(15, 1.0F),
                                    {0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  //
                                     1, 0, 0, 0, 0}),
                          path));
  GDALDatasetH dataset = GDALOpen(path.c_str(), GA_ReadOnly);
  ASSERT_NE(dataset, nullptr);
  std::array<double, 6> gt{};
  ASSERT_EQ(GDALGetGeoTransform(dataset, gt.data()), CE_None);
  EXPECT_EQ(gt, (std::array<double, 6>{500000.0, 2.0, 0.0, 5000009.0, 0.0, -3.0}));
  EXPECT_STREQ(OSRGetAuthorityCode(GDALGetSpatialRef(dataset), nullptr), "32633");
  std::uint8_t first = 0;
  ASSERT_EQ(GDALRasterIO(GDALGetRasterBand(dataset, 1), GF_Read, 0, 0, 1, 1, &first, 1, 1, GDT_Byte, 0, 0),
            CE_None);
  EXPECT_EQ(first, 255);
  GDALClose(dataset);
  const auto again = importMarks(utmField(), path);
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(pictureOf(*again), "#....\n.....\n.....\n");
}

TEST_F(MarksGeoTiff, MayHaveAnyIntegerType) {
  for (const GDALDataType type :
       {GDT_Byte, GDT_UInt16, GDT_Int16, GDT_UInt32, GDT_Int32, GDT_UInt64, GDT_Int64}) {
    Mask mask;
    mask.type = type;
    mask.pixels[1] = 1.0;
    mask.pixels[14] = type == GDT_Int16 || type == GDT_Int32 || type == GDT_Int64 ? -7.0 : 200.0;
    EXPECT_EQ(read(mask), ".#...\n.....\n....#\n") << GDALGetDataTypeName(type);
  }
  Mask mask;
  mask.type = GDT_Float32;
  EXPECT_NE(read(mask).find("marks are one band of integers"), std::string::npos);
}

TEST_F(MarksGeoTiff, NoDataIsNotMarked) {
  Mask mask;
  mask.pixels = {255, 1, 255, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 2};
  mask.no_data = 255.0;
  EXPECT_EQ(read(mask), ".#...\n.....\n....#\n");
  mask.type = GDT_Int16;
  for (double& pixel : mask.pixels) pixel = pixel == 255.0 ? -9999.0 : pixel;
  mask.no_data = -9999.0;
  EXPECT_EQ(read(mask), ".#...\n.....\n....#\n");
}

TEST_F(MarksGeoTiff, LiesByItsPositionWhicheverWayItsRowsAndColumnsGo) {
  Mask mask;
  mask.pixels[1] = 1.0;
  mask.transform = {500000.0, 2.0, 0.0, 5000000.0, 0.0, 3.0};  // the first row is the lowest
  EXPECT_EQ(read(mask), ".....\n.....\n.#...\n");
  mask.transform = {500010.0, -2.0, 0.0, 5000009.0, 0.0, -3.0};  // the first column is the last
  EXPECT_EQ(read(mask), "...#.\n.....\n.....\n");
}

TEST_F(MarksGeoTiff, OfALargerMapThePartOnTheScanCounts) {
  for (const bool top_down : {true, false})
    for (const bool right_to_left : {true, false}) {
      Mask mask;
      mask.width = 9;
      mask.height = 6;
      mask.pixels.assign(54, 0.0);
      // 3 columns to the left of the scan, 1 row below it, 2 above.
      mask.transform = {right_to_left ? 500012.0 : 499994.0,
                        right_to_left ? -2.0 : 2.0,
                        0.0,
                        top_down ? 5000015.0 : 4999997.0,
                        0.0,
                        top_down ? -3.0 : 3.0};
      const auto set = [&](int column, int row) {  // of the scan
        const int x = column + 3, y = row + 1;
        mask.pixels[static_cast<std::size_t>((top_down ? 5 - y : y) * 9 + (right_to_left ? 8 - x : x))] = 1.0;
      };
      set(0, 2);
      set(4, 0);
      set(5, 1);   // outside
      set(-1, 1);  // outside
      EXPECT_EQ(read(mask), "#....\n.....\n....#\n") << top_down << right_to_left;
    }
}

TEST_F(MarksGeoTiff, ThatDoesNotFitIsRefused) {
  Mask mask;
  mask.transform[0] += 2.0;
  EXPECT_NE(read(mask).find("cover 12 of the 5 x 3 samples"), std::string::npos) << read(mask);
  mask.transform[0] += 2000.0;
  EXPECT_NE(read(mask).find("lie outside the scan"), std::string::npos) << read(mask);
  mask.transform = geoTransformOf(utmGrid());
  mask.transform[3] += 0.75;
  EXPECT_NE(read(mask).find("0 and 0.25 pixels beside"), std::string::npos) << read(mask);
  mask.transform = geoTransformOf(utmGrid());
  mask.transform[1] = 2.01;
  EXPECT_NE(read(mask).find("the pixels of the marks are 2.01 x 3, those of the scan 2 x 3"),
            std::string::npos)
      << read(mask);
  mask.transform = geoTransformOf(utmGrid());
  mask.transform[2] = 0.1;
  EXPECT_NE(read(mask).find("rotated"), std::string::npos) << read(mask);
  mask.transform[2] = 0.0;
  mask.epsg = 32632;
  EXPECT_NE(read(mask).find("the marks are in WGS 84 / UTM zone 32N, the scan is in WGS 84 / UTM zone 33N"),
            std::string::npos)
      << read(mask);
}

TEST_F(MarksGeoTiff, OfARoundedPositionOrWithoutASystemFits) {
  Mask mask;
  mask.pixels[0] = 1.0;
  mask.epsg = 0;
  mask.transform[0] += 0.015;  // under a hundredth of 2 m
  EXPECT_EQ(read(mask), "#....\n.....\n.....\n");
  // Without a position the size alone decides.
  mask.transform = {0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  EXPECT_EQ(read(mask), "#....\n.....\n.....\n");
}

TEST_F(MarksGeoTiff, AScanOfIntegersIsNotTakenForMarks) {
  Grid grid = gridOf(30, 10);
  Mask mask;
  mask.width = 30;
  mask.height = 10;
  mask.type = GDT_UInt16;
  mask.transform = geoTransformOf(grid);
  mask.epsg = 0;
  mask.pixels.clear();
  for (int i = 0; i < 300; ++i) mask.pixels.push_back(i);
  write(mask, path);
  const auto marked = importMarks(makeField(grid, std::vector<float>(300, 0.0F)), path);
  ASSERT_FALSE(marked);
  EXPECT_NE(marked.error().line().find("is this the scan itself?"), std::string::npos);
}

}  // namespace
}  // namespace fettle::engine
