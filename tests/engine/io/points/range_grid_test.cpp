// PLY of range scanners: the raster that obj_info and the element range_grid say.

#include <array>
#include <bit>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

struct Point {
  double x, y, z;
};

// A range scan of columns x rows places; those that `hole` names were not measured.
std::string rangeScan(int columns, int rows, const std::function<Point(int, int)>& point,
                      const std::function<bool(int, int)>& hole) {
  std::string vertices, places;
  int count = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (hole(c, r)) {
        places += "0\n";
        continue;
      }
      const Point p = point(c, r);
      vertices += fmt::format("{} {} {} 0.5\n", static_cast<float>(p.x), static_cast<float>(p.y),
                              static_cast<float>(p.z));
      places += fmt::format("1 {}\n", count++);
    }
  return fmt::format(
             "ply\nformat ascii 1.0\nobj_info is_cyberware_data 1\nobj_info num_cols {}\nobj_info num_rows "
             "{}\n"
             "comment units mm\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
             "property float confidence\nelement range_grid {}\nproperty list uchar int vertex_indices\n"
             "end_header\n",
             columns, rows, count, columns * rows) +
         vertices + places;
}

bool someHole(int c, int r) {
  return c < 2 || r == 0 || (c * 7 + r * 3) % 4 == 1;  // two columns and a row hold nothing at all
}

TEST(RangeGrid, IsReadAsTheGridThatItIs) {
  const TempFolder folder;
  const auto height = [](int c, int r) { return static_cast<float>(c) * 0.37F + static_cast<float>(r * r); };
  // Rows and columns that rise, and that fall.
  for (const double turn_x : {1.0, -1.0})
    for (const double turn_y : {1.0, -1.0}) {
      SCOPED_TRACE(fmt::format("{} {}", turn_x, turn_y));
      writeBytes(
          folder.file("scan.ply"),
          rangeScan(
              24, 17,
              [&](int c, int r) {
                return Point{turn_x * c * 0.25, 5.0 + turn_y * r * 0.5, static_cast<double>(height(c, r))};
              },
              someHole));
      FETTLE_LOAD(scan, folder.file("scan.ply"));
      const Grid& grid = scan.field.grid();
      ASSERT_EQ(grid.width, 24);
      ASSERT_EQ(grid.height, 17);
      EXPECT_EQ(grid.spacing_x, 0.25);
      EXPECT_EQ(grid.spacing_y, 0.5);
      EXPECT_EQ(grid.origin_x, turn_x > 0.0 ? 0.0 : -23 * 0.25);
      EXPECT_EQ(grid.origin_y, turn_y > 0.0 ? 5.0 : 5.0 - 16 * 0.5);
      EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();
      for (int r = 0; r < 17; ++r)
        for (int c = 0; c < 24; ++c) {
          const float z = scan.field.reader().heightAt(turn_x > 0.0 ? c : 23 - c, turn_y > 0.0 ? r : 16 - r);
          if (someHole(c, r))
            ASSERT_TRUE(std::isnan(z)) << c << ", " << r;
          else
            ASSERT_EQ(z, height(c, r)) << c << ", " << r;
        }
    }
}

TEST(RangeGrid, OfACameraKeepsItsPixelsAndOneOffARasterItsPlaces) {
  const TempFolder folder;
  const auto none = [](int, int) { return false; };
  const auto depth = [](int c, int r) { return 500.0 + 3.0 * c - 2.0 * r + (c > 12 ? 150.0 : 0.0); };
  writeBytes(folder.file("camera.ply"), rangeScan(
                                            24, 17,
                                            [&](int c, int r) {
                                              const double z = depth(c, r);
                                              return Point{(c - 11.5) * z / 300.0, (8.0 - r) * z / 300.0, z};
                                            },
                                            none));
  FETTLE_LOAD(camera, folder.file("camera.ply"));
  ASSERT_EQ(camera.field.grid().width, 24);
  ASSERT_EQ(camera.field.grid().height, 17);
  EXPECT_TRUE(warned(camera.warnings, "range grid is that of a camera"));
  EXPECT_TRUE(warned(camera.warnings, "perspective"));
  for (int r = 0; r < 17; ++r)
    for (int c = 0; c < 24; ++c)
      ASSERT_EQ(stored(camera.field, r, c), static_cast<float>(depth(c, r)));  // row 0 is the highest here
  // The axis of the camera is at 0, 0.
  EXPECT_NEAR(camera.field.grid().origin_x, -11.5 * camera.field.grid().spacing_x, 1e-3);
  EXPECT_NEAR(camera.field.grid().origin_y, -8.0 * camera.field.grid().spacing_y, 1e-3);

  writeBytes(folder.file("off.ply"),
             rangeScan(
                 24, 17,
                 [&](int c, int r) {
                   return Point{c + 0.4 * std::sin(r), r + 0.3 * std::cos(c * 2.0), c * r * 0.25};
                 },
                 none));
  FETTLE_LOAD(off, folder.file("off.ply"));
  ASSERT_EQ(off.field.grid().samples(), 24 * 17);
  EXPECT_TRUE(warned(off.warnings, "off a raster"));
  EXPECT_EQ(off.field.reader().heightAt(5, 7), 8.75F);
  EXPECT_NEAR(off.field.grid().spacing_x, 1.0, 0.02);
  ImportOptions above;
  above.cell_size = 2.0;
  FETTLE_LOAD(gridded, folder.file("off.ply"), above);
  EXPECT_EQ(gridded.field.grid().spacing_x, 2.0);
}

TEST(RangeGrid, BinaryOnesSmallOnesAndWithoutSidesAreRead) {
  const TempFolder folder;
  std::string big =
      "ply\nformat binary_big_endian 1.0\nobj_info num_cols 2\nobj_info num_rows 2\nelement vertex "
      "3\nproperty float x\nproperty float y\nproperty float z\nelement range_grid 4\nproperty list uchar "
      "int vertex_indices\nend_header\n";
  const auto put = [&](auto value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    big.append(raw.rbegin(), raw.rend());
  };
  for (const auto& [x, y, z] : {Point{0, 0, 5}, {2, 0, 6}, {2, 3, 7}}) {
    put(static_cast<float>(x));
    put(static_cast<float>(y));
    put(static_cast<float>(z));
  }
  for (const int place : {0, 1, -1, 2}) {
    big += place < 0 ? '\0' : '\1';
    if (place >= 0) put(place);
  }
  writeBytes(folder.file("big.ply"), big);
  FETTLE_LOAD(small, folder.file("big.ply"));
  ASSERT_EQ(small.field.grid().samples(), 4);
  EXPECT_EQ(small.field.grid().spacing_x, 2.0);
  EXPECT_EQ(small.field.grid().spacing_y, 3.0);
  EXPECT_EQ(small.field.reader().heightAt(1, 0), 6.0F);
  EXPECT_TRUE(std::isnan(small.field.reader().heightAt(0, 1)));
  EXPECT_EQ(small.field.reader().heightAt(1, 1), 7.0F);
  // Without its sides a range grid says nothing, and the points are points.
  std::string bare = big;
  bare.replace(bare.find("num_cols"), 8, "nothing_");
  writeBytes(folder.file("bare.ply"), bare);
  FETTLE_LOAD(points, folder.file("bare.ply"));
  EXPECT_TRUE(points.gridding.has_value());
}

TEST(RangeGrid, DamagedOnesAreRefusedInOneLine) {
  const TempFolder folder;
  const std::string sound = rangeScan(
      6, 5,
      [](int c, int r) {
        return Point{c * 1.0, r * 1.0, c * 0.5};
      },
      [](int c, int) { return c == 3; });
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string bad = sound;
    ASSERT_NE(bad.find(from), std::string::npos) << from;
    bad.replace(bad.find(from), from.size(), to);
    writeBytes(folder.file("bad.ply"), bad);
    const auto scan = load(folder.file("bad.ply"));
    ASSERT_FALSE(scan) << to;
    EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    EXPECT_EQ(scan.error().line().find('\n'), std::string::npos);
  };
  refused("num_cols 6", "num_cols 7");
  refused("num_rows 5", "num_rows 18446744073709551615");
  refused("range_grid 30", "range_grid 31");
  refused("range_grid 30", "range_grid 3000000000000");
  refused("\n1 24\n", "\n1 25\n");
  refused("\n1 24\n", "\n1 -1\n");
  refused("\n1 24\n", "\n1 x\n");
  for (std::size_t bytes = sound.find("end_header"); bytes < sound.size() - 2; bytes += 7) {
    writeBytes(folder.file("bad.ply"), sound.substr(0, bytes));
    const auto scan = load(folder.file("bad.ply"));
    EXPECT_FALSE(scan) << bytes;
  }
}

}  // namespace
}  // namespace fettle::engine
