#include "engine/fill/fill_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec2.hpp>

#include "engine/field/builder.h"
#include "engine/field/means.h"
#include "engine/fill/holes.h"

namespace fettle::engine {
namespace {

constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();
using Predicate = std::function<bool(int, int)>;

Version viewedScan(Grid grid, const Predicate& hole, const Predicate& marked = {}) {
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  heights.reserve(static_cast<std::size_t>(grid.samples()));
  for (int r = 0; r < grid.height; ++r) {
    const double along = std::cos(r * 0.013);
    for (int c = 0; c < grid.width; ++c) {
      heights.push_back(hole(c, r) ? kNoHeight
                                   : static_cast<float>(std::sin(c * 0.01) + along + 1e-5 * (c % 7)));
      if (marked) marks.push_back(marked(c, r) ? 1 : 0);
    }
  }
  return makeField(grid, heights, marks);
}

Grid gridOf(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

std::vector<EarlyPicture> shown(FillView& holes, const FieldView& view) {
  std::vector<EarlyPicture> pictures;
  JobControl job;
  const auto done = holes.see(
      view, [&](EarlyPicture p) { pictures.push_back(std::move(p)); }, job);
  EXPECT_TRUE(done) << done.error().line();
  return pictures;
}

std::vector<EarlyPicture> shown(const Version& field, const FillOptions& options, const FieldView& view) {
  FillView holes(field, options);
  return shown(holes, view);
}

Version whole(const Version& field, const FillOptions& options) {
  JobControl job;
  const auto filled = fillHoles(field, options, job);
  EXPECT_TRUE(filled) << filled.error().line();
  return filled ? filled->field : Version();
}

FieldView viewOf(const TileRange& tiles) {
  return {tiles, (2 * tiles.column + tiles.columns) * kTileSide / 2,
          (2 * tiles.row + tiles.rows) * kTileSide / 2};
}

bool sameBits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

// Every sample is as before or has the whole's bits; counts those that were filled.
std::int64_t filledAsWhole(const Version& picture, const Version& before, const Version& all) {
  const FieldReader p = picture.reader(), b = before.reader(), w = all.reader();
  std::int64_t filled = 0;
  for (std::int32_t r = 0; r < b.height(); ++r)
    for (std::int32_t c = 0; c < b.width(); ++c) {
      const float z = p.heightAt(c, r), was = b.heightAt(c, r);
      if (std::isnan(z) && std::isnan(was)) continue;
      if (!sameBits(z, w.heightAt(c, r))) {
        ADD_FAILURE() << "column " << c << ", row " << r;
        return -1;
      }
      filled += std::isnan(was) ? 1 : 0;
    }
  return filled;
}

TEST(HolesOfAPart, AreThoseOfTheFieldUnlessTheyAreCut) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  for (const auto& [width, height, share] :
       {std::tuple{400, 300, 0.03}, {400, 300, 0.45}, {400, 300, 0.6}, {400, 1, 0.5}, {1, 300, 0.5}}) {
    std::vector<std::uint8_t> hole(static_cast<std::size_t>(width * height));
    for (auto& each : hole) each = uniform(random) < share;
    const Version field = viewedScan(gridOf(width, height), [&, w = width](int c, int r) {
      return hole[static_cast<std::size_t>(r * w + c)] != 0;
    });
    JobControl job;
    const auto all = findHoles(field, job);
    ASSERT_TRUE(all);
    const TileRange every = allTiles(field.grid());
    const TileRange part{every.columns / 3, every.rows / 3, (every.columns + 1) / 2, (every.rows + 1) / 2};
    const auto of_part = findHoles(field, part, job);
    ASSERT_TRUE(of_part);
    const SampleRect rect{part.column * kTileSide, part.row * kTileSide, part.columns * kTileSide,
                          part.rows * kTileSide};
    // Those of the field that do not touch a side of the part, in their order.
    std::vector<const Hole*> inside;
    const auto free = [&](const SampleRect& box) {
      const bool left = rect.column == 0 || box.column > rect.column;
      const bool low = rect.row == 0 || box.row > rect.row;
      const std::int32_t right = rect.column + rect.columns, high = rect.row + rect.rows;
      return left && low && (right >= width || box.column + box.columns < right) &&
             (high >= height || box.row + box.rows < high);
    };
    for (const Hole& each : all->holes)
      if (free(each.box)) inside.push_back(&each);
    std::vector<const Hole*> found;
    for (const Hole& each : of_part->holes)
      if (!each.cut) found.push_back(&each);
    ASSERT_EQ(found.size(), inside.size()) << width << " x " << height << ", " << share;
    EXPECT_LT(found.size(), all->holes.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto a = of_part->runsOf(*found[i]), b = all->runsOf(*inside[i]);
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
      EXPECT_EQ(found[i]->at_border, inside[i]->at_border);
    }
  }
}

// Round holes 40 samples apart, one that reaches out of the view and one that reaches out of its margin, too; marks on
// rims, an edge line through many, four times as far apart along y, far from the origin.
TEST(FillView, HolesInViewHaveTheBitsOfTheWhole) {
  Grid grid = gridOf(2000, 1800);
  grid.spacing_x = 0.01;
  grid.spacing_y = 0.04;
  grid.origin_x = 5e6;
  grid.origin_y = -5e6;
  const TileRange tiles{10, 9, 6, 6};  // columns 640 .. 1023, rows 576 .. 959; its margin 512 more
  const Predicate crosses = [](int c, int r) { return r == 700 && c >= 900 && c < 1100; };
  const Predicate beyond = [](int c, int r) { return r == 740 && c >= 900 && c < 1700; };
  const Predicate hole = [&](int c, int r) {
    return (std::hypot(c % 40 - 20, r % 40 - 10) < 5.0 + (c / 40 % 3)) || crosses(c, r) || beyond(c, r);
  };
  Version scan = viewedScan(grid, hole, [&](int c, int r) {
    return (c % 40 == 28 || r % 160 == 4) && !crosses(c, r) && !beyond(c, r);
  });
  EdgeLine line;
  for (int i = 0; i < 900; ++i) {
    EdgePoint point;
    point.position = {600.5 + 0.4 * i, 580.0 + 0.5 * i};
    point.located = i % 7 != 0;
    line.points.push_back(point);
  }
  scan = scan.withLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
  for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature})
    for (const bool at_border : {false, true}) {
      FillOptions options;
      options.method = method;
      options.at_border = at_border;
      const Version all = whole(scan, options);
      const auto pictures = shown(scan, options, viewOf(tiles));
      ASSERT_EQ(pictures.size(), 1U);
      const EarlyPicture& last = pictures.back();
      EXPECT_EQ(last.step, 1);
      EXPECT_FALSE(last.off);
      EXPECT_GT(filledAsWhole(last.field, scan, all), 5000);
      for (int r = tiles.row * kTileSide; r < (tiles.row + tiles.rows) * kTileSide; ++r)
        for (int c = tiles.column * kTileSide; c < (tiles.column + tiles.columns) * kTileSide; ++c) {
          const bool expected = beyond(c, r) || (hole(c, r) && std::isnan(all.reader().heightAt(c, r)));
          ASSERT_EQ(std::isnan(last.field.reader().heightAt(c, r)), expected) << c << ", " << r;
        }
      EXPECT_FALSE(std::isnan(last.field.reader().heightAt(1050, 700))) << "whole, also where it is not seen";
      EXPECT_TRUE(std::isnan(last.field.reader().heightAt(20, 10))) << "far from the view";
      EXPECT_LT(last.exact, 1.0) << "one comes with the whole";
      EXPECT_GT(last.exact, 0.9);
    }
  // The same upside down.
  const FillOptions options;
  const Version over = scan.inverted();
  const auto pictures = shown(over, options, viewOf(tiles));
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_GT(filledAsWhole(pictures.back().field, over, whole(over, options)), 5000);
}

TEST(FillView, TheNearestToTheMiddleComeFirst) {
  const Version scan = viewedScan(gridOf(1503, 1502), [](int c, int r) { return c % 20 > 2 && r % 20 > 14; });
  const FillOptions options;
  const FieldView view{{0, 12, 11, 12}, 300, 1200};
  const auto pictures = shown(scan, options, view);
  ASSERT_GE(pictures.size(), 3U);
  const Version all = whole(scan, options);
  double before = 0.0;
  double nearest_open = 0.0;
  for (const EarlyPicture& picture : pictures) {
    EXPECT_GT(picture.exact, before);
    before = picture.exact;
    // All that is nearer to the middle than an open hole is filled, but for the size of a hole.
    double open = 1e9, filled = 0.0;
    for (int r = 777; r < 1500; r += 20)
      for (int c = 10; c < 700; c += 20) {
        const double distance = std::hypot(c - 300, r - 1200);
        const bool is_open = std::isnan(picture.field.reader().heightAt(c, r));
        if (is_open)
          open = std::min(open, distance);
        else
          filled = std::max(filled, distance);
      }
    EXPECT_GT(open, filled - 5.0);
    EXPECT_GT(open, nearest_open);
    nearest_open = open;
    EXPECT_GE(filledAsWhole(picture.field, scan, all), 50'000);
  }
}

TEST(FillView, ShowsNothingWhereNothingIsFilled) {
  const FillOptions options;
  const Version all_holes = viewedScan(gridOf(200, 100), [](int, int) { return true; });
  EXPECT_TRUE(shown(all_holes, options, viewOf(allTiles(all_holes.grid()))).empty());
  const Version none = viewedScan(gridOf(200, 100), [](int, int) { return false; });
  EXPECT_TRUE(shown(none, options, viewOf(allTiles(none.grid()))).empty());
  const Version one = viewedScan(gridOf(200, 100), [](int c, int r) { return c == 50 && r == 50; });
  EXPECT_TRUE(shown(one, options, {}).empty()) << "nothing is seen";
  EXPECT_TRUE(shown(one, options, viewOf({2, 0, 1, 1})).empty());
  EXPECT_EQ(shown(one, options, viewOf({0, 0, 1, 1})).size(), 1U);
  const Version row = viewedScan(gridOf(300, 1), [](int c, int) { return c > 70 && c < 90; });
  EXPECT_TRUE(shown(row, options, viewOf(allTiles(row.grid()))).empty()) << "it reaches the border";
  FillOptions too = options;
  too.at_border = true;
  const auto pictures = shown(row, too, viewOf(allTiles(row.grid())));
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_EQ(pictures.back().exact, 1.0);
  EXPECT_EQ(contentHash(pictures.back().field), contentHash(whole(row, too)));
}

TEST(FillView, ACancelIsHeard) {
  const Version one = viewedScan(gridOf(200, 100), [](int c, int r) { return c == 50 && r == 50; });
  JobControl job;
  job.cancel();
  FillView holes(one, {});
  const auto done = holes.see(
      viewOf({0, 0, 1, 1}), [](const EarlyPicture&) { FAIL(); }, job);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kCancelled);
}

// How far a picture of means is off all holes, where these fill cells of it.
double offAll(const EarlyPicture& picture, const Version& scan, const Version& all) {
  const SampleRect rect{0, 0, scan.grid().width, scan.grid().height};
  const Version before = meansOf(scan, rect, picture.step), after = meansOf(all, rect, picture.step);
  double squares = 0.0;
  int compared = 0;
  for (std::int32_t r = 0; r < before.grid().height; ++r)
    for (std::int32_t c = 0; c < before.grid().width; ++c) {
      const float was = before.reader().heightAt(c, r), now = after.reader().heightAt(c, r);
      if (sameBits(was, now) || std::isnan(now)) continue;
      const double off =
          static_cast<double>(picture.field.reader().heightAt(c, r)) - static_cast<double>(now);
      EXPECT_TRUE(std::isfinite(off)) << c << ", " << r;
      squares += off * off;
      ++compared;
    }
  EXPECT_GT(compared, 100);
  return std::sqrt(squares / compared);
}

TEST(FillView, OfALargeFieldIsOfMeansWithTheirMeasuredError) {
  const Version scan = viewedScan(gridOf(3100, 2900), [](int c, int r) {
    const int radius = 4 + (c / 100 + r / 100) % 20;
    return (c % 100 - 50) * (c % 100 - 50) + (r % 100 - 50) * (r % 100 - 50) <= radius * radius;
  });
  const FillOptions options;
  const Version all = whole(scan, options);
  const auto pictures = shown(scan, options, viewOf(allTiles(scan.grid())));
  ASSERT_EQ(pictures.size(), 1U);
  const EarlyPicture& picture = pictures.back();
  EXPECT_EQ(picture.step, 3);
  EXPECT_EQ(picture.field.grid().width, 1034);
  ASSERT_TRUE(picture.off);
  EXPECT_FALSE(picture.off->estimated);
  const double off = offAll(picture, scan, all);
  EXPECT_GT(off, 0.0);
  EXPECT_GT(picture.off->rms, 0.5 * off);
  EXPECT_LT(picture.off->rms, 2.0 * off);
  // A part of it in view is exact.
  const auto part = shown(scan, options, viewOf({10, 10, 15, 15}));
  ASSERT_FALSE(part.empty());
  EXPECT_EQ(part.back().step, 1);
  EXPECT_EQ(part.back().exact, 1.0);
}

// How far cells of means are off in the holes nearest to the middle of the view, as many of them as have 30,000 samples.
double offNearest(const EarlyPicture& picture, const Version& scan, const Version& all, const FieldView& view,
                  std::int32_t* right) {
  JobControl job;
  const auto found = findHoles(scan, job);
  EXPECT_TRUE(found);
  const auto distance = [&](const Hole& hole) {
    return std::hypot(hole.box.column + 0.5 * hole.box.columns - view.column,
                      hole.box.row + 0.5 * hole.box.rows - view.row);
  };
  std::vector<Hole> holes = found->holes;
  std::ranges::stable_sort(holes, {}, distance);
  const std::int32_t step = picture.step;
  const Version means = meansOf(all, {0, 0, scan.grid().width, scan.grid().height}, step);
  std::set<std::pair<std::int32_t, std::int32_t>> cells;
  std::int64_t samples = 0;
  for (auto hole = holes.begin(); samples < 30'000 && hole != holes.end(); samples += hole->samples, ++hole) {
    *right = std::max(*right, hole->box.column + hole->box.columns);
    for (const HoleRun& run : found->runsOf(*hole))
      for (std::int32_t c = run.first; c <= run.last; ++c) cells.emplace(c / step, run.row / step);
  }
  double squares = 0.0;
  for (const auto& [c, r] : cells)
    squares += std::pow(static_cast<double>(picture.field.reader().heightAt(c, r)) -
                            static_cast<double>(means.reader().heightAt(c, r)),
                        2);
  return std::sqrt(squares / static_cast<double>(cells.size()));
}

TEST(FillView, HowFarMeansAreOffIsMeasuredInTheHolesNearestToTheMiddle) {
  const Version scan = viewedScan(gridOf(3000, 3000), [](int c, int r) {
    return (c % 60 - 30) * (c % 60 - 30) + (r % 60 - 30) * (r % 60 - 30) <= 225;
  });
  const Version all = whole(scan, {});
  for (const glm::ivec2 middle : {glm::ivec2(2303, 1211), glm::ivec2(701, 2590)}) {
    const FieldView view{allTiles(scan.grid()), middle.x, middle.y};
    const auto pictures = shown(scan, {}, view);
    ASSERT_EQ(pictures.size(), 1U);
    ASSERT_TRUE(pictures.back().off);
    std::int32_t right = 0;
    const double off = offNearest(pictures.back(), scan, all, view, &right);
    EXPECT_EQ(right % pictures.back().step, 1) << "the last cell reaches beyond the last hole";
    EXPECT_NEAR(pictures.back().off->rms, off, 1e-9 * off);
  }
}

TEST(FillView, ALargeHoleOfALargeFieldSaysAboutHowFarItIsOff) {
  const Version scan = viewedScan(gridOf(3000, 3000), [](int c, int r) {
    return (c - 1700) * (c - 1700) + (r - 1300) * (r - 1300) <= 140 * 140;
  });
  FillOptions options;
  options.method = FillMethod::kMembrane;
  const Version all = whole(scan, options);
  const auto pictures = shown(scan, options, viewOf(allTiles(scan.grid())));
  ASSERT_EQ(pictures.size(), 1U);
  const EarlyPicture& picture = pictures.back();
  ASSERT_TRUE(picture.off);
  EXPECT_TRUE(picture.off->estimated);
  const double off = offAll(picture, scan, all);
  EXPECT_GT(picture.off->rms, 0.5 * off);
  EXPECT_LT(picture.off->rms, 4.0 * off);
  // A hole too large for the options stays one.
  options.most_extent_mm = 100.0;
  EXPECT_TRUE(shown(scan, options, viewOf(allTiles(scan.grid()))).empty());
}

// Of 21,000 samples, beside small ones, in a view of a part.
TEST(FillView, ALargeHoleInAPartIsApproximatedFirstAndSaysAboutHowFarItIsOff) {
  const Predicate large = [](int c, int r) { return std::hypot(c - 800, r - 700) <= 82.0; };
  const Predicate small = [](int c, int r) {
    return std::hypot(c - 800, r - 700) > 90.0 && c % 40 < 3 && r % 40 < 3 && c > 40 && r > 40;
  };
  const Version scan =
      viewedScan(gridOf(2000, 1800), [&](int c, int r) { return large(c, r) || small(c, r); });
  const TileRange tiles{8, 7, 9, 8};  // all of it, of a field of 32 x 29
  for (const FillMethod method : {FillMethod::kMembrane, FillMethod::kCurvature}) {
    FillOptions options;
    options.method = method;
    const Version all = whole(scan, options);
    const auto pictures = shown(scan, options, viewOf(tiles));
    ASSERT_GE(pictures.size(), 2U);
    EXPECT_EQ(pictures.front().exact, 0.0) << "large ones come first";
    for (const EarlyPicture& picture : pictures) {
      EXPECT_EQ(picture.step, 1);
      ASSERT_TRUE(picture.off);
      EXPECT_TRUE(picture.off->estimated);
      double squares = 0.0;
      int compared = 0;
      for (int r = 610; r < 790; ++r)
        for (int c = 710; c < 890; ++c) {
          if (!large(c, r)) continue;
          const auto z = static_cast<double>(picture.field.reader().heightAt(c, r));
          ASSERT_TRUE(std::isfinite(z)) << c << ", " << r;
          squares += std::pow(z - static_cast<double>(all.reader().heightAt(c, r)), 2);
          ++compared;
        }
      const double off = std::sqrt(squares / compared);
      EXPECT_GT(picture.off->rms, 0.3 * off);
      EXPECT_LT(picture.off->rms, 6.0 * off);
      EXPECT_LT(off, 0.05) << "of waves of 2";
    }
    const EarlyPicture& last = pictures.back();
    EXPECT_GT(last.exact, 0.0);
    EXPECT_LT(last.exact, 0.1);
    EXPECT_EQ(last.untouched, 0.0);
    for (int r = tiles.row * kTileSide; r < (tiles.row + tiles.rows) * kTileSide; ++r)
      for (int c = tiles.column * kTileSide; c < (tiles.column + tiles.columns) * kTileSide; ++c)
        if (!large(c, r)) {
          ASSERT_TRUE(sameBits(last.field.reader().heightAt(c, r), all.reader().heightAt(c, r)))
              << c << ", " << r;
        }
  }
}

TEST(FillView, AHoleOfAnySizeIsApproximatedFromFewMeans) {
  // 360,000 samples; a scratch through most of the field.
  const Predicate holes[] = {[](int c, int r) { return c > 700 && c <= 1300 && r > 700 && r <= 1300; },
                             [](int c, int r) { return std::abs(c - r) < 4 && c > 100 && c < 1900; }};
  for (const Predicate& hole : holes) {
    const Version scan = viewedScan(gridOf(2000, 2000), hole);
    const auto pictures = shown(scan, {}, {allTiles(scan.grid()), 1000, 1000});
    ASSERT_FALSE(pictures.empty());
    EXPECT_EQ(pictures.back().exact, 0.0);
    ASSERT_TRUE(pictures.back().off);
    EXPECT_TRUE(std::isfinite(pictures.back().field.reader().heightAt(1000, 1000)));
  }
}

TEST(FillView, WhatComesIntoViewIsFilledNextAndWhatWasSeenStays) {
  const Predicate large = [](int c, int r) { return std::hypot(c - 1500, r - 700) <= 70.0; };
  const Version scan = viewedScan(
      gridOf(2200, 1500), [&](int c, int r) { return large(c, r) || (c % 40 == 20 && r % 40 == 20); });
  const FillOptions options;
  const Version all = whole(scan, options);
  FillView holes(scan, options);
  const FieldView left = viewOf({1, 8, 6, 6}), right = viewOf({20, 8, 8, 7}), far = viewOf({1, 18, 4, 4});
  const auto first = shown(holes, left);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first.back().exact, 1.0);
  EXPECT_FALSE(first.back().off);
  EXPECT_TRUE(std::isnan(first.back().field.reader().heightAt(1500, 700)));
  const auto moved = shown(holes, right);
  ASSERT_EQ(moved.size(), 2U);
  EXPECT_TRUE(moved.front().off) << "the large one";
  EXPECT_EQ(moved.front().exact, 0.0);
  EXPECT_TRUE(std::isfinite(moved.back().field.reader().heightAt(1500, 700)));
  EXPECT_TRUE(sameBits(moved.back().field.reader().heightAt(1380, 740), all.reader().heightAt(1380, 740)));
  // Back again: at once, as it was, and no word of what is not in view.
  const auto back = shown(holes, left);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back.back().exact, 1.0);
  EXPECT_FALSE(back.back().off);
  EXPECT_EQ(contentHash(back.back().field), contentHash(moved.back().field));
  const auto again = shown(holes, right);
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again.back().off->rms, moved.back().off->rms);
  EXPECT_EQ(again.back().exact, moved.back().exact);
  // Where nothing is filled, that is what is said.
  const Version one = viewedScan(gridOf(2200, 1500), [](int c, int r) { return c == 50 && r == 50; });
  FillView lone(one, options);
  ASSERT_EQ(shown(lone, viewOf({0, 0, 2, 2})).size(), 1U);
  const auto nothing = shown(lone, far);
  ASSERT_EQ(nothing.size(), 1U);
  EXPECT_EQ(nothing.back().exact, 1.0);
  EXPECT_EQ(nothing.back().untouched, 0.0);
}

TEST(FillView, ZoomedInAndOutOfALargeFieldShowsSamplesAndTheSameMeansAgain) {
  const Version scan = viewedScan(gridOf(3100, 2900), [](int c, int r) {
    return (c % 100 - 50) * (c % 100 - 50) + (r % 100 - 50) * (r % 100 - 50) <= 200;
  });
  FillView holes(scan, {});
  const auto out = shown(holes, viewOf(allTiles(scan.grid())));
  ASSERT_EQ(out.size(), 1U);
  EXPECT_GT(out.back().step, 1);
  const auto in = shown(holes, viewOf({10, 10, 15, 15}));
  ASSERT_FALSE(in.empty());
  EXPECT_EQ(in.back().step, 1);
  EXPECT_EQ(in.back().exact, 1.0);
  const auto again = shown(holes, viewOf(allTiles(scan.grid())));
  ASSERT_EQ(again.size(), 1U);
  EXPECT_TRUE(again.back().field == out.back().field) << "made once";
  EXPECT_EQ(again.back().off->rms, out.back().off->rms);
}

}  // namespace
}  // namespace fettle::engine
