// fettle align and compare --align, as a metrologist types them.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// Waves, or what `shape` says, shifted by (x, y) mm, 0.1 mm apart. ESRI ASCII.
enum class Shape { kWaves, kPlane, kHoles };
void writeShape(const std::string& path, Shape shape, double x, double y, double up, int side = 90) {
  std::ofstream out(path);
  out.precision(9);
  out << "ncols " << side << "\nnrows " << side
      << "\nxllcenter 0\nyllcenter 0\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = side - 1; r >= 0; --r) {
    for (int c = 0; c < side; ++c) {
      const double u = 0.1 * c - x, v = 0.1 * r - y;
      const double z = shape == Shape::kWaves ? 0.4 * std::sin(0.9 * u + 0.3) * std::cos(0.7 * v) +
                                                    0.25 * std::sin(1.7 * u - 1.3 * v + 1.0)
                       : shape == Shape::kPlane ? 0.1 * u
                                                : -9999.0 - up;
      out << z + up << ' ';
    }
    out << '\n';
  }
}

TEST(AlignCommand, FindsAShiftAndWritesTheMovedScan) {
  const TempFolder folder;
  const std::string a = folder.file("a.asc"), b = folder.file("b.asc"), out = folder.file("moved.asc");
  writeShape(a, Shape::kWaves, 0.33, -0.27, 0.5);
  writeShape(b, Shape::kWaves, 0.0, 0.0, 0.0, 100);
  const auto report = fettleJson({"align", a, b, out, "--unit", "mm", "--csv", folder.file("m.csv")});
  EXPECT_NEAR(report["shift_x_mm"], 0.33, 1e-3);
  EXPECT_NEAR(report["shift_y_mm"], -0.27, 1e-3);
  EXPECT_NEAR(report["shift_z_mm"], 0.5, 1e-3);
  EXPECT_NEAR(report["rotation_z_deg"], 0.0, 0.01);
  EXPECT_GT(report["shift_x_error_mm"].get<double>(), 0.0);
  EXPECT_NEAR(report["matrix"][3], 0.33, 2e-3);
  const auto compared = fettleJson({"compare", a, out, "--unit", "mm"});
  EXPECT_LT(compared["rms"], 2e-3);
  // One command does the same.
  const auto at_once = fettleJson({"compare", a, b, "--unit", "mm", "--align", "all"});
  EXPECT_EQ(at_once["samples"], compared["samples"]);
  EXPECT_NEAR(at_once["rms"], compared["rms"], 1e-6);
  EXPECT_EQ(at_once["align"]["shift_x_mm"], report["shift_x_mm"]);
  std::ifstream csv(folder.file("m.csv"));
  std::string head, first;
  std::getline(csv, head);
  std::getline(csv, first);
  EXPECT_EQ(head, "figure,value,standard_error,unit");
  EXPECT_TRUE(first.starts_with("shift_x,0.3"));
  const Outcome text = fettle({"align", a, b, "--unit", "mm", "--moves", "shift"});
  EXPECT_NE(text.out.find("shift x     330 "), std::string::npos) << text.out;
}

// Waves 1.5 mm long along both sides, each scan with noise of its own; one of them with a boss.
void writePattern(const std::string& path, double x, unsigned seed, double boss) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 0.003);
  std::ofstream out(path);
  out.precision(9);
  out << "ncols 120\nnrows 120\nxllcenter 0\nyllcenter 0\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = 119; r >= 0; --r) {
    for (int c = 0; c < 120; ++c) {
      const double u = 0.1 * c - x, v = 0.1 * r, square = (u - 3.0) * (u - 3.0) + (v - 8.0) * (v - 8.0);
      out << 0.02 * (std::sin(4.18879 * u) + std::sin(4.18879 * v)) + boss * std::exp(-square / 0.4) +
                 normal(random)
          << ' ';
    }
    out << '\n';
  }
}

TEST(AlignCommand, WarnsWhereTheSurfaceRepeatsItself) {
  const TempFolder folder;
  const std::string a = folder.file("a.asc"), b = folder.file("b.asc"), boss_a = folder.file("c.asc"),
                    boss_b = folder.file("d.asc");
  writePattern(a, 0.23, 1, 0.0);
  writePattern(b, 0.0, 2, 0.0);
  writePattern(boss_a, 0.23, 3, 0.05);
  writePattern(boss_b, 0.0, 4, 0.05);
  const char* const kWarning = "fettle: warning: the surface repeats itself every ";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"align", a, b},
        {"compare", a, b, "--align", "all"},
        {"align", boss_a, boss_b, "--region", "rectangle 6,0,11.9,11.9"}}) {
    std::vector<std::string> with_unit = words;
    with_unit.insert(with_unit.end(), {"--unit", "mm"});
    const Outcome text = fettle(with_unit);
    EXPECT_EQ(text.status, 0) << text.err;
    EXPECT_NE(text.err.find(kWarning), std::string::npos) << words[0] << ": " << text.err;
    const auto report = fettleJson(with_unit);
    const auto& of = words[0] == "compare" ? report["align"] : report;
    ASSERT_TRUE(of.contains("repeat")) << of.dump();
    EXPECT_NEAR(
        std::hypot(of["repeat"]["shift_x_mm"].get<double>(), of["repeat"]["shift_y_mm"].get<double>()), 1.5,
        0.02);
  }
  const Outcome once = fettle({"align", boss_a, boss_b, "--unit", "mm"});
  EXPECT_EQ(once.err.find("repeats itself"), std::string::npos) << once.err;
  const auto report = fettleJson({"align", boss_a, boss_b, "--unit", "mm"});
  EXPECT_FALSE(report.contains("repeat"));
  EXPECT_NEAR(report["shift_x_mm"], 0.23, 0.01);
}

TEST(AlignCommand, SaysWhatItCannotDo) {
  const TempFolder folder;
  const std::string a = folder.file("a.asc"), plane = folder.file("p.asc"), holes = folder.file("h.asc"),
                    out = folder.file("o.asc");
  writeShape(a, Shape::kWaves, 0.0, 0.0, 0.0);
  writeShape(plane, Shape::kPlane, 0.0, 0.0, 0.0);
  writeShape(holes, Shape::kHoles, 0.0, 0.0, 0.0);
  struct Refusal {
    std::vector<std::string> words;
    const char* text;
  };
  for (const Refusal& one : {Refusal{{"align", plane, plane, out}, "does not decide"},
                             {{"align", a, holes, out}, "a field without a height cannot be aligned"},
                             {{"align", a, a, a}, "would replace an input"},
                             {{"align", a, a, out, "--marks", "m.png"}, "marks choose nothing"},
                             {{"align", a, a, out, "--region", "marked"}, "is marked"},
                             {{"align", a, a, "--moves", "level", "--rotation", "5"}, "does not rotate"},
                             {{"align", a, a, "--compress", "zstd"}, "no scan is written"},
                             {{"align", a, a, "--to", "tif"}, "no scan is written"},
                             {{"compare", a, a, "--rotation", "5"}, "nothing is aligned"},
                             {{"compare", a, a, "--align-region", "marked"}, "nothing is aligned"},
                             {{"compare", a, a, "--region", "marked"}, "is marked"}}) {
    std::vector<std::string> words = one.words;
    words.insert(words.end(), {"--unit", "mm"});
    const Outcome outcome = fettle(words);
    EXPECT_EQ(outcome.status, 2) << one.text;
    EXPECT_NE(outcome.err.find(one.text), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << one.text;
  }
  EXPECT_EQ(fettle({"align", plane, plane, out, "--moves", "level", "--unit", "mm"}).status, 0);
}

TEST(AlignCommand, StatesWhatWasFittedAlone) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "128x128", "--part", "bracket"}).status, 0);
  const Outcome all = fettle({"align", scan, scan, "--unit", "mm"});
  // Rounding far below the error is 0, and no figure is -0.
  EXPECT_NE(all.out.find("shift x     0 +-"), std::string::npos) << all.out;
  EXPECT_EQ(all.out.find("-0 "), std::string::npos) << all.out;
  const Outcome level = fettle({"align", scan, scan, "--unit", "mm", "--moves", "level"});
  EXPECT_EQ(level.out.find("shift x"), std::string::npos) << level.out;
  EXPECT_EQ(level.out.find("rotation z"), std::string::npos) << level.out;
  EXPECT_NE(level.out.find("shift z"), std::string::npos) << level.out;
  const auto report = fettleJson({"align", scan, scan, "--unit", "mm", "--moves", "level"});
  EXPECT_EQ(report["shift_x_mm"].get<double>(), 0.0);
  EXPECT_TRUE(report["shift_x_error_mm"].is_null());
}

TEST(AlignCommand, RangesOfHelpAreThoseOfAPerson) {
  const Outcome help = fettle({"report", "--help"});
  EXPECT_EQ(help.out.find("e+308"), std::string::npos) << help.out;
  EXPECT_NE(help.out.find("above 0 mm"), std::string::npos) << help.out;
  EXPECT_NE(help.out.find("at least 0 mm"), std::string::npos) << help.out;
}

}  // namespace
}  // namespace fettle::tests
