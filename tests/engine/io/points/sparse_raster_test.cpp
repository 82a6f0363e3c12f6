// Points that are samples of a raster with many holes: what Fettle writes says its raster and is read back on
// it, what others write is found from the differences of the coordinates, and what is no raster is not taken
// for one.

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// Three of a hundred samples are no holes; none lies near the border.
Version sparseField() {
  Grid grid = gridOf(300, 200);
  grid.spacing_x = 0.215326741;
  grid.spacing_y = 0.5;
  grid.origin_x = -106.564972;
  grid.origin_y = 5000000.25;
  grid.lateral_unit = {"um", 1e-3};
  grid.height_unit = {"nm", 1e-6};
  grid.height_per_count = 0.02;
  std::mt19937 random(97);
  std::vector<float> z(static_cast<std::size_t>(grid.samples()), kNan);
  for (std::size_t r = 9; r < 180; ++r)
    for (std::size_t c = 11; c < 280; ++c)
      if (random() % 100 < 3) z[r * 300 + c] = static_cast<float>(random() % 1000) * 0.1F;
  return makeField(grid, z);
}

// The lines of a text or the header of a PLY without its comments, as another program writes them.
std::string withoutComments(const std::string& bytes, const std::string& mark) {
  std::string rest;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size() - 1) + 1;
    if (bytes.compare(at, mark.size(), mark) != 0) rest += bytes.substr(at, end - at);
    at = end;
  }
  return rest;
}

TEST(SparseRaster, WhatFettleWritesComesBackOnItsOwnRasterWithItsUnits) {
  const TempFolder folder;
  const Version field = sparseField();
  for (const std::string name : {"sparse.xyz", "sparse.ply"}) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(save(field, folder.file(name)));
    FETTLE_LOAD(again, folder.file(name));
    EXPECT_EQ(again.field.grid(), field.grid());
    EXPECT_EQ(contentHash(again.field), contentHash(field));
    EXPECT_TRUE(again.gridding->lattice);
    EXPECT_TRUE(again.warnings.empty()) << again.warnings.front();
  }
}

TEST(SparseRaster, AMeshComesBackOnItsOwnRasterHoweverFewItsTriangles) {
  const TempFolder folder;
  Grid grid = gridOf(90, 70);
  grid.spacing_x = 0.215326741;
  grid.origin_y = 5000000.25;
  grid.height_unit = {"um", 1e-3};
  std::vector<float> z;
  for (std::size_t i = 0; i < 90 * 70; ++i) z.push_back(static_cast<float>(i % 90) * 0.5F);
  const Version plane = makeField(grid, z);
  ExportOptions options;
  options.max_error = 0.01;
  ASSERT_TRUE(save(plane, folder.file("plane.ply"), options));
  EXPECT_LT(readBytes(folder.file("plane.ply")).size(), 20000U) << "too many for showing anything";
  FETTLE_LOAD(again, folder.file("plane.ply"));
  EXPECT_EQ(again.field.grid(), grid);
  const auto heights = heightsOf(again.field);
  for (std::size_t i = 0; i < z.size(); ++i) ASSERT_NEAR(heights[i], z[i], 0.01) << i;
}

TEST(SparseRaster, OfAnotherProgramIsFoundFromTheDifferencesOfItsCoordinates) {
  const TempFolder folder;
  const Version field = sparseField();
  ASSERT_TRUE(save(field, folder.file("own.xyz")));
  ASSERT_TRUE(save(field, folder.file("own.ply")));
  writeBytes(folder.file("bare.xyz"), withoutComments(readBytes(folder.file("own.xyz")), "//"));
  std::string ply = readBytes(folder.file("own.ply"));
  const std::size_t body = ply.find("end_header\n") + 11;
  writeBytes(folder.file("bare.ply"), withoutComments(ply.substr(0, body), "comment") + ply.substr(body));
  for (const std::string name : {"bare.xyz", "bare.ply"}) {
    SCOPED_TRACE(name);
    FETTLE_LOAD(found, folder.file(name));
    EXPECT_TRUE(found.gridding->lattice);
    EXPECT_EQ(found.gridding->multiple_cells, 0);
    EXPECT_TRUE(warned(found.warnings, "97")) << "how much of the raster is empty is not said";
    EXPECT_TRUE(warned(found.warnings, "--cell-size"));
    const Grid& grid = found.field.grid();
    EXPECT_NEAR(grid.spacing_x, 0.215326741, 1e-12);
    EXPECT_NEAR(grid.spacing_y, 0.5, 1e-12);
    // The rows and columns that hold anything.
    EXPECT_EQ(grid.width, 269);
    EXPECT_EQ(grid.height, 171);
    for (std::int32_t r = 0; r < grid.height; ++r)
      for (std::int32_t c = 0; c < grid.width; ++c) {
        const float was = field.reader().heightAt(c + 11, r + 9), is = found.field.reader().heightAt(c, r);
        ASSERT_TRUE(std::isnan(was) ? std::isnan(is) : was == is) << c << ", " << r;
      }
  }
}

TEST(SparseRaster, TwoPatchesFarApartAreOneRaster) {
  const TempFolder folder;
  std::string text;
  for (const int corner : {0, 600})
    for (int r = 0; r < 40; ++r)
      for (int c = 0; c < 40; ++c)
        // Three digits: a step read off neighbours is up to 0.001 off, which counts for a column on the way.
        text += fmt::format("{:.3f} {:.3f} {}\n", (corner + c) * (1.0 / 3.0), (corner + r) * 0.7, c + r);
  writeBytes(folder.file("two.xyz"), text);
  FETTLE_LOAD(scan, folder.file("two.xyz"));
  EXPECT_TRUE(scan.gridding->lattice);
  ASSERT_EQ(scan.field.grid().width, 640);
  ASSERT_EQ(scan.field.grid().height, 640);
  EXPECT_EQ(scan.gridding->multiple_cells, 0);
  EXPECT_NEAR(scan.field.grid().spacing_x, 1.0 / 3.0, 1e-5);
  EXPECT_EQ(scan.field.reader().heightAt(605, 607), 12.0F);
}

TEST(SparseRaster, RoundedCoordinatesOfMeasuredPointsAreNone) {
  // As many points on as many positions as a raster with 97 % holes, at places of their own: thrown at
  // random, some share a position; kept apart, as thinned clouds are, none has a neighbour.
  const TempFolder folder;
  std::mt19937 random(5);
  std::string thrown, apart;
  std::set<std::pair<int, int>> near;
  int kept = 0;
  for (int i = 0; i < 40000 && (i < 3000 || kept < 3000); ++i) {
    const int x = static_cast<int>(random() % 400), y = static_cast<int>(random() % 250);
    const std::string line = fmt::format("{:.2f} {:.2f} {}\n", x * 0.01, y * 0.01, i % 9);
    if (i < 3000) thrown += line;
    bool alone = true;
    for (int dx = -2; dx <= 2 && alone; ++dx)
      for (int dy = -2; dy <= 2 && alone; ++dy) alone = !near.contains({x + dx, y + dy});
    if (!alone || kept == 3000) continue;
    near.insert({x, y});
    apart += line;
    ++kept;
  }
  for (const std::string& text : {thrown, apart}) {
    writeBytes(folder.file("cloud.xyz"), text);
    FETTLE_LOAD(scan, folder.file("cloud.xyz"));
    EXPECT_FALSE(scan.gridding->lattice);
    EXPECT_TRUE(warned(scan.warnings, "no raster"));
    EXPECT_GT(scan.field.grid().spacing_x, 0.03);
  }
}

TEST(SparseRaster, AStatedOneOnWhichThePointsDoNotLieIsWarnedOf) {
  const TempFolder folder;
  ASSERT_TRUE(save(sparseField(), folder.file("own.xyz")));
  const std::string own = readBytes(folder.file("own.xyz"));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = own;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    writeBytes(folder.file("changed.xyz"), text);
    return load(folder.file("changed.xyz"));
  };
  for (const auto& [from, to] : {std::pair{"spacing_y = 0.5", "spacing_y = 0.3"},
                                 {"origin_x = -106.564972", "origin_x = 106.564972"},
                                 {"rows = 200", "rows = 20"}}) {
    const auto scan = changed(from, to);
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_TRUE(warned(scan->warnings, "do not lie on the raster that the file states")) << to;
    EXPECT_EQ(scan->field.grid().width, 269);
    EXPECT_EQ(scan->field.grid().lateral_unit.name, "um");
  }
  // What cannot be a raster is none.
  for (const auto& [from, to] : {std::pair{"spacing_y = 0.5", "spacing_y = -1"},
                                 {"rows = 200", "rows = 0"},
                                 {"columns = 300", "columns = 99999999999999999999"},
                                 {"height_mm = ", "height_mm = nan"}}) {
    const auto scan = changed(from, to);
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_EQ(scan->field.grid().width, 269) << to;
  }
}

TEST(SparseRaster, AStatedOneOfNearlyNothingTakesNoMemoryForIt) {
  const TempFolder folder;
  ASSERT_TRUE(save(sparseField(), folder.file("own.xyz")));
  std::string text = readBytes(folder.file("own.xyz"));
  const std::size_t rows = text.find("rows = 200"), columns = text.find("columns = 300");
  text.replace(rows, 10, "rows = 262144");
  text.replace(columns, 13, "columns = 262144");
  writeBytes(folder.file("huge.xyz"), text);
  FETTLE_LOAD(scan, folder.file("huge.xyz"));
  EXPECT_EQ(scan.field.grid().width, 269);
  EXPECT_EQ(scan.field.grid().height, 171);
  EXPECT_EQ(scan.field.grid().spacing_x, 0.215326741);
  EXPECT_TRUE(warned(scan.warnings, "border"));
}

TEST(SparseRaster, TheUserWinsOverWhatTheFileStates) {
  const TempFolder folder;
  ASSERT_TRUE(save(sparseField(), folder.file("own.xyz")));
  ImportOptions options;
  options.cell_size = 5.0;
  options.unit = LengthUnit{"mm", 1.0};
  FETTLE_LOAD(scan, folder.file("own.xyz"), options);
  EXPECT_EQ(scan.field.grid().spacing_x, 5.0);
  EXPECT_EQ(scan.field.grid().lateral_unit.name, "mm");
  EXPECT_EQ(scan.field.grid().height_unit.name, "mm");
  EXPECT_TRUE(warned(scan.warnings, "the file states spacing 0.215326741 x 0.5, read as 5 x 5 as requested"));
  EXPECT_TRUE(warned(scan.warnings, "the file states um, read as mm as requested"));
}

}  // namespace
}  // namespace fettle::engine
