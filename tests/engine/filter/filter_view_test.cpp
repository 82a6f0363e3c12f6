// Previews: what is seen first, exactly or approximately, and what says how far an approximation is off.
#include "engine/filter/filter_view.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/filter/each_block.h"
#include "engine/filter/region.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

// A wavy ground with noise, some holes and marks.
Version groundOf(int width, int height, bool holes = true) {
  PlainField plain = formed(width, height, [holes](int c, int r) {
    const unsigned hash =
        (static_cast<unsigned>(c) * 2654435761U) ^ (static_cast<unsigned>(r) * 40503U * 7919U);
    if (holes && hash % 97 == 3) return std::numeric_limits<float>::quiet_NaN();
    return static_cast<float>(std::sin(0.02 * c) + std::cos(0.015 * r) + 1e-3 * ((hash >> 8) % 100));
  });
  plain.marks.assign(plain.z.size(), 0);
  for (std::size_t i = 0; i < plain.z.size(); i += 31) plain.marks[i] = 1;
  return toVersion(plain);
}

FilterSpec specOf(FilterKind kind, int window = 3) {
  FilterSpec spec;
  spec.kind = kind;
  const Filter& filter = filterOf(kind);
  if (filter.window.exists()) spec.window = window;
  if (filter.range_sigma.exists()) spec.range_sigma = 0.03;
  if (filter.nesting.exists()) spec.nesting_mm = 8.0;
  return spec;
}

// So slow that what is in view is approximated, on any machine.
FilterSpec slowSpec() {
  FilterSpec spec = specOf(FilterKind::kMedian, 61);
  spec.passes = 100;
  spec.threads = 1;
  return spec;
}

// run() on a thread of its own, looked at by this one.
class Running {
 public:
  Running(FilterView& view, const FilterSpec& spec)
      : thread_([this, &view, spec] {
          result_ = view.run(spec, job_);
          ended_.store(true);
        }) {}
  ~Running() { job_.cancel(); }

  // Until a picture is so; that picture.
  FilterView::Picture until(const FilterView& view,
                            const std::function<bool(const FilterView::Picture&)>& holds) {
    for (;;) {
      const bool last = ended_.load();
      FilterView::Picture picture = view.picture();
      if (holds(picture)) return picture;
      if (last) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  Result<FilterView::Done>& end() {
    thread_.join();
    return result_;
  }
  void cancel() { job_.cancel(); }
  [[nodiscard]] bool ended() const { return ended_.load(); }

 private:
  JobControl job_;
  std::atomic<bool> ended_{false};
  Result<FilterView::Done> result_ = cancelled();
  std::jthread thread_;
};

// Samples of these tiles that are not the same, bit by bit.
std::int64_t differing(const Version& a, const Version& b, const TileRange& in) {
  std::int64_t n = 0;
  for (int r = in.row * 64; r < std::min((in.row + in.rows) * 64, a.grid().height); ++r)
    for (int c = in.column * 64; c < std::min((in.column + in.columns) * 64, a.grid().width); ++c)
      n += sameBits(a.reader().heightAt(c, r), b.reader().heightAt(c, r)) ? 0 : 1;
  return n;
}

TEST(FilterView, EveryFilterEndsWithTheBitsOfTheWhole) {
  const Version field = groundOf(600, 450);
  for (const Filter& filter : filters())
    for (const int passes : {1, 3}) {
      if (passes > 1 && (filter.keeps_edges || !filter.sampled)) continue;
      for (const Version& input : {field, field.inverted()}) {
        FilterSpec spec = specOf(filter.kind, 5);
        spec.passes = passes;
        JobControl job;
        FilterView view(input, field, {{2, 1, 4, 3}, 250, 150});
        EXPECT_TRUE(view.picture().field.empty());
        const auto done = view.run(spec, job);
        ASSERT_TRUE(done) << filter.word;
        const auto whole = applyFilter(input, field, spec, job);
        EXPECT_EQ(contentHash(done->filtered.field), contentHash(whole->field)) << filter.word;
        EXPECT_EQ(done->filtered.report.changed, whole->report.changed);
        const FilterView::Picture last = view.picture();
        EXPECT_EQ(contentHash(last.field), contentHash(whole->field)) << filter.word;
        EXPECT_EQ(last.exact, 1.0);
        EXPECT_EQ(last.step, 0);
      }
    }
}

TEST(FilterView, ARangeThatIsMissingIsThatOfTheWholeField) {
  const Version field = groundOf(500, 400, false);
  JobControl job;
  FilterSpec asked = specOf(FilterKind::kTotalVariation, 7);
  asked.range_sigma = 0.0;
  FilterView view(field, field, {{0, 0, 2, 2}, 30, 30});
  const auto done = view.run(asked, job);
  ASSERT_TRUE(done);
  EXPECT_GT(done->spec.range_sigma, 0.0);
  EXPECT_EQ(contentHash(done->filtered.field),
            contentHash(applyFilter(field, field, done->spec, job)->field));
}

// What is in view has its bits long before the rest.
TEST(FilterView, WhatIsSeenIsExactFirst) {
  const Version field = groundOf(1400, 1200);
  const TileRange seen{14, 9, 3, 2};
  FilterSpec spec = specOf(FilterKind::kBilateral, 41);
  spec.threads = 1;
  FilterView view(field, field, {seen, 15 * 64, 10 * 64});
  Running running(view, spec);
  const auto picture = running.until(view, [](const auto& p) { return p.exact == 1.0; });
  running.cancel();
  ASSERT_FALSE(picture.field.empty());
  const Result<FilterView::Done>& ended = running.end();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::kCancelled);
  JobControl job;
  const auto expected = filterRange(field, field, field, spec, seen, job);
  ASSERT_TRUE(expected);
  EXPECT_EQ(differing(picture.field, *expected, seen), 0);
  EXPECT_GT(differing(picture.field, field, seen), 10000);
  // The corner farthest away is as it was.
  EXPECT_EQ(differing(picture.field, field, {0, 0, 4, 4}), 0);
}

// Blocks as a pass hands them out, and a camera that moves after five of them.
TEST(FilterView, BlocksFollowTheOrderThatIsWished) {
  class Ordered : public FilterWork {
   public:
    std::vector<TileRect> blocks;
    Result<State> begin(const Version& input) override { return State{0, input}; }
    Status beginPass(const State&) override { return {}; }
    std::uint64_t wish() override { return blocks.size() < 5 ? 1 : 2; }
    double rank(const TileRect& b) override {
      return blocks.size() < 5 ? std::hypot(b.column0 - 4, b.row0 - 3) : b.column0 + 0.01 * b.row0;
    }
    bool isDone(const TileRect&) override { return false; }
    void done(const TileRect& block, std::vector<NewTile>&, std::size_t) override { blocks.push_back(block); }
    void addMade(std::vector<NewTile>&) override {}
  };
  const Version field = groundOf(500, 400);
  for (const FilterKind kind : {FilterKind::kMedian, FilterKind::kOpening}) {
    Ordered work;
    FilterSpec spec = specOf(kind, 5);
    spec.threads = 1;
    JobControl job;
    const auto done = applyFilter(field, field, spec, {.block_side = 64, .work = &work}, job);
    ASSERT_TRUE(done);
    EXPECT_EQ(contentHash(done->field), contentHash(applyFilter(field, field, spec, job)->field));
    ASSERT_EQ(work.blocks.size(), 56U);
    for (std::size_t i = 1; i < 5; ++i)
      EXPECT_GE(std::hypot(work.blocks[i].column0 - 4, work.blocks[i].row0 - 3),
                std::hypot(work.blocks[i - 1].column0 - 4, work.blocks[i - 1].row0 - 3));
    EXPECT_EQ(work.blocks[0].column0, 4);
    EXPECT_EQ(work.blocks[0].row0, 3);
    for (std::size_t i = 6; i < work.blocks.size(); ++i)
      EXPECT_GE(work.blocks[i].column0, work.blocks[i - 1].column0);
  }
}

TEST(FilterView, WhatTakesLongIsApproximatedAndSaysByHowMuch) {
  const Version field = groundOf(700, 500);
  const TileRange seen{1, 1, 8, 5};
  FilterView view(field, field, {seen, 300, 200});
  const FilterSpec spec = slowSpec();
  Running running(view, spec);
  const auto first = running.until(
      view, [](const auto& p) { return p.step > 0 && p.field.grid().width == 700 && p.untouched == 0.0; });
  ASSERT_FALSE(first.field.empty());
  EXPECT_FALSE(running.ended());
  EXPECT_GT(first.step, 1);
  EXPECT_LT(first.exact, 0.5);
  // Holes and marks are as they were.
  for (int r = 64; r < 6 * 64; ++r)
    for (int c = 64; c < 9 * 64; ++c) {
      const float was = field.reader().heightAt(c, r), is = first.field.reader().heightAt(c, r);
      ASSERT_EQ(std::isnan(was), std::isnan(is));
      if (field.reader().markedAt(c, r)) {
        ASSERT_TRUE(sameBits(was, is));
      }
    }
  // It comes near what it stands for.
  const Result<FilterView::Done>& done = running.end();
  ASSERT_TRUE(done);
  double off = 0.0, changed = 0.0;
  for (int r = 64; r < 6 * 64; ++r)
    for (int c = 64; c < 9 * 64; ++c) {
      const double z = done->filtered.field.reader().heightAt(c, r);
      if (std::isnan(z)) continue;
      off += std::pow(first.field.reader().heightAt(c, r) - z, 2);
      changed += std::pow(field.reader().heightAt(c, r) - z, 2);
    }
  EXPECT_GT(changed, 0.0);
  EXPECT_LT(off, 0.3 * changed);
}

// The stated error against that of the picture that was shown.
TEST(FilterView, TheErrorIsThatOfTheTilesThatWereApproximated) {
  const Version field = groundOf(1280, 1280, false);
  FilterSpec spec = specOf(FilterKind::kGeneralisedVariation);
  spec.threads = 1;
  const TileRange seen{0, 0, 20, 20};
  FilterView view(field, field, {seen, 640, 640});
  Running running(view, spec);
  const auto first = running.until(
      view, [](const auto& p) { return p.step > 0 && p.field.grid().width == 1280 && p.untouched == 0.0; });
  ASSERT_FALSE(first.field.empty());
  ASSERT_EQ(first.exact, 0.0) << "too late to see it without results";
  ASSERT_TRUE(running.end());
  const auto last = view.picture();
  ASSERT_TRUE(last.off);
  EXPECT_FALSE(last.off->estimated);
  double squares = 0.0, most = 0.0;
  for (int r = 0; r < 1280; ++r)
    for (int c = 0; c < 1280; ++c) {
      const double off = std::abs(static_cast<double>(first.field.reader().heightAt(c, r)) -
                                  static_cast<double>(last.field.reader().heightAt(c, r)));
      squares += off * off;
      most = std::max(most, off);
    }
  EXPECT_NEAR(last.off->rms, std::sqrt(squares / (1280.0 * 1280.0)), 1e-9);
  EXPECT_NEAR(last.off->most, most, 1e-9);
  EXPECT_GT(most, 0.0);
}

// Its results are all there at the end only.
TEST(FilterView, AFilterOfTheWholeFieldIsApproximatedWithAnEstimate) {
  // A quarter of it takes about as long as is soon enough for nothing to be approximated.
  const Version field = groundOf(2560, 2560);
  FilterSpec spec = specOf(FilterKind::kRobustSpline);
  spec.nesting_mm = 40.0;
  spec.threads = 1;
  FilterView view(field, field, {{0, 0, 40, 40}, 1280, 1280});
  Running running(view, spec);
  const auto first = running.until(view, [](const auto& p) { return p.step > 0 && p.off; });
  ASSERT_FALSE(first.field.empty());
  EXPECT_TRUE(first.off->estimated);
  EXPECT_GT(first.off->rms, 0.0);
  ASSERT_TRUE(running.end());
  const auto last = view.picture();
  EXPECT_EQ(last.exact, 1.0);
  EXPECT_FALSE(last.off->estimated);
  EXPECT_LT(last.off->rms, 4.0 * first.off->rms) << "the estimate says little";
}

TEST(FilterView, ACameraThatMovesIsFollowed) {
  const Version field = groundOf(1400, 1200);
  const FilterSpec spec = slowSpec();
  FilterView view(field, field, {{0, 0, 3, 3}, 90, 90});
  Running running(view, spec);
  ASSERT_FALSE(
      running.until(view, [](const auto& p) { return p.step > 0 && p.untouched == 0.0; }).field.empty());
  EXPECT_FALSE(view.wantsCoarse());
  view.look({{15, 14, 3, 3}, 16 * 64 + 32, 15 * 64 + 32});
  const auto moved = view.picture();
  EXPECT_EQ(moved.untouched, 1.0);
  EXPECT_TRUE(view.wantsCoarse());
  JobControl job;
  ASSERT_TRUE(view.coarsen(job));
  EXPECT_FALSE(view.wantsCoarse());
  EXPECT_EQ(view.picture().untouched, 0.0);
  EXPECT_GT(differing(view.picture().field, field, {15, 14, 3, 3}), 10000);
  EXPECT_FALSE(running.ended());
  // A view that reaches beyond the field is cut.
  view.look({{20, 17, 90, 90}, 5000, 5000});
  EXPECT_EQ(view.picture().untouched, 1.0);
  running.cancel();
}

TEST(CoarseFilter, SpecsShrinkWithTheStep) {
  FilterSpec spec = specOf(FilterKind::kBilateral, 33);
  spec.sigma = 8.0;
  const auto coarse = coarseSpec(spec, 4, 16, 4.0);
  ASSERT_TRUE(coarse);
  EXPECT_EQ(coarse->window, 9);
  EXPECT_EQ(coarse->sigma, 2.0);
  EXPECT_NEAR(coarse->range_sigma, 0.03 / 4.0, 1e-15);
  // Windows within a cell: nothing to do, or with many passes as wide by fewer of them.
  EXPECT_FALSE(coarseSpec(specOf(FilterKind::kMedian, 5), 16, 64, 16.0));
  FilterSpec many = specOf(FilterKind::kBox, 3);
  many.passes = 400;
  const auto fewer = coarseSpec(many, 10, 30, 10.0);
  ASSERT_TRUE(fewer);
  EXPECT_EQ(fewer->window, 3);
  EXPECT_EQ(fewer->passes, 4);
  // A cut-off that is shorter than two cells.
  EXPECT_FALSE(coarseSpec(specOf(FilterKind::kArealGaussian), 5, 20, 5.0));
  EXPECT_TRUE(coarseSpec(specOf(FilterKind::kArealGaussian), 3, 9, 3.0));
}

TEST(CoarseFilter, APlaneStaysAPlane) {
  const Version plane =
      toVersion(formed(300, 260, [](int c, int r) { return static_cast<float>(0.5 * c - 0.25 * r); }));
  const FilterSpec spec = specOf(FilterKind::kBox, 31);
  JobControl job;
  for (const Version& input : {plane, plane.inverted()}) {
    const auto coarse = CoarseFilter::make(input, input, spec, {0, 0, 300, 260}, 5, job);
    ASSERT_TRUE(coarse);
    EXPECT_EQ(coarse->cells().grid().width, 60);
    const TileRef tile = coarse->tile(input, input, spec, 1, 1);
    ASSERT_TRUE(tile);
    for (int r = 64; r < 128; ++r)
      for (int c = 64; c < 128; ++c) {
        ASSERT_NEAR(tile->samples[static_cast<std::size_t>((r - 64) * 64 + c - 64)],
                    plane.reader().heightAt(c, r), 1e-4);
        ASSERT_NEAR(coarse->heightAt(c, r), input.reader().heightAt(c, r), 1e-4);
      }
  }
}

TEST(CoarseFilter, NoSampleChangesByMoreThanAllowed) {
  const Version field = groundOf(300, 260);
  FilterSpec spec = specOf(FilterKind::kBox, 31);
  spec.max_change = 0.01;
  JobControl job;
  const auto coarse = CoarseFilter::make(field, field, spec, {0, 0, 300, 260}, 6, job);
  ASSERT_TRUE(coarse);
  const TileRef tile = coarse->tile(field, field, spec, 0, 0);
  double most = 0.0;
  for (int i = 0; i < 64 * 64; ++i) {
    const double off = static_cast<double>(tile->samples[static_cast<std::size_t>(i)]) -
                       static_cast<double>(field.reader().heightAt(i % 64, i / 64));
    if (!std::isnan(off)) most = std::max(most, std::abs(off));
  }
  EXPECT_LE(most, 0.01);
  EXPECT_GT(most, 0.009);
}

}  // namespace
}  // namespace fettle::engine::tests
