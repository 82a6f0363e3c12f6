// What Fettle writes, opened by other programs: GDAL (and QGIS, which asks it) always, the others where they
// are installed, else the test names those that are not. The table of docs/formats.md says who reads which
// TIFF; it is read here, so that it says what is so.

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gdal.h>
#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/markdown_table.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

constexpr std::int32_t kWidth = 600, kHeight = 500;  // more than one tile, the last ones cut

Version scan(bool holes) {
  Grid grid = gridOf(kWidth, kHeight);
  grid.spacing_x = 0.25;
  grid.spacing_y = 0.5;
  grid.origin_x = 500000.5;
  grid.origin_y = -3.5;
  grid.height_unit = {"um", 1e-3};
  std::mt19937 random(4);
  std::vector<float> z;
  for (std::int32_t i = 0; i < kWidth * kHeight; ++i)
    z.push_back(static_cast<float>(i % kWidth + i / kWidth) * 0.01F +
                static_cast<float>(random() % 1000) * 1e-5F);
  if (holes)
    for (std::size_t i = 2000; i < z.size(); ++i)
      if (random() % 4 == 0) z[i] = kNan;
  return makeField(grid, z);
}

bool succeeds(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

bool installed(const std::string& program) {
  return succeeds("command -v " + program);
}

// Heights row by row from the top as another program read them; empty if it could not.
using Heights = std::vector<double>;

Heights byGdal(const std::string& path, const std::string&) {
  GDALAllRegister();
  GDALDatasetH dataset = GDALOpen(path.c_str(), GA_ReadOnly);
  if (dataset == nullptr) return {};
  Heights heights(static_cast<std::size_t>(GDALGetRasterXSize(dataset)) *
                  static_cast<std::size_t>(GDALGetRasterYSize(dataset)));
  const int width = GDALGetRasterXSize(dataset), height = GDALGetRasterYSize(dataset);
  if (GDALRasterIO(GDALGetRasterBand(dataset, 1), GF_Read, 0, 0, width, height, heights.data(), width, height,
                   GDT_Float64, 0, 0) != CE_None)
    heights.clear();
  GDALClose(dataset);
  return heights;
}

// A file of doubles alone.
Heights doublesIn(const std::string& path) {
  const std::string bytes = readBytes(path);
  Heights heights(bytes.size() / sizeof(double));
  std::memcpy(heights.data(), bytes.data(), heights.size() * sizeof(double));
  return heights;
}

Heights byPython(const std::string& modules, const std::string& read, const std::string& path,
                 const std::string& folder) {
  const std::string script = folder + "/read.py", out = folder + "/read.bin";
  std::filesystem::remove(out);
  std::ofstream(script) << "import sys, numpy, " << modules << "\nread = " << read
                        << "\nnumpy.asarray(read(sys.argv[1])).astype('<f8').tofile(sys.argv[2])\n";
  if (!succeeds(fmt::format("/usr/bin/python3 '{}' '{}' '{}'", script, path, out))) return {};
  return doublesIn(out);
}

Heights byPillow(const std::string& path, const std::string& folder) {
  return byPython("PIL.Image", "PIL.Image.open", path, folder);
}

Heights byTifffile(const std::string& path, const std::string& folder) {
  return byPython("tifffile", "tifffile.imread", path, folder);
}

// Gwyddion's own format: the item "data" of the field is an array of doubles, 'D' and their number before it.
Heights byGwyddion(const std::string& path, const std::string& folder) {
  const std::string out = folder + "/read.gwy";
  std::filesystem::remove(out);
  if (!succeeds(fmt::format("xvfb-run -a gwyddion --convert-to-gwy='{}' '{}'", out, path))) return {};
  const std::string bytes = readBytes(out);
  constexpr std::string_view kItem("data\0D", 6);
  const std::size_t at = bytes.find(kItem);
  if (at == std::string::npos || bytes.size() < at + 10) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + at + 6, 4);
  Heights heights(count);
  if (bytes.size() < at + 10 + count * sizeof(double)) return {};
  std::memcpy(heights.data(), bytes.data() + at + 10, count * sizeof(double));
  return heights;
}

struct Program {
  std::function<bool()> there;
  Heights (*read)(const std::string& path, const std::string& folder);
};

const std::map<std::string, Program>& programs() {
  static const std::map<std::string, Program> all{
      {"GDAL 3.6, QGIS", {[] { return true; }, byGdal}},
      {"Gwyddion 2.62", {[] { return installed("gwyddion") && installed("xvfb-run"); }, byGwyddion}},
      {"Pillow 9.4", {[] { return succeeds("/usr/bin/python3 -c 'import numpy, PIL.Image'"); }, byPillow}},
      // With the module imagecodecs, which Debian has not, it reads all of them.
      {"tifffile 2023.2",
       {[] {
          return succeeds("/usr/bin/python3 -c 'import numpy, tifffile'") &&
                 !succeeds("/usr/bin/python3 -c 'import imagecodecs'");
        },
        byTifffile}}};
  return all;
}

struct Row {
  std::string program;
  std::array<std::string, 4> read;  // yes, no, by TiffCompression
};

std::vector<Row> tableOfReaders() {
  std::vector<Row> rows;
  for (const auto& cells :
       tests::markdownTable("docs/formats.md", "| read by | `none` | `lzw` | `deflate` | `zstd` |"))
    rows.push_back({cells[0], {cells[1], cells[2], cells[3], cells[4]}});
  return rows;
}

bool sameHeights(const Heights& read, const std::vector<float>& wrote) {
  if (read.size() != wrote.size()) return false;
  for (std::size_t i = 0; i < read.size(); ++i)
    if (static_cast<float>(read[i]) != wrote[i]) return false;
  return true;
}

TEST(OtherPrograms, ReadTheTiffsThatTheTableSaysAndTheDefaultIsReadByAll) {
  const TempFolder folder;
  const Version field = scan(false);
  std::vector<float> wrote;  // from the top
  for (std::int32_t r = kHeight - 1; r >= 0; --r) {
    std::vector<float> row(kWidth);
    field.reader().readHeights(0, r, kWidth, 1, row.data(), kWidth);
    wrote.insert(wrote.end(), row.begin(), row.end());
  }
  constexpr std::array<const char*, 4> kNames{"none", "lzw", "deflate", "zstd"};
  std::array<std::string, 4> paths;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    ExportOptions options;
    options.tiff_compression = tiffCompressionFromName(kNames[i]);
    paths[i] = folder.file(std::string(kNames[i]) + ".tif");
    ASSERT_TRUE(save(field, paths[i], options));
  }
  ASSERT_TRUE(save(field, folder.file("default.tif")));
  EXPECT_EQ(readBytes(folder.file("default.tif")), readBytes(paths[0]));

  const std::vector<Row> rows = tableOfReaders();
  EXPECT_EQ(rows.size(), programs().size()) << "the table in docs/formats.md was not found or has other rows";
  std::string not_tried;
  for (const Row& row : rows) {
    SCOPED_TRACE(row.program);
    EXPECT_EQ(row.read[0], "yes") << "the default is one that every program reads";
    const auto program = programs().find(row.program);
    ASSERT_NE(program, programs().end()) << "this test cannot run that program";
    if (!program->second.there()) {
      not_tried += (not_tried.empty() ? "" : ", ") + row.program;
      continue;
    }
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      ASSERT_TRUE(row.read[i] == "yes" || row.read[i] == "no") << row.read[i];
      EXPECT_EQ(sameHeights(program->second.read(paths[i], folder.path().string()), wrote),
                row.read[i] == "yes")
          << kNames[i];
    }
  }
  if (!not_tried.empty()) GTEST_SKIP() << "not installed, so not tried: " << not_tried;
}

TEST(OtherPrograms, GdalReadsAnXyzInItsPlaceWithItsHoles) {
  const TempFolder folder;
  const Version field = scan(true);
  const std::string path = folder.file("scan.xyz");
  ASSERT_TRUE(save(field, path));
  const std::string bytes = readBytes(path);
  EXPECT_TRUE(bytes.starts_with("//X Y Z\n")) << "CloudCompare takes the names of columns from there";
  // GDAL recognises an XYZ file by its first 1024 bytes, points among them.
  ASSERT_LT(bytes.find("\n5"), 800U);
  GDALAllRegister();
  GDALDatasetH dataset = GDALOpen(path.c_str(), GA_ReadOnly);
  ASSERT_NE(dataset, nullptr);
  EXPECT_STREQ(GDALGetDriverShortName(GDALGetDatasetDriver(dataset)), "XYZ");
  ASSERT_EQ(GDALGetRasterXSize(dataset), kWidth);
  ASSERT_EQ(GDALGetRasterYSize(dataset), kHeight);
  std::array<double, 6> gt{};
  ASSERT_EQ(GDALGetGeoTransform(dataset, gt.data()), CE_None);
  // Rows run upwards, as in the file; corners of pixels.
  EXPECT_NEAR(gt[0], 500000.5 - 0.125, 1e-6);
  EXPECT_NEAR(gt[1], 0.25, 1e-9);
  EXPECT_NEAR(gt[3], -3.5 - 0.25, 1e-6);
  EXPECT_NEAR(gt[5], 0.5, 1e-9);
  int declared = 0;
  const double hole = GDALGetRasterNoDataValue(GDALGetRasterBand(dataset, 1), &declared);
  GDALClose(dataset);
  EXPECT_EQ(declared, 1);
  const Heights read = byGdal(path, {});
  const std::vector<float> wrote = heightsOf(field);
  ASSERT_EQ(read.size(), wrote.size());
  for (std::size_t i = 0; i < wrote.size(); ++i) {
    if (std::isnan(wrote[i]))
      ASSERT_EQ(read[i], hole) << i;
    else
      ASSERT_EQ(static_cast<float>(read[i]), wrote[i]) << i;
  }
}

TEST(OtherPrograms, CloudCompareReadsEveryPointOfAnXyzAndAPly) {
  if (!installed("CloudCompare") || !installed("xvfb-run")) GTEST_SKIP() << "CloudCompare is not installed";
  const TempFolder folder;
  Grid grid = gridOf(7, 5);
  grid.origin_x = 500.0;
  const Version field = makeField(grid, [] {
    std::vector<float> z;
    for (int i = 0; i < 35; ++i) z.push_back(i == 12 ? kNan : 1000.0F + static_cast<float>(i));
    return z;
  }());
  for (const std::string name : {"points.xyz", "points.ply"}) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(save(field, folder.file(name)));
    const std::string out = folder.file("out.asc");
    std::filesystem::remove(out);
    ASSERT_TRUE(
        succeeds(fmt::format("xvfb-run -a CloudCompare -SILENT -AUTO_SAVE OFF -C_EXPORT_FMT ASC -PREC 6 -O "
                             "'{}' -SAVE_CLOUDS FILE '{}'",
                             folder.file(name), out)));
    std::istringstream lines(readBytes(out));
    int points = 0;
    for (double x = 0.0, y = 0.0, z = 0.0; lines >> x >> y >> z; ++points) {
      std::string rest;
      std::getline(lines, rest);
      EXPECT_EQ(field.reader().heightAt(static_cast<std::int32_t>(x - 500.0), static_cast<std::int32_t>(y)),
                static_cast<float>(z));
    }
    EXPECT_EQ(points, 34);
  }
}

}  // namespace
}  // namespace fettle::engine
