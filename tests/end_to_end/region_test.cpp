// --region by coordinates, the same for all commands that have it.

#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/vec2.hpp>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

constexpr int kWide = 90, kHigh = 40;
constexpr double kAlongX = 0.1, kAlongY = 0.4, kOrigin = 5e6;

double wavy(int c, int r) {
  return 0.2 * std::sin(0.3 * c) + 0.1 * std::cos(0.5 * r) + 0.01 * std::sin(12.9898 * c + 78.233 * r);
}

bool isHole(int c, int r) {
  return (3 * c + 5 * r) % 17 == 0;
}

// Samples 0.1 mm apart along x and 0.4 along y, the lower left one at 5e6, 5e6, with a hole in every 17th.
void writeScan(const std::string& path, const std::function<double(int, int)>& z) {
  std::ofstream out(path);
  out << fmt::format("ncols {}\nnrows {}\nxllcenter {}\nyllcenter {}\ndx {}\ndy {}\nNODATA_value -9999\n",
                     kWide, kHigh, kOrigin, kOrigin, kAlongX, kAlongY);
  for (int r = kHigh - 1; r >= 0; --r) {
    for (int c = 0; c < kWide; ++c) out << fmt::format("{:.9g} ", isHole(c, r) ? -9999.0 : z(c, r));
    out << '\n';
  }
}

using Inside = std::function<bool(double, double)>;

int samplesIn(const Inside& inside) {
  int count = 0;
  for (int r = 0; r < kHigh; ++r)
    for (int c = 0; c < kWide; ++c) count += !isHole(c, r) && inside(c * kAlongX, r * kAlongY);
  return count;
}

// Both name the same samples: x 1 to 4 mm, y 2 to 8 mm; of the polygon corners lie between samples, where no rule of sides
// decides.
const Inside kInside = [](double x, double y) { return x > 0.95 && x < 4.05 && y > 1.9 && y < 8.1; };
const std::vector<std::string> kSameRegions = {
    "rectangle 1,2,4,8",
    "rectangle 4,8,1,2",
    "polygon 0.95,1.9 4.05,1.9 4.05,8.1 0.95,8.1",
    "polygon  0.95,8.1 4.05,8.1  4.05,1.9 0.95,1.9 ",
    "world-rectangle 5000001,5000002,5000004,5000008",
    "world-polygon 5000000.95,5000001.9 5000004.05,5000001.9 5000004.05,5000008.1 5000000.95,5000008.1",
    "rectangle 1mm,0.2cm,4000um,8",
    "polygon 950um,1.9mm 4.05mm,1.9 4.05,8.1 0.095cm,8.1mm",
    "world-rectangle 5.000001km,5000002,5000004mm,5000.008m"};

class RegionOption : public testing::Test {
 protected:
  RegionOption() { writeScan(scan_, wavy); }

  nlohmann::json run(std::vector<std::string> line) const {
    line.insert(line.end(), {"--unit", "mm"});
    return fettleJson(line);
  }

  TempFolder folder_;
  const std::string scan_ = folder_.file("scan.asc"), out_ = folder_.file("out.tif");
};

TEST_F(RegionOption, ShapesHaveTheSamplesOfTheirCoordinates) {
  const int samples = samplesIn(kInside);
  ASSERT_GT(samples, 400);
  const auto first =
      run({"measure", scan_, "--only", "height", "--noise-trials", "0", "--region", kSameRegions.front()});
  EXPECT_EQ(first["samples"], samples);
  EXPECT_EQ(first["region"], kSameRegions.front());
  for (const std::string& region : kSameRegions) {
    const auto same = run({"measure", scan_, "--only", "height", "--noise-trials", "0", "--region", region});
    EXPECT_EQ(same["samples"], samples) << region;
    EXPECT_EQ(same["sq"], first["sq"]) << region;
  }
  // A triangle, by hand: what lies below the diagonal.
  const auto below = run({"measure", scan_, "--only", "height", "--noise-trials", "0", "--region",
                          "polygon -0.03,-0.2 8.97,-0.2 8.97,35.8"});
  EXPECT_EQ(below["samples"],
            samplesIn([](double x, double y) { return y + 0.2 < (x + 0.03) * 36.0 / 9.0; }));
}

TEST_F(RegionOption, EveryCommandTakesIt) {
  const int samples = samplesIn(kInside);
  for (const std::string& region : {kSameRegions[0], kSameRegions[2], kSameRegions[4]}) {
    EXPECT_EQ(run({"level", scan_, out_, "--form", "poly2", "--region", region})["samples"], samples);
    EXPECT_EQ(run({"level", scan_, folder_.file(region.substr(0, 8) + ".fettle"), "--layer", "put",
                   "--region", region})["samples"],
              samples);
    EXPECT_EQ(run({"fit", scan_, "--shape", "plane", "--region", region})["fits"][0]["samples"], samples);
    EXPECT_EQ(run({"remove", scan_, out_, "--region", region})["removed"], samples);
    EXPECT_EQ(run({"mark", scan_, folder_.file("m.png"), "--region", region})["marked"], samples);
    EXPECT_EQ(run({"compare", scan_, scan_, "--region", region})["samples"], samples);
    EXPECT_EQ(run({"features", scan_, "--region", region})["region"], region);
    // A section through it: heights inside, none outside.
    const auto section = run({"section", scan_, "--start", "0,4", "--end", "8.9,4", "--interpolation",
                              "nearest", "--region", region})["sections"][0];
    const int places = section["places"], without = section["without_height"];
    EXPECT_EQ(places - without,
              samplesIn([](double x, double y) { return kInside(x, y) && std::abs(y - 4.0) < 0.1; }))
        << region;
    const Outcome report =
        fettle({"report", scan_, folder_.file("r.html"), "--region", region, "--unit", "mm"});
    EXPECT_EQ(report.status, 0) << report.err;
  }
}

// A motion is decided by more than the samples of these.
TEST_F(RegionOption, AlignsByWhatLiesInIt) {
  const std::string half = "rectangle 0,0,8.9,8";
  const int by_all = run({"align", scan_, scan_, "--moves", "level"})["samples"],
            by_half = run({"align", scan_, scan_, "--moves", "level", "--region", half})["samples"];
  EXPECT_GT(by_half, 100);
  EXPECT_LT(by_half, 0.7 * by_all);
}

TEST_F(RegionOption, MarksOfTheScanStay) {
  const std::string session = folder_.file("s.fettle"), marks = folder_.file("m.png"),
                    removed = folder_.file("removed.fettle");
  run({"mark", scan_, marks, "--region", "rectangle 0,0,2,4"});
  const int marked = samplesIn([](double x, double y) { return x < 2.05 && y < 4.1; });
  EXPECT_EQ(run({"remove", scan_, session, "--marks", marks, "--above", "1e6"})["removed"], 0);
  const auto markedIn = [](const std::string& path) {
    return fettleJson(
        {"measure", path, "--only", "height", "--noise-trials", "0", "--region", "marked"})["samples"];
  };
  EXPECT_EQ(markedIn(session), marked);
  // Samples of a shape go, marked or not, and the other marks stay.
  const int gone = samplesIn([](double x, double y) { return x < 1.05 && y < 20.1; });
  EXPECT_EQ(fettleJson({"remove", session, removed, "--region", "rectangle 0,0,1,20"})["removed"], gone);
  EXPECT_EQ(markedIn(removed), samplesIn([](double x, double y) { return x > 1.05 && x < 2.05 && y < 4.1; }));
}

TEST_F(RegionOption, ComparesInsideAlone) {
  const std::string other = folder_.file("b.asc"), deviation = folder_.file("d.tif");
  // 1 higher inside, 5 higher outside.
  writeScan(other, [](int c, int r) { return wavy(c, r) + (kInside(c * kAlongX, r * kAlongY) ? 1.0 : 5.0); });
  const auto all = run({"compare", scan_, other});
  EXPECT_NEAR(all["max_abs"], 5.0, 1e-5);
  EXPECT_FALSE(all.contains("region"));
  const auto inside =
      run({"compare", scan_, other, "--region", kSameRegions[0], "--deviation", deviation, "--truth", scan_});
  EXPECT_NEAR(inside["max_abs"], 1.0, 1e-5);
  EXPECT_NEAR(inside["rmse"], 1.0, 1e-5);
  EXPECT_EQ(inside["only_a"], 0);
  EXPECT_EQ(inside["only_b"], 0);
  EXPECT_EQ(inside["region"], kSameRegions[0]);
  const auto written = fettleJson({"info", deviation});
  EXPECT_EQ(written["no_data"], kWide * kHigh - samplesIn(kInside));
  EXPECT_NEAR(written["max"], 1.0, 1e-5);
  const std::string marks = folder_.file("m.png");
  run({"mark", scan_, marks, "--region", kSameRegions[0]});
  EXPECT_EQ(run({"compare", scan_, other, "--region", "marked", "--marks", marks})["mean"], inside["mean"]);
  EXPECT_NEAR(run({"compare", scan_, other, "--region", "unmarked", "--marks", marks})["mean"], 5.0, 1e-5);
  // Aligned by one region, compared in another.
  const std::string half = "rectangle 0,0,8.9,8";
  const auto aligned =
      run({"compare", scan_, scan_, "--align", "level", "--align-region", half, "--region", kSameRegions[0]});
  EXPECT_EQ(aligned["align"]["region"], half);
  EXPECT_EQ(aligned["region"], kSameRegions[0]);
  EXPECT_LT(aligned["max_abs"], 1e-6);
  expectRefused(
      fettle({"compare", scan_, other, "--align", "level", "--region", kSameRegions[0], "--unit", "mm"}),
      "by which samples");
}

TEST_F(RegionOption, FilledSamplesAreNoMeasuredOnes) {
  const std::string session = folder_.file("filled.fettle");
  ASSERT_EQ(fettle({"fill", scan_, session, "--border", "--unit", "mm"}).status, 0);
  const int samples = samplesIn([](double, double) { return true; });
  const std::vector<std::string> measured{"--region", "measured"};
  const auto with = [&](std::vector<std::string> line) {
    line.insert(line.end(), measured.begin(), measured.end());
    return fettleJson(line);
  };
  EXPECT_EQ(fettleJson({"fit", session, "--shape", "plane"})["fits"][0]["samples"], kWide * kHigh);
  EXPECT_EQ(with({"fit", session, "--shape", "plane"})["fits"][0]["samples"], samples);
  EXPECT_EQ(with({"compare", session, session})["samples"], samples);
  EXPECT_LT(with({"align", session, session})["samples"], fettleJson({"align", session, session})["samples"]);
  const auto section = with(
      {"section", session, "--start", "0,4", "--end", "8.9,4", "--interpolation", "nearest"})["sections"][0];
  EXPECT_EQ(section["without_height"],
            kWide - samplesIn([](double, double y) { return std::abs(y - 4.0) < 0.1; }));
  for (const char* command : {"fit", "section"})
    expectRefused(fettle(command == std::string("fit")
                             ? std::vector<std::string>{"fit", scan_, "--region", "measured", "--unit", "mm"}
                             : std::vector<std::string>{"section", scan_, "--start", "0,4", "--end", "8,4",
                                                        "--region", "measured", "--unit", "mm"}),
                  "which samples were filled");
}

TEST_F(RegionOption, RecipesHaveIt) {
  const std::string session = folder_.file("work.fettle"), recipe = folder_.file("r.toml"),
                    by_recipe = folder_.file("by.tif"), by_hand = folder_.file("hand.tif");
  run({"level", scan_, session, "--region", kSameRegions[0]});
  const Outcome written = fettle({"recipe", session});
  ASSERT_EQ(written.status, 0) << written.err;
  std::ofstream(recipe) << written.out;
  const auto applied = run({"apply", recipe, scan_, by_recipe});
  const auto level = run({"level", scan_, by_hand, "--region", kSameRegions[0]});
  EXPECT_EQ(applied["hash"], level["hash"]);
  std::ofstream(recipe) << "recipe = 1\n\n[[step]]\ndo = \"remove\"\nregion = \"rectangle 1,2\"\n";
  expectRefused(fettle({"apply", recipe, scan_, by_recipe, "--unit", "mm"}), "two corners");
}

TEST_F(RegionOption, SaysWhatIsNoRegion) {
  struct NoRegion {
    std::string region, text;
  };
  for (const NoRegion& one : std::vector<NoRegion>{
           {"rectangel 1,2,3,4", "rectangle"},
           {"rectangle", "two corners"},
           {"rectangle 1,2,3", "two corners"},
           {"rectangle 1,2,3,4 5,6,7,8", "two corners"},
           {"rectangle 1,2,3,nan", "two corners"},
           {"polygon 1,2 3,4", "three corners"},
           {"polygon 1,2 3,4 five,6", "three corners"},
           {"polygon 1,2 3,2 5,2", "no area"},
           {"all 1,2", "no coordinates"},
           {"rectangle -5,-5,-1,-1", "the scan is from 0,0 to 8.9,15.6 mm"},
           {"rectangle 1.01,2,1.09,8", "no sample"},
           {"polygon 1.01,2 1.09,2 1.05,8", "no sample"},
           {"polygon 1,2 1e9,2 1,8", "samples away"},
           {"world-rectangle 1,2,4,8", "the scan is from 5000000,5000000 to 5000008.9,5000015.6 mm"},
           // A hole alone.
           {"rectangle 0,0,0,0", "no sample"}}) {
    for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
             {"measure", scan_, "--region", one.region, "--unit", "mm"},
             {"compare", scan_, scan_, "--region", one.region, "--unit", "mm"},
             {"section", scan_, "--start", "0,1", "--end", "8,1", "--region", one.region, "--unit", "mm"}}) {
      const Outcome outcome = fettle(line);
      EXPECT_EQ(outcome.status, 2) << one.region;
      EXPECT_NE(outcome.err.find(one.text), std::string::npos) << one.region << ": " << outcome.err;
      EXPECT_NE(outcome.err.find("--region"), std::string::npos) << one.region << ": " << outcome.err;
    }
  }
  expectRefused(fettle({"measure", scan_, "--region", kSameRegions[0], "--marks", "m.png", "--unit", "mm"}),
                "marks choose nothing");
  expectRefused(fettle({"remove", scan_, out_, "--region", "measured", "--unit", "mm"}), "is not one of");
}

// "Take a larger region" helps nobody who has marked nothing.
TEST_F(RegionOption, WhereNothingIsMarkedEveryCommandSaysSoAndHowToMark) {
  const std::string all = folder_.file("all.png"), none = folder_.file("none.png"),
                    page = folder_.file("r.html");
  run({"mark", scan_, all, "--invert"});
  run({"mark", scan_, none, "--add", all, "--invert"});
  const std::vector<std::vector<std::string>> commands = {
      {"level", scan_, out_},
      {"level", scan_, out_, "--form", "none", "--rows", "median"},
      {"level", scan_, folder_.file("o.fettle"), "--layer", "put"},
      {"fit", scan_},
      {"measure", scan_},
      {"features", scan_},
      {"report", scan_, page},
      {"section", scan_, "--start", "0,4", "--end", "8.9,4"},
      {"align", scan_, scan_},
      {"compare", scan_, scan_}};
  for (std::vector<std::string> line : commands) {
    const std::string name = line[0];
    line.insert(line.end(), {"--unit", "mm", "--region", "marked"});
    Outcome outcome = fettle(line);
    expectRefused(outcome, "no sample of " + scan_ + " with a height is marked, --region marked, ");
    for (const char* part : {"fettle mark", "--marks", "in the window", "--region all"})
      EXPECT_NE(outcome.err.find(part), std::string::npos) << name << ": " << outcome.err;
    line.insert(line.end(), {"--marks", none});
    outcome = fettle(line);
    EXPECT_EQ(outcome.status, 2) << name;
    EXPECT_NE(outcome.err.find("is marked in " + none), std::string::npos) << name << ": " << outcome.err;
    line[line.size() - 3] = "unmarked";
    line.back() = all;
    outcome = fettle(line);
    EXPECT_EQ(outcome.status, 2) << name;
    EXPECT_NE(outcome.err.find("every sample of " + scan_ + " with a height is marked in " + all),
              std::string::npos)
        << name << ": " << outcome.err;
    // And with marks that hold something nothing is refused.
    line[line.size() - 3] = "marked";
    EXPECT_EQ(fettle(line).status, 0) << name;
  }
  const Outcome aligned =
      fettle({"compare", scan_, scan_, "--unit", "mm", "--align", "all", "--align-region", "marked"});
  EXPECT_NE(aligned.err.find("with a height is marked, --align-region marked"), std::string::npos)
      << aligned.err;
  EXPECT_NE(aligned.err.find("--align-marks"), std::string::npos) << aligned.err;
}

// A hole in its middle does not matter, holes alone do: nothing of them could be marked.
TEST_F(RegionOption, MarksWhatHasAHeightAroundAHole) {
  // Column 13, row 16 is a hole, and every sample beside it has a height.
  ASSERT_TRUE(isHole(13, 16));
  const Inside around = [](double x, double y) { return x > 1.15 && x < 1.45 && y > 5.9 && y < 6.9; };
  EXPECT_EQ(samplesIn(around), 8);
  for (const char* region : {"rectangle 1.2,6,1.4,6.8", "polygon 1.15,5.9 1.45,5.9 1.45,6.9 1.15,6.9"})
    EXPECT_EQ(run({"mark", scan_, folder_.file("m.png"), "--region", region})["marked"], 8) << region;
  const Outcome alone = fettle(
      {"mark", scan_, folder_.file("n.png"), "--region", "rectangle 1.26,6.3,1.34,6.5", "--unit", "mm"});
  EXPECT_EQ(alone.status, 2);
  EXPECT_NE(alone.err.find("with a height lies in"), std::string::npos) << alone.err;
}

}  // namespace
}  // namespace fettle::tests
