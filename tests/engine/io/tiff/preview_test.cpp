// The coarse picture of a large TIFF: the samples it says it has, where it says they are.

#include <cmath>
#include <filesystem>
#include <vector>

#include <cpl_string.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// Exact in every type used here, and another number for each of the neighbours looked at.
double numberAt(int column, int row) {
  return (column * 7 + row * 131) % 30011 + 1;
}
constexpr double kNoData = 31000.0;

void makeTiff(const std::string& path, GDALDataType type, int width, int height,
              std::vector<const char*> options, bool holes, double row_step = -0.5) {
  GDALRegister_GTiff();
  options.push_back(nullptr);
  GDALDatasetH dataset = GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), width, height, 1, type,
                                    const_cast<char**>(options.data()));
  ASSERT_NE(dataset, nullptr);
  std::array<double, 6> place{100.0, 0.25, 0.0, 50.0, 0.0, row_step};
  GDALSetGeoTransform(dataset, place.data());
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  if (holes) GDALSetRasterNoDataValue(band, kNoData);
  std::vector<double> z;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) z.push_back(holes && (c + r) % 3 == 0 ? kNoData : numberAt(c, r));
  ASSERT_EQ(GDALRasterIO(band, GF_Write, 0, 0, width, height, z.data(), width, height, GDT_Float64, 0, 0),
            CE_None);
  GDALClose(dataset);
}

// Row 0 is the lowest.
float sampleAt(const Version& field, int column, int row) {
  return static_cast<float>(field.reader().heightAt(column, row));
}

// Every sample of the picture is bit-identical to the sample of the whole at its position.
void expectPartOf(const Version& whole, const Preview& coarse) {
  const Grid& w = whole.grid();
  const Grid& c = coarse.field.grid();
  ASSERT_EQ(coarse.width, w.width);
  ASSERT_EQ(coarse.height, w.height);
  ASSERT_EQ(c.width, (w.width - 1) / coarse.step_columns + 1);
  ASSERT_EQ(c.height, (w.height - 1) / coarse.step_rows + 1);
  EXPECT_DOUBLE_EQ(c.spacing_x, w.spacing_x * coarse.step_columns);
  EXPECT_DOUBLE_EQ(c.spacing_y, w.spacing_y * coarse.step_rows);
  const auto left = std::lround((c.origin_x - w.origin_x) / w.spacing_x);
  const auto below = std::lround((c.origin_y - w.origin_y) / w.spacing_y);
  for (int r = 0; r < c.height; ++r)
    for (int k = 0; k < c.width; ++k) {
      const float a = sampleAt(coarse.field, k, r);
      const float b = sampleAt(whole, static_cast<int>(left) + k * coarse.step_columns,
                               static_cast<int>(below) + r * coarse.step_rows);
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << r << ' ' << k << ": " << a << ", " << b;
    }
}

TEST(Preview, HoldsEveryNthSampleOfEveryKindOfFile) {
  const TempFolder folder;
  const std::string path = folder.file("t.tif");
  for (const GDALDataType type : {GDT_Float32, GDT_Int16, GDT_Float64})
    for (const std::vector<const char*>& options :
         {std::vector<const char*>{},
          {"BLOCKYSIZE=1"},
          {"BLOCKYSIZE=7"},
          {"ENDIANNESS=BIG"},
          {"TILED=YES", "BLOCKXSIZE=32", "BLOCKYSIZE=48"},
          {"COMPRESS=DEFLATE", "BLOCKYSIZE=16"},
          {"COMPRESS=DEFLATE", "PREDICTOR=2", "TILED=YES", "BLOCKXSIZE=32", "BLOCKYSIZE=32"},
          {"COMPRESS=LZW", "BLOCKYSIZE=5"},
          {"COMPRESS=ZSTD", "BLOCKYSIZE=333"}})
      for (const bool holes : {false, true}) {
        makeTiff(path, type, 517, 333, options, holes);
        FETTLE_LOAD(scan, path);
        JobControl job;
        const auto coarse = importPreview(path, {}, 2000, job);
        ASSERT_TRUE(coarse) << coarse.error().line();
        ASSERT_TRUE(*coarse) << (options.empty() ? "" : options.front());
        EXPECT_LE((*coarse)->field.grid().samples(), 2000);
        EXPECT_FALSE((*coarse)->overview);
        expectPartOf(scan.field, **coarse);
      }
  // Predictors for floats alone, one of them with the bytes the other way round.
  for (const GDALDataType type : {GDT_Float32, GDT_Float64})
    for (const char* order : {"ENDIANNESS=LITTLE", "ENDIANNESS=BIG"}) {
      makeTiff(path, type, 517, 333, {"COMPRESS=DEFLATE", "PREDICTOR=3", "BLOCKYSIZE=16", order}, true);
      FETTLE_LOAD(scan, path);
      JobControl job;
      const auto coarse = importPreview(path, {}, 2000, job);
      ASSERT_TRUE(coarse && *coarse);
      expectPartOf(scan.field, **coarse);
    }
}

TEST(Preview, RowsThatRunUpwardsAndFieldsOfOneRowOrColumnAreWhereTheyBelong) {
  const TempFolder folder;
  const std::string path = folder.file("t.tif");
  JobControl job;
  for (const auto& [width, height, step] :
       {std::tuple{401, 203, 0.5}, {9001, 1, -0.5}, {1, 9001, -0.5}, {9001, 2, 0.5}}) {
    makeTiff(path, GDT_Float32, width, height, {}, false, step);
    FETTLE_LOAD(scan, path);
    const auto coarse = importPreview(path, {}, 1000, job);
    ASSERT_TRUE(coarse && *coarse) << width << ' ' << height;
    expectPartOf(scan.field, **coarse);
  }
}

TEST(Preview, PackedBlocksTooManyToUnpackAreLookedAtInFewerRows) {
  const TempFolder folder;
  const std::string path = folder.file("t.tif");
  // 26 million samples, the rows that are not looked at all of one number.
  GDALRegister_GTiff();
  const std::array<const char*, 5> options{"COMPRESS=DEFLATE", "ZLEVEL=1", "TILED=YES", "PREDICTOR=3",
                                           nullptr};
  GDALDatasetH dataset = GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), 5120, 5121, 1, GDT_Float32,
                                    const_cast<char**>(options.data()));
  ASSERT_NE(dataset, nullptr);
  GDALFillRaster(GDALGetRasterBand(dataset, 1), 2.5, 0.0);
  std::vector<float> row(5120);
  for (int r = 0; r < 5121; r += 32) {
    for (std::size_t c = 0; c < row.size(); ++c)
      row[c] = static_cast<float>(numberAt(static_cast<int>(c), r));
    ASSERT_EQ(GDALRasterIO(GDALGetRasterBand(dataset, 1), GF_Write, 0, r, 5120, 1, row.data(), 5120, 1,
                           GDT_Float32, 0, 0),
              CE_None);
  }
  GDALClose(dataset);
  FETTLE_LOAD(scan, path);
  JobControl job;
  const auto coarse = importPreview(path, {}, 1 << 20, job);
  ASSERT_TRUE(coarse && *coarse);
  EXPECT_EQ((*coarse)->step_rows, 32);  // all but the last 31 rows of each block of 256
  EXPECT_EQ((*coarse)->step_columns, 6);
  expectPartOf(scan.field, **coarse);
}

TEST(Preview, AnOverviewIsTakenAsTheFileHasIt) {
  const TempFolder folder;
  const std::string plain = folder.file("t.tif"), path = folder.file("cloud.tif");
  makeTiff(plain, GDT_Float32, 1100, 1300, {}, true);
  FETTLE_LOAD(scan, plain);
  JobControl job;
  ExportOptions options;
  options.cloud_optimised = true;
  ASSERT_TRUE(exportField(scan.field, path, options, job));
  const auto coarse = importPreview(path, {}, 250000, job);
  ASSERT_TRUE(coarse && *coarse);
  EXPECT_TRUE((*coarse)->overview);
  const Grid& grid = (*coarse)->field.grid();
  EXPECT_LE(grid.samples(), 250000);
  EXPECT_NEAR(grid.width * grid.spacing_x, 1100 * 0.25, 1e-9);
  EXPECT_NEAR(grid.height * grid.spacing_y, 1300 * 0.5, 1e-9);
  // Means lie between the lowest and the highest.
  const HeightBounds some = (*coarse)->field.reader().bounds(), all = scan.field.reader().bounds();
  EXPECT_GE(some.min, all.min);
  EXPECT_LE(some.max, all.max);
}

TEST(Preview, ThereIsNoneOfSmallFieldsOtherFormatsAndFieldsWithoutHeights) {
  const TempFolder folder;
  const std::string path = folder.file("t.tif");
  JobControl job;
  makeTiff(path, GDT_Float32, 100, 100, {}, false);
  auto coarse = importPreview(path, {}, 2500, job);
  ASSERT_TRUE(coarse);
  EXPECT_FALSE(*coarse) << "as fast read whole";
  ImportOptions options;
  options.depth_camera = DepthCamera{100.0, 100.0, 50.0, 50.0};
  coarse = importPreview(path, options, 100, job);
  ASSERT_TRUE(coarse);
  EXPECT_FALSE(*coarse) << "a depth image";
  FETTLE_LOAD(scan, path);
  ASSERT_TRUE(exportField(scan.field, folder.file("t.asc"), {}, job));
  coarse = importPreview(folder.file("t.asc"), {}, 100, job);
  ASSERT_TRUE(coarse);
  EXPECT_FALSE(*coarse) << "text";
}

TEST(Preview, WhatTheUserSaysOfTheFileHolds) {
  const TempFolder folder;
  const std::string path = folder.file("t.tif");
  makeTiff(path, GDT_Int16, 300, 200, {}, false);
  ImportOptions options;
  options.no_data = numberAt(0, 0);
  options.z_scale = 0.25;
  options.spacing = std::pair{2.0, 3.0};
  JobControl job;
  const auto whole = importField(path, options, job);
  const auto coarse = importPreview(path, options, 1000, job);
  ASSERT_TRUE(whole && coarse && *coarse);
  EXPECT_TRUE(std::isnan(sampleAt((*coarse)->field, 0, (*coarse)->field.grid().height - 1)));
  expectPartOf(whole->field, **coarse);
}

TEST(Preview, CutFilesAndCancelledJobsGiveNoPicture) {
  const TempFolder folder;
  const std::string path = folder.file("t.tif");
  for (const std::vector<const char*>& options :
       {std::vector<const char*>{}, {"COMPRESS=DEFLATE", "BLOCKYSIZE=16"}}) {
    makeTiff(path, GDT_Float32, 600, 600, options, false);
    JobControl stopped;
    stopped.cancel();
    const auto none = importPreview(path, {}, 1000, stopped);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().kind, ErrorKind::kCancelled);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    JobControl job;
    const auto cut = importPreview(path, {}, 1000, job);
    ASSERT_FALSE(cut);
    EXPECT_EQ(cut.error().kind, ErrorKind::kInput);
  }
  JobControl job;
  EXPECT_FALSE(importPreview(folder.file("none.tif"), {}, 1000, job));
}

}  // namespace
}  // namespace fettle::engine
