#include "engine/edges/strip.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/engine/edges/edge_fields.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

TEST(SampleWindow, DropsSpikesPairsAndHolesAndKeepsThinRidges) {
  const Version field = edgeField(64, 64, [](int c, int r) {
    if (c == 10 && r == 10) return 1e6;
    if (c == 20 && (r == 20 || r == 21)) return -50.0;  // a pair has one neighbour each
    if (c == 30 && r == 30) return std::nan("");
    if (c == 40) return 5.0;  // a wall one sample wide has four each
    return 0.1 * whiteNoise(c, r);
  });
  const std::vector<Polyline> lines{polylineOf(straightStroke({5.0, 5.0}, {60.0, 60.0}), false)};
  SampleWindow window(field.reader(), {0, 0}, lines, 40.0, 0.1);
  int seen = 0;
  window.forEachAround({32.0, 32.0}, 40, [&](SampleWindow::Index i, int c, int r) {
    const SampleWindow::Sample& sample = window.at(i);
    if (c < 0 || r < 0 || c >= 64 || r >= 64) {
      EXPECT_TRUE(std::isnan(sample.height));
      return;
    }
    ++seen;
    if (c == 40 && (r == 0 || r == 63)) return;  // only two of its neighbours lie in the field
    const bool spike = (c == 10 && r == 10) || (c == 20 && (r == 20 || r == 21)) || (c == 30 && r == 30);
    EXPECT_EQ(sample.kept, !spike) << c << ", " << r;
  });
  EXPECT_EQ(seen, 64 * 64);
}

TEST(SampleWindow, SamplesThatNothingExplainsAreDroppedAndOthersComeBack) {
  const Version field = edgeField(32, 32, [](int c, int r) { return c == 5 && r == 5 ? 9.0 : 0.0; });
  SampleWindow window(field.reader(), {0, 0}, {polylineOf({{5.0, 5.0}, {9.0, 5.0}}, false)}, 3.0, 0.1);
  const auto at = [&](int column) -> SampleWindow::Sample& {
    SampleWindow::Index found = 0;
    window.forEachAround({column, 5.0}, 0, [&](SampleWindow::Index i, int, int) { found = i; });
    return window.at(found);
  };
  EXPECT_FALSE(at(5).kept);
  at(5).misfit = 1.0F;  // fits a surface after all
  at(6).misfit = 5.0F;
  at(7).misfit = 0.0F;  // not known
  window.applyMisfits();
  EXPECT_TRUE(at(5).kept);
  EXPECT_FALSE(at(6).kept);
  EXPECT_TRUE(at(7).kept);
  EXPECT_TRUE(at(8).kept);
  EXPECT_EQ(at(5).misfit, SampleWindow::kNoFit);
}

TEST(Strip, CoordinatesAreAcrossToTheLeftAndAlong) {
  const Version field = edgeField(64, 64, [](int c, int r) { return 2.0 * c + 3.0 * r; });
  const Polyline line = polylineOf({{20.0, 30.0}, {40.0, 30.0}}, false);
  SampleWindow window(field.reader(), {0, 0}, {line}, 12.0, 1000.0);
  const Strip strip = stripAlong(line, window, 6.0, 3);
  std::set<SampleWindow::Index> once;
  for (int i = 0; i < line.size(); ++i)
    for (const StripSample& sample : strip.at(i)) {
      EXPECT_TRUE(once.insert(sample.index).second) << "a sample belongs to one point";
      // The line runs along x, so that left is up.
      EXPECT_NEAR(sample.z + strip.reference, 2.0 * (20.0 + i + sample.s) + 3.0 * (30.0 + sample.d), 1e-4);
      EXPECT_LE(std::abs(sample.d), 6.5);
      EXPECT_LE(std::abs(sample.s), 2.5);
    }
  EXPECT_GE(once.size(), 21U * 13U);
}

TEST(Strip, HolesAndTheOutsideAreLeftOut) {
  const Version field = edgeField(64, 8, [](int c, int r) { return c < 30 || r == 2 ? std::nan("") : 1.0; });
  const Polyline line = polylineOf({{10.0, 3.0}, {50.0, 3.0}}, false);
  SampleWindow window(field.reader(), {0, 0}, {line}, 14.0, 1.0);
  const Strip strip = stripAlong(line, window, 12.0, 3);
  EXPECT_TRUE(strip.at(0).empty());
  EXPECT_EQ(strip.at(30).size(), 7U);
}

}  // namespace
}  // namespace fettle::engine
