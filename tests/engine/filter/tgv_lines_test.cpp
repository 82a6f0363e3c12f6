// Generalised variation with edge lines.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/filter/pass.h"
#include "engine/filter/region.h"
#include "tests/engine/filter/edge_line_of.h"
#include "tests/engine/filter/reference.h"
#include "tests/engine/filter/tgv_twin.h"

namespace fettle::engine::tests {
namespace {

constexpr double kLineNoise = 0.02;

FilterSpec lineSpec() {
  FilterSpec s = makeSpec(FilterKind::kGeneralisedVariation, 3);
  s.range_sigma = kLineNoise;
  return s;
}

// Two flats that meet in a slanted line, with noise.
struct Step {
  int width = 120, height = 100;
  double noises = 3.0;  // high
  double from = 50.3, to = 64.8;

  [[nodiscard]] double edgeAt(double row) const { return from + (to - from) * row / height; }
  [[nodiscard]] double truth(int c, int r) const { return c > edgeAt(r) ? noises * kLineNoise : 0.0; }
  [[nodiscard]] PlainField scan(unsigned seed = 5) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, kLineNoise);
    return formed(width, height,
                  [&](int c, int r) { return static_cast<float>(truth(c, r) + noise(random)); });
  }
  [[nodiscard]] EdgeLine line(double off = 0.0, double deviation = 0.0) const {
    return edgeLineOf({{edgeAt(-3) + off, -3.0}, {edgeAt(height + 3) + off, height + 3.0}}, deviation);
  }
  // Largest and root mean square error within 3 samples of the edge [noises].
  struct Errors {
    double most = 0.0, rms = 0.0;
  };
  [[nodiscard]] Errors errors(const PlainField& got) const {
    Errors e;
    int n = 0;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) {
        if (std::fabs(c - edgeAt(r)) > 3.0 || std::isnan(got.at(c, r))) continue;
        const double d = std::fabs(static_cast<double>(got.at(c, r)) - truth(c, r)) / kLineNoise;
        e.most = std::max(e.most, d);
        e.rms += d * d;
        ++n;
      }
    e.rms = std::sqrt(e.rms / n);
    return e;
  }
};

Version withLine(const Version& field, const EdgeLine& line) {
  return field.withLines(std::make_shared<std::vector<EdgeLine>>(std::vector{line}));
}

PlainField lineTgv(const PlainField& field, const EdgeLine& line) {
  return toPlain(filtered(withLine(toVersion(field), line), lineSpec()).field);
}
PlainField lineTgv(const PlainField& field) {
  return toPlain(filtered(toVersion(field), lineSpec()).field);
}

TEST(TgvLines, AreCutLinksOfTheSameStepsInDouble) {
  const Step step;
  const PlainField field = step.scan();
  TgvTwin twin;
  twin.lone = false;
  const LineCuts cuts(std::vector{step.line()}, step.width, step.height);
  twin.cuts = &cuts;
  const std::vector<double> expected = tgvTwin(field, kLineNoise, twin);
  const PlainField got = lineTgv(field, step.line());
  double most = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    most = std::max(most, std::fabs(static_cast<double>(got.z[i]) - expected[i]) / kLineNoise);
  EXPECT_LT(most, 2e-3);
}

// A step of two noises: without its line the filter rounds it; with it, both sides are as clean as flats.
TEST(TgvLines, AStepOfTwoNoisesIsAsCleanAsTheFlats) {
  Step step;
  step.noises = 2.0;
  double alone = 0.0, with_line = 0.0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    alone += step.errors(lineTgv(step.scan(seed))).rms / 5;
    with_line += step.errors(lineTgv(step.scan(seed), step.line())).rms / 5;
  }
  EXPECT_LT(with_line, 0.5 * alone);
  EXPECT_LT(with_line, 0.3);
}

// At a wall of 200 noises samples change to the side that they fit. What a line a sample off leaves is their own
// noise, in places.
TEST(TgvLines, ALineOffATallWallDoesNoHarm) {
  Step step;
  step.noises = 200.0;
  for (const double off : {-1.2, -0.6, 0.4, 1.2}) {
    const Step::Errors e = step.errors(lineTgv(step.scan(), step.line(off, 0.5)));
    EXPECT_LT(e.most, 4.0) << off;
    EXPECT_LT(e.rms, 0.3) << off;
  }
}

// Samples next to a tall wall at any height between both sides and some at that of the wrong side.
TEST(TgvLines, MixedPixelsAreMovedToTheSideWhereTheLineHasThem) {
  Step step;
  step.noises = 200.0;
  PlainField field = step.scan();
  for (int r = 3; r < step.height - 3; r += 7) {
    const int left = static_cast<int>(std::floor(step.edgeAt(r)));
    const bool wrong = r % 2 == 0;  // side, else between
    field.at(left, r) = static_cast<float>((wrong ? 200.0 : 20.0 + r) * kLineNoise);
  }
  EXPECT_GT(step.errors(lineTgv(field)).most, 100.0);
  const Step::Errors e = step.errors(lineTgv(field, step.line()));
  EXPECT_LT(e.most, 5.0);
  EXPECT_LT(e.rms, 1.0);
}

// A steep strip of six samples between two lines: windows of five fit in it, and with the slope that they find it becomes as
// clean as 0.22 to 0.29 noises; where none is found it stays at 0.48 to 0.52.
TEST(TgvLines, ASteepStripBetweenTwoLinesIsAsCleanAsAPlane) {
  constexpr int kSize = 70, kFirst = 30, kLast = 35;
  for (const bool along_x : {false, true}) {
    const auto truth = [&](int c, int r) {
      const int across = along_x ? r : c, along = along_x ? c : r;
      return across < kFirst || across > kLast ? 0.0 : (40.0 * along - 5000.0) * kLineNoise;
    };
    std::vector<EdgeLine> lines;
    for (const double at : {kFirst - 0.5, kLast + 0.5})
      lines.push_back(along_x ? edgeLineOf({{-3.0, at}, {kSize + 3.0, at}})
                              : edgeLineOf({{at, -3.0}, {at, kSize + 3.0}}));
    const auto all = std::make_shared<std::vector<EdgeLine>>(lines);
    double squares = 0.0;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      std::mt19937 random(seed);
      std::normal_distribution<double> noise(0.0, kLineNoise);
      const PlainField field =
          formed(kSize, kSize, [&](int c, int r) { return static_cast<float>(truth(c, r) + noise(random)); });
      const PlainField got = toPlain(filtered(toVersion(field).withLines(all), lineSpec()).field);
      for (int along = 0; along < kSize; ++along)
        for (int across = kFirst; across <= kLast; ++across) {
          const int c = along_x ? along : across, r = along_x ? across : along;
          squares += std::pow((static_cast<double>(got.at(c, r)) - truth(c, r)) / kLineNoise, 2);
        }
    }
    EXPECT_LT(std::sqrt(squares / (3.0 * 6.0 * kSize)), 0.35) << along_x;
  }
}

TEST(TgvLines, AreWithoutInfluenceFarAwayAndWhereNothingIsLocated) {
  const Step step;
  const PlainField field = step.scan();
  const PlainField alone = lineTgv(field);
  EXPECT_TRUE(sameBits(lineTgv(field, edgeLineOf({})), alone));
  EXPECT_TRUE(sameBits(lineTgv(field, edgeLineOf({{-50.0, -5.5}, {300.0, -5.5}})), alone));
  EdgeLine not_located = step.line();
  for (EdgePoint& point : not_located.points) point.located = false;
  EXPECT_TRUE(sameBits(lineTgv(field, not_located), alone));
}

TEST(TgvLines, GiveTheSameBitsForAnyThreadsPiecesAndUpsideDown) {
  Step step;
  step.width = 600;
  step.height = 300;
  step.from = 250.4;
  step.to = 263.9;
  PlainField field = step.scan();
  for (int r = 9; r < 300; r += 11) field.at(static_cast<int>(step.edgeAt(r)), r) = 2.0F;
  const Version scan = withLine(toVersion(field), step.line(0.3, 0.3));
  JobControl job;
  FilterSpec one = lineSpec();
  one.threads = 1;
  const Version whole = applyFilter(scan, scan, one, job)->field;
  one.threads = 5;
  EXPECT_EQ(contentHash(applyFilter(scan, scan, one, job)->field), contentHash(whole));
  EXPECT_EQ(whole.lines(), scan.lines());
  for (const CpuLevel level : {CpuLevel::kPlain, CpuLevel::kAvx2})
    EXPECT_EQ(contentHash(applyFilter(scan, scan, one, FilterTuning{0, level}, job)->field),
              contentHash(whole));
  EXPECT_EQ(contentHash(applyFilter(scan.inverted(), scan, one, job)->field.inverted()), contentHash(whole));
  Version so_far = scan;
  for (const TileRange& range : {TileRange{4, 1, 2, 2}, {0, 0, 3, 5}, {3, 0, 9, 9}})
    so_far = *filterRange(scan, scan, so_far, one, range, job);
  EXPECT_EQ(contentHash(so_far), contentHash(whole));
}

class TgvLinesHardField : public testing::TestWithParam<std::string> {};

TEST_P(TgvLinesHardField, KeepHolesMarksAndFiniteHeights) {
  PlainField field = hardField(GetParam());
  const double w = field.width, h = field.height;
  const std::vector<EdgeLine> lines{
      edgeLineOf({{0.5, -1.0}, {0.5, h}}), edgeLineOf({{-1.0, 0.3 * h}, {w, 0.6 * h}}, 0.4),
      edgeLineOf({{0.2 * w, 0.2 * h}, {0.7 * w, 0.3 * h}, {0.4 * w, 0.9 * h}, {0.2 * w, 0.2 * h}}, 0.2)};
  FilterSpec s = lineSpec();
  s.range_sigma = 0.25;
  const Version scan = toVersion(field).withLines(std::make_shared<std::vector<EdgeLine>>(lines));
  const PlainField got = toPlain(filtered(scan, s).field);
  for (int r = 0; r < field.height; ++r)
    for (int c = 0; c < field.width; ++c) {
      ASSERT_EQ(std::isnan(got.at(c, r)), std::isnan(field.at(c, r)));
      ASSERT_FALSE(std::isinf(got.at(c, r)));
      if (field.marked(c, r)) {
        ASSERT_TRUE(sameBits(got.at(c, r), field.at(c, r)));
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Filters, TgvLinesHardField, testing::ValuesIn(hardFieldNames()),
                         [](const auto& test) {
                           std::string text = test.param;
                           for (char& c : text) c = c == ' ' ? '_' : c;
                           return text;
                         });

}  // namespace
}  // namespace fettle::engine::tests
