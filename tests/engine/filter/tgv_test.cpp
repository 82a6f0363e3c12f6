// Generalised variation against its twin in double, against the surface that its steps go to, and on forms that
// it must keep.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "engine/filter/region.h"
#include "tests/engine/filter/reference.h"
#include "tests/engine/filter/tgv_twin.h"

namespace fettle::engine::tests {
namespace {

constexpr double kNoise = 0.02;

FilterSpec spec(double noise = kNoise) {
  FilterSpec s = makeSpec(FilterKind::kGeneralisedVariation, 3);
  s.range_sigma = noise;
  return s;
}

PlainField tgv(const PlainField& field, double noise = kNoise) {
  return toPlain(filtered(toVersion(field), spec(noise)).field);
}

PlainField withNoise(PlainField field, unsigned seed = 11) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  for (float& z : field.z) z = static_cast<float>(static_cast<double>(z) + noise(random));
  return field;
}

// A slope that meets a flat, a step of twelve noises, a round hill, a hole and a few mixed pixels.
PlainField part(int width, int height) {
  PlainField field = formed(width, height, [&](int c, int r) {
    if (std::hypot(c - 0.7 * width, r - 0.2 * height) < 0.05 * height)
      return std::numeric_limits<float>::quiet_NaN();
    double z = 0.01 * std::max(0, r - height / 2);
    if (c < width / 3) z += 12 * kNoise;
    const double d = std::hypot(c - 0.6 * width, r - 0.7 * height) / (0.2 * height);
    if (d < 1) z += 0.5 * (1 - d * d);
    return static_cast<float>(z);
  });
  field = withNoise(std::move(field));
  for (int r = 5; r < height; r += 17) field.at(2 * width / 3, r) = 5.0F;
  return field;
}

// Largest and mean square difference in noises over the samples that are not holes.
struct Off {
  double most = 0.0, rms = 0.0;
};
template <class Want>
Off off(const PlainField& got, const Want& want, double noise = kNoise, int rim = 0) {
  Off o;
  int n = 0;
  for (int r = rim; r < got.height - rim; ++r)
    for (int c = rim; c < got.width - rim; ++c) {
      if (std::isnan(got.at(c, r))) continue;
      const double d = std::fabs(static_cast<double>(got.at(c, r)) - want(c, r)) / noise;
      o.most = std::max(o.most, d);
      o.rms += d * d;
      ++n;
    }
  o.rms = std::sqrt(o.rms / std::max(n, 1));
  return o;
}

Off offTwin(const PlainField& got, const std::vector<double>& twin, double noise = kNoise) {
  return off(
      got, [&](int c, int r) { return twin[static_cast<std::size_t>(r) * got.width + c]; }, noise);
}

TEST(Tgv, IsTheSameStepsInDoubleButForItsError) {
  // Across the border of two squares, along a row and along a column.
  for (const auto& [width, height] : {std::pair{300, 64}, {56, 290}}) {
    const PlainField field = part(width, height);
    EXPECT_LT(offTwin(tgv(field), tgvTwin(field, kNoise)).most, 2e-3);
  }
}

// Where two choices are equally good the last bit decides between them; no field of noise has such places.
constexpr const char* kTies[] = {"integers", "spikes", "all magnitudes"};

class TgvHardField : public testing::TestWithParam<std::string> {};

TEST_P(TgvHardField, IsTheSameStepsInDoubleButForItsError) {
  constexpr double kRange = 0.25;
  const PlainField field = hardField(GetParam());
  const PlainField got = tgv(field, kRange);
  const std::vector<double> twin = tgvTwin(field, kRange);
  const bool ties = std::ranges::find(kTies, GetParam()) != std::end(kTies);
  // Of differences between heights as float holds them, in ranges and up to 1e15 of these.
  double largest = 0.0;
  for (const float z : field.z)
    if (z == z) largest = std::max(largest, std::min(std::fabs(static_cast<double>(z)), 1e15 * kRange));
  double beyond = 0.0;
  for (std::size_t i = 0; i < got.z.size(); ++i) {
    ASSERT_EQ(std::isnan(got.z[i]), std::isnan(field.z[i])) << i;
    if (std::isnan(got.z[i])) continue;
    const double bound =
        static_cast<double>(ulp(got.z[i])) + (ties ? 4.0 : 1e-3) * kRange + std::ldexp(largest, -22);
    beyond = std::max(beyond, std::fabs(static_cast<double>(got.z[i]) - twin[i]) / bound);
  }
  EXPECT_LE(beyond, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Filters, TgvHardField, testing::ValuesIn(hardFieldNames()), [](const auto& test) {
  std::string text = test.param;
  for (char& c : text) c = c == ' ' ? '_' : c;
  return text;
});

TEST(Tgv, IsThisFarFromTheSurfaceThatItsStepsGoTo) {
  const PlainField field = part(96, 84);
  TgvTwin long_way;
  long_way.first_steps = 600;
  long_way.round_steps = 600;
  const Off o = offTwin(tgv(field), tgvTwin(field, kNoise, long_way));
  RecordProperty("most", std::to_string(o.most));
  RecordProperty("rms", std::to_string(o.rms));
  // As filter.h states.
  EXPECT_LT(o.rms, 0.06);
  EXPECT_LT(o.most, 1.0);
}

TEST(Tgv, InSquaresIsNearTheWholeFieldInOne) {
  const PlainField field = part(310, 80);
  TgvTwin whole;
  whole.side = 0;
  EXPECT_LT(offTwin(tgv(field), tgvTwin(field, kNoise, whole)).most, 2e-3);
  TgvTwin narrow = whole;
  narrow.side = 256;
  narrow.halo = 16;
  EXPECT_GT(offTwin(tgv(field), tgvTwin(field, kNoise, narrow)).most, 2e-3);
}

TEST(Tgv, KeepsTheFormOfConstantsPlanesAndQuadrics) {
  struct Form {
    const char* name;
    std::function<double(int, int)> z;
    double clean, rim, noisy;  // rms allowed without noise but for a rim of 8, with it, and of noise [noises]
  };
  const Form forms[] = {
      {"constant", [](int, int) { return 0.1; }, 1e-6, 1e-6, 0.06},
      {"plane", [](int c, int) { return 0.02 * c; }, 0.002, 0.002, 0.06},
      {"tilted plane", [](int c, int r) { return 0.1 * c - 0.17 * r; }, 0.01, 0.02, 0.1},
      {"paraboloid",
       [](int c, int r) { return 1e-3 * ((c - 150.0) * (c - 150.0) + (r - 50.0) * (r - 50.0)); }, 0.005, 0.1,
       0.35},
      {"saddle", [](int c, int r) { return 1e-3 * (c - 150.0) * (r - 50.0); }, 0.002, 0.05, 0.25},
  };
  for (const Form& form : forms) {
    SCOPED_TRACE(form.name);
    const PlainField clean = formed(300, 100, [&](int c, int r) { return static_cast<float>(form.z(c, r)); });
    const PlainField kept = tgv(clean);
    EXPECT_LT(off(kept, form.z, kNoise, 8).rms, form.clean);
    EXPECT_LT(off(kept, form.z).rms, form.rim);
    EXPECT_LT(off(tgv(withNoise(clean)), form.z).rms, form.noisy);
  }
}

TEST(Tgv, GivesAConstantBackBitIdenticalWithHolesAndASpike) {
  for (const float z : {0.1F, -1e6F, 1.1e-40F, 3.4e38F, -0.0F}) {
    PlainField plain = formed(200, 80, [&](int c, int r) {
      return (c * r) % 11 == 10 ? std::numeric_limits<float>::quiet_NaN() : z;
    });
    plain.at(150, 40) = 7.0F;
    const PlainField after = tgv(plain);
    plain.at(150, 40) = after.at(150, 40);
    EXPECT_TRUE(sameBits(after, plain)) << z;
    EXPECT_FLOAT_EQ(after.at(150, 40), z) << z;
  }
}

TEST(Tgv, TakesLoneSamplesAtAWallToOneSide) {
  PlainField field = withNoise(formed(200, 150, [](int c, int) { return c < 100 ? 0.0F : 8.0F; }));
  std::mt19937 random(5);
  for (int r = 2; r < 148; r += 3)
    field.at(98 + static_cast<int>(random() % 4), r) = 1.2F + 0.1F * static_cast<float>(random() % 56);
  const PlainField after = tgv(field);
  int between = 0;
  for (const float z : after.z) between += z > 0.1F && z < 7.9F ? 1 : 0;
  EXPECT_LE(between, 2);
}

TEST(Tgv, TakesTheNoiseAndKeepsAStepSharperThanVariationAlone) {
  const auto step = [](int c, int) { return c < 100 ? 0.0 : 8 * kNoise; };
  const PlainField field =
      withNoise(formed(200, 160, [&](int c, int r) { return static_cast<float>(step(c, r)); }));
  FilterSpec variation = makeSpec(FilterKind::kTotalVariation, 31);
  variation.range_sigma = kNoise;
  const double alone = off(toPlain(filtered(toVersion(field), variation).field), step).rms;
  EXPECT_LT(off(tgv(field), step).rms, 0.5 * alone);
  EXPECT_LT(off(tgv(field), step).rms, 0.1);
}

TEST(Tgv, GivesATileTheBitsOfTheWholeFieldWhereverItsPieceBegins) {
  const PlainField plain = part(900, 200);
  const Version field = toVersion(plain);
  JobControl job;
  const Version whole = filtered(field, spec()).field;
  Version pieces = field;
  for (const TileRange& range :
       {TileRange{9, 0, 2, 4}, {0, 0, 3, 2}, {3, 1, 6, 3}, {11, 0, 4, 4}, {0, 2, 3, 2}, {3, 0, 6, 1}})
    pieces = *filterRange(field, field, pieces, spec(), range, job);
  EXPECT_EQ(contentHash(pieces), contentHash(whole));
}

}  // namespace
}  // namespace fettle::engine::tests
