// Windows that end at edge lines: box, Gaussian, median and bilateral.
#include "engine/filter/line_windows.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/line_cuts.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/pass.h"
#include "engine/filter/region.h"
#include "tests/engine/filter/edge_line_of.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

std::vector<FilterKind> windowsWithLines() {
  std::vector<FilterKind> kinds;
  for (const Filter& filter : filters())
    if (filter.knows_lines && filter.window.exists()) kinds.push_back(filter.kind);
  return kinds;
}

FilterSpec specOf(FilterKind kind, int window) {
  FilterSpec spec = makeSpec(kind, window);
  if (hasRange(kind)) spec.range_sigma = 1e3;
  return spec;
}

EdgeLine slanted(double x, double y, double angle, double length = 400.0) {
  const double c = length * std::cos(angle), s = length * std::sin(angle);
  return edgeLineOf({{x - c, y - s}, {x + c, y + s}});
}

// Positions are multiples of 2^-20, and ids differ, as those of located lines.
Version withLines(const PlainField& field, std::vector<EdgeLine> lines) {
  for (std::size_t k = 0; k < lines.size(); ++k) {
    lines[k].id = static_cast<std::int64_t>(k);
    for (EdgePoint& p : lines[k].points)
      p.position = {std::round(p.position.x * 0x1p20) * 0x1p-20, std::round(p.position.y * 0x1p20) * 0x1p-20};
  }
  return toVersion(field).withLines(std::make_shared<std::vector<EdgeLine>>(std::move(lines)));
}

// On which side of the line a sample lies.
bool isLeft(double x, double y, double angle, int c, int r) {
  return (c - x) * std::sin(angle) - (r - y) * std::cos(angle) > 0.0;
}

TEST(LineWindows, AreOfAllFiltersWithWindowsButTotalVariation) {
  EXPECT_EQ(windowsWithLines(), (std::vector{FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian,
                                             FilterKind::kBilateral}));
}

// Two flats keep every bit, whatever the line's angle and the window.
TEST(LineWindows, NeverReachOverALine) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(25.0, 50.0), turn(0.0, 3.1416);
  for (const FilterKind kind : windowsWithLines())
    for (int i = 0; i < 12; ++i) {
      const double x = place(random), y = place(random), angle = turn(random);
      PlainField field =
          formed(80, 75, [&](int c, int r) { return isLeft(x, y, angle, c, r) ? 3.25F : -1.5F; });
      for (int k = 0; k < 60; ++k)
        field.at(static_cast<int>(random() % 80), static_cast<int>(random() % 75)) = std::nanf("");
      const Version lined = withLines(field, {slanted(x, y, angle)});
      const PlainField got = toPlain(filtered(lined, specOf(kind, 3 + 4 * (i % 4))).field);
      EXPECT_TRUE(sameBits(got, field)) << static_cast<int>(kind) << ", angle " << angle;
      EXPECT_FALSE(sameBits(toPlain(filtered(toVersion(field), specOf(kind, 5)).field), field));
    }
}

// On noise: each side as if it were the whole field.
TEST(LineWindows, FilterEachSideAsIfTheOtherWereHoles) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0F, 0.1F);
  const double x = 40.3, y = 35.0, angle = 1.1;
  const PlainField field =
      formed(90, 70, [&](int c, int r) { return noise(random) + (isLeft(x, y, angle, c, r) ? 1.0F : 0.0F); });
  for (const FilterKind kind : windowsWithLines())
    for (const int window : {3, 9}) {
      const FilterSpec spec = specOf(kind, window);
      const PlainField got = toPlain(filtered(withLines(field, {slanted(x, y, angle)}), spec).field);
      for (const bool left : {false, true}) {
        PlainField half = field;
        for (int r = 0; r < half.height; ++r)
          for (int c = 0; c < half.width; ++c)
            if (isLeft(x, y, angle, c, r) != left) half.at(c, r) = std::nanf("");
        const PlainField expected = toPlain(filtered(toVersion(half), spec).field);
        for (int r = 0; r < half.height; ++r)
          for (int c = 0; c < half.width; ++c)
            if (!std::isnan(half.at(c, r))) {
              ASSERT_TRUE(sameBits(got.at(c, r), expected.at(c, r)))
                  << static_cast<int>(kind) << ": " << c << ", " << r;
            }
      }
    }
}

// A line half a sample off puts every second sample next to it on the wrong side of a tall wall.
TEST(LineWindows, KeepSamplesOnTheSideOfTheirHeight) {
  std::mt19937 random(8);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  const double x = 40.3, y = 35.0, angle = 1.1;
  const auto truth = [&](int c, int r) { return isLeft(x, y, angle, c, r) ? 5.0F : 0.0F; };
  const PlainField field = formed(90, 70, [&](int c, int r) { return noise(random) + truth(c, r); });
  for (const FilterKind kind : windowsWithLines())
    for (const double off : {-0.6, 0.6}) {
      const PlainField got =
          toPlain(filtered(withLines(field, {slanted(x + off, y, angle)}), specOf(kind, 7)).field);
      for (int r = 0; r < field.height; ++r)
        for (int c = 0; c < field.width; ++c)
          ASSERT_NEAR(got.at(c, r), truth(c, r), 0.04) << static_cast<int>(kind) << ": " << c << ", " << r;
    }
}

TEST(LineWindows, ReachAroundTheEndOfALine) {
  const PlainField field = formed(40, 40, [](int c, int) { return c > 19 ? 1.0F : 0.0F; });
  // It ends in the middle of the field.
  const Version lined = withLines(field, {edgeLineOf({{19.5, -3.0}, {19.5, 20.5}})});
  const PlainField got = toPlain(filtered(lined, specOf(FilterKind::kBox, 5)).field);
  for (int r = 0; r < 18; ++r) EXPECT_EQ(got.at(19, r), 0.0F) << r;
  // Samples beside the line stay on the side of their height.
  for (int r = 23; r < 40; ++r) EXPECT_GT(got.at(19, r), 0.0F) << r;
}

TEST(LineWindows, GiveTheSameBitsForAnyThreadsBlocksPiecesAndUpsideDown) {
  std::mt19937 random(9);
  std::normal_distribution<float> noise(0.0F, 0.1F);
  // Walls under the lines, which are up to a sample off: heights decide there.
  const PlainField field = formed(300, 200, [&](int c, int r) {
    return noise(random) + (isLeft(150, 100, 0.3, c, r) ? 3.0F : 0.0F) +
           (isLeft(60.8, 100, 1.5, c, r) ? 5.0F : 0.0F);
  });
  const Version scan = withLines(field, {slanted(150, 100.7, 0.3), slanted(60, 100, 1.5),
                                         edgeLineOf({{200, 50}, {280, 60}, {240, 130}})});
  JobControl job;
  for (const FilterKind kind : windowsWithLines()) {
    FilterSpec spec = specOf(kind, 7);
    spec.passes = 2;
    spec.threads = 1;
    const Version whole = applyFilter(scan, scan, spec, job)->field;
    EXPECT_EQ(whole.lines(), scan.lines());
    spec.threads = 4;
    EXPECT_EQ(contentHash(applyFilter(scan, scan, spec, FilterTuning{64, CpuLevel::kPlain}, job)->field),
              contentHash(whole));
    spec.threads = 2;
    for (const int side : {64, 128, 192})
      EXPECT_EQ(contentHash(applyFilter(scan, scan, spec, FilterTuning{side}, job)->field),
                contentHash(whole));
    EXPECT_EQ(contentHash(applyFilter(scan.inverted(), scan.inverted(), spec, job)->field.inverted()),
              contentHash(whole));
    spec.passes = 1;
    const Version once = applyFilter(scan, scan, spec, job)->field;
    Version so_far = scan;
    for (const TileRange& range : {TileRange{1, 1, 2, 2}, {0, 0, 3, 5}, {3, 0, 9, 9}})
      so_far = *filterRange(scan, scan, so_far, spec, range, job);
    EXPECT_EQ(contentHash(so_far), contentHash(once));
  }
}

// The text of line_windows.h taken word by word: a way is searched sample by sample, and all medians are sorted.
float plainMedian(std::vector<float> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 != 0 ? values[n / 2]
                    : static_cast<float>((double{values[n / 2 - 1]} + double{values[n / 2]}) * 0.5);
}

struct PlainSide {
  std::vector<float> heights;
  [[nodiscard]] float median() const { return plainMedian(heights); }
  [[nodiscard]] float spread() const {
    std::vector<float> distances;
    for (const float z : heights) distances.push_back(std::fabs(z - median()));
    return plainMedian(distances);
  }
};

std::vector<float> plainLineWindow(const PlainField& field, const LineCuts& cuts, int column, int row,
                                   int radius) {
  const auto linksOf = [&](int c, int r) {
    for (const LineCut& cut : cuts.row(r))
      if (cut.column == c) return static_cast<int>(cut.links);
    return 0;
  };
  const int c0 = std::max(column - radius, 0), c1 = std::min(column + radius, field.width - 1);
  const int r0 = std::max(row - radius, 0), r1 = std::min(row + radius, field.height - 1);
  struct Sample {
    int c, r;
    bool reached = false, near = false;
  };
  std::vector<Sample> samples;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c) samples.push_back({c, r});
  const auto sampleAt = [&](int c, int r) -> Sample& {
    return samples[static_cast<std::size_t>((r - r0) * (c1 - c0 + 1) + c - c0)];
  };
  std::vector<std::vector<int>>
      links;  // of the window and one row and column before it, and those that near asks for
  constexpr int kAround = 2;
  for (int r = r0 - kAround; r <= r1 + kAround; ++r) {
    links.emplace_back();
    for (int c = c0 - kAround; c <= c1 + kAround; ++c)
      links.back().push_back(c < 0 || r < 0 || c >= field.width || r >= field.height ? 0 : linksOf(c, r));
  }
  const auto linkAt = [&](int c, int r) {
    return links[static_cast<std::size_t>(r - r0 + kAround)][static_cast<std::size_t>(c - c0 + kAround)];
  };
  sampleAt(column, row).reached = true;
  for (bool more = true; more;) {
    more = false;
    const auto join = [&](Sample& a, Sample& b, bool cut) {
      if (cut || a.reached == b.reached) return;
      a.reached = b.reached = more = true;
    };
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) {
        if (c < c1) join(sampleAt(c, r), sampleAt(c + 1, r), (linkAt(c, r) & LineCut::kRight) != 0);
        if (r < r1) join(sampleAt(c, r), sampleAt(c, r + 1), (linkAt(c, r) & LineCut::kUp) != 0);
      }
  }
  bool any_cut = false;
  for (Sample& s : samples)
    for (int y = -kAround; y < kAround; ++y)
      for (int x = -kAround; x < kAround; ++x) s.near = s.near || linkAt(s.c + x, s.r + y) != 0;
  PlainSide own, other;
  for (const Sample& s : samples) {
    any_cut = any_cut || s.near;
    if (const float z = field.at(s.c, s.r); !std::isnan(z)) (s.reached ? own : other).heights.push_back(z);
  }
  const float middle = own.median(), spread = own.spread();
  if (other.heights.empty()) {
    const auto standsOut = [&](const Sample& s) {
      return std::fabs(field.at(s.c, s.r) - middle) > 27.0F * spread;
    };
    if (any_cut && std::ranges::none_of(samples, [&](const Sample& s) { return standsOut(s) && !s.near; }))
      for (Sample& s : samples)
        if (s.near) s.reached = !standsOut(s);
  } else if (const float beyond = other.median();
             std::fabs(middle - beyond) > 9.0F * std::max(spread, other.spread())) {
    for (Sample& s : samples)
      if (const float z = field.at(s.c, s.r); s.near)
        s.reached = std::fabs(z - middle) <= std::fabs(z - beyond);
  }
  const bool mine = sampleAt(column, row).reached;
  std::vector<float> counted;
  for (const Sample& s : samples)
    if (const float z = field.at(s.c, s.r); s.reached == mine && !std::isnan(z)) counted.push_back(z);
  return counted;
}

// A long double holds the sums of these tests exactly.
float plainMean(const std::vector<float>& values) {
  long double sum = 0.0L;
  for (const float z : values) sum += static_cast<long double>(z);
  return static_cast<float>(static_cast<double>(sum) / static_cast<double>(values.size()));
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kPlainEvery = 29;  // the plain search is slow there
#else
constexpr int kPlainEvery = 1;
#endif

TEST(LineWindows, AreThoseOfAPlainSearchBitForBit) {
  std::mt19937 random(12);
  std::normal_distribution<float> noise(0.0F, 0.1F);
  PlainField field = formed(97, 71, [&](int c, int r) {
    return noise(random) + (isLeft(40.6, 30, 1.2, c, r) ? 4.0F : 0.0F) +
           (isLeft(70, 40, 0.4, c, r) ? 0.3F : 0.0F);
  });
  for (int k = 0; k < 400; ++k)
    field.at(static_cast<int>(random() % 97), static_cast<int>(random() % 71)) = std::nanf("");
  for (int k = 0; k < 30; ++k)  // equal heights, and some that stand out
    field.at(static_cast<int>(random() % 97), static_cast<int>(random() % 71)) = k % 2 == 0 ? 0.0F : 9.0F;
  const Version scan =
      withLines(field, {slanted(40, 30, 1.2), slanted(70, 40, 0.4), edgeLineOf({{10, 8}, {30, 12}, {22, 50}}),
                        edgeLineOf({{12, 60.5}, {32, 60.5}, {32, 66}, {12, 66}})});
  const LineCuts cuts(*scan.lines(), 97, 71);
  // A plain search takes the square of the window for each sample: of large windows some samples all over the field.
  for (const auto& [window, every] : {std::pair(5, 1), {13, 5}, {25, 23}, {51, 83}}) {
    const PlainField median = toPlain(filtered(scan, specOf(FilterKind::kMedian, window)).field);
    const PlainField mean = toPlain(filtered(scan, specOf(FilterKind::kBox, window)).field);
    for (int k = 0; k < field.width * field.height; k += every * kPlainEvery)
      if (const int c = k % field.width, r = k / field.width; !std::isnan(field.at(c, r))) {
        const std::vector<float> counted = plainLineWindow(field, cuts, c, r, window / 2);
        ASSERT_TRUE(sameBits(median.at(c, r), plainMedian(counted))) << window << ": " << c << ", " << r;
        ASSERT_TRUE(sameBits(mean.at(c, r), plainMean(counted))) << window << ": " << c << ", " << r;
      }
  }
}

TEST(LineWindows, LargeOnesAreRefused) {
  const PlainField field = formed(60, 60, [](int c, int) { return static_cast<float>(c); });
  const Version lined = withLines(field, {slanted(30, 30, 0.5)});
  JobControl job;
  EXPECT_TRUE(applyFilter(lined, lined, specOf(FilterKind::kBox, kMostLineWindow), job));
  const auto refused = applyFilter(lined, lined, specOf(FilterKind::kBox, kMostLineWindow + 2), job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
}

class LineWindowsHardField : public testing::TestWithParam<std::string> {};

TEST_P(LineWindowsHardField, KeepHolesMarksAndFiniteHeights) {
  const PlainField field = hardField(GetParam());
  const double w = field.width, h = field.height;
  const Version scan =
      withLines(field, {edgeLineOf({{0.5, -1.0}, {0.5, h}}), edgeLineOf({{-1.0, 0.3 * h}, {w, 0.6 * h}}),
                        edgeLineOf({{0.2 * w, 0.2 * h}, {0.7 * w, 0.3 * h}, {0.4 * w, 0.9 * h}})});
  for (const FilterKind kind : windowsWithLines()) {
    const PlainField got = toPlain(filtered(scan, specOf(kind, 5)).field);
    for (int r = 0; r < field.height; ++r)
      for (int c = 0; c < field.width; ++c) {
        ASSERT_EQ(std::isnan(got.at(c, r)), std::isnan(field.at(c, r)));
        ASSERT_FALSE(std::isinf(got.at(c, r)));
        if (field.marked(c, r)) {
          ASSERT_TRUE(sameBits(got.at(c, r), field.at(c, r)));
        }
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, LineWindowsHardField, testing::ValuesIn(hardFieldNames()),
                         [](const auto& test) {
                           std::string text = test.param;
                           for (char& c : text) c = c == ' ' ? '_' : c;
                           return text;
                         });

}  // namespace
}  // namespace fettle::engine::tests
