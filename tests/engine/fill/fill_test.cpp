#include "engine/fill/fill.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "engine/field/line_cuts.h"
#include "engine/fill/holes.h"

namespace fettle::engine {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
using Surface2 = std::function<double(int, int)>;
using Where = std::function<bool(int, int)>;

Version scanOf(int width, int height, const Surface2& z, const Where& hole, const Where& marked = {},
               double spacing_x = 1.0, double spacing_y = 1.0) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      heights.push_back(hole(c, r) ? kNone : static_cast<float>(z(c, r)));
      marks.push_back(marked && marked(c, r) ? 1 : 0);
    }
  return makeField(grid, heights, marks);
}

Filled fill(const Version& scan, const FillOptions& options) {
  JobControl job;
  auto filled = fillHoles(scan, options, job);
  EXPECT_TRUE(filled) << filled.error().line();
  return filled ? *std::move(filled) : Filled{};
}

double worst(const Version& field, const Surface2& z) {
  double most = 0.0;
  for (int r = 0; r < field.grid().height; ++r)
    for (int c = 0; c < field.grid().width; ++c)
      most = std::max(most, std::abs(static_cast<double>(field.reader().heightAt(c, r)) - z(c, r)));
  return most;
}

FillOptions by(FillMethod method, bool at_border = false) {
  FillOptions options;
  options.method = method;
  options.at_border = at_border;
  return options;
}

Where disc(double column, double row, double radius) {
  return [=](int c, int r) { return std::hypot(c - column, r - row) <= radius; };
}

// The surface of one hole by the sums as they are written down: every term of the whole field, a full matrix, elimination.
class PlainFill {
 public:
  PlainFill(const Version& field, const Where& hole, const Where& bends, const Where& cut_right,
            FillMethod method)
      : field_(field.reader()), hole_(hole), bends_(bends), cut_right_(cut_right) {
    const Grid& grid = field.grid();
    for (int r = 0; r < grid.height; ++r)
      for (int c = 0; c < grid.width; ++c)
        if (hole(c, r)) at_.push_back({c, r});
    const std::size_t n = at_.size();
    a_.assign(n, std::vector<double>(n));
    b_.assign(n, 0.0);
    const double x = 1.0 / grid.spacing_x, y = 1.0 / grid.spacing_y;
    for (int r = 0; r < grid.height; ++r)
      for (int c = 0; c < grid.width; ++c) {
        if (method == FillMethod::kMembrane) {
          if (!cutRight(c, r)) add({{c, r, 1}, {c + 1, r, -1}}, x * x);
          add({{c, r, 1}, {c, r + 1, -1}}, y * y);
          continue;
        }
        if (!bend(c, r)) {
          if (!cutRight(c - 1, r) && !cutRight(c, r))
            add({{c - 1, r, 1}, {c, r, -2}, {c + 1, r, 1}}, x * x * x * x);
          add({{c, r - 1, 1}, {c, r, -2}, {c, r + 1, 1}}, y * y * y * y);
        }
        const int bent = bend(c, r) + bend(c + 1, r) + bend(c, r + 1) + bend(c + 1, r + 1);
        if (!cutRight(c, r) && !cutRight(c, r + 1) && bent < 2)
          add({{c, r, 1}, {c + 1, r, -1}, {c, r + 1, -1}, {c + 1, r + 1, 1}}, 2.0 * x * x * y * y);
      }
  }

  [[nodiscard]] std::vector<double> solve() {
    const std::size_t n = at_.size();
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t p = k;
      for (std::size_t i = k; i < n; ++i)
        if (std::abs(a_[i][k]) > std::abs(a_[p][k])) p = i;
      std::swap(a_[k], a_[p]);
      std::swap(b_[k], b_[p]);
      for (std::size_t i = k + 1; i < n; ++i) {
        const double f = a_[i][k] / a_[k][k];
        if (f == 0.0) continue;
        for (std::size_t j = k; j < n; ++j) a_[i][j] -= f * a_[k][j];
        b_[i] -= f * b_[k];
      }
    }
    for (std::size_t k = n; k-- > 0;) {
      for (std::size_t j = k + 1; j < n; ++j) b_[k] -= a_[k][j] * b_[j];
      b_[k] /= a_[k][k];
    }
    return b_;
  }

 private:
  struct Part {
    int c, r;
    double factor;
  };
  [[nodiscard]] int bend(int c, int r) const { return bends_ && bends_(c, r) ? 1 : 0; }
  [[nodiscard]] bool cutRight(int c, int r) const { return cut_right_ && cut_right_(c, r); }
  void add(const std::vector<Part>& parts, double weight) {
    double known = 0.0;
    std::vector<std::pair<std::size_t, double>> unknown;
    for (const Part& p : parts) {
      if (!field_.grid().contains(p.c, p.r)) return;
      if (hole_(p.c, p.r)) {
        const auto place = std::ranges::find(at_, std::pair{p.c, p.r});
        unknown.emplace_back(static_cast<std::size_t>(place - at_.begin()), p.factor);
      } else {
        const auto z = static_cast<double>(field_.heightAt(p.c, p.r));
        if (std::isnan(z)) return;
        known += p.factor * z;
      }
    }
    for (const auto& [i, fi] : unknown) {
      b_[i] -= weight * fi * known;
      for (const auto& [k, fk] : unknown) a_[i][k] += weight * fi * fk;
    }
  }

  FieldReader field_;
  Where hole_, bends_, cut_right_;
  std::vector<std::pair<int, int>> at_;
  std::vector<std::vector<double>> a_;
  std::vector<double> b_;
};

double rough(int c, int r) {
  return std::sin(c * 0.7) + std::cos(r * 1.3) * 0.5 + 0.01 * c * r;
}

TEST(Fill, IsThePlainSumsMinimumWithMarksWallsOtherHolesAndUnequalSpacing) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform;
  for (const auto& [sx, sy] : {std::pair{1.0, 1.0}, {1.0, 4.0}, {0.002, 0.0005}})
    for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature})
      for (int round = 0; round < 6; ++round) {
        // A ragged hole of up to 170 samples, another one sample away from it, marks on its rim, and a wall between
        // columns 11 and 12 beside a few of its rows.
        std::vector<std::uint8_t> hole(24 * 22), marks(hole.size());
        for (int r = 4; r < 18; ++r)
          for (int c = 5; c < 17; ++c) hole[static_cast<std::size_t>(r * 24 + c)] = uniform(random) < 0.97;
        const auto isHole = [&](int c, int r) {
          return c < 24 && hole[static_cast<std::size_t>(r * 24 + c)] != 0;
        };
        for (int r = 3; r < 19; ++r) marks[static_cast<std::size_t>(r * 24 + 4)] = uniform(random) < 0.5;
        const auto isMarked = [&](int c, int r) {
          return c >= 0 && r >= 0 && c < 24 && r < 22 && marks[static_cast<std::size_t>(r * 24 + c)] != 0;
        };
        const auto other = [&](int c, int r) { return isHole(c, r) || (c == 18 && r > 6 && r < 12); };
        Version scan = scanOf(24, 22, rough, other, isMarked, sx, sy);
        EdgeLine wall;
        for (int r = 3; r <= 8; ++r) {
          EdgePoint p;
          p.position = {11.5, r};
          p.located = true;
          wall.points.push_back(p);
        }
        scan = scan.withLines(std::make_shared<const std::vector<EdgeLine>>(1, wall));
        JobControl job;
        const auto holes = findHoles(scan, job);
        ASSERT_TRUE(holes);
        const Hole* largest = &holes->holes.front();
        for (const Hole& h : holes->holes)
          if (h.samples > largest->samples) largest = &h;
        std::vector<std::uint8_t> of_largest(hole.size());
        for (const HoleRun& run : holes->runsOf(*largest))
          for (int c = run.first; c <= run.last; ++c)
            of_largest[static_cast<std::size_t>(run.row * 24 + c)] = 1;
        const auto inLargest = [&](int c, int r) {
          return of_largest[static_cast<std::size_t>(r * 24 + c)] != 0;
        };
        const LineCuts cuts(*scan.lines(), 24, 22);
        const auto cutRight = [&](int c, int r) {
          if (r < 0 || r >= 22) return false;
          return std::ranges::any_of(cuts.row(r), [&](const LineCut& cut) {
            return cut.column == c && (cut.links & LineCut::kRight) != 0;
          });
        };
        // The line passes the sample on the side of the smaller coordinate.
        const auto bends = [&](int c, int r) {
          if (isMarked(c, r)) return true;
          if (c < 0 || r < 0) return false;
          return std::ranges::any_of(cuts.samplesOf(c / 64, r / 64).samples,
                                     [&](const LineSample& s) { return s.column == c && s.row == r; });
        };
        const std::vector<double> expected = PlainFill(scan, inLargest, bends, cutRight, method).solve();
        const Version filled = fill(scan, by(method)).field;
        std::size_t i = 0;
        for (int r = 0; r < 22; ++r)
          for (int c = 0; c < 24; ++c)
            if (inLargest(c, r)) {
              // Half an ulp of float of heights below 8, and of the full matrix's elimination 1e-9.
              EXPECT_NEAR(static_cast<double>(filled.reader().heightAt(c, r)), expected[i], 3e-7)
                  << c << ' ' << r << " of " << expected.size();
              ++i;
            }
        ASSERT_GT(i, 100U);
      }
}

TEST(Fill, APlaneStaysAPlaneByBothMethods) {
  for (const auto& [sx, sy] : {std::pair{1.0, 1.0}, {1.0, 4.0}}) {
    const auto plane = [](int c, int r) { return 0.25 * c - 0.5 * r + 3.0; };
    const Version scan = scanOf(90, 80, plane, disc(44.0, 40.0, 25.0), {}, sx, sy);
    // Float holds these heights, so that only rounding of double remains: 1e-16 of 40, by the condition of the
    // equations, (25 samples)^2 and (25 samples)^4.
    EXPECT_LT(worst(fill(scan, by(FillMethod::kMembrane)).field, plane), 1e-12);
    EXPECT_LT(worst(fill(scan, by(FillMethod::kCurvature)).field, plane), 1e-9);
  }
}

TEST(Fill, CurvatureGoesOnWithASaddleAndAHarmonicCubic) {
  // Second differences of both are exact, and their squares' sum is least where the fourth differences are zero: the
  // saddle xy and x^3 - 3 x y^2 have none, so the surface is the function itself.
  const auto saddle = [](int c, int r) { return 1e-3 * (c - 40) * (r - 35); };
  const auto cubic = [](int c, int r) {
    const double x = c - 40, y = r - 35;
    return 1e-4 * (x * x * x - 3.0 * x * y * y);
  };
  const auto bowl = [](int c, int r) { return 1e-3 * ((c - 40.0) * (c - 40.0) + (r - 35.0) * (r - 35.0)); };
  for (const auto& z : {Surface2(saddle), Surface2(cubic), Surface2(bowl)}) {
    const Version scan = scanOf(80, 70, z, disc(40.0, 35.0, 20.0));
    // Known heights are rounded to float: 6e-8 of up to 7, which a slope at the rim carries over 20 samples.
    EXPECT_LT(worst(fill(scan, by(FillMethod::kCurvature)).field, z), 1e-4);
  }
  // A membrane cannot: through the rim of the bowl it is level, lower by r^2 = 0.4 at the middle.
  const Version scan = scanOf(80, 70, bowl, disc(40.0, 35.0, 20.0));
  EXPECT_NEAR(worst(fill(scan, by(FillMethod::kMembrane)).field, bowl), 0.4, 0.05);
  // A harmonic function of second order has no fourth difference of the five-point sum: the membrane is it.
  const auto harmonic = [](int c, int r) {
    return 1e-3 * ((c - 40.0) * (c - 40.0) - (r - 35.0) * (r - 35.0));
  };
  EXPECT_LT(worst(fill(scanOf(80, 70, harmonic, disc(40.0, 35.0, 20.0)), by(FillMethod::kMembrane)).field,
                  harmonic),
            2e-7);
}

TEST(Fill, AMembraneStaysBetweenTheLowestAndHighestOfTheRimAlsoWithASpike) {
  const Version scan = scanOf(
      60, 60, [](int c, int r) { return c == 20 && r == 30 ? 1e6 : rough(c, r) * 0.1; },
      disc(30.0, 30.0, 9.6));
  ASSERT_FALSE(std::isnan(scan.reader().heightAt(20, 30)));
  const Version filled = fill(scan, by(FillMethod::kMembrane)).field;
  for (int r = 20; r < 41; ++r)
    for (int c = 21; c < 41; ++c)
      if (std::isnan(scan.reader().heightAt(c, r))) {
        EXPECT_GE(filled.reader().heightAt(c, r), -3.0F);
        EXPECT_LT(filled.reader().heightAt(c, r), 1e6F);
      }
  const Version curved = fill(scan, by(FillMethod::kCurvature)).field;
  EXPECT_EQ(summarize(curved).no_data, 0);
}

// A bowl's bottom, which is missing, is lower than its walls: by curvature far below all that is known, by a membrane not.
TEST(Fill, SaysHowFarItGoesBeyondTheHeightsBefore) {
  const Version bowl = scanOf(
      41, 41, [](int c, int r) { return (c - 20) * (c - 20) + (r - 20) * (r - 20); },
      [](int c, int r) { return std::hypot(c - 20, r - 20) < 12; });
  const BeyondBefore curved = beyondBefore(bowl, fill(bowl, by(FillMethod::kCurvature)).field);
  EXPECT_NEAR(curved.below, 144, 20);
  EXPECT_EQ(curved.above, 0.0);
  const BeyondBefore flat = beyondBefore(bowl, fill(bowl, by(FillMethod::kMembrane)).field);
  EXPECT_EQ(flat.below, 0.0);
  const BeyondBefore turned =
      beyondBefore(bowl.inverted(), fill(bowl.inverted(), by(FillMethod::kCurvature)).field);
  EXPECT_EQ(turned.below, 0.0);
  EXPECT_EQ(turned.above, curved.below);
}

TEST(Fill, GoesOnWithBothSidesOfAStepUpToItsLineAndNotOver) {
  // A step between columns 39 and 40; the line is drawn across the hole, where nothing could be located.
  const auto step = [](int c, int r) { return (c < 40 ? 0.0 : 10.0) + 0.01 * r; };
  const Version scan = scanOf(80, 80, step, disc(40.0, 40.0, 15.0));
  EdgeLine line;
  for (int i = 0; i <= 79; ++i) {
    EdgePoint p;
    p.position = {39.5, i};
    p.located = i < 25 || i > 55;
    line.points.push_back(p);
  }
  const Version lined = scan.withLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
  for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature}) {
    // The membrane's free edge meets the line at a right angle, as the slope along the step does not.
    EXPECT_LT(worst(fill(lined, by(method)).field, step), 1e-5);
    EXPECT_GT(worst(fill(scan, by(method)).field, step), 3.0);
  }
}

TEST(Fill, BendsAtACreaseAndAtMarksAlone) {
  const auto roof = [](int c, int /*r*/) { return -0.5 * std::abs(c - 40); };
  const Version scan = scanOf(80, 80, roof, disc(40.0, 40.0, 15.0));
  EdgeLine line;
  for (int i = 0; i <= 79; ++i) {
    EdgePoint p;
    p.position = {40.0, i};
    p.located = i < 25 || i > 55;
    p.kind = LineKind::kCrease;
    line.points.push_back(p);
  }
  const Version lined = scan.withLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
  EXPECT_LT(worst(fill(lined, by(FillMethod::kCurvature)).field, roof), 1e-5);
  EXPECT_GT(worst(fill(scan, by(FillMethod::kCurvature)).field, roof), 0.5);
  // A hole beside a ridge that is marked: the slope beyond the marks does not count.
  const Where beside = [](int c, int r) { return c >= 30 && c < 40 && r >= 30 && r < 50; };
  const Where ridge = [](int c, int /*r*/) { return c == 40; };
  EXPECT_LT(worst(fill(scanOf(80, 80, roof, beside, ridge), by(FillMethod::kCurvature)).field, roof), 1e-5);
  EXPECT_GT(worst(fill(scanOf(80, 80, roof, beside), by(FillMethod::kCurvature)).field, roof), 0.05);
}

TEST(Fill, LeavesHolesThatAreLargerReachTheBorderOrAreMarked) {
  const auto flat = [](int, int) { return 1.0; };
  const Where holes = [](int c, int r) {
    return (c >= 10 && c < 14 && r == 10) || (c >= 20 && c < 30 && r >= 20 && r < 22) || (c < 3 && r < 3) ||
           (c == 40 && r == 40);
  };
  const Where marked = [](int c, int r) { return c == 40 && r == 40; };
  const Version scan = scanOf(60, 60, flat, holes, marked, 0.5, 0.25);
  FillOptions options = by(FillMethod::kMembrane);
  Filled all = fill(scan, options);
  EXPECT_EQ(all.holes, 3);
  EXPECT_EQ(all.filled_holes, 2);
  EXPECT_EQ(all.filled, 24);
  EXPECT_EQ(all.at_border, 1);
  EXPECT_EQ(summarize(all.field).no_data, 10);  // nine in the corner, and the marked one
  options.most_extent_mm = 2.0;                 // four samples of 0.5
  EXPECT_EQ(fill(scan, options).filled, 4);
  options.most_extent_mm = 1.99;
  EXPECT_EQ(fill(scan, options).filled, 0);
  EXPECT_EQ(fill(scan, options).larger, 2);
  options = by(FillMethod::kMembrane, true);
  options.most_area_mm2 = 9 * 0.125;
  const Filled small = fill(scan, options);
  EXPECT_EQ(small.filled, 13);
  EXPECT_EQ(small.larger, 1);
  // What has a height keeps its bits, and tiles without a hole stay shared.
  for (int r = 0; r < 60; ++r)
    for (int c = 0; c < 60; ++c)
      EXPECT_TRUE(holes(c, r) || all.field.reader().heightAt(c, r) == 1.0F) << c << ' ' << r;
}

TEST(Fill, TakesWhatRimThereIs) {
  const auto plane = [](int c, int r) { return 0.5 * c + 0.25 * r; };
  // Three samples that are not in a line: the plane through them, where terms hold them together; else the flattest.
  for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature}) {
    const Where all_but_three = [](int c, int r) {
      return !((c == 5 && r == 5) || (c == 25 && r == 5) || (c == 5 && r == 25));
    };
    const Filled three = fill(scanOf(31, 31, plane, all_but_three), by(method, true));
    EXPECT_EQ(summarize(three.field).no_data, 0);
    if (method == FillMethod::kCurvature) {
      EXPECT_LT(worst(three.field, plane), 1e-4);
    }
    const Filled one =
        fill(scanOf(31, 31, plane, [](int c, int r) { return c != 9 || r != 9; }), by(method, true));
    EXPECT_LT(worst(one.field, [&](int, int) { return plane(9, 9); }), 1e-5);
    EXPECT_EQ(one.undetermined, method == FillMethod::kCurvature ? 1 : 0);
    // One row, one column.
    const Where middle = [](int c, int r) { return c + r > 10 && c + r < 20; };
    EXPECT_LT(worst(fill(scanOf(40, 1, plane, middle), by(method, true)).field, plane), 1e-5);
    EXPECT_LT(worst(fill(scanOf(1, 40, plane, middle), by(method, true)).field, plane), 1e-5);
    // 5e6 away, in heights as well: what float holds there.
    Version far = scanOf(
        60, 60, [&](int c, int r) { return 5e6 + plane(c, r); }, disc(30.0, 30.0, 12.0));
    Grid grid = far.grid();
    grid.origin_x = grid.origin_y = 5e6;
    far = far.withGrid(grid);
    EXPECT_LE(worst(fill(far, by(method)).field, [&](int c, int r) { return 5e6 + plane(c, r); }), 0.5);
    // Upside down: the same heights with the other sign.
    const Version scan = scanOf(60, 60, rough, disc(30.0, 30.0, 12.0));
    const Version down = fill(scan.inverted(), by(method)).field;
    EXPECT_EQ(contentHash(down.inverted()), contentHash(fill(scan, by(method)).field));
  }
}

// Behind a line that ends within the hole there is no rim: it is filled around the line's end.
TEST(Fill, GoesRoundTheEndOfALineIntoWhatHasNoRimOfItsOwn) {
  const auto plane = [](int c, int r) { return 0.5 * c + 0.25 * r; };
  const Where all_but_four = [](int c, int r) { return !((c == 20 || c == 25) && (r == 3 || r == 8)); };
  EdgeLine line;
  for (int i = 0; i <= 20; ++i) {
    EdgePoint p;
    p.position = {9.5, i};
    p.located = true;
    line.points.push_back(p);
  }
  const Version scan =
      scanOf(31, 31, plane, all_but_four).withLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
  for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature}) {
    const Filled filled = fill(scan, by(method, true));
    EXPECT_EQ(summarize(filled.field).no_data, 0);
    if (method == FillMethod::kMembrane) {
      EXPECT_GE(summarize(filled.field).min, plane(20, 3) - 1e-4);
      EXPECT_LE(summarize(filled.field).max, plane(25, 8) + 1e-4);
    }
  }
}

// A hole in the shape of a U whose left arm lies between lines: only the right arm, whose first sample comes second, has
// a rim, and all is filled from there.
TEST(Fill, GoesFromOneArmOfAHoleIntoOneThatLinesCutOff) {
  const auto flat = [](int, int) { return 2.0; };
  const Where hole = [](int c, int r) {
    return (r == 10 && (c == 10 || c == 12)) || (r == 11 && c >= 10 && c <= 12);
  };
  const auto lineAlong = [](glm::dvec2 from, glm::dvec2 to, std::int64_t id) {
    EdgeLine line;
    line.id = id;
    for (int i = 0; i <= 16; ++i) {
      EdgePoint p;
      p.position = from + (to - from) * (i / 16.0);
      p.located = true;
      line.points.push_back(p);
    }
    return line;
  };
  // To the left of both rows, below the left arm, between the arms, above all, and below the bar's middle.
  const std::vector<EdgeLine> lines{
      lineAlong({9.5, 9.0}, {9.5, 12.0}, 0),    lineAlong({9.0, 9.5}, {10.5, 9.5}, 1),
      lineAlong({10.5, 9.0}, {10.5, 10.5}, 2),  lineAlong({9.0, 11.5}, {13.0, 11.5}, 3),
      lineAlong({10.5, 10.5}, {11.5, 10.5}, 4), lineAlong({12.5, 10.5}, {12.5, 12.0}, 5)};
  const Version scan =
      scanOf(24, 24, flat, hole).withLines(std::make_shared<const std::vector<EdgeLine>>(lines));
  const Filled filled = fill(scan, by(FillMethod::kMembrane));
  EXPECT_EQ(filled.filled, 5);
  EXPECT_EQ(summarize(filled.field).no_data, 0);
  EXPECT_LT(worst(filled.field, flat), 1e-6);
}

TEST(Fill, FillsRingsInEachOther) {
  const auto bowl = [](int c, int r) {
    return 1e-3 * ((c - 200.0) * (c - 200.0) + (r - 200.0) * (r - 200.0));
  };
  const Where rings = [](int c, int r) {
    return static_cast<int>(std::max(std::abs(c - 200), std::abs(r - 200))) % 5 == 3 &&
           std::abs(c - 200) < 195 && std::abs(r - 200) < 195;
  };
  const Filled filled = fill(scanOf(401, 401, bowl, rings), by(FillMethod::kCurvature));
  EXPECT_EQ(filled.filled_holes, 39);
  EXPECT_EQ(summarize(filled.field).no_data, 0);
  // Between two known samples on each side, one sample wide: the bowl, but for heights rounded to float.
  EXPECT_LT(worst(filled.field, bowl), 1e-4);
}

TEST(Fill, OfNothingButHolesIsRefused) {
  const Version scan = scanOf(20, 20, rough, [](int, int) { return true; });
  JobControl job;
  const auto filled = fillHoles(scan, by(FillMethod::kMembrane, true), job);
  ASSERT_FALSE(filled);
  EXPECT_EQ(filled.error().kind, ErrorKind::kInput);
}

TEST(Fill, IsTheSameForAnyNumberOfThreadsAndCanBeCancelled) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::uint8_t> hole(300 * 260);
  for (auto& h : hole) h = uniform(random) < 0.3;
  for (int r = 50; r < 200; ++r)
    for (int c = 60; c < 200; ++c) hole[static_cast<std::size_t>(r * 300 + c)] |= uniform(random) < 0.9;
  const Version scan =
      scanOf(300, 260, rough, [&](int c, int r) { return hole[static_cast<std::size_t>(r * 300 + c)] != 0; });
  for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature}) {
    std::uint64_t one = 0, four = 0;
    tbb::task_arena(1).execute([&] { one = contentHash(fill(scan, by(method, true)).field); });
    tbb::task_arena(4).execute([&] { four = contentHash(fill(scan, by(method, true)).field); });
    EXPECT_EQ(one, four);
  }
  JobControl job;
  job.cancel();
  const auto stopped = fillHoles(scan, {}, job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
