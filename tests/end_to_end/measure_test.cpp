// fettle level and fettle measure, as a metrologist types them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

constexpr double kPi = std::numbers::pi;

// A tilted plate of 60 x 50 samples, 0.1 mm apart, with a wave of 2 um along x, even about its middle so that no plane
// follows it. ESRI ASCII, in millimetres.
void writeWave(const std::string& path) {
  std::ofstream out(path);
  out << "ncols 60\nnrows 50\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
  for (int r = 49; r >= 0; --r) {
    for (int c = 0; c < 60; ++c)
      out << 0.01 * c - 0.005 * r + 0.002 * std::cos(2.0 * kPi * (c - 29.5) / 12.0) << ' ';
    out << '\n';
  }
}

TEST(Measure, OfATiltedWaveIsTheWave) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto report = fettleJson({"measure", scan, "--unit", "mm"});
  EXPECT_EQ(report["samples"], 3000);
  // Heights in the file have six digits: 1e-6 of up to 0.6.
  EXPECT_NEAR(report["sq"], 0.002 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(report["sku"], 1.5, 0.005);
  EXPECT_NEAR(report["tilt_x"], std::atan(0.1) * 180.0 / 3.14159265, 0.05);
  EXPECT_NEAR(report["tilt_y"], -std::atan(0.05) * 180.0 / 3.14159265, 0.05);
  const Outcome text = fettle({"measure", scan, "--unit", "mm"});
  EXPECT_NE(text.out.find("Sq             1.4"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find(" um "), std::string::npos) << text.out;
}

// Grid of a height by column and row, of cells of 0.05 mm.
void writeHeights(const std::string& path, int columns, int rows,
                  const std::function<double(int, int)>& height) {
  std::ofstream out(path);
  out.precision(9);
  out << fmt::format("ncols {}\nnrows {}\nxllcenter 0\nyllcenter 0\ncellsize 0.05\n", columns, rows);
  for (int r = rows - 1; r >= 0; --r) {
    for (int c = 0; c < columns; ++c) out << height(c, r) << ' ';
    out << '\n';
  }
}

// What lies beyond a region is as good as holes for the filters, too: figures are those of the part alone.
TEST(Measure, FiltersOfARegionKnowNothingBeyondIt) {
  const TempFolder folder;
  const std::string scan = folder.file("step.asc"), part = folder.file("part.tif");
  const std::string marks = folder.file("marks.png"), marked = folder.file("marked.tif");
  writeHeights(scan, 80, 50, [](int c, int r) {
    return 1e-3 * std::sin(1.3 * c) * std::cos(0.9 * r) + (c > 40 ? 0.2 : 0.0);
  });
  ASSERT_EQ(fettle({"transform", scan, part, "--unit", "mm", "--crop-samples", "0,0,50,41"}).status, 0);
  const std::vector<std::string> filters{"--s-filter", "0.12", "--l-filter", "0.8", "--noise-trials", "0"};
  const auto figures = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "measure");
    arguments.insert(arguments.end(), filters.begin(), filters.end());
    return fettleJson(arguments);
  };
  const auto of_part = figures({part});
  const auto of_region = figures({scan, "--unit", "mm", "--region", "rectangle 0,0,2.01,2.5"});
  EXPECT_EQ(of_region["samples"], of_part["samples"]);
  for (const char* key : {"sq", "sz", "sdq", "sal", "sk"})
    EXPECT_NEAR(of_region[key], of_part[key], 1e-3 * of_part[key].get<double>()) << key;
}

// A bow is bent up at its ends by what it is filtered with, unless it is filtered about its form.
TEST(Measure, AnSFilterOfABentSurfaceKeepsItsEnds) {
  const TempFolder folder;
  const std::string scan = folder.file("bow.asc"), level = folder.file("level.tif");
  writeHeights(scan, 80, 60, [](int c, int r) {
    const double x = 0.05 * (c - 39.5);
    return std::sqrt(25.0 - x * x) - 5.0 + 2e-4 * std::sin(0.4 * c + 0.3 * r);
  });
  ASSERT_EQ(fettle({"level", scan, level, "--unit", "mm", "--form", "cylinder"}).status, 0);
  const std::vector<std::string> s{"--s-filter", "0.15", "--noise-trials", "0", "--only", "height"};
  const auto sz = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "measure");
    arguments.insert(arguments.end(), s.begin(), s.end());
    return fettleJson(arguments)["sz"].get<double>();
  };
  const double alone = sz({level, "--form", "none"});
  EXPECT_NEAR(sz({scan, "--unit", "mm", "--form", "cylinder"}) / alone, 1.0, 0.02);
  EXPECT_GT(sz({scan, "--unit", "mm", "--form", "plane"}) / alone, 10.0) << "it has a bow to filter";
}

TEST(Measure, OfALevelledScanIsThatOfTheScan) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc"), level = folder.file("level.tif");
  writeWave(scan);
  const auto levelled = fettleJson({"level", scan, level, "--unit", "mm"});
  const auto before = fettleJson({"measure", scan, "--unit", "mm"});
  const auto after = fettleJson({"measure", level, "--form", "none"});
  for (const char* key : {"sq", "sa", "sz", "sdq", "sk", "vvc"})
    EXPECT_NEAR(after[key], before[key], 1e-5 * before[key].get<double>()) << key;
  EXPECT_NEAR(levelled["rms"], before["sq"], 1e-9);
  EXPECT_NEAR(after["mean"], 0.0, 1e-8);
  EXPECT_FALSE(after.contains("tilt_x"));
}

// The surface that is written has, measured as it is, the parameters that were stated, its holes, and no sample outside of the
// region. Heights are rounded to float once more: 6e-8 of the greatest, of parameters of small differences a thousand times that.
TEST(Measure, TheSurfaceThatIsWrittenHasTheParameters) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.asc"), surface = folder.file("surface.tif");
  {
    std::ofstream out(scan);
    out << "ncols 120\nnrows 90\nxllcenter 0\nyllcenter 0\ndx 0.1\ndy 0.2\nNODATA_value -9999\n";
    for (int r = 89; r >= 0; --r) {
      for (int c = 0; c < 120; ++c)
        out << ((c - 40) * (c - 40) + (r - 30) * (r - 30) < 30
                    ? -9999.0
                    : 0.01 * c - 0.02 * r + 0.05 * std::sin(0.8 * c) * std::cos(0.5 * r) +
                          0.2 * std::sin(0.06 * c))
            << ' ';
      out << '\n';
    }
  }
  for (const std::vector<std::string>& how : std::vector<std::vector<std::string>>{
           {},
           {"--form", "poly2", "--robust"},
           {"--s-filter", "0.6"},
           {"--s-filter", "0.6", "--l-filter", "4"},
           {"--l-filter", "4", "--l-filter-kind", "spline", "--form", "poly3"},
           {"--s-filter", "0.6", "--l-filter", "4", "--region", "rectangle 1,2,9,15"}}) {
    std::vector<std::string> line{"measure",   scan,    "--unit",         "mm",
                                  "--surface", surface, "--noise-trials", "0"};
    line.insert(line.end(), how.begin(), how.end());
    const std::string typed = how.empty() ? "" : how.back();
    const auto stated = fettleJson(line);
    EXPECT_EQ(stated["surface"], surface);
    const auto again = fettleJson({"measure", surface, "--form", "none", "--noise-trials", "0"});
    EXPECT_EQ(again["samples"], stated["samples"]) << typed;
    EXPECT_EQ(again["cells"], stated["cells"]) << typed;
    int compared = 0;
    for (const char* key :
         {"sq",  "ssk", "sku", "sp",  "sv",    "sz",    "sa",  "sal", "str", "std", "ssw", "sdq",
          "sdr", "sk",  "spk", "svk", "smrk1", "smrk2", "vmp", "vmc", "vvc", "vvv", "sxp", "spd",
          "svd", "spc", "svc", "s5p", "s5v",   "s10z",  "sha", "sda", "shv", "sdv"}) {
      ASSERT_EQ(again[key].is_null(), stated[key].is_null()) << typed << " " << key;
      if (again[key].is_null()) continue;
      const double value = stated[key];
      EXPECT_NEAR(again[key], value, 2e-5 * std::max(std::abs(value), 0.1)) << typed << " " << key;
      ++compared;
    }
    EXPECT_GT(compared, 18) << typed;
  }
  expectRefused(fettle({"measure", scan, scan, "--unit", "mm", "--surface", surface}), "one scan");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--surface", folder.file("s.what")}), "what");
}

// Above a million samples errors are those of a part that stands for all. White noise of 0.1 on waves: Sq without it is 1/sqrt 2 of
// the amplitude.
TEST(Measure, OfAMillionSamplesAndMoreHasErrorsToo) {
  const TempFolder folder;
  const std::string scan = folder.file("large.asc");
  {
    std::ofstream out(scan);
    out << "ncols 1100\nnrows 1000\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal(0.0, 0.1);
    for (int r = 999; r >= 0; --r) {
      std::string row;
      for (int c = 0; c < 1100; ++c)
        row += fmt::format("{:.5f} ", std::sin(2.0 * kPi * c / 55.0) + 3e-4 * c + normal(random));
      out << row << '\n';
    }
  }
  const auto report = fettleJson({"measure", scan, "--unit", "mm", "--only", "hybrid,functional"});
  EXPECT_EQ(report["noise"]["part"], 16 * 180 * 180);
  int stated = 0;
  for (const auto& figure : report["noise"]["figures"]) {
    if (figure["error"].is_null()) continue;
    ++stated;
    EXPECT_GE(figure["error"], 0.0) << figure["parameter"];
    const double off = figure["without"].get<double>() - 1.0 / std::sqrt(2.0);
    if (figure["parameter"] != "sq") continue;
    // The scatter alone is 1e-4; the noise that is measured is known to some per cent of 0.007.
    EXPECT_LT(std::abs(off), std::max(4.0 * figure["error"].get<double>(), 5e-4));
    EXPECT_LT(figure["error"], 3e-3);
  }
  EXPECT_GT(stated, 12);
  EXPECT_FALSE(fettleJson({"measure", scan, "--unit", "mm", "--only", "height", "--noise-trials", "0"})
                   .contains("noise"));
  const std::string page = folder.file("large.html");
  (void)fettleJson({"report", scan, page, "--unit", "mm"});
  EXPECT_NE(bytesOf(page).find("by 4 trials with more of it on 518400 samples of the scan"),
            std::string::npos);
}

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

TEST(Measure, GroupsAreThoseAskedForAndEachHasAFigureOrAReason) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto all = fettleJson({"measure", scan, "--unit", "mm"});
  // Waves along x of 12 samples of 0.1 mm; along y heights are equal, so that there is no second length.
  EXPECT_NEAR(all["sal"], std::acos(0.2) / (2.0 * 3.14159265 / 1.2), 0.03);
  EXPECT_TRUE(all["str"].is_null());
  EXPECT_EQ(all["not_stated"][0]["parameter"], "str");
  EXPECT_NEAR(all["std"], 90.0, 1.0);
  EXPECT_NEAR(all["ssw"], 1.2, 1e-3);
  EXPECT_EQ(all["smc"].size(), 2U);
  const auto only = fettleJson({"measure", scan, "--unit", "mm", "--only", "spatial,hybrid"});
  EXPECT_EQ(only["sal"], all["sal"]);
  EXPECT_EQ(only["sq"], all["sq"]);
  EXPECT_FALSE(only.contains("sk"));
  EXPECT_EQ(only["ssw"], all["ssw"]);
  for (const char* const key : {"spd", "svc", "s10z", "sha", "sdv", "hills", "dales"})
    EXPECT_FALSE(only.contains(key)) << key;
  // The word after the list is the scan; the option may be repeated.
  EXPECT_EQ(fettleJson({"measure", "--only", "spatial,hybrid", scan, "--unit", "mm"}), only);
  EXPECT_EQ(fettleJson({"measure", "--unit", "mm", "--only", "spatial", "--only", "hybrid", scan}), only);
  const Outcome text = fettle({"measure", scan, "--unit", "mm"});
  for (const char* heading : {"\nHeight\n", "\nSpatial\n", "\nHybrid\n", "\nFunctional\n", "\nFeature\n"})
    EXPECT_NE(text.out.find(heading), std::string::npos) << heading;
  EXPECT_NE(text.out.find("Str      not stated: along"), std::string::npos) << text.out;
  EXPECT_NE(
      text.out.find("figure is without noise, +- its standard error, by 16 trials, which is known to 25 %"),
      std::string::npos);
  EXPECT_EQ(text.out.find(" nan"), std::string::npos) << text.out;
}

// Noise on a wave: the parameters without it are those of the wave, within what is stated; and they can be left out.
TEST(Measure, StatesWhatNoiseDoesToEachParameter) {
  const TempFolder folder;
  const std::string clean = folder.file("clean.asc"), noisy = folder.file("noisy.asc");
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.0002);
  for (const bool noise : {false, true}) {
    std::ofstream out(noise ? noisy : clean);
    out.precision(9);
    out << "ncols 90\nnrows 80\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    for (int r = 79; r >= 0; --r) {
      for (int c = 0; c < 90; ++c)
        out << 0.002 * std::cos(2.0 * kPi * c / 18.0) + 0.001 * std::cos(2.0 * kPi * r / 20.0) +
                   (noise ? normal(random) : 0.0)
            << ' ';
      out << '\n';
    }
  }
  const auto truth = fettleJson({"measure", clean, "--unit", "mm", "--noise-trials", "0"});
  EXPECT_FALSE(truth.contains("noise"));
  const auto found = fettleJson({"measure", noisy, "--unit", "mm"});
  EXPECT_EQ(found["noise"]["trials"], 16);
  EXPECT_NEAR(found["noise"]["error_of_errors"], 1.0 / 4.0, 1e-12);
  EXPECT_NEAR(found["noise"]["sigma"], 0.0002, 2e-5);
  int stated = 0, outside = 0;
  for (const auto& each : found["noise"]["figures"]) {
    const std::string key = each["parameter"];
    if (each["without"].is_null() || truth[key].is_null() || key == "str" || key == "std") continue;
    ++stated;
    const double off = each["without"].get<double>() - truth[key].get<double>();
    if (std::abs(off) > 3.0 * each["error"].get<double>()) ++outside;
    if (key == "sq" || key == "sdq") {
      EXPECT_LT(std::abs(off), 0.5 * (found[key].get<double>() - truth[key].get<double>())) << key;
    }
  }
  EXPECT_GE(stated, 18);
  EXPECT_LE(outside, 2);
  EXPECT_TRUE(found["smc"][0]["error"].is_number());
  EXPECT_EQ(fettleJson({"measure", noisy, "--unit", "mm"}), found) << "the same trials again";
  const auto few = fettleJson({"measure", noisy, "--unit", "mm", "--noise-trials", "6", "--only", "height"});
  EXPECT_EQ(few["noise"]["trials"], 6);
  EXPECT_EQ(few["noise"]["figures"].size(), 7U);
  for (const char* const trials : {"-1", "1", "2", "5"})
    expectRefused(fettle({"measure", noisy, "--unit", "mm", "--noise-trials", trials}), "--noise-trials");
}

TEST(Measure, MaterialRatiosAreThoseAskedFor) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto report =
      fettleJson({"measure", scan, "--unit", "mm", "--at-height", "-1mm,0,500nm", "--at-ratio", "50"});
  EXPECT_EQ(report["smr"][0]["ratio"], 1.0);
  EXPECT_NEAR(report["smr"][1]["ratio"], 0.5, 0.05);
  EXPECT_NEAR(report["smr"][2]["height"], 5e-4, 1e-12);
  EXPECT_NEAR(report["smc"][0]["height"], 0.0, 2e-4);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--at-height", "1kg"}), "--at-height");
}

// Of a ramp along y, of which a mean takes nothing, from 1.99 to 0 mm: z = 2 (1 - q) by the share q, to half a row.
TEST(Measure, VolumesAndPruningAreThoseAskedFor) {
  const TempFolder folder;
  const std::string scan = folder.file("ramp.asc");
  {
    std::ofstream out(scan);
    out << "ncols 20\nnrows 200\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    for (int r = 199; r >= 0; --r)
      for (int c = 0; c < 20; ++c) out << 0.01 * r << (c == 19 ? '\n' : ' ');
  }
  const std::vector<std::string> words{
      "measure",    scan, "--unit",           "mm",       "--form",  "mean", "--ratios", "25,60",
      "--at-ratio", "5",  "--height-between", "2.5,97.5", "--prune", "8"};
  const auto report = fettleJson(words);
  constexpr double kNear = 0.011;
  EXPECT_NEAR(report["vmp"], 0.25 * 0.25, kNear);
  EXPECT_NEAR(report["vmc"], 0.6 * 0.6 - 0.25 * 0.25, kNear);
  EXPECT_NEAR(report["vvc"], 0.75 * 0.75 - 0.4 * 0.4, kNear);
  EXPECT_NEAR(report["vvv"], 0.4 * 0.4, kNear);
  EXPECT_NEAR(report["smc"][0]["material_volume"], 0.05 * 0.05, kNear);
  EXPECT_NEAR(report["smc"][0]["void_volume"], 0.95 * 0.95, kNear);
  EXPECT_NEAR(report["sdc"]["height"], 0.95 * 2.0, kNear);
  EXPECT_EQ(report["prune"], 0.08);
  const Outcome text = fettle(words);
  for (const char* const part :
       {"(25 to 60 %)", "(60 %)", "Vm(p)", "Vv(p)", "Sdc ", "material ratios 2.5 and 97.5 %", "of 8 % of Sz"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
  const auto usual = fettleJson({"measure", scan, "--unit", "mm", "--form", "mean"});
  EXPECT_FALSE(usual.contains("sdc"));
  EXPECT_NEAR(usual["vmp"], 0.1 * 0.1, kNear);
  for (const char* const wrong : {"60,25", "-1,50", "10,101", "10"})
    expectRefused(fettle({"measure", scan, "--unit", "mm", "--ratios", wrong}), "--ratios");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--only", "hybrid", "--height-between", "2,98"}),
                "--height-between");
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

// The wave of 1.2 mm: half of it is left by an S-filter of its length, and half by an L-filter of its length.
TEST(Measure, FiltersLimitTheScales) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto sq = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"measure", scan, "--unit", "mm", "--only", "height"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fettleJson(arguments)["sq"].get<double>();
  };
  const double all = sq({});
  // Borders within a wave of a field of five: what they add is seen beside the closed formula.
  EXPECT_NEAR(sq({"--s-filter", "1.2"}) / all, 0.5, 0.06);
  EXPECT_NEAR(sq({"--l-filter", "1200um"}) / all, 0.5, 0.06);
  EXPECT_NEAR(sq({"--s-filter", "0.2", "--l-filter", "5"}) / all, 1.0, 0.08);
  const auto report = fettleJson({"measure", scan, "--unit", "mm", "--s-filter", "0.2", "--l-filter", "5"});
  EXPECT_EQ(report["s_filter"], 0.2);
  EXPECT_EQ(report["l_filter"], 5.0);
  // Of a smooth wave the robust filters leave more than the linear ones, whose half is not theirs.
  EXPECT_NEAR(sq({"--l-filter", "5", "--l-filter-kind", "robust-gaussian"}) / all, 1.0, 0.1);
  EXPECT_NEAR(sq({"--s-filter", "0.2", "--s-filter-kind", "robust-gaussian"}) / all, 1.0, 0.05);
  // A wave of the cut-off along an axis keeps half in a spline as well; balls much larger than its arcs take all of it
  // away, and smaller ones nothing.
  EXPECT_NEAR(sq({"--s-filter", "1.2", "--s-filter-kind", "spline"}) / all, 0.5, 0.06);
  EXPECT_NEAR(sq({"--l-filter", "1.2", "--l-filter-kind", "spline"}) / all, 0.5, 0.06);
  EXPECT_LT(sq({"--s-filter", "1e5", "--s-filter-kind", "closing"}) / all, 0.05);
  EXPECT_LT(sq({"--l-filter", "0.12", "--l-filter-kind", "opening"}) / all, 0.05);
  EXPECT_NE(fettle({"measure", scan, "--unit", "mm", "--s-filter", "7"}).err.find("longer than the field"),
            std::string::npos);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--s-filter", "0"}), "--s-filter");
  // A radius is no wavelength: neither has to be the longer.
  EXPECT_GT(sq({"--s-filter", "5", "--s-filter-kind", "closing", "--l-filter", "2"}), 0.0);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--l-filter-kind", "robust-gaussian"}),
                "--l-filter");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--s-filter", "0.1"}), "--s-filter");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--s-filter", "5", "--l-filter", "2"}),
                "--l-filter");
}

TEST(Measure, OfFeetIsPrintedInFeet) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const Outcome text = fettle({"measure", scan, "--unit", "ft", "--only", "spatial"});
  EXPECT_NE(text.out.find(" ft "), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find(" mm "), std::string::npos) << text.out;
}

TEST(Measure, CsvHasARowPerScanAndParameter) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc"), flat = folder.file("a, flat.asc"),
                    csv = folder.file("t.csv");
  writeWave(scan);
  std::ofstream(flat) << "ncols 5\nnrows 4\nxllcenter 0\nyllcenter 0\ncellsize 1\n"
                      << "1 1 1 1 1\n1 1 1 1 1\n"
                      << "1 1 1 1 1\n1 1 1 1 1\n";
  ASSERT_EQ(fettle({"measure", scan, flat, "--unit", "mm", "--csv", csv}).status, 0);
  std::ifstream in(csv);
  std::string line, all;
  int rows = 0;
  while (std::getline(in, line)) ++rows, all += line + "\n";
  EXPECT_TRUE(all.starts_with("scan,group,parameter,value,unit,remark,without_noise,error,layer\n"));
  // 34 parameters; Smc, Vm and Vv at two ratios each.
  EXPECT_EQ(rows, 1 + 2 * (34 + 3 * 2));
  EXPECT_NE(all.find("\"" + flat + "\",height,Ssk,,,not stated: the surface is flat,,,\n"), std::string::npos)
      << all;
  EXPECT_NE(all.find(",height,Sq,0.0014"), std::string::npos) << all;
  EXPECT_EQ(all.find("nan"), std::string::npos) << all;
}

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
  EXPECT_NEAR(std::abs(std::cos(degrees[0] * kPi / 180.0)), 1.0, 1e-3);  // the fastest is along x
  ASSERT_GT(correlation.size(), 25U);
  for (const auto& row : correlation)
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
      if (std::isnan(row[k + 1])) continue;
      const double along_x = row[0] * std::abs(std::cos(degrees[k] * kPi / 180.0));
      EXPECT_NEAR(row[k + 1], std::cos(2.0 * kPi * along_x / 1.2), 2.0 / (60.0 - along_x / 0.1) + 0.035)
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

TEST(Measure, SeveralScansHaveAReportEachAndABadOneFailsAlone) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const Outcome outcome = fettle({"measure", scan, folder.file("none.tif"), "--json", "--unit", "mm"});
  EXPECT_EQ(outcome.status, 1);
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["done"], 1);
  EXPECT_EQ(report["failed"], 1);
  EXPECT_TRUE(report["files"][0].contains("sq"));
  EXPECT_TRUE(report["files"][1].contains("error"));
}

TEST(Measure, RefusesWhatHasNoSample) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--region", "marked"}), "--marks");
  const std::string marks = folder.file("marks.png");
  ASSERT_EQ(fettle({"mark", scan, marks, "--edges", "--unit", "mm"}).status, 0);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--marks", marks}), "--region");
  expectRefused(fettle({"level", scan, folder.file("out.tif"), "--unit", "mm", "--marks", marks}),
                "--region");
  expectRefused(fettle({"level", scan, folder.file("out.tif"), "--unit", "mm", "--form", "none"}), "--form");
  expectRefused(fettle({"measure", scan, "--form", "poly6"}), "poly6");
}

TEST(Measure, WarnsOfAFormThatTheSamplesDoNotDetermine) {
  const TempFolder folder;
  const std::string scan = folder.file("small.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "2x2"}).status, 0);
  expectRefused(fettle({"measure", scan, "--form", "poly5"}),
                "4 samples decide 4 of the 21 terms of a polynomial of degree 5 and leave");
  const Outcome plane = fettle({"measure", scan, "--region", "rectangle 0,0,0,0"});
  EXPECT_NE(plane.err.find("1 sample decides 1 of the 3 terms of a plane and leaves x, y open"),
            std::string::npos)
      << plane.err;
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
