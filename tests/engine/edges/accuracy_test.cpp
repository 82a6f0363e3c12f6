#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/edges/locate.h"
#include "engine/scanner/true_lines.h"
#include "haptic/operator/hand_lines.h"

// Lines located from simulated strokes, against the true edges of simulated parts. The full figures:
// `fettle accuracy --only lines`.

namespace fettle::engine {
namespace {

struct Figures {
  double hand = 0.0, located = 0.0, normalised = 0.0, share = 0.0,
         kind_right = 0.0;  // all but the last two: rms
};

struct TracedPart {
  const char* part;
  double noise;
  double hand;  // times the usual person
  double hand_deviation;
};

Figures figuresOf(const TracedPart& traced, std::uint64_t seed) {
  JobControl job;
  ScannerSpec scanner;
  scanner.part = traced.part;
  scanner.noise = traced.noise;
  scanner.width = scanner.height = 1024;
  scanner.seed = seed;
  const auto scan = simulateScan(scanner, job);
  EXPECT_TRUE(scan);
  if (!scan) return {};
  haptic::OperatorSpec person;
  person.seed = seed + 10;
  person.wander_mm *= traced.hand;
  person.tremor_mm *= traced.hand;
  const auto hands = haptic::handLines(scan->edge_lines, scan->scan.grid(), person);
  std::vector<EdgeStroke> strokes;
  for (const haptic::HandLine& hand : hands) strokes.push_back({0, hand.points, hand.closed});
  const auto lines =
      locateEdgeLines(scan->scan.reader(), scan->sigma_mm, strokes, {traced.hand_deviation}, job);
  EXPECT_TRUE(lines);
  if (!lines) return {};
  const double spacing = scan->scan.grid().spacingXMm();
  double hand_count = 0.0, points = 0.0, located = 0.0;
  Figures sums;
  for (std::size_t k = 0; k < lines->size(); ++k) {
    const Edge& edge = scan->edge_lines[k];
    const auto squareOff = [&](glm::dvec2 p) {
      return std::pow(distanceFrom(edge, p * spacing) / spacing, 2);
    };
    for (std::size_t i = 0; i < hands[k].points.size(); i += 4) {
      sums.hand += squareOff(hands[k].points[i]);
      hand_count += 1.0;
    }
    for (const EdgePoint& p : (*lines)[k].points) {
      points += 1.0;
      if (!p.located) continue;
      located += 1.0;
      sums.located += squareOff(p.position);
      sums.normalised += squareOff(p.position) / (p.deviation * p.deviation);
      sums.kind_right += (p.kind == LineKind::kStep) == (edge.kind == EdgeKind::kStep) ? 1.0 : 0.0;
    }
  }
  return {std::sqrt(sums.hand / hand_count), std::sqrt(sums.located / located),
          std::sqrt(sums.normalised / located), located / points, sums.kind_right / located};
}

void expectWithin(const TracedPart& traced, double bound, double least_share) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Figures figures = figuresOf(traced, seed);
    fmt::print(
        "{} x{:g}, seed {}: hand {:.2f}, located {:.3f} samples, {:.2f} of the stated deviation; located "
        "{:.1f} %, kind right {:.1f} %\n",
        traced.part, traced.noise, seed, figures.hand, figures.located, figures.normalised,
        100.0 * figures.share, 100.0 * figures.kind_right);
    EXPECT_LE(figures.located, bound) << traced.part << ", seed " << seed;
    EXPECT_GE(figures.normalised, 0.5) << traced.part << ", seed " << seed;
    EXPECT_LE(figures.normalised, 2.0) << traced.part << ", seed " << seed;
    EXPECT_GE(figures.share, least_share) << traced.part << ", seed " << seed;
    EXPECT_GE(figures.kind_right, 0.9) << traced.part << ", seed " << seed;
  }
}

// Bounds in samples. Of the hand: 1.5 on steps, 1.3 on the bracket, 1.6 on ribs, 2.7 where it is rough.
TEST(LocatedLines, StepsAsHighAsTheNoise) {
  expectWithin({"steps", 3.0, 1.0, 1.2}, 0.5, 0.95);
}
TEST(LocatedLines, Bracket) {
  expectWithin({"bracket", 1.0, 1.0, 1.2}, 0.65, 0.9);
}
TEST(LocatedLines, BracketWithThreeTimesTheNoise) {
  expectWithin({"bracket", 3.0, 1.0, 1.2}, 0.65, 0.9);
}
// A third of the ribs' edges are less than two samples apart and have no surface between them.
TEST(LocatedLines, Ribs) {
  expectWithin({"ribs", 3.0, 1.0, 1.2}, 1.1, 0.6);
}
TEST(LocatedLines, StepsByARoughHand) {
  expectWithin({"steps", 3.0, 1.8, 2.5}, 1.1, 0.9);
}

}  // namespace
}  // namespace fettle::engine
