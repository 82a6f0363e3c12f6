#include "tests/fuzz/seeds.h"

#include <cstdlib>
#include <iostream>

#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/engine/io/surface/instrument_files.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {

namespace {

using namespace engine;

Version smallField() {
  Grid grid = gridOf(9, 7);
  grid.spacing_x = 0.25;
  grid.origin_y = -3.5;
  grid.height_per_count = 0.02;
  std::vector<float> z;
  for (int i = 0; i < 63; ++i) z.push_back(i == 30 ? kNan : static_cast<float>(i % 11) * 0.5F - 2.0F);
  return makeField(grid, z);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> fuzzSeeds() {
  std::vector<std::pair<std::string, std::string>> seeds;
  const TempFolder folder;
  const Version field = smallField();
  const auto exported = [&](const std::string& extension, const ExportOptions& options = {}) {
    const std::string path = folder.file("seed" + extension);
    if (const auto written = save(field, path, options); !written) {
      std::cerr << written.error().line() << '\n';
      std::abort();  // a seed that is not there would be a fuzz run of nothing
    }
    seeds.emplace_back(extension, readBytes(path));
  };
  // Sessions are SQLite's: it is fuzzed at its source, and a file takes milliseconds to make.
  for (const FormatInfo& format : formats())
    if (format.writes && format.name != "Fettle") exported(std::string(format.extensions.front()));
  ExportOptions mesh;
  mesh.mesh = true;
  exported(".ply", mesh);
  for (const TiffCompression compression :
       {TiffCompression::kLzw, TiffCompression::kDeflate, TiffCompression::kZstd}) {
    ExportOptions packed;
    packed.tiff_compression = compression;
    exported(".tif", packed);
  }
  ExportOptions text;
  text.ascii = true;
  exported(".sdf", text);
  seeds.emplace_back(".sdf", binarySdf<std::int16_t>(5, 3, {1, 2, -32768, 4, 5, 6}));
  seeds.emplace_back(".sdf", binarySdf<float>(3, 3, {1, 2, 3, 4, 5, 6}, "bISO-2.0"));
  seeds.emplace_back(".sdf", textSdf("aBCR-1.0", 5, "1 2 3\n4 BAD 6\n"));
  for (const bool packed : {false, true}) {
    seeds.emplace_back(".sur", sur<std::int16_t>(packed));
    seeds.emplace_back(".sur", sur<std::int32_t>(packed));
  }
  const std::vector<LasPoint> points{{0, 0, 1000}, {1, 0, -2000}, {0, 1, 3000}, {1, 1, 4001}};
  seeds.emplace_back(".las", las(2, 3, 34, points));
  seeds.emplace_back(".las", las(4, 6, 30, points, "LOCAL_CS[\"here\",UNIT[\"metre\",1]]"));
  std::vector<std::array<double, 3>> cloud;
  for (int i = 0; i < 12; ++i) cloud.push_back({0.25 * (i % 4), 0.5 * (i / 4), 1.0 + i});
  for (const char* data : {"ascii", "binary", "binary_compressed"})
    seeds.emplace_back(".pcd", pcd(data, cloud, 4));
  seeds.emplace_back(
      ".stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 4 0 1\nvertex 0 4 5\nendloop\n"
      "endfacet\nendsolid a\n");
  seeds.emplace_back(
      ".ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n2 0 1\n2 2 3\n0 2 3\n"
      "4 0 1 2 3\n");
  seeds.emplace_back(
      ".ply",
      "ply\nformat ascii 1.0\nobj_info num_cols 3\nobj_info num_rows 2\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nelement range_grid 6\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 5\n2 0 6\n0 1 7\n1 1 8\n1 0\n0\n1 1\n1 2\n1 3\n0\n");
  seeds.emplace_back(
      ".txt", "# Channel: Z\n# Width: 3 um\n# Height: 2 um\n# Value units: m\n1e-9\t2e-9\tnan\n4\t\t6\n");
  seeds.emplace_back(
      ".txt", "a title\n1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16\n,2,3,4,,6,7,8,9,10,11,12,13,NA,15,16\n");
  seeds.emplace_back(".xyz",
                     "a title\nid;\"Z [nm]\";x_um;Y (um)\nP1;5;0;0\n\"P;2\";6;1;0\nP3;;0;1\nP4;8;1;1\n");
  seeds.emplace_back(".xyz", "x\ty\tz\nmm\tmm\tum\n0\t0\t1\n0.5\t0\t2\n0\t0.5\t3\n40\t40\t4\n");
  return seeds;
}

}  // namespace fettle::tests
