// fettle level --through: the plane through three places, as heights, as a layer, as a step of recipes and sessions.

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A plate that rises by 1 in 50 along x and falls by 1 in 100 along y, with a block on it, and a hole where a point will be.
std::string plateGrid() {
  std::ostringstream text;
  text.precision(10);
  text << "ncols 120\nnrows 90\nxllcorner 500000\nyllcorner 500000\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = 89; r >= 0; --r)
    for (int c = 0; c < 120; ++c) {
      const double x = 0.1 * c, y = 0.1 * r, off = ((c * 7 + r * 5) % 13 - 6) * 1e-4;
      const bool block = c > 40 && c < 90 && r > 30 && r < 70;
      if (c == 10 && r == 10)
        text << -9999;
      else
        text << 0.02 * x - 0.01 * y + off + (block ? 1.0 : 0.0);
      text << (c < 119 ? ' ' : '\n');
    }
  return text.str();
}

constexpr const char* kThrough = "1,1:11,1.5:6,8.2";  // beside the block

class ThreePoints : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.file("plate.asc")) << plateGrid();
    const Outcome made = fettle({"convert", folder_.file("plate.asc"), scan_, "--unit", "mm"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  std::string file(const char* name) { return folder_.file(name); }

  const TempFolder folder_;
  const std::string scan_ = folder_.file("plate.tif");
};

double degreesOf(double slope) {
  return std::atan(slope) * 180.0 / std::numbers::pi;
}

TEST_F(ThreePoints, LevelThePlateUnderABlock) {
  const auto level = fettleJson({"level", scan_, file("level.tif"), "--through", kThrough});
  EXPECT_EQ(level["form"], "plane");
  for (const auto& [key, slope] : {std::pair("tilt_x", 0.02), {"tilt_y", -0.01}}) {
    const double error = level[std::string(key) + "_error"];
    EXPECT_NEAR(level[key].get<double>(), degreesOf(slope), 4.0 * error) << key;
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, 0.001);
  }
  ASSERT_EQ(level["through"].size(), 3U);
  EXPECT_EQ(level["through"][0]["samples"], 80);  // 81 within five samples, one is a hole
  EXPECT_EQ(level["through"][1]["samples"], 81);
  EXPECT_NEAR(level["through"][1]["height"].get<double>(), 0.02 * 11.0 - 0.01 * 1.5, 1e-4);
  EXPECT_EQ(level["samples"], 80 + 81 + 81);
  // The plane that is nearest to all samples leans on the block.
  const auto nearest = fettleJson({"level", scan_, file("all.tif")});
  EXPECT_GT(std::abs(nearest["tilt_y"].get<double>() - degreesOf(-0.01)), 0.05);
  // What is left is the block on a level plate; parameters about the same plane.
  const auto at = fettleJson({"info", file("level.tif"), "--at", "89,0", "--at", "0,119", "--at", "40,60"});
  EXPECT_NEAR(at["at"][0]["height"].get<double>(), 0.0, 0.002);
  EXPECT_NEAR(at["at"][1]["height"].get<double>(), 0.0, 0.002);
  EXPECT_NEAR(at["at"][2]["height"].get<double>(), 1.0, 0.002);
  const auto measured = fettleJson({"measure", scan_, "--through", kThrough, "--only", "height"});
  EXPECT_EQ(measured["tilt_x"], level["tilt_x"]);
  EXPECT_NEAR(measured["sz"].get<double>(), 1.0, 0.01);
  // Another radius is another mean.
  const auto small = fettleJson({"level", scan_, file("small.tif"), "--through", kThrough, "--probe", "0.1"});
  EXPECT_EQ(small["through"][1]["samples"], 5);
  EXPECT_GT(small["tilt_x_error"].get<double>(), level["tilt_x_error"].get<double>());
  const auto one =
      fettleJson({"level", scan_, file("one.tif"), "--through", "1.1,1:11,1.5:6,8.2", "--probe", "0.05"});
  EXPECT_TRUE(one["tilt_x_error"].is_null());
}

TEST_F(ThreePoints, AsALayerGoInAndOutAndBakeToTheSameHeights) {
  const auto level =
      fettleJson({"level", scan_, file("level.fettle"), "--through", kThrough, "--probe", "0.4"});
  const auto put = fettleJson(
      {"level", scan_, file("a.fettle"), "--layer", "put", "--through", kThrough, "--probe", "0.4"});
  EXPECT_EQ(put["tilt_x"], level["tilt_x"]);
  EXPECT_EQ(fettleJson({"info", file("a.fettle")})["form"], "plane");
  EXPECT_EQ(fettleJson({"level", file("a.fettle"), file("baked.tif"), "--layer", "bake"})["hash"],
            level["hash"]);
  const auto hash = fettleJson({"level", file("a.fettle"), file("b.fettle"), "--layer", "remove"})["hash"];
  EXPECT_EQ(hash, fettleJson({"convert", scan_, file("copy.tif")})["hash"]);
  // A recipe of either does the same again, and is read as it is written.
  for (const char* session : {"a.fettle", "level.fettle"}) {
    const Outcome recipe = fettle({"recipe", file(session)});
    ASSERT_EQ(recipe.status, 0) << recipe.err;
    EXPECT_NE(recipe.out.find("through = [[1, 1], [11, 1.5], [6, 8.2]]  # mm\nprobe = 0.4"),
              std::string::npos)
        << recipe.out;
    std::ofstream(file("again.toml")) << recipe.out;
    const auto again = fettleJson({"apply", file("again.toml"), scan_, file("again.fettle"), "--force"});
    EXPECT_EQ(again["steps"][0]["tilt_x"], level["tilt_x"]) << session;
    EXPECT_EQ(again["steps"][0]["through"], level["through"]) << session;
    const Outcome printed = fettle({"recipe", file("again.fettle")});
    EXPECT_EQ(printed.out, recipe.out);
    const auto baked = fettleJson({"convert", file("again.fettle"), file("seen.fettle"), "--force"});
    EXPECT_EQ(baked["hash"], fettleJson({"convert", file(session), file("seen2.fettle"), "--force"})["hash"]);
  }
}

TEST_F(ThreePoints, ThatSayNothingAreRefused) {
  const auto refused = [&](std::vector<std::string> more, const std::string& part) {
    std::vector<std::string> arguments{"level", scan_, file("x.tif")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expectRefused(fettle(arguments), part);
  };
  refused({"--through", "1,1:5,5"}, "is not three points");
  refused({"--through", "1,1:5,5:here"}, "is not three points");
  refused({"--through", "1,1:5,5:9,9"}, "the three points lie nearly on a line");
  refused({"--through", "1,1:5,5:9,90"}, "no sample counts within 0.5 mm of 9,90");
  refused({"--through", "1,1:11,1:1,1", "--probe", "0.2"}, "nearly on a line");
  refused({"--through", kThrough, "--form", "poly2"}, "three points are those of a plane");
  refused({"--through", kThrough, "--robust"}, "around three points all samples count");
  refused({"--through", kThrough, "--region", "marked"}, "with a height is marked");
  refused({"--probe", "1"}, "there are no points around which samples would count");
  std::ofstream(file("bad.toml")) << "recipe = 1\n[[step]]\ndo = \"level\"\nthrough = [[1, 1], [2, 2]]\n";
  expectRefused(fettle({"apply", file("bad.toml"), scan_, file("x.tif")}),
                "line 4: through is not a list of three points");
  std::ofstream(file("bad.toml")) << "recipe = 1\n[[step]]\ndo = \"level\"\nprobe = 1\n";
  expectRefused(fettle({"apply", file("bad.toml"), scan_, file("x.tif")}),
                "line 4: probe is that of three points");
  std::ofstream(file("bad.toml"))
      << "recipe = 1\n[[step]]\ndo = \"level\"\nrobust = true\nthrough = [[1, 1], [2, 2], [1, 5]]\n";
  expectRefused(fettle({"apply", file("bad.toml"), scan_, file("x.tif")}),
                "line 5: through is that of a plane which is not robust");
}

}  // namespace
}  // namespace fettle::tests
