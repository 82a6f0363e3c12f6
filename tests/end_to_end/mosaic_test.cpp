// fettle mosaic, as one types it who has scanned a part in pieces.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// Hills from (x, y) mm on, `up` higher, tilted, with noise; 0.1 mm apart. ESRI ASCII, its corner at `at_x`, `at_y`.
struct Piece {
  double x = 0.0, y = 0.0, up = 0.0, tilt = 0.0;
  double at_x = 0.0, at_y = 0.0;
  unsigned seed = 1;
};
void writePiece(const std::string& path, const Piece& piece, int side = 80) {
  std::mt19937 random(piece.seed);
  std::normal_distribution<double> noise(0.0, 0.002);
  std::ofstream out(path);
  out.precision(9);
  out << "ncols " << side << "\nnrows " << side << "\nxllcenter " << piece.at_x << "\nyllcenter "
      << piece.at_y << "\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = side - 1; r >= 0; --r) {
    for (int c = 0; c < side; ++c) {
      const double x = piece.x + 0.1 * c, y = piece.y + 0.1 * r;
      out << 0.4 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y) + 0.25 * std::sin(1.7 * x - 1.3 * y + 1.0) +
                 0.1 * std::sin(3.1 * x + 0.03 * y * y) + piece.up + piece.tilt * c * 0.1 + noise(random)
          << ' ';
    }
    out << '\n';
  }
}

TEST(MosaicCommand, JoinsPiecesByStatedPlacesAndByLayout) {
  const TempFolder folder;
  const std::vector<std::string> in{folder.file("sw.asc"), folder.file("se.asc"), folder.file("nw.asc"),
                                    folder.file("ne.asc")};
  const std::string out = folder.file("all.tif"), other = folder.file("again.tif");
  for (unsigned k = 0; k < 4; ++k) {
    // Placed to 0.3 mm, 5e6 mm away.
    const double x = 6.0 * (k % 2), y = 6.0 * (k / 2);
    writePiece(in[k], {x, y, 0.3 * k, 0.001 * k, 5e6 + x + 0.3 * (k % 2), -5e6 + y, k + 1});
  }
  const auto report = fettleJson({"mosaic", in[0], in[1], in[2], in[3], out, "--unit", "mm"});
  EXPECT_GE(report["pairs"].get<int>(), 4);
  EXPECT_GE(report["freedom"].get<int>(), 6);
  EXPECT_NEAR(report["scans"][1]["shift_x_mm"], 6.0, 0.005);
  EXPECT_NEAR(report["scans"][3]["shift_y_mm"], 6.0, 0.005);
  EXPECT_NEAR(report["scans"][3]["tilt_x_deg"], -0.003 * 180.0 / 3.14159265, 0.02);
  EXPECT_GT(report["scans"][1]["shift_x_error_mm"].get<double>(), 0.0);
  EXPECT_EQ(report["scans"][0]["shift_x_mm"], 0.0);
  for (const auto& overlap : report["overlaps"]) {
    EXPECT_LT(std::abs(overlap["median_mm"].get<double>()), 0.002);
    EXPECT_GT(overlap["height_error_mm"].get<double>(), 0.0);
  }
  // 14 mm a side; the first scan's place in the world.
  EXPECT_NEAR(report["width"].get<int>(), 140, 1);
  const auto info = fettleJson({"info", out});
  EXPECT_NEAR(info["origin_x"].get<double>(), 5e6, 0.11);
  const auto laid = fettleJson({"mosaic", in[0], in[1], in[2], in[3], other, "--unit", "mm", "--layout",
                                "2x2", "--overlap", "25", "--blend", "mean"});
  EXPECT_NEAR(laid["scans"][3]["shift_x_mm"].get<double>(), report["scans"][3]["shift_x_mm"].get<double>(),
              0.003);
  const Outcome text = fettle({"mosaic", in[0], in[1], out, "--unit", "mm"});
  EXPECT_NE(text.out.find("no loop"), std::string::npos) << text.out;
  // A session holds it as well.
  EXPECT_EQ(fettle({"mosaic", in[0], in[1], folder.file("all.fettle"), "--unit", "mm"}).status, 0);
}

TEST(MosaicCommand, NamesWhatItCannotJoin) {
  const TempFolder folder;
  const std::string a = folder.file("a.asc"), b = folder.file("b.asc"), far = folder.file("far.asc"),
                    out = folder.file("out.tif");
  writePiece(a, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1});
  writePiece(b, {6.0, 0.0, 0.2, 0.0, 6.0, 0.0, 2});
  writePiece(far, {60.0, 0.0, 0.2, 0.0, 60.0, 0.0, 3});
  const std::string row = folder.file("row.asc");
  {
    std::ofstream file(row);
    file << "ncols 60\nnrows 1\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    for (int c = 0; c < 60; ++c) file << c % 7 << ' ';
  }
  struct Refusal {
    std::vector<std::string> words;
    std::string text;
  };
  for (const Refusal& one :
       {Refusal{{"mosaic", a, b, far, out}, "far.asc"},
        {{"mosaic", a, b, far, out}, "no overlap joins this scan to the first"},
        {{"mosaic", row, a, out}, "heights of " + row + " are whole"},
        {{"mosaic", a, out}, "needs two scans"},
        {{"mosaic", a, b, out, "--layout", "3x1"}, "3 x 1 places"},
        {{"mosaic", a, b, out, "--overlap", "30"}, "give --layout too"},
        {{"mosaic", a, b, out, "--moves", "level", "--rotation", "3"}, "does not rotate"},
        {{"mosaic", a, b, a}, "would replace an input"},
        {{"mosaic", a, b, folder.file("o.png"), "--compress", "zstd"}, "--compress"},
        {{"mosaic", a, folder.file("none.asc"), out}, "none.asc"}}) {
    std::vector<std::string> words = one.words;
    words.insert(words.end(), {"--unit", "mm"});
    const Outcome outcome = fettle(words);
    EXPECT_EQ(outcome.status, 2) << one.text << outcome.out;
    EXPECT_NE(outcome.err.find(one.text), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << one.text;
  }
}

}  // namespace
}  // namespace fettle::tests
