// Generalised variation on a Vulkan device (lavapipe is enough) against the processor's, validation layers on.
#include "render/compute/tgv_compute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/piece.h"
#include "engine/filter/noise_range.h"
#include "engine/scanner/scanner.h"
#include "tests/engine/filter/edge_line_of.h"
#include "tests/engine/filter/reference.h"
#include "tests/engine/filter/tgv_twin.h"

namespace fettle::render {
namespace {

using engine::Filtered;
using engine::FilterSpec;
using engine::JobControl;
using engine::Result;
using engine::Version;
using engine::tests::PlainField;
using engine::tests::toPlain;
using engine::tests::toVersion;

constexpr double kNoise = 0.02;

// How far two results are apart at most, in units of the bound of tgv_device.h; `ties`: that of fields in which the last
// bit decides.
double apart(const Version& got, const Version& expected, double noise, bool ties = false) {
  const PlainField a = toPlain(got), b = toPlain(expected);
  double largest = 0.0;
  for (const float z : b.z)
    if (z == z) largest = std::max(largest, std::min(std::fabs(static_cast<double>(z)), 1e15 * noise));
  double most = 0.0;
  for (std::size_t i = 0; i < a.z.size(); ++i) {
    EXPECT_EQ(std::isnan(a.z[i]), std::isnan(b.z[i])) << i;
    if (std::isnan(a.z[i]) || std::isnan(b.z[i])) continue;
    const double bound = static_cast<double>(engine::tests::ulp(b.z[i])) + (ties ? 4.0 : 0.001) * noise +
                         std::ldexp(largest, -22);
    most = std::max(most, std::fabs(static_cast<double>(a.z[i]) - static_cast<double>(b.z[i])) / bound);
  }
  return most;
}

class TgvOnDevice : public testing::Test {
 protected:
  // Made once: starting a device takes longer than a case.
  static TgvCompute& device() {
    static const std::unique_ptr<TgvCompute> one = [] {
      auto made = TgvCompute::create({.validation = Validation::kOn});
      if (!made) {
        ADD_FAILURE() << made.error().line();
        std::abort();
      }
      return *std::move(made);
    }();
    return *one;
  }
  void TearDown() override {
    for (const std::string& message : device().messages()) ADD_FAILURE() << message;
    EXPECT_EQ(device().underWay(), 0);
  }

  static FilterSpec spec(double noise = kNoise) {
    FilterSpec s = engine::tests::makeSpec(engine::FilterKind::kGeneralisedVariation, 3);
    s.range_sigma = noise;
    return s;
  }
  static Filtered onDevice(const Version& input, const FilterSpec& spec) {
    JobControl job;
    Result<Filtered> result = engine::applyFilter(input, input, spec, device(), job);
    EXPECT_TRUE(result) << result.error().line();
    EXPECT_EQ(job.done(), job.total());
    return result ? *std::move(result) : Filtered{input, {}};
  }
  // The bound of tgv_device.h; on lavapipe, which rounds divisions and roots as the processor does, no bit differs.
  static void expectWithin(const Version& got, const Version& expected, double noise, bool ties = false) {
    EXPECT_LE(apart(got, expected, noise, ties), 1.0);
    if (device().name().find("llvmpipe") != std::string::npos) {
      EXPECT_TRUE(engine::tests::sameBits(toPlain(got), toPlain(expected)));
    }
  }
};

PlainField rough(PlainField field, unsigned seed = 11) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  for (float& z : field.z) z = static_cast<float>(static_cast<double>(z) + noise(random));
  return field;
}

// A slope that meets a flat, a step, a hole and mixed pixels.
PlainField part(int width, int height) {
  PlainField field = rough(engine::tests::formed(width, height, [&](int c, int r) {
    if (std::hypot(c - 0.7 * width, r - 0.2 * height) < 0.05 * height)
      return std::numeric_limits<float>::quiet_NaN();
    return static_cast<float>(0.01 * std::max(0, r - height / 2) + (c < width / 3 ? 12 * kNoise : 0.0));
  }));
  for (int r = 5; r < height; r += 17) field.at(2 * width / 3, r) = 5.0F;
  return field;
}

// Every part of the catalogue, at one and three times the usual noise, with mixed pixels and lost samples.
TEST_F(TgvOnDevice, IsWithinTheBoundOfTheProcessorOnEveryPart) {
  for (const engine::PartInfo& each : engine::parts())
    for (const double noise : {1.0, 3.0}) {
      SCOPED_TRACE(std::string(each.name) + (noise > 1.0 ? ", noise x 3" : ""));
      engine::ScannerSpec scanner;
      scanner.part = each.name;
      scanner.width = 130;
      scanner.height = 100;
      scanner.noise = noise;
      scanner.outliers = noise > 1.0 ? 0.0 : 0.02;
      scanner.dropouts = noise > 1.0 ? 0.0 : 1.0;
      scanner.seed = 77;
      JobControl job;
      const auto scan = engine::simulateScan(scanner, job);
      ASSERT_TRUE(scan) << scan.error().line();
      const auto ready = engine::withMeasuredRange(spec(0.0), scan->scan, job);
      ASSERT_TRUE(ready) << ready.error().line();
      const Filtered here = engine::tests::filtered(scan->scan, *ready);
      EXPECT_GT(here.report.changed, 5000);
      expectWithin(onDevice(scan->scan, *ready).field, here.field, ready->range_sigma);
    }
}

TEST_F(TgvOnDevice, IsWithinTheBoundOfTheProcessorOnHardFields) {
  constexpr double kRange = 0.25;
  for (const std::string& name : engine::tests::hardFieldNames()) {
    SCOPED_TRACE(name);
    const PlainField field = engine::tests::hardField(name);
    const bool ties = name == "integers" || name == "spikes" || name == "all magnitudes";
    const Version here = engine::tests::filtered(toVersion(field), spec(kRange)).field;
    const Version there = onDevice(toVersion(field), spec(kRange)).field;
    expectWithin(there, here, kRange, ties);
    const PlainField got = toPlain(there);
    for (std::size_t i = 0; i < got.z.size(); ++i) {
      ASSERT_FALSE(std::isinf(got.z[i]));
      if (field.marked(static_cast<int>(i) % field.width, static_cast<int>(i) / field.width)) {
        ASSERT_TRUE(engine::tests::sameBits(got.z[i], field.z[i]));
      }
    }
  }
}

// Not against the processor's float but against the formulas.
TEST_F(TgvOnDevice, IsTheSameStepsInDoubleButForTheErrorOfTheFilter) {
  const PlainField field = part(280, 30);
  const std::vector<double> twin = engine::tests::tgvTwin(field, kNoise);
  const PlainField got = toPlain(onDevice(toVersion(field), spec()).field);
  double most = 0.0;
  for (std::size_t i = 0; i < twin.size(); ++i)
    if (!std::isnan(field.z[i])) most = std::max(most, std::fabs(static_cast<double>(got.z[i]) - twin[i]));
  EXPECT_LT(most / kNoise, 2e-3);
}

TEST_F(TgvOnDevice, EndsAtEdgeLinesAsTheProcessorDoes) {
  const Version scan = toVersion(part(120, 80));
  const auto lines = std::make_shared<std::vector<engine::EdgeLine>>(
      std::vector{engine::tests::edgeLineOf({{39.6, -3.0}, {39.6, 83.0}}, 0.2),
                  engine::tests::edgeLineOf({{-1.0, 41.3}, {121.0, 38.0}}, 0.3)});
  const Version lined = scan.withLines(lines);
  const Version here = engine::tests::filtered(lined, spec()).field;
  expectWithin(onDevice(lined, spec()).field, here, kNoise);
  EXPECT_NE(contentHash(here), contentHash(engine::tests::filtered(scan, spec()).field));
}

TEST_F(TgvOnDevice, KnowsNothingOfPlaceAndSpacing) {
  PlainField plain = part(100, 60);
  for (float& z : plain.z) z += 40000.0F;
  engine::Grid grid;
  grid.width = plain.width;
  grid.height = plain.height;
  grid.spacing_x = 0.013;
  grid.spacing_y = 11.0;
  grid.origin_x = 5e6;
  grid.origin_y = -5e6;
  const Version far = engine::makeField(grid, plain.z, {});
  const Version near = toVersion(plain);
  const Version got = onDevice(far, spec()).field;
  EXPECT_TRUE(engine::tests::sameBits(toPlain(got), toPlain(onDevice(near, spec()).field)));
  expectWithin(got, engine::tests::filtered(near, spec()).field, kNoise);
}

TEST_F(TgvOnDevice, TakesEverySettingOfTheFilter) {
  PlainField field = part(90, 70);
  for (std::size_t i = 0; i < field.z.size(); ++i) field.marks.push_back(i % 97 == 0 ? 1 : 0);
  const Version input = toVersion(field);
  std::vector<FilterSpec> specs(3, spec());
  specs[0].scope = engine::FilterScope::kOnlyMarks;
  specs[1].max_change = 0.01;
  specs[2].passes = 2;
  for (const FilterSpec& each : specs)
    expectWithin(onDevice(input, each).field, engine::tests::filtered(input, each).field,
                 kNoise * each.passes);
  EXPECT_TRUE(engine::tests::sameBits(toPlain(onDevice(input.inverted(), spec()).field.inverted()),
                                      toPlain(onDevice(input, spec()).field)));
}

// Nine squares, more than a batch, of which most are a few rows high: in a field of one or of three, or with others
// before them, they come to the same.
TEST_F(TgvOnDevice, GivesTheSameBitsForAnyThreadsAndBatches) {
  const tbb::global_control five(tbb::global_control::max_allowed_parallelism, 5);
  const Version whole = toVersion(part(9 * 256 - 40, 12));
  const Version result = onDevice(whole, spec()).field;
  for (const int threads : {1, 5}) {
    FilterSpec some = spec();
    some.threads = threads;
    EXPECT_EQ(contentHash(onDevice(whole, some).field), contentHash(result)) << threads;
  }
  // Pieces that begin on the grid of squares, and end with the samples around the square that is compared.
  const PlainField all = toPlain(result);
  for (const int from : {0, 256, 1024}) {
    const int at = from > 0 ? 256 : 0;
    const Version piece = engine::pieceOf(whole, from, 0, at + 304, 12);
    const PlainField alone = toPlain(onDevice(piece, spec()).field);
    for (int r = 0; r < 12; ++r)
      for (int c = at; c < at + 256; ++c)
        ASSERT_TRUE(engine::tests::sameBits(alone.at(c, r), all.at(from + c, r)))
            << from << " " << c << " " << r;
  }
}

TEST_F(TgvOnDevice, StopsSoonWhenCancelledAndGoesOnWithTheNextField) {
  const Version input = toVersion(part(900, 700));
  FilterSpec many = spec();
  many.passes = 1000;
  JobControl job;
  std::optional<Result<Filtered>> result;
  std::thread worker([&] { result.emplace(engine::applyFilter(input, input, many, device(), job)); });
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  const auto start = std::chrono::steady_clock::now();
  job.cancel();
  worker.join();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  ASSERT_FALSE(*result);
  EXPECT_EQ(result->error().kind, engine::ErrorKind::kCancelled);
  // Two submissions of 50 ms on a graphics card. On lavapipe one dispatch of a square alone takes as long, beside other
  // work several times that; a single pass of the thousand takes a minute.
  EXPECT_LT(took.count(), 5.0);
  RecordProperty("seconds", std::to_string(took.count()));
  const Version next = toVersion(part(40, 30));
  expectWithin(onDevice(next, spec()).field, engine::tests::filtered(next, spec()).field, kNoise);
}

TEST(TgvComputeDevice, IsNullWithoutHardwareAndAnErrorByAWrongName) {
  const auto none = TgvCompute::create({.device = "no such device"});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, engine::ErrorKind::kFailed);
  const auto hardware = TgvCompute::create({.device = "no such device", .kind = DriverKind::kHardware});
  ASSERT_TRUE(hardware);
  EXPECT_EQ(*hardware, nullptr);
  const auto llvmpipe = TgvCompute::create({.device = "llvmpipe", .kind = DriverKind::kHardware});
  ASSERT_TRUE(llvmpipe) << llvmpipe.error().line();
  EXPECT_EQ(*llvmpipe, nullptr);
}

}  // namespace
}  // namespace fettle::render
