// Meshes in and out: whole, decimated to a stated error, and what other programs write.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/io/mesh/stl_file.h"
#include "engine/io/mesh/surface_mesh.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

Version hills(int width, int height, float noise, double holes) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> off(-noise, noise);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<float> z;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      z.push_back(share(random) < holes ? kNan
                                        : std::sin(static_cast<float>(c) * 0.02F) * 5.0F +
                                              std::cos(static_cast<float>(r) * 0.03F) * 3.0F + off(random));
  Grid grid = gridOf(width, height);
  grid.spacing_x = 0.25;
  grid.spacing_y = 0.5;
  grid.origin_x = 5000000.125;
  grid.origin_y = -3.5;
  return makeField(grid, z);
}

SurfaceMesh meshOf(const Version& field, std::optional<double> max_error) {
  JobControl job;
  auto mesh = SurfaceMesh::create(field, max_error, job);
  EXPECT_TRUE(mesh);
  return *std::move(mesh);
}

// Twice the area of a mesh seen from above [cells], and how often each side of a triangle is taken.
struct Measured {
  std::int64_t area = 0, triangles = 0;
  bool all_up = true;
  std::map<std::pair<std::uint64_t, std::uint64_t>, int> sides;
};
Measured measure(const SurfaceMesh& mesh, std::int64_t width) {
  Measured all;
  mesh.forEach([&](const SurfaceMesh::Triangle& t) {
    const auto x = [&](int k) { return static_cast<std::int64_t>(t[k]) % width; };
    const auto y = [&](int k) { return static_cast<std::int64_t>(t[k]) / width; };
    const std::int64_t area = (x(1) - x(0)) * (y(2) - y(0)) - (x(2) - x(0)) * (y(1) - y(0));
    all.all_up = all.all_up && area > 0;
    all.area += area;
    ++all.triangles;
    for (int k = 0; k < 3; ++k) ++all.sides[std::minmax(t[k], t[(k + 1) % 3])];
  });
  return all;
}

TEST(SurfaceMesh, CoversTheFieldWithoutCracksWhateverItsSides) {
  for (const auto& [w, h] :
       {std::pair{2, 2}, {3, 300}, {257, 257}, {256, 256}, {300, 513}, {600, 2}, {65, 129}})
    for (const double error : {-1.0, 0.0, 0.01, 0.5, 1e9}) {
      const Version field = hills(w, h, 0.02F, 0.0);
      const Measured m = measure(meshOf(field, error < 0 ? std::nullopt : std::optional(error)), w);
      EXPECT_TRUE(m.all_up) << w << " " << h << " " << error;
      EXPECT_EQ(m.area, 2 * std::int64_t{w - 1} * (h - 1)) << w << " " << h << " " << error;
      // A side is shared by two triangles or lies on the field's border: anything else is a crack.
      for (const auto& [side, times] : m.sides) {
        if (times == 2) continue;
        ASSERT_EQ(times, 1);
        const auto on = [&](auto coordinate, std::int64_t at) {
          return coordinate(side.first) == at && coordinate(side.second) == at;
        };
        const auto x = [&](std::uint64_t i) { return static_cast<std::int64_t>(i) % w; };
        const auto y = [&](std::uint64_t i) { return static_cast<std::int64_t>(i) / w; };
        ASSERT_TRUE(on(x, 0) || on(x, w - 1) || on(y, 0) || on(y, h - 1)) << w << " " << h << " " << error;
      }
    }
}

TEST(SurfaceMesh, NoSampleIsOffByMoreThanIsStated) {
  for (const double holes : {0.0, 0.002})
    for (const double error : {0.05, 0.3}) {
      const Version field = hills(400, 300, 0.02F, holes);
      const SurfaceMesh mesh = meshOf(field, error);
      EXPECT_LE(mesh.error(), error);
      EXPECT_GT(mesh.error(), 0.0);
      std::int64_t triangles = 0;
      double worst = 0.0;
      mesh.forEach([&](const SurfaceMesh::Triangle& t) {
        ++triangles;
        std::array<double, 3> x{}, y{}, z{};
        for (std::size_t k = 0; k < 3; ++k) {
          x[k] = static_cast<double>(t[k] % 400);
          y[k] = static_cast<double>(t[k] / 400);
          z[k] = static_cast<double>(mesh.height(t[k]));
          ASSERT_FALSE(std::isnan(z[k]));
        }
        const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        for (double py = *std::ranges::min_element(y); py <= *std::ranges::max_element(y); ++py)
          for (double px = *std::ranges::min_element(x); px <= *std::ranges::max_element(x); ++px) {
            const double b = ((px - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (py - y[0])) / area;
            const double c = ((x[1] - x[0]) * (py - y[0]) - (px - x[0]) * (y[1] - y[0])) / area;
            if (b < 0.0 || c < 0.0 || b + c > 1.0) continue;
            const double plane = z[0] + b * (z[1] - z[0]) + c * (z[2] - z[0]);
            worst = std::max(worst, std::abs(plane - static_cast<double>(field.reader().heightAt(
                                                         static_cast<int>(px), static_cast<int>(py)))));
          }
      });
      EXPECT_LE(worst, mesh.error() + 1e-9);
      if (holes == 0.0) {
        EXPECT_LT(triangles, 2 * 399 * 299 / 4);
      }
    }
}

TEST(Mesh, AWholeMeshBringsEverySampleBack) {
  const TempFolder folder;
  const Version field = hills(90, 70, 0.5F, 0.0);
  ExportOptions mesh;
  mesh.mesh = true;
  const auto ply = save(field, folder.file("a.ply"), mesh);
  ASSERT_TRUE(ply) << ply.error().line();
  FETTLE_LOAD(from_ply, folder.file("a.ply"));
  EXPECT_EQ(contentHash(from_ply.field), contentHash(field));
  EXPECT_EQ(from_ply.field.grid().spacing_x, 0.25);
  EXPECT_EQ(from_ply.field.grid().spacing_y, 0.5);
  EXPECT_EQ(from_ply.field.grid().origin_x, 5000000.125);
  EXPECT_TRUE(warned(from_ply.warnings, "sampled from above"));

  const auto stl = save(field, folder.file("a.stl"));
  ASSERT_TRUE(stl) << stl.error().line();
  EXPECT_TRUE(warned(stl->warnings, "are relative to the field's corner"));
  FETTLE_LOAD(from_stl, folder.file("a.stl"));
  EXPECT_EQ(from_stl.format, "STL");
  EXPECT_EQ(contentHash(from_stl.field), contentHash(field));
  EXPECT_EQ(from_stl.field.grid().spacing_x, 0.25);
  EXPECT_EQ(from_stl.field.grid().origin_x, field.grid().origin_x);
  EXPECT_EQ(from_stl.field.grid().origin_y, field.grid().origin_y);
  EXPECT_EQ(from_stl.field.grid().lateral_unit, field.grid().lateral_unit);
  EXPECT_EQ(readBytes(folder.file("a.stl")).size(), 84U + 50U * 2 * 89 * 69);
}

TEST(Mesh, AnStlIsWrittenInTheUnitThatIsChosen) {
  const TempFolder folder;
  const Version in_mm = hills(40, 30, 0.5F, 0.0);
  Grid grid = in_mm.grid();
  grid.lateral_unit = grid.height_unit = {"um", 1e-3};
  const Version field = in_mm.withGrid(grid);
  ExportOptions options;
  ASSERT_TRUE(save(field, folder.file("own.stl")));
  options.mesh_unit = grid.lateral_unit;
  ASSERT_TRUE(save(field, folder.file("um.stl"), options));
  EXPECT_EQ(readBytes(folder.file("um.stl")), readBytes(folder.file("own.stl")))
      << "in equal units every bit";

  options.mesh_unit = LengthUnit();
  const auto written = save(field, folder.file("mm.stl"), options);
  ASSERT_TRUE(written) << written.error().line();
  EXPECT_TRUE(warned(written->warnings, "all lengths are in mm"));
  EXPECT_TRUE(warned(written->warnings, "lengths in um were converted to mm"));
  EXPECT_TRUE(warned(written->warnings, "corner at 5000.0001"));
  const std::string own = readBytes(folder.file("own.stl")), mm = readBytes(folder.file("mm.stl"));
  const StlHeader header = stlHeaderOf(mm);
  EXPECT_EQ(header.unit, LengthUnit());
  EXPECT_DOUBLE_EQ(header.zero.x, 5000.000125);
  EXPECT_DOUBLE_EQ(header.zero.y, -0.0035);
  ASSERT_EQ(mm.size(), own.size());
  // Corners, behind the normal of each triangle: within 6e-8 of what they are in um.
  constexpr std::size_t kHead = 84, kTriangle = 50, kNormal = 12, kCorners = 36;
  for (std::size_t t = kHead; t < mm.size(); t += kTriangle)
    for (std::size_t at = t + kNormal; at < t + kNormal + kCorners; at += sizeof(float)) {
      float a = 0.0F, b = 0.0F;
      std::memcpy(&a, own.data() + at, sizeof(a));
      std::memcpy(&b, mm.data() + at, sizeof(b));
      const double exact = static_cast<double>(a) * 1e-3;
      // x and y in um are multiples of 0.25 and no larger than 15, which a float holds as they are.
      ASSERT_LE(std::abs(static_cast<double>(b) - exact), 6e-8 * std::abs(exact)) << at;
    }
  FETTLE_LOAD(again, folder.file("mm.stl"));
  EXPECT_EQ(again.field.grid().lateral_unit, LengthUnit());
  EXPECT_NEAR(again.field.grid().spacingXMm(), 0.25e-3, 1e-10);
  EXPECT_NEAR(again.field.grid().origin_x, 5000.000125, 1e-9);

  EXPECT_FALSE(save(field, folder.file("a.ply"), options));
  EXPECT_FALSE(save(field, folder.file("a.tif"), options));
  options.mesh_unit->mm = 0.0;
  EXPECT_FALSE(save(field, folder.file("b.stl"), options));
}

TEST(Mesh, CornersRoundedToFloatsAreStillTheirSamples) {
  // 0.05 is no float: at 40 mm a corner is off by 2e-6 mm, 4e-5 of a step. Heights of all magnitudes side by
  // side would show any interpolation.
  const TempFolder folder;
  Grid grid = gridOf(800, 3);
  grid.spacing_x = grid.spacing_y = 0.05;
  std::vector<float> z;
  for (int i = 0; i < 2400; ++i) z.push_back(std::ldexp(1.0F + static_cast<float>(i) * 1e-4F, i % 90 - 45));
  const Version field = makeField(grid, z);
  for (const char* name : {"a.stl", "a.ply"}) {
    ExportOptions mesh;
    mesh.mesh = true;
    ASSERT_TRUE(save(field, folder.file(name), mesh));
    FETTLE_LOAD(again, folder.file(name));
    EXPECT_EQ(again.field.grid().width, 800);
    EXPECT_EQ(contentHash(again.field), contentHash(field)) << name;
  }
}

TEST(Mesh, ADecimatedMeshIsAsFarOffAsItSays) {
  const TempFolder folder;
  const Version field = hills(300, 200, 0.01F, 0.0);
  ExportOptions options;
  options.max_error = 0.1;
  for (const char* name : {"a.ply", "a.stl"}) {
    const auto written = save(field, folder.file(name), options);
    ASSERT_TRUE(written) << written.error().line();
    EXPECT_TRUE(warned(written->warnings, "no sample is off by more than 0.09")) << written->warnings.front();
    ImportOptions at_samples;
    at_samples.spacing = std::pair{0.25, 0.5};
    FETTLE_LOAD(again, folder.file(name), at_samples);
    ASSERT_EQ(again.field.grid().width, 300) << name;
    ASSERT_EQ(again.field.grid().height, 200);
    const auto a = heightsOf(field), b = heightsOf(again.field);
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
      worst = std::max(worst, std::abs(static_cast<double>(a[i]) - b[i]));
    EXPECT_LE(worst, 0.1 + 1e-5);  // and the rounding of 75 mm as a float
  }
}

TEST(Mesh, OtherFormatsRefuseToBeMeshes) {
  const TempFolder folder;
  ExportOptions options;
  options.max_error = 0.1;
  EXPECT_FALSE(save(hills(5, 5, 0.0F, 0.0), folder.file("a.tif"), options));
  options.max_error = -1.0;
  EXPECT_FALSE(save(hills(5, 5, 0.0F, 0.0), folder.file("a.stl"), options));
  // A row of samples has no cell, a field of holes no surface.
  EXPECT_FALSE(save(hills(5, 1, 0.0F, 0.0), folder.file("a.stl")));
  EXPECT_FALSE(save(hills(5, 5, 0.0F, 1.1), folder.file("a.stl")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.stl")));
}

// Two roofs, one above the other, and an upright wall.
const std::string kText =
    "solid roof\r\n facet normal 0 0 1\r\n  outer loop\r\n   vertex 0 0 1\r\n   vertex 4 0 1\r\n   vertex 0 "
    "4 5\r\n"
    "  endloop\r\n endfacet\r\n facet normal 0 0 1\r\n outer loop\r\n vertex 0 0 -1e0\r\n vertex 4 0 -1\r\n"
    " vertex 4 4 -1\r\n endloop\r\n endfacet\r\n facet normal 1 0 0\r\n outer loop\r\n vertex 4 0 0\r\n"
    " vertex 4 4 0\r\n vertex 4 4 -9\r\n endloop\r\n endfacet\r\nendsolid roof\r\n";

TEST(Mesh, TheHighestSurfaceIsSeenFromAbove) {
  const TempFolder folder;
  writeBytes(folder.file("a.stl"), kText);
  ImportOptions cells;
  cells.cell_size = 1.0;
  FETTLE_LOAD(scan, folder.file("a.stl"), cells);
  ASSERT_EQ(scan.field.grid().width, 5);
  ASSERT_EQ(scan.field.grid().height, 5);
  const FieldReader z = scan.field.reader();
  EXPECT_EQ(z.heightAt(0, 0), 1.0F);
  EXPECT_EQ(z.heightAt(1, 2), 3.0F);
  EXPECT_EQ(z.heightAt(0, 4), 5.0F);
  EXPECT_EQ(z.heightAt(3, 2), -1.0F);  // past the upper roof
  EXPECT_TRUE(std::isnan(z.heightAt(3, 4)));
  EXPECT_TRUE(warned(scan.warnings, "states no unit"));
}

TEST(Mesh, PolygonsOfAnyEncodingAreFans) {
  const TempFolder folder;
  const std::string head =
      "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property uchar flags\nproperty list uchar int vertex_index\nend_header\n";
  writeBytes(folder.file("a.ply"), "ply\nformat ascii 1.0\ncomment units mm\n" + head +
                                       "0 0 1\n2 0 1\n2 2 3\n0 2 3\nnan 9 9\n7 4 0 1 2 3\n");
  std::string big = "ply\nformat binary_big_endian 1.0\ncomment units mm\n" + head;
  const auto put = [&](auto value) {
    std::string raw(sizeof(value), '\0');
    std::memcpy(raw.data(), &value, sizeof(value));
    std::reverse(raw.begin(), raw.end());
    big += raw;
  };
  for (const float v :
       {0.0F, 0.0F, 1.0F, 2.0F, 0.0F, 1.0F, 2.0F, 2.0F, 3.0F, 0.0F, 2.0F, 3.0F, kNan, 9.0F, 9.0F})
    put(v);
  big += "\x07\x04";
  for (const std::int32_t i : {0, 1, 2, 3}) put(i);
  writeBytes(folder.file("b.ply"), big);
  for (const char* name : {"a.ply", "b.ply"}) {
    ImportOptions cells;
    cells.cell_size = 1.0;
    FETTLE_LOAD(scan, folder.file(name), cells);
    EXPECT_EQ(heightsOf(scan.field), (std::vector<float>{1, 1, 1, 2, 2, 2, 3, 3, 3})) << name;
  }
}

// As programs for point clouds write them.
TEST(Mesh, AListOfNoFacesLeavesACloudOfPoints) {
  const TempFolder folder;
  writeBytes(folder.file("a.ply"),
             "ply\nformat ascii 1.0\ncomment units mm\nelement vertex 4\nproperty float x\nproperty float y\n"
             "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
             "0 0 1\n1 0 2\n0 1 3\n1 1 4\n");
  FETTLE_LOAD(scan, folder.file("a.ply"));
  EXPECT_EQ(heightsOf(scan.field), (std::vector<float>{1, 2, 3, 4}));
}

TEST(Mesh, LyingAndCutFilesAreRefused) {
  const TempFolder folder;
  ASSERT_TRUE(save(hills(9, 9, 0.5F, 0.0), folder.file("a.stl")));
  const std::string whole = readBytes(folder.file("a.stl"));
  const auto refused = [&](const std::string& name, const std::string& bytes) {
    writeBytes(folder.file(name), bytes);
    const auto scan = load(folder.file(name));
    EXPECT_FALSE(scan) << name << " " << bytes.size();
    if (!scan) {
      EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    }
  };
  for (std::size_t bytes = 1; bytes < whole.size(); bytes += 97) refused("cut.stl", whole.substr(0, bytes));
  std::string lying = whole;
  lying.replace(80, 4, "\xff\xff\xff\x7f");
  refused("lying.stl", lying);
  for (std::size_t bytes = 10; bytes < kText.size() - 30; bytes += 7) {
    const std::string cut = kText.substr(0, bytes);
    refused("cut.stl", cut);
  }
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  const auto faces = [&](const std::string& count, const std::string& rows) {
    refused("a.ply", head + "element face " + count +
                         "\nproperty list uchar int vertex_indices\nend_header\n" + corners + rows);
  };
  faces("1", "3 0 1 3\n");
  faces("1", "3 0 1 -1\n");
  faces("1", "3 0 1\n");
  faces("2147483648", "3 0 1 2\n");
  faces("1", "255 0 1 2\n");
  faces("1", "2 0 1\n");
  // Triangles over ten million cells, a thousand times.
  std::string much =
      head +
      "element face 100000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1e4 0 0\n0 1e4 0\n";
  for (int i = 0; i < 100000; ++i) much += "3 0 1 2\n";
  writeBytes(folder.file("much.ply"), much);
  ImportOptions cells;
  cells.cell_size = 10.0;
  EXPECT_FALSE(load(folder.file("much.ply"), cells));
}

}  // namespace
}  // namespace fettle::engine
