#include "engine/measure/line_suggestion.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "engine/scanner/counter_random.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

double noiseAt(int c, int r, int seed) {
  return CounterRandom(seed, 0).normal(c, r);
}

LineSuggestion suggestionFor(const Version& field, ScanAxis axis = ScanAxis::kX) {
  LineOptions options;
  options.axis = axis;
  options.form_degree = LineOptions::kUsualFormDegree;
  JobControl job;
  const auto found = suggestLevelling(field, options, job);
  EXPECT_TRUE(found) << (found ? "" : found.error().line());
  return found ? *found : LineSuggestion{};
}

// Each line is off by its own height, over waves along it: one number for each line takes that away, and the simplest does.
TEST(LineSuggestion, LinesThatAreOffByAHeightAreLevelledByTheSimplestWay) {
  for (const bool rows : {true, false}) {
    const Version field = fieldOf(300, 300, [&](int c, int r) {
      const int line = rows ? r : c, place = rows ? c : r;
      return noiseAt(line, 0, 3) + 0.3 * std::sin(0.1 * place) + 0.05 * noiseAt(c, r, 4);
    });
    const LineSuggestion found = suggestionFor(field, rows ? ScanAxis::kX : ScanAxis::kY);
    ASSERT_TRUE(found.best);
    // The mean of a line of Gaussian noise has four fifths of the error that its median has.
    const LineSuggestion::Tried& best = found.tried[*found.best];
    EXPECT_TRUE(best.method == LineMethod::kMedian ||
                (best.method == LineMethod::kPolynomial && best.degree == 0));
    EXPECT_LT(found.tried[*found.best].apart, 0.1 * found.before);
    EXPECT_EQ(found.places, 300);
  }
}

// A plate takes a share of the lines that changes: medians of whole lines follow it.
TEST(LineSuggestion, WhereAPartChangesMediansTheWayGoesFromLineToLine) {
  const Version field = fieldOf(240, 200, [](int c, int r) {
    const bool plate = c < 80 + (r > 60 && r < 120 ? 80 : 0);
    return (plate ? 5.0 : 0.0) + 0.2 * noiseAt(r, 0, 5) + 0.01 * noiseAt(c, r, 6);
  });
  const LineSuggestion found = suggestionFor(field);
  ASSERT_TRUE(found.best);
  const LineMethod method = found.tried[*found.best].method;
  EXPECT_TRUE(method == LineMethod::kDifference || method == LineMethod::kMatching);
}

// Without stripes nothing is suggested: errors of differences add up from line to line, which neighbours alone would hide.
TEST(LineSuggestion, LinesThatAreLevelAreLeft) {
  const Version field =
      fieldOf(240, 200, [](int c, int r) { return 0.02 * c + 0.01 * r + 0.1 * noiseAt(c, r, 7); });
  EXPECT_FALSE(suggestionFor(field).best);
}

TEST(LineSuggestion, OfLongLinesSomeSamplesAreEnough) {
  const Version field =
      fieldOf(6000, 60, [](int c, int r) { return noiseAt(r, 0, 8) + 0.05 * noiseAt(c, r, 9); });
  const LineSuggestion found = suggestionFor(field);
  EXPECT_EQ(found.places, 2 * LineSuggestion::kMostPlaces);
  EXPECT_EQ(found.length, 6000);
  ASSERT_TRUE(found.best);
  EXPECT_LT(found.tried[*found.best].apart, 0.2 * found.before);
}

TEST(LineSuggestion, WhereNoTwoLinesCanBeComparedItSaysSo) {
  JobControl job;
  const auto found = suggestLevelling(fieldOf(4, 50, [](int, int r) { return double(r); }), {}, job);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::kInput);
}

}  // namespace
}  // namespace fettle::engine
