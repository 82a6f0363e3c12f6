// What the standard errors of a section are worth: simulated scans of a step of 50 um, a radius of 2 mm and an angle of 30
// degrees. The table of 1,000 is printed: FETTLE_TRIALS=1000 build/release/tests/engine/measure/measure_test
// --gtest_filter='SectionUncertainty*'

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/inspect/noise.h"
#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"
#include "tests/support/coverage.h"

namespace fettle::engine {
namespace {

using tests::countsCoverage;
using tests::Coverage;
using tests::coverageSeeds;
using tests::scatterOfRms;

constexpr double kSpacing = 0.01, kNoise = 0.002;  // mm
constexpr int kColumns = 201, kRows = 41;

// A part whose shape runs across a direction: z(u), u = x cos + y sin.
struct Part {
  std::string name;
  double truth = 0.0;
  std::function<double(double u)> height;
  // The figure of a section, in the unit of the truth.
  std::function<Estimate(const Section&, double noise)> measured;
  // Derivatives of the model of the samples by its parameters, the wanted one first; none for a sample not used.
  std::function<std::vector<double>(double u)> derivatives;
};

struct Covered : Coverage {
  double bound = 0.0;  // of Cramer and Rao
};

// The least standard error of the wanted parameter that the samples which the section uses allow (H. Cramer 1946,
// C. R. Rao 1945). A sample is used where a field that is 1 there alone shows in the section.
double boundOf(const Part& part, const Grid& grid, const std::vector<glm::dvec2>& line,
               const SectionOptions& options, glm::dvec2 direction) {
  const std::vector<float> none(static_cast<std::size_t>(grid.samples()), 0.0F);
  std::vector<std::vector<double>> rows;
  const double lane = 0.5 * options.width_mm + 1.5 * kSpacing;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const glm::dvec2 at(c * kSpacing, r * kSpacing);
      const glm::dvec2 from = at - line.front();
      if (std::abs(from.x * direction.y - from.y * direction.x) > lane) continue;
      std::vector<float> one = none;
      one[static_cast<std::size_t>(r * grid.width + c)] = 1.0F;
      JobControl job;
      const auto section = sectionAlong(makeField(grid, one), line, options, job);
      bool used = false;
      for (std::size_t i = 0; section && i < section->size(); ++i)
        used = used || (section->height[i] > 0.0 && !part.derivatives(section->along(i)).empty());
      const std::vector<double> row = part.derivatives(from.x * direction.x + from.y * direction.y);
      if (used && !row.empty()) rows.push_back(row);
    }
  // The information of all samples, [A | 1], to [1 | A^-1] by Gauss and Jordan: positive definite, so that no pivot is 0.
  const std::size_t p = rows.front().size();
  std::vector<std::vector<double>> information(p, std::vector<double>(2 * p));
  for (std::size_t a = 0; a < p; ++a) {
    for (std::size_t b = 0; b < p; ++b)
      for (const std::vector<double>& row : rows) information[a][b] += row[a] * row[b];
    information[a][p + a] = 1.0;
  }
  for (std::size_t k = 0; k < p; ++k) {
    const double pivot = information[k][k];
    for (double& entry : information[k]) entry /= pivot;
    for (std::size_t a = 0; a < p; ++a) {
      const double factor = a == k ? 0.0 : information[a][k];
      for (std::size_t b = 0; b < 2 * p; ++b) information[a][b] -= factor * information[k][b];
    }
  }
  return kNoise * std::sqrt(information[0][p]);
}

Covered coverage(const Part& part, double degrees, double width_mm) {
  Grid grid;
  grid.width = kColumns;
  grid.height = kRows;
  grid.spacing_x = grid.spacing_y = kSpacing;
  const double angle = degrees * 3.14159265358979323846 / 180.0;
  const glm::dvec2 direction(std::cos(angle), std::sin(angle)), from(0.1, 0.2 - 0.9 * std::sin(angle));
  const std::vector<glm::dvec2> line{from, from + 1.8 * direction};
  const SectionOptions options{.width_mm = width_mm};
  Covered covered;
  for (int seed = 0; seed < coverageSeeds(); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 1);
    std::normal_distribution<double> normal(0.0, kNoise);
    std::vector<float> heights;
    heights.reserve(static_cast<std::size_t>(grid.samples()));
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const glm::dvec2 at = glm::dvec2(c * kSpacing, r * kSpacing) - from;
        heights.push_back(
            static_cast<float>(part.height(at.x * direction.x + at.y * direction.y) + normal(random)));
      }
    const Version field = makeField(grid, heights);
    JobControl job;
    const auto noise = estimateNoise(field, job);
    const auto section = sectionAlong(field, line, options, job);
    if (!noise || !section) {
      ADD_FAILURE() << "seed " << seed;
      continue;
    }
    const Estimate figure = part.measured(*section, noise->sigma);
    covered.add(figure.value - part.truth, figure.error);
  }
  covered.bound = boundOf(part, grid, line, options, direction);
  return covered;
}

Part step() {
  // Sections are 1.8 mm long: stretches of 0.6 mm on both sides, with the third next to the edge left out.
  const auto outside = [](double u) { return u > -1e-9 && u < 1.8 + 1e-9 && std::abs(u - 0.9) > 0.3 - 1e-9; };
  return {
      "step of 50 um", 0.05, [](double u) { return u > 0.9 ? 0.05 : 0.0; },
      [](const Section& s, double noise) {
        const auto figures = stepFigures(s, 0.9, {0.0, 1.8}, {noise});
        return figures ? figures->step_mm : Estimate{};
      },
      [outside](double u) {
        return outside(u) ? std::vector<double>{u > 0.9 ? 1.0 : 0.0, 1.0, u - 0.9} : std::vector<double>{};
      }};
}

Part radius() {
  constexpr double kRadius = 2.0;
  return {"radius of 2 mm", kRadius,
          [](double u) { return std::sqrt(kRadius * kRadius - (u - 0.9) * (u - 0.9)); },
          [](const Section& s, double noise) {
            const auto figures = arcFigures(s, {0.0, 1.8}, {noise});
            return figures ? figures->radius_mm : Estimate{};
          },
          [](double u) {
            if (u < -1e-9 || u > 1.8 + 1e-9) return std::vector<double>{};
            const double height = std::sqrt(kRadius * kRadius - (u - 0.9) * (u - 0.9));
            return std::vector<double>{kRadius / height, (u - 0.9) / height, 1.0};
          }};
}

Part angle() {
  // Two faces, each inclined by 15 degrees.
  const double slope = std::tan(15.0 * 3.14159265358979323846 / 180.0);
  return {"angle of 30 degrees", -30.0, [slope](double u) { return -slope * std::abs(u - 0.9); },
          [](const Section& s, double noise) {
            const auto figures = angleFigures(s, {0.0, 0.85}, {0.95, 1.8}, {noise});
            return figures ? figures->turn_deg : Estimate{};
          },
          [slope](double u) {
            if (u < -1e-9 || u > 1.8 + 1e-9 || std::abs(u - 0.9) < 0.05 - 1e-9) return std::vector<double>{};
            // Slopes as (a - t) / 2 and (a + t) / 2, t in degrees of turn.
            const double by = (1.0 + slope * slope) * 3.14159265358979323846 / 180.0;
            const double x = u - 0.9, left = u < 0.9 ? 1.0 : 0.0;
            return std::vector<double>{(left > 0.0 ? -0.5 : 0.5) * by * x, x, left, 1.0 - left};
          }};
}

TEST(SectionUncertainty, CoversAtOneTwoAndThreeTimesAndIsNearTheBound) {
  std::printf("%-20s %8s %7s %-22s %11s %11s %11s %7s\n", "", "degrees", "width", "within 1, 2, 3", "error",
              "stated", "bound", "ratio");
  for (const Part& part : {step(), radius(), angle()})
    for (const auto& [degrees, width] : {std::pair{0.0, 0.0}, {0.0, 0.1}, {5.0, 0.0}, {5.0, 0.1}}) {
      const Covered c = coverage(part, degrees, width);
      std::printf("%-20s %8.0f %7.2f %-22s %11.3e %11.3e %11.3e %7.3f\n", part.name.c_str(), degrees, width,
                  c.counts().c_str(), c.rms(), c.stated(), c.bound, c.rms() / c.bound);
      if (!countsCoverage()) continue;
      EXPECT_EQ(c.complaint(), "") << part.name << degrees << width;
      EXPECT_LE(c.rms(), 1.5 * c.bound) << part.name << degrees << width;
      EXPECT_GE(c.rms(), (1.0 - scatterOfRms()) * c.bound) << part.name << degrees << width;
    }
}

Part groove() {
  // From 0.6 to 1.2 mm, so that the stretches are 0 to 0.4, 0.8 to 1 and 1.4 to 1.8 mm.
  return {"groove of 50 um", 0.05, [](double u) { return u > 0.6 && u < 1.2 ? -0.05 : 0.0; }, {}, {}};
}

// The same with offsets of rows or columns of 5 times the noise: along a row it has one, which no difference of heights has,
// across the rows there is another at each place, and aslant some places share one.
TEST(SectionUncertainty, CoversWhereRowsOrColumnsAreOff) {
  using Measured = std::function<Estimate(const Section&, const SectionNoise&)>;
  const auto valueOf = [](const auto& figures, auto member) {
    return figures ? (*figures).*member : Estimate{};
  };
  struct Case {
    Part part;
    Measured measured;
  };
  Part line = angle();
  line.name = "line's height";
  line.truth = 0.0;
  line.height = [](double) { return 0.0; };
  Part slope = line;
  slope.name = "line's slope";
  const std::vector<Case> cases{
      {step(),
       [&](const Section& s, const SectionNoise& noise) {
         return valueOf(stepFigures(s, 0.9, {0.0, 1.8}, noise), &StepFigures::step_mm);
       }},
      {groove(),
       [&](const Section& s, const SectionNoise& noise) {
         return valueOf(grooveFigures(s, 0.6, 1.2, noise), &StepFigures::step_mm);
       }},
      {radius(),
       [&](const Section& s, const SectionNoise& noise) {
         return valueOf(arcFigures(s, {0.0, 1.8}, noise), &ArcFigures::radius_mm);
       }},
      {angle(),
       [&](const Section& s, const SectionNoise& noise) {
         return valueOf(angleFigures(s, {0.0, 0.85}, {0.95, 1.8}, noise), &AngleFigures::turn_deg);
       }},
      {line,
       [&](const Section& s, const SectionNoise& noise) {
         return valueOf(lineFigures(s, {0.0, 1.8}, noise), &LineFigures::height_mm);
       }},
      {slope, [&](const Section& s, const SectionNoise& noise) {
         return valueOf(lineFigures(s, {0.0, 1.8}, noise), &LineFigures::slope);
       }}};
  constexpr int kSide = 201;
  constexpr double kOff = 5.0 * kNoise;
  struct Line {
    const char* name;
    double degrees, width_mm;
    bool rows;  // are off, else columns
  };
  Grid grid;
  grid.width = grid.height = kSide;
  grid.spacing_x = grid.spacing_y = kSpacing;
  for (const Case& one : cases)
    for (const Line& of : {Line{"along a row", 0.0, 0.0, true},
                           {"along a row, wide", 0.0, 0.1, true},
                           {"across the rows", 90.0, 0.0, true},
                           {"across the rows, wide", 90.0, 0.1, true},
                           {"at 5 degrees", 5.0, 0.0, true},
                           {"at 30 degrees, wide", 30.0, 0.1, true},
                           {"across the columns", 0.0, 0.0, false},
                           {"along a column", 90.0, 0.0, false}}) {
      const double turn = of.degrees * 3.14159265358979323846 / 180.0;
      const glm::dvec2 direction(std::cos(turn), std::sin(turn)), from = glm::dvec2(1.0) - 0.9 * direction;
      const std::vector<glm::dvec2> points{from, from + 1.8 * direction};
      Coverage covered;
      for (int seed = 0; seed < coverageSeeds(); ++seed) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 1);
        std::normal_distribution<double> normal;
        std::vector<double> off(kSide);
        for (double& each : off) each = kOff * normal(random);
        std::vector<float> heights(static_cast<std::size_t>(grid.samples()),
                                   std::numeric_limits<float>::quiet_NaN());
        for (int r = 0; r < kSide; ++r)
          for (int c = 0; c < kSide; ++c) {
            const glm::dvec2 at = glm::dvec2(c, r) * kSpacing - from;
            // What the section does not reach is not drawn.
            if (std::abs(at.x * direction.y - at.y * direction.x) > 0.5 * of.width_mm + 3.0 * kSpacing)
              continue;
            heights[static_cast<std::size_t>(r * kSide + c)] =
                static_cast<float>(one.part.height(at.x * direction.x + at.y * direction.y) +
                                   off[static_cast<std::size_t>(of.rows ? r : c)] + kNoise * normal(random));
          }
        JobControl job;
        const auto section = sectionAlong(makeField(grid, heights), points, {.width_mm = of.width_mm}, job);
        ASSERT_TRUE(section) << section.error().line();
        const Estimate figure = one.measured(*section, {kNoise, of.rows ? kOff : 0.0, of.rows ? 0.0 : kOff});
        covered.add(figure.value - one.part.truth, figure.error);
      }
      std::printf("%-20s %-22s %s  error %.3e stated %.3e\n", one.part.name.c_str(), of.name,
                  covered.counts().c_str(), covered.rms(), covered.stated());
      if (!countsCoverage()) continue;
      EXPECT_EQ(covered.complaint(), "") << one.part.name << ' ' << of.name;
      EXPECT_LE(covered.stated(), 1.5 * covered.rms()) << one.part.name << ' ' << of.name;
    }
}

}  // namespace
}  // namespace fettle::engine
