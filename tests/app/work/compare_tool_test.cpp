#include "app/work/compare_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "app/work/form_tool.h"
#include "engine/formats/formats.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using tests::LoopClientBench;

constexpr int kComparedWide = 120, kComparedHigh = 90;

// Waves on a slope of 30 mm: what a comparison without the slope would see is a thousand times the waves.
double slopedWaves(int c, int r, double shifted = 0.0) {
  return 0.25 * c + 0.03 * std::sin(0.3 * c) * std::cos(0.4 * r) + shifted;
}

engine::Version slopedField(double shifted) {
  return tests::fieldOf(
      kComparedWide, kComparedHigh, [&](int c, int r) { return slopedWaves(c, r, shifted); }, 0.1, 0.1);
}

class CompareToolTest : public ::testing::Test {
 protected:
  CompareToolTest() {
    engine::JobControl job;
    EXPECT_TRUE(engine::exportField(slopedField(0.02), other, {}, job));
  }
  enum class Form : std::uint8_t { kOut, kBack };
  void take(Form step) {
    if (step == Form::kOut)
      form.takeOut(bench.client());
    else
      form.putBack(bench.client());
    ASSERT_TRUE(bench.until([&] {
      (void)form.poll(bench.client(), bench.noticesToFill());
      return !form.busy();
    }));
    ASSERT_TRUE(bench.settled());
  }
  // Until nothing is under way, at the field as it is now.
  bool rest() {
    return bench.until([&] {
      (void)tool.poll(bench.client(), bench.noticesToFill());
      return !tool.busy();
    });
  }
  // Largest difference of the field as it is seen from the other scan, as colours show it.
  double mostSeen() {
    const engine::Version now = bench.client().field();
    const engine::Version* const beside = tool.beside(now);
    if (beside == nullptr) return NAN;
    double most = 0.0;
    for (int r = 0; r < kComparedHigh; ++r)
      for (int c = 0; c < kComparedWide; ++c) {
        float a = 0.0F, b = 0.0F;
        now.reader().readHeights(c, r, 1, 1, &a, 1);
        beside->reader().readHeights(c, r, 1, 1, &b, 1);
        most = std::fmax(most, std::abs(static_cast<double>(a) - static_cast<double>(b)));
      }
    return most;
  }

  tests::TempFolder folder;
  std::string other = folder.file("other.tif");
  LoopClientBench bench{slopedField(0.0)};
  FormTool form;
  CompareTool tool;
};

// Half a unit in the last place of 30 mm, four times: two samples stored, and two seen without the slope.
constexpr double kRounding = 4.0 * 1e-6;

TEST_F(CompareToolTest, a_form_that_is_taken_out_counts_as_it_was_measured) {
  take(Form::kOut);
  ASSERT_NE(bench.client().newest().formOver(), nullptr);
  tool.options.moves = std::nullopt;
  tool.compareWith(bench.client(), other, {});
  ASSERT_TRUE(rest());
  ASSERT_NE(tool.compared(), nullptr);
  EXPECT_NEAR(tool.compared()->rms_mm, 0.02, kRounding);
  EXPECT_NEAR(mostSeen(), 0.02, kRounding);
  EXPECT_EQ(tool.lines().back(), "heights count with the form that was taken out");

  // Aligned, the slope is no tilt between the two.
  tool.options.moves = engine::AlignMoves{.shift = false, .rotation = false, .tilt = true};
  tool.again(bench.client());
  ASSERT_TRUE(rest());
  ASSERT_TRUE(tool.compared()->alignment.has_value());
  EXPECT_NEAR(tool.compared()->alignment->angles.tilt_y, 0.0, 0.01);
  EXPECT_LT(tool.compared()->rms_mm, 1e-4);
  EXPECT_LT(mostSeen(), 1e-3);
}

TEST_F(CompareToolTest, what_cannot_be_aligned_is_named_as_the_window_names_it) {
  // Waves of another length and direction: no place fits.
  std::mt19937 random(7);
  std::normal_distribution<double> height(0.0, 1.0);
  const engine::Version unlike = tests::fieldOf(
      kComparedWide, kComparedHigh, [&](int, int) { return height(random); }, 0.1, 0.1);
  engine::JobControl job;
  const std::string path = folder.file("unlike.tif");
  ASSERT_TRUE(engine::exportField(unlike, path, {}, job));
  tool.compareWith(bench.client(), path, {});
  ASSERT_TRUE(rest());
  ASSERT_EQ(bench.notices().size(), 1U);
  const Notice& notice = bench.notices().front();
  const std::string said = notice.what + "|" + notice.remedy;
  EXPECT_EQ(said.find(" A "), std::string::npos) << said;
  EXPECT_EQ(said.find(" B"), std::string::npos) << said;
  EXPECT_EQ(said.find("--"), std::string::npos) << said;
  EXPECT_NE(said.find("a turn by more than 10 degrees is not looked for here"), std::string::npos) << said;
}

TEST_F(CompareToolTest, a_file_is_said_to_be_read_before_it_is_compared) {
  // So large that it is not read when compareWith() has returned.
  const engine::Version large = tests::fieldOf(
      3000, 2000, [](int c, int r) { return slopedWaves(c, r); }, 0.1, 0.1);
  engine::JobControl job;
  const std::string path = folder.file("large.tif");
  ASSERT_TRUE(engine::exportField(large, path, {}, job));
  tool.options.moves = std::nullopt;
  tool.compareWith(bench.client(), path, {});
  EXPECT_EQ(tool.doing(), "reading large.tif");
  std::string last;
  ASSERT_TRUE(bench.until([&] {
    (void)tool.poll(bench.client(), bench.noticesToFill());
    if (tool.busy()) last = tool.doing();
    return !tool.busy();
  }));
  EXPECT_EQ(last, "comparing");
  ASSERT_NE(tool.compared(), nullptr);
}

TEST_F(CompareToolTest, the_other_scan_follows_a_form_that_goes_and_comes) {
  tool.options.moves = std::nullopt;
  tool.compareWith(bench.client(), other, {});
  ASSERT_TRUE(rest());
  EXPECT_NEAR(mostSeen(), 0.02, kRounding);
  for (const Form step : {Form::kOut, Form::kBack}) {
    take(step);
    EXPECT_EQ(tool.beside(bench.client().field()), nullptr) << "of another form";
    (void)tool.poll(bench.client(), bench.noticesToFill());
    ASSERT_TRUE(rest());
    EXPECT_NEAR(mostSeen(), 0.02, kRounding);
    (void)tool.poll(bench.client(), bench.noticesToFill());
    EXPECT_FALSE(tool.outdated()) << "the heights are those that were compared";
    EXPECT_NEAR(tool.compared()->rms_mm, 0.02, kRounding);
  }
  EXPECT_TRUE(bench.notices().empty());
}

// A mesh of the same part, 0.02 mm above it: as `fettle compare` has it.
TEST_F(CompareToolTest, a_nominal_mesh_is_compared_as_a_scan) {
  const std::string mesh = folder.file("nominal.stl");
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(slopedField(0.02), mesh, {}, job));
  tool.options.moves = std::nullopt;
  tool.options.nominal.tolerance = 0.01;
  tool.compareWith(bench.client(), mesh, {});
  ASSERT_TRUE(rest());
  ASSERT_NE(tool.compared(), nullptr) << (bench.notices().empty() ? "" : bench.notices().back().what);
  // Of the corners of the mesh, which are samples; an STL rounds them to float as well.
  EXPECT_NEAR(tool.compared()->mean_mm, -0.02, kRounding);
  EXPECT_NEAR(mostSeen(), 0.02, 2.0 * kRounding);
  ASSERT_TRUE(tool.compared()->tolerated);
  EXPECT_EQ(tool.compared()->tolerated->at(0), 0);
  EXPECT_EQ(tool.compared()->tolerated->at(2), tool.compared()->samples) << "all lie below it";
  EXPECT_FALSE(tool.outdated());

  tool.options.nominal.tolerance = 0.03;
  tool.options.nominal.shortest = true;
  tool.again(bench.client());
  ASSERT_TRUE(rest());
  // On a slope of 2.5 the nearest place is nearer than the one above.
  EXPECT_LT(tool.compared()->most_mm, 0.02);
  EXPECT_EQ(tool.compared()->tolerated->at(0), tool.compared()->samples);
}

// Pads every 2 mm, each scan with noise of its own: the lines say that the other scan fits a period further.
TEST_F(CompareToolTest, a_surface_that_repeats_itself_is_said_to_fit_a_period_further) {
  const auto pads = [](unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, 0.002);
    return tests::fieldOf(
        kComparedWide, kComparedHigh,
        [&](int c, int r) {
          return 0.02 * std::sin(0.1 * std::numbers::pi * c) + 0.02 * std::sin(0.1 * std::numbers::pi * r) +
                 normal(random);
        },
        0.1, 0.1);
  };
  engine::JobControl job;
  const std::string path = folder.file("pads.tif");
  ASSERT_TRUE(engine::exportField(pads(2), path, {}, job));
  LoopClientBench over{pads(1)};
  tool.compareWith(over.client(), path, {});
  ASSERT_TRUE(over.until([&] {
    (void)tool.poll(over.client(), over.noticesToFill());
    return !tool.busy();
  }));
  ASSERT_NE(tool.compared(), nullptr) << (over.notices().empty() ? "" : over.notices().back().what);
  const auto says = [](const std::string& line) {
    return line.find("the surface repeats itself every ") != std::string::npos;
  };
  EXPECT_EQ(std::ranges::count_if(tool.lines(), says), 1);
  ASSERT_TRUE(tool.compared()->alignment->repeat);
  EXPECT_NEAR(std::hypot(tool.compared()->alignment->repeat->x, tool.compared()->alignment->repeat->y), 2.0,
              0.02);
  tool.clear();
}

}  // namespace
}  // namespace fettle::app
