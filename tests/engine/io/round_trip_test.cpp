#include <bit>
#include <cfloat>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// Any float but infinities: every exponent, denormals, both zeros, holes; what files often declare as no data.
std::vector<float> anyFloats(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values;
  for (const float v : {0.0F, -0.0F, FLT_MIN, FLT_TRUE_MIN, -FLT_TRUE_MIN, FLT_MAX, -FLT_MAX, kNan, 1e6F,
                        -9999.0F, -1.0F, 999.0F, 0.1F, 16777217.0F})
    values.push_back(v);
  while (values.size() < count) {
    const float v = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    values.push_back(std::isfinite(v) ? v : kNan);
  }
  values.resize(count);
  return values;
}

void expectSameBits(const Version& a, const Version& b) {
  ASSERT_EQ(a.grid().width, b.grid().width);
  ASSERT_EQ(a.grid().height, b.grid().height);
  const auto x = heightsOf(a);
  const auto y = heightsOf(b);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]))
      ASSERT_TRUE(std::isnan(y[i])) << i;
    else
      ASSERT_EQ(std::bit_cast<std::uint32_t>(x[i]), std::bit_cast<std::uint32_t>(y[i])) << i << ": " << x[i];
  }
}

class Lossless : public ::testing::TestWithParam<const char*> {};

TEST_P(Lossless, EveryFloatComesBackBitForBit) {
  const TempFolder folder;
  for (const auto& [w, h] : {std::pair{300, 517}, {1, 40}, {40, 1}, {64, 64}, {513, 300}}) {
    const Version field = makeField(gridOf(w, h), anyFloats(static_cast<std::size_t>(w) * h, 7));
    const std::string path = folder.file(std::string("out") + GetParam());
    const auto written = save(field, path);
    ASSERT_TRUE(written) << written.error().line();
    FETTLE_LOAD(again, path);
    expectSameBits(field, again.field);
  }
}

TEST_P(Lossless, ReadingSaysHowMuchThereIsToDoAndEndsWithAllOfIt) {
  const TempFolder folder;
  const std::string path = folder.file(std::string("long") + GetParam());
  ASSERT_TRUE(save(makeField(gridOf(70, 150), std::vector<float>(70 * 150, 1.5F)), path));
  JobControl job;
  ASSERT_TRUE(importField(path, {}, job));
  EXPECT_EQ(job.stage(), std::string("reading"));
  EXPECT_GT(job.total(), 0U);
  EXPECT_EQ(job.done(), job.total());
}

TEST_P(Lossless, ASingleSampleComesBack) {
  const TempFolder folder;
  const std::string path = folder.file(std::string("one") + GetParam());
  ASSERT_TRUE(save(makeField(gridOf(1, 1), {-12.75F}), path));
  FETTLE_LOAD(again, path);
  EXPECT_EQ(again.field.reader().heightAt(0, 0), -12.75F);
}

TEST_P(Lossless, AnInvertedFieldIsWrittenUpsideDown) {
  const TempFolder folder;
  const std::string path = folder.file(std::string("down") + GetParam());
  ASSERT_TRUE(save(makeField(gridOf(2, 1), {1.5F, kNan}).inverted(), path));
  FETTLE_LOAD(again, path);
  EXPECT_EQ(again.field.reader().heightAt(0, 0), -1.5F);
  EXPECT_TRUE(std::isnan(again.field.reader().heightAt(1, 0)));
}

TEST_P(Lossless, OriginsAndSpacingsKeepEveryDigit) {
  const TempFolder folder;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> far(-6e6, 6e6);
  std::uniform_real_distribution<double> near(-1.0, 1.0);
  std::uniform_real_distribution<double> step(1e-4, 30.0);
  for (int i = 0; i < 60; ++i) {
    Grid grid = gridOf(1 + i % 7, 1 + i % 50);
    grid.spacing_x = step(random);
    grid.spacing_y = i % 3 == 0 ? grid.spacing_x : step(random);
    grid.origin_x = i % 2 == 0 ? far(random) : near(random);
    grid.origin_y = i % 2 == 0 ? far(random) : near(random);
    const std::string path = folder.file(std::string("at") + GetParam());
    ASSERT_TRUE(
        save(makeField(grid, std::vector<float>(static_cast<std::size_t>(grid.samples()), 1.0F)), path));
    FETTLE_LOAD(again, path);
    EXPECT_EQ(again.field.grid().spacing_x, grid.spacing_x);
    EXPECT_EQ(again.field.grid().spacing_y, grid.spacing_y);
    EXPECT_EQ(again.field.grid().origin_x, grid.origin_x);
    EXPECT_EQ(again.field.grid().origin_y, grid.origin_y);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Lossless, ::testing::Values(".tif", ".asc", ".x3p", ".exr"));

TEST(RoundTrip, CoordinatesOfFilesComeBackDigitByDigit) {
  // What files hold: corners with few digits. Read, written and read again nothing may move.
  const TempFolder folder;
  for (const auto& [x, y, s] : {std::tuple{500000.0, 5400000.0, 0.25},
                                {-336531.6453, -1189032.1189, 1.0},
                                {73410.0, 451653.5, 0.5},
                                {0.1, -0.3, 0.024},
                                {11.123456789, 48.987654321, 1.0 / 3600.0}}) {
    Grid grid = gridOf(20, 333);
    grid.spacing_x = grid.spacing_y = s;
    grid.origin_x = x + 0.5 * s;
    grid.origin_y = y + (grid.height - 0.5) * -s;
    const std::string path = folder.file("digits.tif");
    ASSERT_TRUE(save(makeField(grid, std::vector<float>(20 * 333, 2.0F)), path));
    FETTLE_LOAD(again, path);
    EXPECT_EQ(again.field.grid().origin_x, grid.origin_x);
    EXPECT_EQ(again.field.grid().origin_y, grid.origin_y);
  }
}

TEST(RoundTrip, ARasterThatWasMovedSinceStaysWhereItWasMovedTo) {
  const TempFolder folder;
  Grid grid = gridOf(3, 2);
  grid.origin_x = 1e-17;  // no corner leads there
  ASSERT_TRUE(save(makeField(grid, {1, 2, 3, 4, 5, 6}), folder.file("a.tif")));
  std::string bytes = readBytes(folder.file("a.tif"));
  FETTLE_LOAD(kept, folder.file("a.tif"));
  EXPECT_EQ(kept.field.grid().origin_x, 1e-17);
  const std::size_t at = bytes.find("1e-17 0");
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 7, "1e-03 0");
  writeBytes(folder.file("b.tif"), bytes);
  FETTLE_LOAD(moved, folder.file("b.tif"));
  EXPECT_EQ(moved.field.grid().origin_x, 0.0);
}

TEST(RoundTrip, UnitsAndCountsComeBack) {
  const TempFolder folder;
  Grid grid = gridOf(3, 2);
  grid.lateral_unit = {"um", 1e-3};
  grid.height_unit = {"nm", 1e-6};
  grid.height_per_count = 0.02;
  for (const char* name : {"units.tif", "units.x3p", "units.exr"}) {
    ASSERT_TRUE(save(makeField(grid, {1, 2, 3, 4, 5, 6}), folder.file(name)));
    FETTLE_LOAD(again, folder.file(name));
    EXPECT_EQ(again.field.grid(), grid) << name;
  }
}

TEST(RoundTrip, TheSameFieldGivesTheSameFile) {
  const TempFolder folder;
  const Version field = makeField(gridOf(700, 600), anyFloats(700 * 600, 3));
  for (const std::string extension : {".tif", ".asc", ".xyz", ".ply", ".x3p", ".exr"}) {
    ASSERT_TRUE(save(field, folder.file("a" + extension)));
    ASSERT_TRUE(save(field, folder.file("b" + extension)));
    EXPECT_EQ(readBytes(folder.file("a" + extension)), readBytes(folder.file("b" + extension))) << extension;
  }
}

TEST(RoundTrip, CountsComeBackThroughPngExactly) {
  const TempFolder folder;
  std::vector<float> z;
  for (int i = 0; i < 256 * 256; ++i) z.push_back(i == 0 ? kNan : static_cast<float>(i * 0.02));
  Grid grid = gridOf(256, 256);
  grid.height_per_count = 0.02;
  const Version field = makeField(grid, z);
  const auto written = save(field, folder.file("counts.png"));
  ASSERT_TRUE(written) << written.error().line();
  EXPECT_TRUE(warned(written->warnings, "largest error 0 mm")) << written->warnings.front();
  ImportOptions options;
  options.z_scale = 0.02;
  options.no_data = 0.0;
  FETTLE_LOAD(again, folder.file("counts.png"), options);
  expectSameBits(field, again.field);
}

TEST(RoundTrip, PngSpreadsARangeAndStatesTheTrueError) {
  const TempFolder folder;
  const Version field = makeField(gridOf(3, 1), {-100.0F, 0.123F, 227.67F});
  const auto written = save(field, folder.file("range.png"));
  ASSERT_TRUE(written) << written.error().line();
  FETTLE_LOAD(counts, folder.file("range.png"));
  EXPECT_EQ(counts.field.reader().heightAt(0, 0), 1.0F);
  EXPECT_EQ(counts.field.reader().heightAt(2, 0), 65535.0F);
  // 0.123 lies (0.123 + 100) / 327.67 * 65534 = 20024.4... steps above the lowest.
  EXPECT_EQ(counts.field.reader().heightAt(1, 0), 1.0F + std::nearbyint(100.123F / (327.67F / 65534.0F)));
  EXPECT_TRUE(warned(written->warnings, "largest error")) << written->warnings.front();
}

TEST(RoundTrip, PngRefusesCountsThatDoNotFit) {
  const TempFolder folder;
  ExportOptions options;
  options.height_per_count = 0.001;
  const auto written = save(makeField(gridOf(2, 1), {0.0F, 100.0F}), folder.file("no.png"), options);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kInput);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RoundTrip, PointsOfAFieldFindTheirRasterAgain) {
  const TempFolder folder;
  Grid grid = gridOf(70, 41);
  grid.spacing_x = 0.215326741;
  grid.spacing_y = 0.5;
  grid.origin_x = -106.564972;
  grid.origin_y = 5000000.25;
  std::vector<float> z = anyFloats(70 * 41, 5);
  z[0] = z[69] = z[40 * 70] = 1.0F;  // all four sides are measured somewhere
  const Version field = makeField(grid, z);
  for (const std::string extension : {".xyz", ".ply"}) {
    ASSERT_TRUE(save(field, folder.file("p" + extension)));
    FETTLE_LOAD(again, folder.file("p" + extension));
    EXPECT_TRUE(again.gridding->lattice);
    expectSameBits(field, again.field);
    EXPECT_NEAR(again.field.grid().spacing_x, grid.spacing_x, 1e-15);
    EXPECT_EQ(again.field.grid().spacing_y, grid.spacing_y);
    EXPECT_EQ(again.field.grid().origin_x, grid.origin_x);
    EXPECT_EQ(again.field.grid().origin_y, grid.origin_y);
  }
}

RC_GTEST_PROP(RoundTrip, AnySmallFieldSurvivesTiffAndAscii, ()) {
  const TempFolder folder;
  const auto w = *rc::gen::inRange(1, 90);
  const auto h = *rc::gen::inRange(1, 90);
  auto z = anyFloats(static_cast<std::size_t>(w) * h, *rc::gen::arbitrary<std::uint32_t>());
  z[0] = 1.0F;
  const Version field = makeField(gridOf(w, h), z);
  for (const std::string extension : {".tif", ".asc", ".x3p", ".exr"}) {
    RC_ASSERT(save(field, folder.file("f" + extension)).has_value());
    const auto again = load(folder.file("f" + extension));
    RC_ASSERT(again.has_value());
    RC_ASSERT(contentHash(again->field) == contentHash(field));
  }
}

}  // namespace
}  // namespace fettle::engine
