#include "engine/measure/section.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/measure/section_figures.h"

namespace fettle::engine {
namespace {

constexpr float kSectionHole = std::numeric_limits<float>::quiet_NaN();

Version sectionField(std::int32_t width, std::int32_t height, double spacing_x, double spacing_y,
                     const std::function<double(double, double)>& z_mm,
                     const std::function<bool(int, int)>& marked = {}) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      heights.push_back(static_cast<float>(z_mm(c * spacing_x, r * spacing_y)));
      if (marked) marks.push_back(marked(c, r) ? 1 : 0);
    }
  return makeField(grid, heights, marks);
}

Section taken(const Version& field, const std::vector<glm::dvec2>& points,
              const SectionOptions& options = {}) {
  JobControl job;
  auto section = sectionAlong(field, points, options, job);
  EXPECT_TRUE(section) << section.error().line();
  return section ? *std::move(section) : Section{};
}

// A bilinear surface is its own interpolation, in any direction, at unequal spacing and across a width.
TEST(Section, OfABilinearSurfaceIsExact) {
  const auto surface = [](double x, double y) { return 0.25 + 0.5 * x - 0.125 * y + 0.0625 * x * y; };
  const Version field = sectionField(65, 41, 0.25, 1.0, surface);
  for (const std::vector<glm::dvec2>& line : {std::vector<glm::dvec2>{{1.0, 3.0}, {14.0, 35.0}},
                                              {{0.0, 0.0}, {16.0, 40.0}},
                                              {{2.0, 9.0}, {2.0, 30.0}},
                                              {{1.0, 1.0}, {8.0, 3.0}, {5.0, 30.0}}}) {
    const Section section = taken(field, line);
    ASSERT_GT(section.size(), 20U);
    for (std::size_t i = 0; i < section.size(); ++i)
      // Heights of up to 40 are rounded to float: 2^-19.
      ASSERT_NEAR(section.height[i], surface(section.position[i].x, section.position[i].y), 2e-6) << i;
    EXPECT_EQ(section.position.front(), line.front());
    EXPECT_NEAR(section.position.back().x, line.back().x, 1e-12);
    EXPECT_NEAR(section.position.back().y, line.back().y, 1e-12);
  }
}

// Along a row of samples the heights are those of the samples.
TEST(Section, AlongARowIsTheRow) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Version field = sectionField(50, 9, 0.1, 0.1, [&](double, double) { return normal(random); });
  const Section section = taken(field, {{0.0, 0.4}, {4.9, 0.4}});
  ASSERT_EQ(section.size(), 50U);
  for (std::size_t i = 0; i < 50; ++i)
    EXPECT_EQ(section.height[i], double{field.reader().heightAt(static_cast<std::int32_t>(i), 4)});
  EXPECT_NEAR(section.lengthMm(), 4.9, 1e-12);
}

// The covariance by the weights of each sample, which are what a field that is 1 there and 0 elsewhere shows.
TEST(Section, StatesTheCovarianceOfItsHeights) {
  constexpr int kWidth = 14, kHeight = 12;
  const std::vector<glm::dvec2> line{{0.3, 0.9}, {3.1, 2.2}};
  const SectionOptions options{.width_mm = 0.9};
  for (const double spacing_y : {0.3, 0.7}) {
    Section section;
    std::vector<std::vector<double>> shares;  // of each sample
    for (int sample = 0; sample < kWidth * kHeight; ++sample) {
      const Version one = sectionField(kWidth, kHeight, 0.3, spacing_y, [&](double x, double y) {
        return std::lround(x / 0.3) + kWidth * std::lround(y / spacing_y) == sample ? 1.0 : 0.0;
      });
      section = taken(one, line, options);
      shares.push_back(section.height);
    }
    EXPECT_GT(section.lanes, 1);
    const auto n = section.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i; j < n; ++j) {
        double expected = 0.0;
        for (const auto& share : shares) expected += share[i] * share[j];
        const auto band = static_cast<std::size_t>(section.band);
        const double stated = j - i < band ? section.covariance[i * band + (j - i)] : 0.0;
        ASSERT_NEAR(stated, expected, 1e-12) << spacing_y << ' ' << i << ' ' << j;
      }
  }
}

// Rows off alone, columns alone, or both: each place by the lines that its height is of.
TEST(Section, IsOffByTheRowsAndColumnsThatItsHeightsAreOf) {
  const Version field = sectionField(30, 20, 0.5, 0.25, [](double x, double y) { return x + y; });
  std::vector<double> rows(20), columns(30);
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = 0.25 * static_cast<double>(r * r % 7);
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = 0.125 * static_cast<double>(c * c % 11);
  // Along row 6 from column 4 to 20, sample by sample.
  const Section section = taken(field, {{2.0, 1.5}, {10.0, 1.5}});
  const std::vector<Section::LineOffsets> offsets{{rows, {}}, {{}, columns}, {rows, columns}};
  const auto off = section.offBy(offsets);
  ASSERT_EQ(off.size(), 3U);
  for (std::size_t i = 0; i < section.size(); ++i) {
    const double column = section.along(i) / 0.5 + 4.0;
    const auto left = static_cast<std::size_t>(column);
    const double share = column - static_cast<double>(left);
    const double by_column = (1.0 - share) * columns[left] + (share > 0.0 ? share * columns[left + 1] : 0.0);
    EXPECT_NEAR(off[0][i], rows[6], 1e-12) << i;
    EXPECT_NEAR(off[1][i], by_column, 1e-12) << i;
    EXPECT_NEAR(off[2][i], rows[6] + by_column, 1e-12) << i;
  }
}

TEST(Section, HasNoHeightNextToHolesAndMarksThatAreLeftOut) {
  const auto flat = [](double x, double y) { return x == 10.0 && y == 5.0 ? double{kSectionHole} : 1.0; };
  const Version field = sectionField(30, 11, 1.0, 1.0, flat, [](int c, int) { return c == 20; });
  const Section between = taken(field, {{0.0, 4.5}, {29.0, 4.5}});
  for (std::size_t i = 0; i < between.size(); ++i)
    EXPECT_EQ(std::isnan(between.height[i]), between.position[i].x == 10.0) << i;
  // Half a sample along: two neighbours of each hole.
  const Section half = taken(field, {{0.5, 4.5}, {28.5, 4.5}}, {.region = Region::kUnmarked});
  for (std::size_t i = 0; i < half.size(); ++i)
    EXPECT_EQ(std::isnan(half.height[i]),
              std::abs(half.position[i].x - 10.0) < 1.0 || std::abs(half.position[i].x - 20.0) < 1.0)
        << i;
  // Of many lanes one may be missing, and the share says so.
  const Section wide = taken(field, {{0.0, 5.0}, {29.0, 5.0}}, {.width_mm = 6.0});
  EXPECT_EQ(wide.lanes, 7);
  EXPECT_DOUBLE_EQ(wide.share[10], 6.0 / 7.0);
  EXPECT_EQ(wide.height[10], 1.0);
  const Section nearest = taken(field, {{0.0, 4.4}, {29.0, 4.4}}, {.interpolation = Interpolation::kNearest});
  for (const double z : nearest.height) EXPECT_EQ(z, 1.0);
}

TEST(Section, RefusesWhatIsNone) {
  const Version field = sectionField(5, 5, 1.0, 1.0, [](double, double) { return 0.0; });
  const Version holes = sectionField(5, 5, 1.0, 1.0, [](double, double) { return double{kSectionHole}; });
  JobControl job;
  const auto fails = [&](const Version& f, const std::vector<glm::dvec2>& points,
                         SectionOptions options = {}) {
    const auto section = sectionAlong(f, points, options, job);
    return !section && section.error().kind == ErrorKind::kInput;
  };
  EXPECT_TRUE(fails(field, {{1.0, 1.0}}));
  EXPECT_TRUE(fails(field, {{1.0, 1.0}, {1.0, 1.0}}));
  EXPECT_TRUE(fails(field, {{0.0, 0.0}, {1e300, 0.0}}));
  EXPECT_TRUE(fails(field, {{0.0, 0.0}, {std::nan(""), 0.0}}));
  EXPECT_TRUE(fails(field, {{10.0, 10.0}, {12.0, 10.0}}));
  EXPECT_TRUE(fails(field, {{0.0, 0.0}, {4.0, 0.0}}, {.width_mm = -1.0}));
  EXPECT_TRUE(fails(field, {{0.0, 0.0}, {4.0, 0.0}}, {.width_mm = 1e9}));
  EXPECT_TRUE(fails(holes, {{0.0, 0.0}, {4.0, 0.0}}));
}

TEST(SectionFigures, OfLinesAreThoseOfTheLines) {
  const auto roof = [](double x, double) { return x < 5.0 ? 0.5 * x : 2.5 - 0.25 * (x - 5.0); };
  const Section section = taken(sectionField(101, 5, 0.1, 0.1, roof), {{0.0, 0.2}, {10.0, 0.2}});
  const auto angle = angleFigures(section, {0.5, 4.5}, {5.5, 9.5}, {0.0});
  ASSERT_TRUE(angle) << angle.error().line();
  constexpr double kDegree = 180.0 / 3.14159265358979323846;
  const double turn = (std::atan(-0.25) - std::atan(0.5)) * kDegree;
  // Heights are floats of up to 2.5: 1.2e-7 over 4 mm of 41 places.
  EXPECT_NEAR(angle->turn_deg.value, turn, 1e-5);
  EXPECT_NEAR(angle->included_deg.value, 180.0 + turn, 1e-5);
  EXPECT_NEAR(angle->meet_along_mm.value, 5.0, 1e-6);
  EXPECT_NEAR(angle->meet_height_mm.value, 2.5, 1e-6);
  EXPECT_NEAR(angle->first.slope.value, 0.5, 1e-7);
  EXPECT_NEAR(angle->first.height_mm.value, 1.25, 1e-6);
  EXPECT_NEAR(angle->second.inclination_deg.value, std::atan(-0.25) * kDegree, 1e-5);
  EXPECT_FALSE(lineFigures(section, {3.0, 3.1}, {0.0}));
}

TEST(SectionFigures, StepAndGrooveOnASlopeAreThoseAcrossIt) {
  const double slope = 0.1, cosine = 1.0 / std::hypot(1.0, slope);
  const Version step =
      sectionField(101, 5, 0.1, 0.1, [&](double x, double) { return slope * x + (x > 4.05 ? 0.05 : 0.0); });
  const Section section = taken(step, {{0.0, 0.2}, {10.0, 0.2}});
  EXPECT_NEAR(edgeIn(section, {0.0, 10.0}), 4.05, 1e-9);
  const auto figures = stepFigures(section, 4.05, {0.0, 10.0}, {0.0});
  ASSERT_TRUE(figures) << figures.error().line();
  EXPECT_NEAR(figures->step_mm.value, 0.05 * cosine, 1e-7);
  EXPECT_NEAR(figures->inclination_deg.value, std::atan(slope) * 180.0 / 3.14159265358979, 1e-5);
  EXPECT_NEAR(figures->before.from_mm, 0.0, 1e-12);
  EXPECT_NEAR(figures->before.to_mm, 4.05 * 2.0 / 3.0, 1e-12);

  const Version groove = sectionField(
      201, 5, 0.1, 0.1, [&](double x, double) { return slope * x - (x > 8.05 && x < 12.05 ? 0.02 : 0.0); });
  const Section across = taken(groove, {{0.0, 0.2}, {20.0, 0.2}});
  const Stretch found = grooveIn(across, {0.0, 20.0});
  EXPECT_NEAR(found.from_mm, 8.05, 1e-9);
  EXPECT_NEAR(found.to_mm, 12.05, 1e-9);
  const auto depth = grooveFigures(across, 8.05, 12.05, {0.0});
  ASSERT_TRUE(depth) << depth.error().line();
  EXPECT_NEAR(depth->step_mm.value, 0.02 * cosine, 3e-7);
  EXPECT_NEAR(depth->before.from_mm, 4.05, 1e-12);
  EXPECT_NEAR(depth->edge_after.from_mm, 8.05 + 4.0 / 3.0, 1e-12);
  EXPECT_NEAR(depth->behind.to_mm, 16.05, 1e-12);
  EXPECT_FALSE(grooveFigures(across, 12.0, 8.0, {0.0}));
  // Of a line that ends sooner than a width beside the groove it is what there is.
  const Section near_ends = taken(groove, {{6.0, 0.2}, {15.0, 0.2}});
  const auto cut = grooveFigures(near_ends, 2.05, 6.05, {0.0});
  ASSERT_TRUE(cut) << cut.error().line();
  EXPECT_NEAR(cut->step_mm.value, 0.02 * cosine, 3e-7);
  EXPECT_EQ(cut->before.from_mm, 0.0);
  EXPECT_EQ(cut->behind.to_mm, near_ends.lengthMm());
  EXPECT_FALSE(stepFigures(across, 0.0, {0.0, 20.0}, {0.0}));
}

// Short and long arcs, hollow and raised, beside the middle of the circle too.
TEST(SectionFigures, ArcIsTheCircle) {
  for (const double sign : {-1.0, 1.0})
    for (const double half : {0.1, 0.6, 1.9})
      for (const double centre : {3.0, 3.7}) {
        const Version field = sectionField(601, 3, 0.01, 0.01, [&](double x, double) {
          const double u = x - centre;
          return std::abs(u) < 2.0 ? -sign * std::sqrt(4.0 - u * u) : 0.0;
        });
        const Section section = taken(field, {{0.0, 0.01}, {6.0, 0.01}});
        const double middle = centre == 3.0 ? 3.0 : centre - 0.05;
        const Stretch stretch{middle - half, std::min(middle + half, centre + 1.9)};
        const auto arc = arcFigures(section, stretch, {std::nan("")});
        ASSERT_TRUE(arc) << arc.error().line();
        // Heights are floats of up to 2: 6e-8 rms over an arc of 2 half; its sagitta is half^2 / 2 R.
        const double allowed = 6.0 * 6e-8 * 2.0 * 4.0 * 3.4 / (half * half * std::sqrt(half / 0.1));
        EXPECT_NEAR(arc->radius_mm.value, 2.0, allowed) << sign << ' ' << half;
        EXPECT_NEAR(arc->centre_along_mm.value, centre, allowed + 1e-6);
        EXPECT_NEAR(arc->centre_height_mm.value, 0.0, allowed + 1e-6);
        EXPECT_EQ(arc->hollow, sign > 0.0);
      }
  const Section flat = taken(sectionField(50, 3, 1.0, 1.0, [](double x, double) { return 0.1 * x; }),
                             {{0.0, 1.0}, {49.0, 1.0}});
  EXPECT_FALSE(arcFigures(flat, {0.0, 49.0}, {0.001}));
  EXPECT_FALSE(arcFigures(flat, {0.0, 2.0}, {0.001}));
}

TEST(SectionFigures, CursorsReadWhatLiesBetween) {
  const Version field = sectionField(41, 31, 0.1, 0.1, [](double x, double y) { return 0.3 * x + 0.4 * y; });
  const Section section = taken(field, {{0.0, 0.0}, {4.0, 3.0}});
  const auto cursors = cursorFigures(section, 1.0, 3.0, {0.01});
  ASSERT_TRUE(cursors) << cursors.error().line();
  const double slope = 0.3 * 0.8 + 0.4 * 0.6;
  EXPECT_NEAR(cursors->dx_mm, 2.0, 1e-12);
  EXPECT_NEAR(cursors->dz_mm.value, 2.0 * slope, 1e-6);
  EXPECT_NEAR(cursors->slope_deg, std::atan(slope) * 180.0 / 3.14159265358979, 1e-5);
  EXPECT_NEAR(cursors->distance_mm, std::hypot(2.0, 2.0 * slope), 1e-6);
  // Far apart two heights share no sample: between sqrt(2) / 2 and sqrt(2) times the noise.
  EXPECT_GT(cursors->dz_mm.error, 0.007);
  EXPECT_LT(cursors->dz_mm.error, 0.0142);
  EXPECT_FALSE(cursorFigures(section, 1.0, 6.0, {0.0}));
}

// Spikes at 5e6 mm and heights far from 0 leave figures, not NaN.
TEST(SectionFigures, HardCases) {
  Grid grid;
  grid.width = 40;
  grid.height = 1;
  std::vector<float> heights(40, 1000.0F);
  for (std::size_t i = 20; i < 40; ++i) heights[i] = 1000.05F;
  heights[5] = 1e6F;
  JobControl job;
  const std::vector<glm::dvec2> line{{0.0, 0.0}, {39.0, 0.0}};
  const auto section = sectionAlong(makeField(grid, heights), line, {}, job);
  ASSERT_TRUE(section) << section.error().line();
  const auto step = stepFigures(*section, 19.5, {0.0, 39.0}, {0.001});
  ASSERT_TRUE(step);
  // The spike is far more than the noise, and the error says so.
  EXPECT_GT(step->step_mm.error, std::abs(step->step_mm.value - 0.05) / 5.0);
  EXPECT_TRUE(std::isfinite(step->step_mm.error));
}

// What lies behind a part is not of it: the first half of a section, and of the weights of a whole one.
TEST(Section, VarianceOfAPartIsThatOfTheWholeWithoutTheOtherWeights) {
  const Section whole = taken(sectionField(60, 9, 0.1, 0.1, [](double x, double y) { return x + 0.1 * y; }),
                              {{0.0, 0.31}, {5.9, 0.47}});
  std::vector<double> weights(whole.size()), others(whole.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = 1.0 + 0.1 * static_cast<double>(i % 7);
    others[i] = static_cast<double>(i % 3) - 0.5;
  }
  const std::size_t half = whole.size() / 2;
  Section part = whole;
  part.position.resize(half);
  part.height.resize(half);
  part.share.resize(half);
  part.covariance.resize(half * static_cast<std::size_t>(part.band));
  const std::span<const double> some(weights.data(), half), some_others(others.data(), half);
  const double variance = part.variance(some), covariance = part.covarianceOf(some, some_others);
  std::fill(weights.begin() + static_cast<std::ptrdiff_t>(half), weights.end(), 0.0);
  std::fill(others.begin() + static_cast<std::ptrdiff_t>(half), others.end(), 0.0);
  EXPECT_DOUBLE_EQ(variance, whole.variance(weights));
  EXPECT_DOUBLE_EQ(covariance, whole.covarianceOf(weights, others));
  EXPECT_GT(variance, 1.0);
}

// One edge, or noise alone, is no groove; a groove in the same noise is found.
TEST(Section, AGrooveHasTwoEdges) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(0.0, 0.001);
  const auto found = [&](const std::function<double(double)>& z) {
    const Section section =
        taken(sectionField(200, 9, 0.1, 0.1, [&](double x, double) { return z(x) + normal(random); }),
              {{0.0, 0.4}, {19.9, 0.4}});
    return grooveIn(section, {0.0, 20.0});
  };
  for (int trial = 0; trial < 20; ++trial) {
    EXPECT_TRUE(std::isnan(found([](double) { return 0.0; }).from_mm));
    EXPECT_TRUE(std::isnan(found([](double x) { return x > 12.0 ? 0.05 : 0.0; }).from_mm));
    const Stretch groove = found([](double x) { return x > 8.0 && x < 12.0 ? -0.05 : 0.0; });
    EXPECT_NEAR(groove.from_mm, 8.05, 0.051);
    EXPECT_NEAR(groove.to_mm, 11.95, 0.051);
  }
}

}  // namespace
}  // namespace fettle::engine
