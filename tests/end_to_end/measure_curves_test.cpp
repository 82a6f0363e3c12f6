// The curves of fettle measure, drawn and as numbers.

#include <cmath>
#include <cstddef>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/measured_scans.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// Rows of numbers of a CSV file without its heading and, of a row, without the first `skipped` cells.
std::vector<std::vector<double>> numbersOf(const std::string& path, std::size_t skipped = 0) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    std::string cell;
    for (std::size_t k = 0; std::getline(cells, cell, ','); ++k)
      if (k >= skipped) rows.back().push_back(cell.empty() ? std::nan("") : std::stod(cell));
  }
  return rows;
}

TEST(Measure, DrawsTheCurvesOfTheWaveAndWritesTheirNumbers) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  const std::string scan = file("wave.asc");
  writeWave(scan);
  const auto plain = fettleJson({"measure", scan, "--unit", "mm"});
  const auto report = fettleJson({"measure", scan, "--unit", "mm", "--abbott", file("a.csv"), "--correlation",
                                  file("c.csv"), "--spectrum", file("s.csv")});
  EXPECT_EQ(report, plain);  // the curves add files, nothing else
  // Falls from the highest to the lowest height; half of a wave is above its mean.
  const auto abbott = numbersOf(file("a.csv"));
  ASSERT_EQ(abbott.size(), 401U);
  for (std::size_t i = 1; i < abbott.size(); ++i) EXPECT_LE(abbott[i][1], abbott[i - 1][1]);
  EXPECT_EQ(fettle({"measure", scan, "--unit", "mm", "--abbott", "-"}).out, bytesOf(file("a.csv")));
  EXPECT_NEAR(abbott.front()[1], report["sp"].get<double>(), 1e-9);
  EXPECT_NEAR(abbott.back()[1], -report["sv"].get<double>(), 1e-9);
  EXPECT_NEAR(abbott[200][1], 0.0, 1e-4);
  // Of a wave of 1.2 mm along x the autocorrelation is its cosine, in any direction. Of n samples that are no whole waves the
  // mean of the product deviates by up to 1 / (n sin(2 pi / 12)) of the mean square; between lags of a twelfth of the wave
  // the cosine is straight, up to 1 - cos(2 pi / 24) = 0.035 off.
  const auto correlation = numbersOf(file("c.csv"));
  const std::string heading = bytesOf(file("c.csv"));
  double degrees[2] = {};
  ASSERT_EQ(
      std::sscanf(heading.c_str(), "distance_mm,at_%lf_degrees,at_%lf_degrees", &degrees[0], &degrees[1]), 2);
  EXPECT_NEAR(std::abs(std::cos(degrees[0] * std::numbers::pi / 180.0)), 1.0,
              1e-3);  // the fastest is along x
  ASSERT_GT(correlation.size(), 25U);
  for (const auto& row : correlation)
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
      if (std::isnan(row[k + 1])) continue;
      const double along_x = row[0] * std::abs(std::cos(degrees[k] * std::numbers::pi / 180.0));
      EXPECT_NEAR(row[k + 1], std::cos(2.0 * std::numbers::pi * along_x / 1.2),
                  2.0 / (60.0 - along_x / 0.1) + 0.035)
          << row[0];
    }
  // All power is that of the surface, its peak along x at 1 / 1.2 mm.
  const auto spectrum = numbersOf(file("s.csv"), 1);
  double best = 0.0, at = 0.0;
  for (const auto& row : spectrum)
    if (row[0] > 0.0 && row[1] > best) best = row[1], at = row[0];
  EXPECT_NEAR(at, 1.0 / 1.2, 0.5 / (31 * 0.1));
  // As drawings.
  ASSERT_EQ(fettle({"measure", scan, "--unit", "mm", "--only", "height", "--abbott", file("a.svg"),
                    "--correlation", file("c.png"), "--spectrum", file("s.svg")})
                .status,
            0);
  EXPECT_NE(bytesOf(file("a.svg")).find("material ratio [%]; highest 1.9"), std::string::npos);
  EXPECT_NE(bytesOf(file("s.svg")).find("spatial frequency"), std::string::npos);
  EXPECT_TRUE(bytesOf(file("c.png")).starts_with("\x89PNG"));
}

TEST(Measure, CurvesThatCannotBeDrawnAreRefused) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc"), row = folder.file("row.asc"), out = folder.file("c.svg");
  writeWave(scan);
  std::ofstream(row) << "ncols 5\nnrows 1\nxllcenter 0\nyllcenter 0\ncellsize 1\n1 2 1 4 1\n";
  expectRefused(fettle({"measure", scan, scan, "--unit", "mm", "--abbott", out}), "curves are of one scan");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--abbott", folder.file("c.pdf")}), ".pdf");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--abbott", out, "--spectrum", out}), "c.svg");
  expectRefused(fettle({"measure", row, "--unit", "mm", "--form", "mean", "--correlation", out}),
                "fewer than 4 columns or rows");
  EXPECT_FALSE(std::ifstream(out).is_open());
}

}  // namespace
}  // namespace fettle::tests
