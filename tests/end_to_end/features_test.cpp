// fettle features: segments as a table, as labels and as outlines.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// Four bumps of a cosine, two of which a crest joins, on a level plate of 0.1 mm samples.
void writeBumps(const std::string& path) {
  std::ofstream out(path);
  out << "ncols 80\nnrows 60\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
  for (int r = 59; r >= 0; --r) {
    for (int c = 0; c < 80; ++c) {
      double z = 0.0;
      for (const auto& [x, y, height] :
           {std::tuple{20, 15, 1.0}, {60, 15, 0.8}, {20, 45, 0.6}, {32, 45, 0.5}}) {
        const double distance = std::hypot(c - x, r - y);
        if (distance < 9.0) z = std::max(z, height * (0.5 + 0.5 * std::cos(M_PI * distance / 9.0)));
      }
      out << z << ' ';
    }
    out << '\n';
  }
}

TEST(Features, AreATableLabelsAndOutlines) {
  const TempFolder folder;
  const std::string scan = folder.file("bumps.asc");
  writeBumps(scan);
  const auto report =
      fettleJson({"features", scan, "--unit", "mm", "--form", "none", "--csv", folder.file("f.csv"),
                  "--labels", folder.file("l.tif"), "--edges", folder.file("e.png")});
  ASSERT_EQ(report["count"], 4);
  const auto& first = report["features"][0];
  EXPECT_NEAR(first["x"], 2.0, 1e-9);
  EXPECT_NEAR(first["y"], 1.5, 1e-9);
  EXPECT_NEAR(report["features"][1]["x"], 6.0, 1e-9);
  // The second stands alone on the plate: its height and volume are its own. Integral of h (1 + cos(pi r / R)) / 2 over a disk: h pi R^2 (1/2 - 2/pi^2).
  const double own = 0.8 * M_PI * 0.81 * (0.5 - 2.0 / (M_PI * M_PI));
  EXPECT_NEAR(report["features"][1]["height"], 0.8, 1e-6);
  EXPECT_NEAR(report["features"][1]["volume"], own, 0.01 * own);
  EXPECT_EQ(report["features"][1]["open"], false);
  EXPECT_EQ(report["features"][1]["cut"], true) << "its ground goes on to the border of the plate";
  EXPECT_TRUE(report["mean_area"].is_null());
  // The last is a shoulder of the third: over the saddle between them.
  EXPECT_LT(report["features"][3]["height"], 0.4);
  engine::JobControl job;
  const auto labels = engine::importField(folder.file("l.tif"), {}, job);
  ASSERT_TRUE(labels) << labels.error().line();
  const auto numberAt = [&](int column, int row) {
    float z = 0.0F;
    labels->field.reader().readHeights(column, row, 1, 1, &z, 1);
    return z;
  };
  EXPECT_EQ(numberAt(20, 15), 1.0F);
  EXPECT_EQ(numberAt(60, 15), 2.0F);
  EXPECT_EQ(numberAt(20, 45), 3.0F);
  EXPECT_EQ(numberAt(34, 45), 4.0F);
  std::ifstream csv(folder.file("f.csv"));
  const std::string table{std::istreambuf_iterator<char>(csv), {}};
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
  EXPECT_EQ(table.rfind("number,x [mm],y [mm],z [mm],height [mm],samples", 0), 0U) << table;
  // Read at ease whatever unit the scan has.
  const Outcome small = fettle({"features", scan, "--unit", "um", "--form", "none"});
  EXPECT_NE(small.out.find("x mm"), std::string::npos) << small.out;
  EXPECT_NE(small.out.find("area mm2"), std::string::npos) << small.out;
  const auto marked =
      fettleJson({"mark", scan, folder.file("m.png"), "--unit", "mm", "--add", folder.file("e.png")});
  EXPECT_GT(marked["marked"], 20) << "where segments meet";
  EXPECT_LT(marked["marked"], 400);
  // Pruned at half of Sz the shoulder and the third are one no more of their own.
  EXPECT_EQ(fettleJson({"features", scan, "--unit", "mm", "--form", "none", "--prune", "55"})["count"], 3);
  const auto dales = fettleJson({"features", scan, "--unit", "mm", "--form", "none", "--kind", "dales"});
  EXPECT_GE(dales["count"], 1);
  EXPECT_LE(dales["features"][0]["z"], 0.0);
  const Outcome text = fettle({"features", scan, "--unit", "mm", "--form", "none"});
  EXPECT_NE(text.out.find("4 hills at least"), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find("nan"), std::string::npos) << text.out;
}

// Means of the table are the parameters of `fettle measure`, in the scan's units.
TEST(Features, MeansAreTheParametersOfMeasure) {
  const TempFolder folder;
  const std::string scan = folder.file("crate.asc");
  {
    std::ofstream out(scan);
    out.precision(9);
    out << "ncols 90\nnrows 80\nxllcenter 5e6\nyllcenter 5e6\ncellsize 0.1\n";
    for (int r = 79; r >= 0; --r) {
      for (int c = 0; c < 90; ++c)
        out << 0.02 * std::cos(0.31 * (c - 0.3)) * std::cos(0.27 * (r - 0.2)) + 0.003 * std::sin(0.1 * c)
            << ' ';
      out << '\n';
    }
  }
  const auto all = fettleJson(
      {"measure", scan, "--unit", "mm", "--form", "none", "--noise-trials", "0", "--only", "feature"});
  for (const bool dales : {false, true}) {
    const auto report =
        fettleJson({"features", scan, "--unit", "mm", "--form", "none", "--kind", dales ? "dales" : "hills"});
    EXPECT_EQ(report["count"], all[dales ? "dales" : "hills"]);
    EXPECT_NEAR(report["mean_area"], all[dales ? "sda" : "sha"], 1e-9);
    const double volume = all[dales ? "sdv" : "shv"];
    EXPECT_NEAR(report["mean_volume"], volume, 1e-9 * volume);
    double five = 0.0;
    for (int i = 0; i < 5; ++i) five += report["features"][i]["z"].get<double>() / 5.0;
    EXPECT_NEAR(std::abs(five), all[dales ? "s5v" : "s5p"], 1e-9);
    // Half of a square of the waves' lengths, each known to its ground's sides.
    EXPECT_NEAR(report["mean_area"], 0.5 * (2.0 * M_PI / 3.1) * (2.0 * M_PI / 2.7), 0.15);
  }
  const Outcome text = fettle({"measure", scan, "--unit", "mm", "--only", "feature,spatial"});
  for (const char* const row : {"\nSsw ", "\nS10z ", "\nSha ", "\nSdv "})
    EXPECT_NE(text.out.find(row), std::string::npos) << row << text.out;
}

TEST(Features, OfHardScansAreNoneOrARefusal) {
  const TempFolder folder;
  const std::string flat = folder.file("flat.asc"), row = folder.file("row.asc"),
                    holes = folder.file("holes.asc");
  std::ofstream(flat)
      << "ncols 4\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 1\n1 1 1 1\n1 1 1 1\n1 1 1 1\n";
  std::ofstream(row) << "ncols 6\nnrows 1\nxllcenter 5e6\nyllcenter 5e6\ncellsize 1\n0 1e6 0 3 0 0\n";
  std::ofstream(holes)
      << "ncols 2\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 1\nNODATA_value -9\n-9 -9\n-9 -9\n";
  const auto none = fettleJson({"features", flat, "--unit", "mm"});
  EXPECT_EQ(none["count"], 0);
  EXPECT_TRUE(none["mean_area"].is_null());
  EXPECT_EQ(fettleJson({"features", row, "--unit", "mm", "--form", "none"})["count"], 1);
  expectRefused(fettle({"features", holes, "--unit", "mm"}), "");
  expectRefused(fettle({"features", flat, "--unit", "mm", "--prune", "101"}), "--prune");
}

}  // namespace
}  // namespace fettle::tests
