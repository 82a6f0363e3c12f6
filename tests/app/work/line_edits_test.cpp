#include "app/work/line_edits.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "app/work/line_pieces.h"
#include "engine/field/live_field.h"
#include "engine/session/line_codec.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/engine/edges/edge_fields.h"

namespace fettle::app {
namespace {

using engine::EdgeLine;
using engine::Version;
using tests::markedSamples;

constexpr double kNoise = 0.01;

// Two steps, at columns 60.5 and 90.5, ten times the noise.
Version twoSteps() {
  return engine::edgeField(160, 140, [](int c, int r) {
    return (c > 60 ? 0.1 : 0.0) + (c > 90 ? 0.1 : 0.0) + kNoise * engine::whiteNoise(c, r);
  });
}

// A field with the marks of a stroke, the stroke, and what it was drawn on.
struct Drawn {
  Version before, after;
  std::vector<glm::dvec2> points;
};

Drawn drawn(const Version& before, glm::dvec2 from, glm::dvec2 to) {
  engine::LiveField live(before, engine::Growth::kAllowed);
  Drawn out{before, before, engine::straightStroke(from, to)};
  for (glm::dvec2& p : out.points) {
    p = {std::round(p.x * 0x1p20) * 0x1p-20, std::round(p.y * 0x1p20) * 0x1p-20};
    for (int r = -1; r <= 1; ++r)
      for (int c = -1; c <= 1; ++c)
        EXPECT_TRUE(live.setMark(static_cast<int>(p.x) + c, static_cast<int>(p.y) + r, true));
  }
  out.after = live.snapshot();
  return out;
}

Version lineAlong(const Version& before, glm::dvec2 from, glm::dvec2 to) {
  const Drawn stroke = drawn(before, from, to);
  engine::JobControl job;
  const auto made = drawLine(stroke.after, {stroke.points, stroke.before, stroke.after, 1.0}, {}, job);
  EXPECT_TRUE(made) << (made ? "" : made.error().line());
  return made ? *made : before;
}

const std::vector<EdgeLine>& linesOf(const Version& version) {
  static const std::vector<EdgeLine> none;
  return version.lines() ? *version.lines() : none;
}

double rmsFrom(const EdgeLine& line, double column) {
  double squares = 0.0;
  for (const engine::EdgePoint& p : line.points) squares += (p.position.x - column) * (p.position.x - column);
  return std::sqrt(squares / static_cast<double>(line.points.size()));
}

TEST(LineEdits, AStrokeAlongAnEdgeBecomesItsLineAndLeavesNoMarks) {
  const Version made = lineAlong(twoSteps(), {62, 20}, {59.5, 110});
  ASSERT_EQ(linesOf(made).size(), 1U);
  const EdgeLine& line = linesOf(made).front();
  EXPECT_EQ(line.id, 1);
  EXPECT_FALSE(line.closed);
  // Steps of ten times the noise are located to some tenths of a sample.
  EXPECT_LT(rmsFrom(line, 60.5), 0.3);
  EXPECT_EQ(markedSamples(made), 0);
}

TEST(LineEdits, MarksFromBeforeTheStrokeRemain) {
  engine::LiveField live(twoSteps(), engine::Growth::kAllowed);
  ASSERT_TRUE(live.setMark(60, 50, true));
  const Version made = lineAlong(live.snapshot(), {61, 20}, {60, 110});
  EXPECT_EQ(linesOf(made).size(), 1U);
  EXPECT_EQ(markedSamples(made), 1);
  EXPECT_TRUE(made.reader().markedAt(60, 50));
}

TEST(LineEdits, AStrokeWhereThereIsNoEdgeRemainsMarks) {
  const Version base = twoSteps();
  const Drawn stroke = drawn(base, {20, 20}, {25, 100});
  engine::JobControl job;
  const auto made = drawLine(stroke.after, {stroke.points, stroke.before, stroke.after, 1.0}, {}, job);
  ASSERT_TRUE(made);
  EXPECT_EQ(*made, stroke.after);
}

TEST(LineEdits, ASecondEdgeGetsALineOfItsOwn) {
  const Version one = lineAlong(twoSteps(), {61, 20}, {60, 110});
  const Version two = lineAlong(one, {91.5, 20}, {89.5, 110});
  ASSERT_EQ(linesOf(two).size(), 2U);
  EXPECT_TRUE(std::ranges::equal(linesOf(two)[0].points, linesOf(one)[0].points, {},
                                 &engine::EdgePoint::position, &engine::EdgePoint::position))
      << "the first stays where it is";
  EXPECT_NE(linesOf(two)[0].id, linesOf(two)[1].id);
  EXPECT_LT(rmsFrom(linesOf(two)[1], 90.5), 0.3);
}

TEST(LineEdits, DrawnAgainALineReplacesTheOneBefore) {
  const Version once = lineAlong(twoSteps(), {61, 20}, {60, 110});
  const Version twice = lineAlong(once, {60, 15}, {61, 115});
  ASSERT_EQ(linesOf(twice).size(), 1U);
  // Only a part of it: the pieces before and after remain.
  const Version part = lineAlong(once, {61, 50}, {60, 80});
  ASSERT_EQ(linesOf(part).size(), 3U);
  double length = 0.0;
  for (const EdgeLine& line : linesOf(part)) {
    EXPECT_LT(rmsFrom(line, 60.5), 0.3);
    length += glm::distance(line.points.front().position, line.points.back().position);
  }
  EXPECT_NEAR(length, 90.0, 8.0);  // without overlap: at most some samples missing at the joints
  // As a session keeps it: ids differ.
  EXPECT_TRUE(engine::unpackLines(engine::packLines(part.lines())));
}

// A line along a column, from one row to another; a step of `step`, 0: not located.
EdgeLine lineAtColumn(std::int64_t id, double column, int from, int to, double step) {
  EdgeLine line{id, false, {}};
  for (int row = from; from < to ? row <= to : row >= to; row += from < to ? 1 : -1) {
    engine::EdgePoint& p = line.points.emplace_back();
    p.position = {column, row};
    p.located = step != 0.0;
    p.step = step;
  }
  return line;
}

TEST(LineEdits, AnEdgeThatWasTracedTwiceHasOneLine) {
  const EdgeLine wall = lineAtColumn(1, 60.5, 0, 100, 1.0);
  const auto kept = [&](const EdgeLine& other) {
    return linesOfOneEdgeEach(std::vector{other, wall}, {}).size();
  };
  EXPECT_EQ(kept(lineAtColumn(2, 61.0, 20, 60, 1.0)), 1U);
  EXPECT_EQ(kept(lineAtColumn(2, 61.0, 60, 20, -1.0)), 1U) << "drawn the other way";
  EXPECT_EQ(kept(lineAtColumn(2, 63.0, 20, 60, 0.0)), 1U) << "not located, beside it";
  EXPECT_EQ(kept(lineAtColumn(2, 61.0, 20, 60, -1.0)), 2U) << "the other side of a thin rib";
  EXPECT_EQ(kept(lineAtColumn(2, 62.5, 20, 60, 1.0)), 2U) << "the next step";
  EXPECT_EQ(kept(lineAtColumn(2, 66.0, 20, 60, 0.0)), 2U) << "not located, elsewhere";
  // What lies beyond the end of the longer line stays, under its own number.
  const auto beyond = linesOfOneEdgeEach(std::vector{lineAtColumn(2, 61.0, 60, 150, 1.0), wall}, {});
  ASSERT_EQ(beyond.size(), 2U);
  EXPECT_EQ(beyond[0].id, 2);
  EXPECT_NEAR(beyond[0].points.front().position.y, 100.0, 3.0);
  // Lines that are there are kept, whatever their length.
  const auto beside = linesOfOneEdgeEach(std::vector{wall}, std::vector{lineAtColumn(7, 60.0, 40, 60, 1.0)});
  ASSERT_EQ(beside.size(), 2U);
  EXPECT_NE(beside[0].id, beside[1].id);
  EXPECT_GT(beside[1].id, 7);
}

TEST(LineEdits, ErasingDividesALine) {
  const Version made = lineAlong(twoSteps(), {61, 20}, {60, 110});
  const std::vector<glm::dvec2> across = engine::straightStroke({50, 60}, {70, 60});
  const Version cut = eraseLines(made, across, 3.0);
  ASSERT_EQ(linesOf(cut).size(), 2U);
  EXPECT_EQ(linesOf(cut)[0].id, 1);
  EXPECT_EQ(linesOf(cut)[1].id, 2);
  for (const EdgeLine& line : linesOf(cut))
    for (const engine::EdgePoint& p : line.points) EXPECT_GT(std::abs(p.position.y - 60.0), 2.9);
  EXPECT_EQ(eraseLines(made, engine::straightStroke({100, 60}, {120, 60}), 3.0), made);
  const Version gone = eraseLines(made, engine::straightStroke({60, 10}, {60, 120}), 4.0);
  EXPECT_FALSE(gone.lines());
}

TEST(LineEdits, AClosedLineIsOpenedWhereItIsErased) {
  EdgeLine ring;
  ring.id = 4;
  ring.closed = true;
  for (int i = 0; i < 100; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 100.0;
    ring.points.emplace_back();
    ring.points.back().position = {70.0 + 20.0 * std::cos(angle), 70.0 + 20.0 * std::sin(angle)};
  }
  const Version made = twoSteps().withLines(std::make_shared<const std::vector<EdgeLine>>(1, ring));
  // Where the list of its points begins, and elsewhere: one open line each.
  for (const glm::dvec2 at : {glm::dvec2(90, 70), glm::dvec2(50, 70)}) {
    const std::vector<glm::dvec2> path{at};
    const Version cut = eraseLines(made, path, 3.0);
    ASSERT_EQ(linesOf(cut).size(), 1U);
    const EdgeLine& line = linesOf(cut).front();
    EXPECT_FALSE(line.closed);
    EXPECT_GT(line.points.size(), 90U);
    for (std::size_t i = 1; i < line.points.size(); ++i)
      EXPECT_LT(glm::distance(line.points[i].position, line.points[i - 1].position), 2.0);
  }
}

TEST(LineEdits, LinesAreRemovedOneByOneOrAllAtOnce) {
  const Version two = lineAlong(lineAlong(twoSteps(), {61, 20}, {60, 110}), {91, 20}, {90, 110});
  ASSERT_EQ(linesOf(two).size(), 2U);
  const Version one = removeLines(two, linesOf(two)[0].id);
  ASSERT_EQ(linesOf(one).size(), 1U);
  EXPECT_EQ(linesOf(one)[0].id, linesOf(two)[1].id);
  EXPECT_FALSE(removeLines(two, std::nullopt).lines());
  EXPECT_EQ(removeLines(two, 99), two);
}

TEST(LineEdits, NearestEndsAreJoinedAndLocatedBetween) {
  const Version cut =
      eraseLines(lineAlong(twoSteps(), {61, 20}, {60, 110}), engine::straightStroke({50, 60}, {70, 60}), 5.0);
  ASSERT_EQ(linesOf(cut).size(), 2U);
  engine::JobControl job;
  const auto joined = joinLine(cut, linesOf(cut)[1].id, {}, job);
  ASSERT_TRUE(joined) << joined.error().line();
  ASSERT_EQ(linesOf(*joined).size(), 1U);
  const EdgeLine& line = linesOf(*joined).front();
  EXPECT_EQ(line.id, 2);
  EXPECT_LT(rmsFrom(line, 60.5), 0.3);
  EXPECT_NEAR(glm::distance(line.points.front().position, line.points.back().position), 90.0, 6.0);
  EXPECT_TRUE(std::ranges::all_of(line.points, &engine::EdgePoint::located));
  EXPECT_FALSE(joinLine(cut, 77, {}, job));
  // The ends of one line alone are too far apart to be joined.
  EXPECT_FALSE(joinLine(*joined, 2, {}, job));
}

TEST(LineEdits, HardFieldsGiveALineOrNone) {
  const auto everywhere = [](double z) { return engine::edgeField(60, 50, [z](int, int) { return z; }); };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto step = [](double height, double base) {
    return engine::edgeField(60, 50, [=](int c, int) { return base + (c > 30 ? height : 0.0); });
  };
  for (const Version& field :
       {everywhere(0.0), everywhere(nan), everywhere(1e30), step(1e-40, 0.0), step(1.0, 5e6), step(1e30, 0.0),
        step(nan, 1.0), engine::edgeField(60, 1, [](int c, int) { return c > 30 ? 1.0 : 0.0; })}) {
    const std::vector<glm::dvec2> points = engine::straightStroke({31, 0}, {30, 49});
    engine::JobControl job;
    const auto made = drawLine(field, {points, field, field, 2.0}, {}, job);
    ASSERT_TRUE(made) << made.error().line();
    for (const EdgeLine& line : linesOf(*made))
      for (const engine::EdgePoint& p : line.points)
        EXPECT_TRUE(std::isfinite(p.position.x + p.position.y + p.deviation + p.step + p.slope_change));
  }
}

TEST(LineEdits, ADraggedLineIsLocatedAgainWhereItWasLeft) {
  const Version made = lineAlong(twoSteps(), {61.5, 20}, {60.5, 110});
  engine::JobControl job;
  const std::int64_t id = linesOf(made).front().id;
  // A little aside: the same edge. The part that is pulled to the other step: that one.
  const auto same = dragLine(made, id, {60.5, 60}, {62.0, 61}, {}, job);
  ASSERT_TRUE(same) << same.error().line();
  ASSERT_EQ(linesOf(*same).size(), 1U);
  EXPECT_EQ(linesOf(*same).front().id, id);
  EXPECT_LT(rmsFrom(linesOf(*same).front(), 60.5), 0.3);
  const auto other = dragLine(made, id, {60.5, 65}, {90.0, 65}, {}, job);
  ASSERT_TRUE(other) << other.error().line();
  const auto& points = linesOf(*other).front().points;
  const auto farthest =
      std::ranges::max_element(points, {}, [](const engine::EdgePoint& p) { return p.position.x; });
  EXPECT_NEAR(farthest->position.x, 90.5, 2.0);
  EXPECT_FALSE(dragLine(made, id + 7, {60.5, 60}, {62.0, 61}, {}, job));
}

TEST(LineEdits, ALineIsExtendedToTheLineThatItMeetsAndToTheBorder) {
  // A step along row 70.5 that ends at the one along column 60.5.
  const Version field = engine::edgeField(160, 140, [](int c, int r) {
    return (c > 60 ? 0.5 : r > 70 ? 0.2 : 0.0) + kNoise * engine::whiteNoise(c, r);
  });
  const Version across = lineAlong(field, {60.5, 3}, {60.5, 136});
  const auto& upright = linesOf(across).front().points;
  EXPECT_LT(std::min(upright.front().position.y, upright.back().position.y), 0.01);
  const Version both = lineAlong(across, {3, 70.5}, {58, 70.5});
  ASSERT_EQ(linesOf(both).size(), 2U);
  const auto& meeting = linesOf(both).back().points;
  EXPECT_NEAR(meeting.back().position.x, 60.5, 0.5);
  EXPECT_EQ(meeting.front().position.x, 0.0);
}

}  // namespace
}  // namespace fettle::app
