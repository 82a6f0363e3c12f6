// fettle measure, as a metrologist types it.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/end_to_end/measured_scans.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

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
        row +=
            fmt::format("{:.5f} ", std::sin(2.0 * std::numbers::pi * c / 55.0) + 3e-4 * c + normal(random));
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

TEST(Measure, GroupsAreThoseAskedForAndEachHasAFigureOrAReason) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto all = fettleJson({"measure", scan, "--unit", "mm"});
  // Waves along x of 12 samples of 0.1 mm; along y heights are equal, so that there is no second length.
  EXPECT_NEAR(all["sal"], std::acos(0.2) / (2.0 * 3.14159265 / 1.2), 0.03);
  EXPECT_TRUE(all["str"].is_null());
  EXPECT_EQ(all["not_stated"][0]["parameter"], "str");
  // Every figure without noise is stated, or has a reason: that of Str is that there is none with noise either.
  for (const auto& figure : all["noise"]["figures"])
    EXPECT_EQ(figure["without"].is_null(), figure["reason"] != "") << figure.dump();
  for (const auto& figure : all["noise"]["figures"])
    if (figure["parameter"] == "str") {
      EXPECT_EQ(figure["reason"], all["not_stated"][0]["reason"]);
    }
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
        out << 0.002 * std::cos(2.0 * std::numbers::pi * c / 18.0) +
                   0.001 * std::cos(2.0 * std::numbers::pi * r / 20.0) + (noise ? normal(random) : 0.0)
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

}  // namespace
}  // namespace fettle::tests
