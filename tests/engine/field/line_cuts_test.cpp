#include "engine/field/line_cuts.h"

#include <cmath>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/piece.h"
#include "tests/engine/filter/edge_line_of.h"

namespace fettle::engine::tests {
namespace {

using Cuts = std::set<std::tuple<int, int, int>>;  // column, row, link

Cuts cutsOf(const std::vector<EdgeLine>& lines, int columns, int rows) {
  const LineCuts cuts(lines, columns, rows);
  Cuts found;
  for (int r = 0; r < rows; ++r) {
    int last = -1;
    for (const LineCut& cut : cuts.row(r)) {
      EXPECT_EQ(cut.row, r);
      EXPECT_GT(cut.column, last);
      last = cut.column;
      for (const int link : {LineCut::kRight, LineCut::kUp})
        if ((cut.links & link) != 0) found.emplace(cut.column, cut.row, link);
    }
  }
  return found;
}

TEST(LineCuts, ALineBetweenTwoColumnsCutsTheLinkOfEachRow) {
  const LineCuts cuts(std::vector{edgeLineOf({{3.25, -5.0}, {3.25, 20.0}})}, 10, 8);
  for (int r = 0; r < 8; ++r) {
    ASSERT_EQ(cuts.row(r).size(), 1U);
    EXPECT_EQ(cuts.row(r)[0].column, 3);
    EXPECT_EQ(cuts.row(r)[0].links, LineCut::kRight);
    EXPECT_EQ(cuts.row(r)[0].right_at, 0.25F);
  }
}

TEST(LineCuts, SamplesOnTheTwoSidesOfAnyStraightLineHaveNoWholeLink) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(2.0, 28.0), angle(0.0, 6.283);
  for (int k = 0; k < 200; ++k) {
    const glm::dvec2 middle{k % 3 == 0 ? 15.0 : place(random), k % 5 == 0 ? 12.0 : place(random)};
    const double a = k % 4 == 0 ? k * 0.7853981633974483 : angle(random);
    const glm::dvec2 along{std::cos(a), std::sin(a)};
    const Cuts cuts = cutsOf({edgeLineOf({middle - 60.0 * along, middle + 60.0 * along})}, 30, 30);
    // Beyond rounding: a line through samples passes on one side of each.
    const auto side = [&](int c, int r) {
      const double d = along.x * (r - middle.y) - along.y * (c - middle.x);
      return std::fabs(d) < 1e-9 ? 0 : d > 0.0 ? 1 : -1;
    };
    for (int r = 0; r < 30; ++r)
      for (int c = 0; c < 30; ++c) {
        const int here = side(c, r), right = side(c + 1, r), up = side(c, r + 1);
        if (c < 29 && here * right != 0) {
          EXPECT_EQ(cuts.contains({c, r, LineCut::kRight}), here != right);
        }
        if (r < 29 && here * up != 0) {
          EXPECT_EQ(cuts.contains({c, r, LineCut::kUp}), here != up);
        }
        // A sample on the line belongs to one of both sides.
        if (here == 0 && c > 0 && c < 29 && side(c - 1, r) * right == -1) {
          EXPECT_NE(cuts.contains({c - 1, r, LineCut::kRight}), cuts.contains({c, r, LineCut::kRight}));
        }
      }
  }
}

TEST(LineCuts, ALinkThatALineGoesOverAndBackIsWholeAndOneThatTwoLinesGoOverIsCut) {
  const EdgeLine there_and_back = edgeLineOf({{3.2, 0.5}, {3.2, 4.5}, {3.6, 4.5}, {3.6, 0.5}});
  EXPECT_EQ(cutsOf({there_and_back}, 10, 8), Cuts());
  EdgeLine first = edgeLineOf({{3.2, 0.5}, {3.2, 4.5}}), second = edgeLineOf({{3.6, 0.5}, {3.6, 4.5}});
  second.id = 1;
  const Cuts both = cutsOf({first, second}, 10, 8);
  EXPECT_EQ(both.size(), 4U);
  EXPECT_EQ(both, cutsOf({first}, 10, 8));
}

TEST(LineCuts, OnlyLocatedPointsOfStepsCutAndAClosedLineAllTheWayRound) {
  EdgeLine line = edgeLineOf({{3.5, 0.5}, {3.5, 6.5}});
  for (EdgePoint& point : line.points) point.located = point.position.y < 3.0;
  EXPECT_EQ(cutsOf({line}, 10, 8).size(), 2U);  // rows 1 and 2
  for (EdgePoint& point : line.points) point = {point.position, true, LineKind::kCrease};
  EXPECT_EQ(cutsOf({line}, 10, 8), Cuts());
  EdgeLine square = edgeLineOf({{2.5, 2.5}, {5.5, 2.5}, {5.5, 5.5}, {2.5, 5.5}, {2.5, 3.5}});
  const std::size_t open = cutsOf({square}, 10, 8).size();
  square.closed = true;
  EXPECT_EQ(open + 1, 12U);
  EXPECT_EQ(cutsOf({square}, 10, 8).size(), 12U);
}

TEST(LineCuts, OfAPieceOfAFieldAreThoseOfTheFieldThere) {
  EdgeLine wave = edgeLineOf({});
  for (int i = 0; i < 900; ++i) {
    EdgePoint point;
    point.position = {40.0 + 30.0 * std::cos(i * 0.05) + 0.01 * i, 35.0 + 33.0 * std::sin(i * 0.11)};
    point.located = i % 50 != 0;
    wave.points.push_back(point);
  }
  wave.closed = true;
  Grid grid;
  grid.width = 80;
  grid.height = 70;
  const Version field = makeField(grid, std::vector<float>(80 * 70))
                            .withLines(std::make_shared<std::vector<EdgeLine>>(std::vector{wave}));
  const Version piece = pieceOf(field, 13, 17, 40, 30);
  const Cuts of_field = cutsOf(*field.lines(), 80, 70), of_piece = cutsOf(*piece.lines(), 40, 30);
  int compared = 0;
  for (int r = 0; r < 29; ++r)
    for (int c = 0; c < 39; ++c)
      for (const int link : {LineCut::kRight, LineCut::kUp}) {
        EXPECT_EQ(of_piece.contains({c, r, link}), of_field.contains({c + 13, r + 17, link}));
        compared += of_piece.contains({c, r, link}) ? 1 : 0;
      }
  EXPECT_GT(compared, 20);
}

TEST(LineCuts, LinesLeadOutOfTheFieldAndFarAway) {
  EXPECT_EQ(
      cutsOf({edgeLineOf({{-1e6, -7.5}, {-1e6 + 1.0, -7.5}}), edgeLineOf({{0.5, 9.0}, {0.5, 1e5}})}, 10, 8),
      Cuts());
  EXPECT_EQ(cutsOf({edgeLineOf({{0.5, -3.0}, {0.5, 3.0}})}, 2, 1), (Cuts{{0, 0, LineCut::kRight}}));
  EXPECT_EQ(cutsOf({edgeLineOf({{-0.5, -3.0}, {-0.5, 3.0}}), edgeLineOf({{1.5, -3.0}, {1.5, 3.0}})}, 2, 4),
            Cuts());
}

TEST(LineCuts, HaveTheSamplesNearestToStepsAndCreases) {
  std::vector<EdgeLine> lines{edgeLineOf({{3.2, -4.0}, {150.7, 90.4}, {140.0, 200.0}}),
                              edgeLineOf({{20.0, 70.5}, {20.0, 59.5}})};
  for (EdgePoint& point : lines[1].points) point.kind = LineKind::kCrease;
  const LineCuts cuts(lines, 160, 130);
  std::set<std::pair<int, int>> found;
  for (int tr = 0; tr < 3; ++tr)
    for (int tc = 0; tc < 3; ++tc)
      for (const LineSample& sample : cuts.samplesOf(tc, tr).samples) {
        EXPECT_EQ(sample.column / kTileSide, tc);
        EXPECT_EQ(sample.row / kTileSide, tr);
        EXPECT_TRUE(found.emplace(sample.column, sample.row).second);
      }
  const auto isNear = [&](int c, int r) {
    double least = HUGE_VAL;
    for (const EdgeLine& line : lines)
      for (const EdgePoint& point : line.points)
        least = std::min(least, glm::distance(point.position, glm::dvec2(c, r)));
    return least;
  };
  int near = 0;
  for (int r = 0; r < 129; ++r)
    for (int c = 0; c < 159; ++c) {
      const bool has = found.contains({c, r});
      // Points are half a sample apart.
      if (has) {
        EXPECT_LE(isNear(c, r), 0.71 + 0.25) << c << ' ' << r;
      }
      if (isNear(c, r) < 0.25) {
        EXPECT_TRUE(has) << c << ' ' << r;
      }
      near += static_cast<int>(has);
    }
  EXPECT_GT(near, 150);
  EXPECT_TRUE(LineCuts(std::vector<EdgeLine>{}, 10, 10).samplesOf(0, 0).samples.empty());
}

}  // namespace
}  // namespace fettle::engine::tests
