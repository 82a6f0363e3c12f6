// fettle fit, as a reverse engineer types it.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A hollow of radius 5 mm beside a plane of 30 degrees, 0.1 mm apart, with a column of holes between. ESRI ASCII.
void writePart(const std::string& path) {
  std::ofstream out(path);
  out.precision(9);
  out << "ncols 81\nnrows 50\nxllcenter 0\nyllcenter 0\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = 49; r >= 0; --r) {
    for (int c = 0; c < 81; ++c) {
      const double x = 0.1 * c, y = 0.1 * r;
      const double z = c < 40    ? 6.0 - std::sqrt(25.0 - (x - 2.0) * (x - 2.0) - (y - 2.0) * (y - 2.0))
                       : c == 40 ? -9999.0
                                 : std::tan(std::acos(-1.0) / 6.0) * x;
      out << z << ' ';
    }
    out << '\n';
  }
}

// 81 x 61 heights [mm] about the middle of a field, 0.08 mm apart, with normal noise. ESRI ASCII.
void writeNoisy(const std::string& path, double noise_mm,
                const std::function<double(double x, double y)>& height) {
  std::ofstream out(path);
  out << "ncols 81\nnrows 61\nxllcenter 0\nyllcenter 0\ncellsize 0.08\n";
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, noise_mm);
  for (int i = 0; i < 81 * 61; ++i) {
    const double x = 0.08 * (i % 81 - 40), y = 0.08 * (i / 81 - 30);
    out << height(x, y) + noise(random) << (i % 81 == 80 ? '\n' : ' ');
  }
}

TEST(FitCommand, SaysWhereTheBestShapeIsNone) {
  const TempFolder folder;
  const std::string part = folder.file("part.asc"), bracket = folder.file("bracket.tif");
  writePart(part);
  const Outcome plane = fettle({"fit", part, "--unit", "mm", "--at", "6,2"});
  EXPECT_EQ(plane.status, 0) << plane.err;
  EXPECT_EQ(plane.err.find("another shape"), std::string::npos) << plane.err;
  ASSERT_EQ(fettle({"synth", bracket, "--size", "200x150"}).status, 0);
  const Outcome several = fettle({"fit", bracket});
  EXPECT_EQ(several.status, 0) << several.err;
  EXPECT_NE(several.err.find("so it is another shape, or several"), std::string::npos) << several.err;
}

TEST(FitCommand, FitsBothSidesAndWritesWhatItSays) {
  const TempFolder folder;
  const std::string scan = folder.file("part.asc"), csv = folder.file("fits.csv"),
                    step = folder.file("fits.step"), residuals = folder.file("residuals.asc");
  writePart(scan);
  const auto report = fettleJson({"fit", scan, "--unit", "mm", "--at", "6,2", "--at", "2,2", "--between",
                                  "1,2", "--csv", csv, "--step", step, "--residuals", residuals});
  ASSERT_EQ(report["fits"].size(), 2U);
  EXPECT_EQ(report["fits"][0]["shape"], "plane");
  EXPECT_NEAR(report["fits"][0]["tilt_x_deg"], 30.0, 1e-5);
  const auto& ball = report["fits"][1];
  EXPECT_EQ(ball["shape"], "sphere");
  EXPECT_EQ(ball["hollow"], true);
  EXPECT_NEAR(ball["radius_mm"], 5.0, 1e-5);
  EXPECT_NEAR(ball["point_mm"][2], 6.0, 1e-5);
  EXPECT_TRUE(report["between"]["angle_deg"].is_null());
  // From the plane z = x tan 30 to (2, 2, 6).
  const double turn = std::acos(-1.0) / 6.0;
  EXPECT_NEAR(report["between"]["distance_mm"], 6.0 * std::cos(turn) - 2.0 * std::sin(turn), 1e-5);
  EXPECT_TRUE(
      bytesOf(csv).starts_with("region,shape,figure,value,standard_error,unit,layer\n1,plane,point_x,"));
  const auto left = fettleJson({"info", residuals, "--unit", "mm"});
  EXPECT_EQ(left["no_data"], 50);
  EXPECT_LT(left["max"].get<double>(), 1e-6);
  const Outcome text = fettle({"fit", scan, "--unit", "mm", "--at", "2,2"});
  EXPECT_NE(text.out.find("region 1: hollow sphere, 2000 samples"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("radius              5"), std::string::npos) << text.out;

  // The file is the same each time, and every entity that it refers to is there.
  const std::string first = bytesOf(step);
  EXPECT_EQ(fettle({"fit", scan, "--unit", "mm", "--at", "6,2", "--at", "2,2", "--step", step}).status, 0);
  EXPECT_EQ(bytesOf(step), first);
  EXPECT_TRUE(first.starts_with("ISO-10303-21;") && first.ends_with("END-ISO-10303-21;\n"));
  std::set<std::string> defined, used;
  const std::regex number("#([0-9]+)(=?)");
  for (std::sregex_iterator i(first.begin(), first.end(), number), end; i != end; ++i)
    ((*i)[2].length() > 0 ? defined : used).insert((*i)[1]);
  for (const std::string& one : used) EXPECT_TRUE(defined.contains(one)) << one;
  EXPECT_NE(first.find("PLANE("), std::string::npos);
  EXPECT_NE(first.find("SPHERICAL_SURFACE("), std::string::npos);
}

// Orthogonal distances make the radius of a ball in noise smaller than it is, by more than its standard error here; those along z hardly.
TEST(FitCommand, WarnsOfWhatNoiseMovesOnAverage) {
  const TempFolder folder;
  const std::string scan = folder.file("ball.asc");
  writeNoisy(scan, 0.1, [](double x, double y) { return std::sqrt(36.0 - x * x - y * y); });
  const std::vector<std::string> words{"fit", scan, "--unit", "mm", "--shape", "sphere"};
  const auto ball = fettleJson(words)["fits"][0];
  EXPECT_LT(ball["radius_bias_mm"].get<double>(), -ball["radius_error_mm"].get<double>());
  EXPECT_NEAR(ball["radius_mm"].get<double>() - ball["radius_bias_mm"].get<double>(), 6.0,
              4.0 * ball["radius_error_mm"].get<double>());
  const Outcome text = fettle(words);
  EXPECT_NE(text.err.find("region 1: noise moves the "), std::string::npos) << text.err;
  EXPECT_NE(text.err.find("of its standard error on average"), std::string::npos) << text.err;
  std::vector<std::string> along = words;
  along.insert(along.end(), {"--distance", "vertical"});
  EXPECT_EQ(fettle(along).err.find("noise moves"), std::string::npos);
}

// An axis that is upright but for noise: its z is 1 less half of the square of how far it is turned, which is no motion of the axis.
TEST(FitCommand, DoesNotWarnOfTheLengthOfAnAxis) {
  const TempFolder folder;
  const std::string scan = folder.file("cone.asc");
  writeNoisy(scan, 0.003, [](double x, double y) { return 0.6 * std::hypot(x, y); });
  const Outcome cone = fettle({"fit", scan, "--unit", "mm", "--shape", "cone"});
  EXPECT_EQ(cone.status, 0);
  EXPECT_EQ(cone.err.find("noise moves the axis"), std::string::npos) << cone.err;
}

TEST(FitCommand, SaysWhatItCannotDo) {
  const TempFolder folder;
  const std::string scan = folder.file("part.asc"), out = folder.file("o.csv");
  writePart(scan);
  struct Refusal {
    std::vector<std::string> words;
    const char* text;
  };
  for (const Refusal& one : {Refusal{{"--at", "6,2", "--shape", "cylinder"}, "do not determine"},
                             {{"--at", "4,2"}, "no region holds the place"},
                             {{"--at", "4"}, "is no place"},
                             {{"--shape", "cube"}, "cube"},
                             {{"--margin", "3"}, "no line to keep a margin from"},
                             {{"--between", "1,1"}, "between a fit and itself"},
                             {{"--between", "1,2"}, "region 2 has no fit"},
                             {{"--marks", "m.png"}, "marks choose nothing"},
                             {{"--region", "marked"}, "with a height is marked"},
                             {{"--residuals", scan}, "would replace an input"}}) {
    std::vector<std::string> words{"fit", scan, "--unit", "mm", "--csv", out};
    words.insert(words.end(), one.words.begin(), one.words.end());
    const Outcome outcome = fettle(words);
    EXPECT_EQ(outcome.status, 2) << one.text;
    EXPECT_NE(outcome.err.find(one.text), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << one.text;
  }
}

}  // namespace
}  // namespace fettle::tests
