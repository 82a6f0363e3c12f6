// fettle level, as a metrologist types it.

#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/measured_scans.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A grating, even about the middle, with an offset for each line, as an AFM makes it, along x or along y.
void writeLines(const std::string& path, bool along_x, bool offsets) {
  std::ofstream out(path);
  out << "ncols 64\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
  for (int r = 63; r >= 0; --r) {
    for (int c = 0; c < 64; ++c) {
      const int line = along_x ? r : c, place = along_x ? c : r;
      out << (static_cast<int>(std::abs(place - 31.5)) / 8 % 2 == 0 ? 0.02 : 0.0) +
                 (offsets ? 0.001 * ((line * 37) % 11 - 5) : 0.0)
          << ' ';
    }
    out << '\n';
  }
}

TEST(Measure, LinesAreLevelledAlongTheirAxis) {
  const TempFolder folder;
  const std::string scan = folder.file("lines.asc"), truth = folder.file("truth.asc");
  const std::string level = folder.file("level.tif");
  for (const std::string axis : {"x", "y"}) {
    writeLines(scan, axis == "x", true);
    writeLines(truth, axis == "x", false);
    for (const std::string rows : {"median", "mean", "poly1", "difference", "matching"}) {
      const auto report = fettleJson(
          {"level", scan, level, "--unit", "mm", "--form", "none", "--rows", rows, "--scan-axis", axis});
      EXPECT_EQ(report["rows"], rows);
      EXPECT_EQ(report["rows_empty"], 0);
      EXPECT_NEAR(report["rows_rms"], 0.00316, 0.0001) << rows;
      const auto left = fettleJson({"compare", level, truth, "--unit", "mm"});
      const double mean = left["mean"], rms = left["rms"];
      EXPECT_LT(std::sqrt(rms * rms - mean * mean), 2e-8) << rows << axis;  // the grating, as it was
    }
  }
  // Marks choose the samples of the form after lines are level, too.
  const std::string steps = folder.file("steps.tif"), marks = folder.file("marks.png");
  ASSERT_EQ(fettle({"synth", steps, "--part", "steps", "--size", "128x128"}).status, 0);
  ASSERT_EQ(fettle({"mark", steps, marks, "--edges"}).status, 0);
  const auto marked =
      fettleJson({"level", steps, level, "--rows", "median", "--region", "unmarked", "--marks", marks});
  EXPECT_LT(marked["samples"].get<int>(), 128 * 128);
  expectRefused(fettle({"level", scan, level, "--unit", "mm", "--rows", "medium"}), "--rows");
}

// A plate that takes a changing share of the lines: the median of each makes steps of it.
TEST(Measure, LinesThatALevellingMovesApartAreWarnedOf) {
  const TempFolder folder;
  const std::string scan = folder.file("plate.asc"), level = folder.file("level.tif");
  std::ofstream out(scan);
  out << "ncols 64\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
  // No pattern that runs on from line to line: differences take that for a slope.
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (int r = 0; r < 64; ++r) {
    for (int c = 0; c < 64; ++c) out << (c < (r > 20 && r < 40 ? 44 : 24) ? 5.0 : 0.0) + noise(random) << ' ';
    out << '\n';
  }
  out.close();
  const auto warned = [&](const std::string& rows) {
    const auto report = fettleJson({"level", scan, level, "--unit", "mm", "--form", "none", "--rows", rows});
    return report.contains("warnings") &&
           report["warnings"].dump().find("further apart than before") != std::string::npos;
  };
  EXPECT_TRUE(warned("median"));
  EXPECT_FALSE(warned("difference"));
}

// A bend over the lines stays, and the stripes go: of their rms of 3.16 um a third part at most, the share of four polynomials
// in 64 lines.
TEST(Measure, FormAcrossLinesStaysWhereItIsToBeKept) {
  const TempFolder folder;
  const std::string scan = folder.file("bent.asc"), truth = folder.file("truth.asc"),
                    level = folder.file("level.tif");
  for (const bool offsets : {true, false}) {
    std::ofstream out(offsets ? scan : truth);
    out << "ncols 64\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    for (int r = 63; r >= 0; --r) {
      for (int c = 0; c < 64; ++c)
        out << (static_cast<int>(std::abs(c - 31.5)) / 8 % 2 == 0 ? 0.02 : 0.0) +
                   0.0004 * (r - 31.5) * (r - 31.5) + (offsets ? 0.001 * ((r * 37) % 11 - 5) : 0.0)
            << ' ';
      out << '\n';
    }
  }
  const auto offBy = [&](const std::string& rows, bool keep) {
    std::vector<std::string> command = {"level",  scan,   level,    "--unit", "mm",
                                        "--form", "none", "--rows", rows};
    if (keep) command.insert(command.end(), {"--keep-form", "3"});
    const auto report = fettleJson(command);
    EXPECT_EQ(report.contains("keep_form"), keep);
    if (keep) {
      EXPECT_EQ(report["keep_form"], 3);
      EXPECT_NEAR(report["rows_form_rms"], 0.12, 0.01);  // of 0.0004 (r - 31.5)^2
    }
    const auto left = fettleJson({"compare", level, truth, "--unit", "mm"});
    const double mean = left["mean"], rms = left["rms"];
    return std::sqrt(rms * rms - mean * mean);
  };
  for (const std::string rows : {"median", "mean", "poly1", "difference", "matching"}) {
    EXPECT_LT(offBy(rows, true), 0.00316 / 3.0) << rows;
    EXPECT_GT(offBy(rows, false), 0.1) << rows;
  }
  expectRefused(fettle({"level", scan, level, "--unit", "mm", "--keep-form", "3"}), "--keep-form");
  expectRefused(fettle({"level", scan, level, "--unit", "mm", "--rows", "mean", "--keep-form", "10"}),
                "--keep-form");
}

TEST(Measure, RobustFormIgnoresAStepAndMarksChooseTheRegion) {
  const TempFolder folder;
  const std::string scan = folder.file("steps.tif"), marks = folder.file("marks.png");
  ASSERT_EQ(fettle({"synth", scan, "--part", "steps", "--size", "256x256"}).status, 0);
  ASSERT_EQ(fettle({"mark", scan, marks, "--edges"}).status, 0);
  const auto all = fettleJson({"measure", scan});
  const auto marked = fettleJson({"measure", scan, "--region", "marked", "--marks", marks});
  const auto rest = fettleJson({"measure", scan, "--region", "unmarked", "--marks", marks});
  EXPECT_EQ(marked["samples"].get<int>() + rest["samples"].get<int>(), all["samples"].get<int>());
  EXPECT_GT(marked["samples"].get<int>(), 0);
  const auto robust = fettleJson({"measure", scan, "--robust"});
  EXPECT_NE(robust["sq"], all["sq"]);
}

// A step over a third of the samples counts in the rms of all and not in that of the samples that count.
TEST(Measure, ARobustLevelSaysWhatItsRmsIsOf) {
  const TempFolder folder;
  const std::string scan = folder.file("step.asc");
  {
    std::ofstream out(scan);
    out << "ncols 60\nnrows 60\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    for (int i = 0; i < 3600; ++i)
      out << ((i % 60 > 39 ? 1.0 : 0.0) + 1e-3 * ((i * 7 + i / 60 * 3) % 5)) << (i % 60 == 59 ? '\n' : ' ');
  }
  for (const char* const form : {"plane", "mean"}) {
    const auto robust = fettleJson(
        {"level", scan, folder.file("l.tif"), "--unit", "mm", "--form", form, "--robust", "--force"});
    EXPECT_NEAR(robust["rms"], std::sqrt(1.0 / 3.0), 0.01) << form;
    EXPECT_LT(robust["rms_counted"].get<double>(), 0.002) << form;
    EXPECT_GT(robust["rms_counted"].get<double>(), 0.001) << form;
  }
  EXPECT_FALSE(
      fettleJson({"level", scan, folder.file("l.tif"), "--unit", "mm", "--force"}).contains("rms_counted"));
}

// A limit of changes counts from the levelled heights, not from those before.
TEST(Measure, ChangesOfALevelledSessionAreLimitedFromItsHeights) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc"), level = folder.file("level.fettle");
  writeWave(scan);
  ASSERT_EQ(fettle({"level", scan, level, "--unit", "mm"}).status, 0);
  const auto filtered =
      fettleJson({"filter", level, folder.file("out.tif"), "--filter", "median", "--max-change", "1um"});
  EXPECT_LE(filtered["max_change"].get<double>(), 1.0001e-3);
}

}  // namespace
}  // namespace fettle::tests
