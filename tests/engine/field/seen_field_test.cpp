#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/field/nominal_form.h"
#include "engine/field/seen_field.h"
#include "tests/support/no_data.h"
#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

using EditedAt = std::pair<int, int>;

Grid seenGrid(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.origin_x = 5e6;
  grid.origin_y = 5e6;
  return grid;
}

// A rough field about `level`, with holes and marks.
Version roughField(int width, int height, float level, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (int i = 0; i < width * height; ++i) {
    z.push_back(random() % 11 == 0 ? kNan : level + static_cast<float>(random() % 100000) * 1e-4F);
    marks.push_back(random() % 17 == 0);
  }
  return makeField(seenGrid(width, height), z, marks);
}

// Of a degree; above the most a shape, so that 6 to 8 are a sphere, a cylinder and a cone.
FieldForm someForm(const Version& field, int degree, double base, unsigned seed) {
  if (degree > PolynomialForm::kMostDegree)
    return std::make_shared<const NominalForm>(someShape(
        field.grid(), static_cast<FormShape>(degree - PolynomialForm::kMostDegree - 1), base, seed));
  PolynomialForm form{degree, field.grid().width, field.grid().height, base, {}};
  std::mt19937 random(seed);
  for (int i = 0; i < PolynomialForm::terms(degree); ++i)
    form.coefficients.push_back(static_cast<double>(random() % 2000) * 0.01 - 10.0);
  return std::make_shared<const NominalForm>(std::move(form));
}

SeenField seenOf(const Version& version) {
  JobControl job;
  return *SeenField::of(version, job);
}

SeenField afterEdit(const SeenField& before, const Version& field) {
  JobControl job;
  return *before.edited(field, job);
}

std::uint32_t bitsAt(const Version& field, int c, int r) {
  const float z = field.reader().heightAt(c, r);
  return std::isnan(z) ? 0x7FC00000U : std::bit_cast<std::uint32_t>(z);
}

// The plain reference: one sample.
float plainSeen(float z, double form) {
  return std::isnan(z) ? z : static_cast<float>(static_cast<double>(z) - form);
}

void expectSeen(const SeenField& field) {
  const FieldReader z = field.restored().reader();
  const FieldReader s = field.seen().reader();
  const NominalForm& form = *field.restored().form();
  for (int r = 0; r < z.height(); ++r)
    for (int c = 0; c < z.width(); ++c) {
      const float want = z.sign() * plainSeen(z.sign() * z.heightAt(c, r), form.heightAt(c, r));
      const float got = s.heightAt(c, r);
      // The form of a tile and that of one sample add the same terms in another order, and may be rounded to neighbours when
      // the base is added: a unit in the last place of the form. Near the middle between two floats one may round up and
      // one down.
      const double near = std::numeric_limits<float>::epsilon() * std::abs(want) +
                          std::numeric_limits<double>::epsilon() * std::abs(form.heightAt(c, r));
      RC_ASSERT((std::isnan(want) ? std::isnan(got) : std::abs(got - want) <= near));
      RC_ASSERT(z.markedAt(c, r) == s.markedAt(c, r));
    }
  // Bounds, counts and flags of the tree are those of the samples.
  const FieldSummary summary = summarize(field.seen());
  RC_ASSERT(summary.no_data == summarize(field.restored()).no_data);
  RC_ASSERT(summary.marked == summarize(field.restored()).marked);
  if (summary.no_data < std::int64_t{z.width()} * z.height()) {
    RC_ASSERT(s.bounds().min == static_cast<float>(summary.min));
    RC_ASSERT(s.bounds().max == static_cast<float>(summary.max));
  }
}

TEST(SeenField, WithoutAFormIsTheFieldItself) {
  const Version field = roughField(100, 70, 0.0F, 1);
  const SeenField seen = seenOf(field);
  EXPECT_EQ(seen.restored(), field);
  EXPECT_EQ(seen.seen(), field);
  LiveField live(seen.seen(), Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(3, 4, 5.0F));
  EXPECT_EQ(afterEdit(seen, live.snapshot()).restored(), live.snapshot());
}

TEST(SeenField, AFormGoesInAndOutWithoutTouchingASample) {
  const Version field = roughField(100, 70, 0.0F, 1);
  for (const int degree : {2, 6, 7, 8}) {
    const Version formed = field.withForm(someForm(field, degree, 3.0, 1));
    EXPECT_FALSE(formed == field);
    EXPECT_EQ(contentHash(formed), contentHash(field));
    EXPECT_EQ(seenOf(formed).restored(), formed);
    EXPECT_EQ(formed.withForm(nullptr), field);
    EXPECT_NE(contentHash(seenOf(formed).seen()), contentHash(field));
    EXPECT_EQ(seenOf(formed).seen().form(), nullptr);
    JobControl job;
    EXPECT_EQ(*seenOf(formed).seen().seenOf(), formed);
    EXPECT_EQ(*restored(seenOf(formed).seen(), job), formed);
    EXPECT_EQ(*withoutLayer(seenOf(formed).seen(), job), field);
    EXPECT_EQ(*restored(field, job), field);
    // Neither another place nor other lines take it away.
    EXPECT_EQ(formed.withGrid(field.grid()).form(), formed.form());
    EXPECT_EQ(formed.withLines(nullptr).form(), formed.form());
    EXPECT_EQ(formed.inverted().form(), formed.form());
  }
}

// All sizes, levels far from the form, degrees, signs; edits of heights, holes and marks over several steps.
RC_GTEST_PROP(SeenField, EditsChangeTheSamplesThatAreEditedAndNoOther, ()) {
  const int width = *rc::gen::inRange(1, 150);
  const int height = *rc::gen::inRange(1, 150);
  const float level = *rc::gen::element(0.0F, 1000.0F, -5e6F, 1e-3F);
  const auto seed = *rc::gen::inRange(0U, 1000U);
  Version field = roughField(width, height, level, seed);
  field = field.withForm(someForm(field, *rc::gen::inRange(0, 9), level, seed));
  if (*rc::gen::element(0, 1) != 0) field = field.inverted();
  SeenField now = seenOf(field);
  Version felt = now.seen();  // as a loop has it: never computed again
  expectSeen(now);
  std::map<EditedAt, float> edits;

  const int steps = *rc::gen::inRange(1, 5);
  for (int step = 0; step < steps; ++step) {
    LiveField live(felt, Growth::kAllowed);
    std::map<EditedAt, float> edited;
    const int writes = *rc::gen::inRange(0, 12);
    for (int k = 0; k < writes; ++k) {
      const EditedAt at{*rc::gen::inRange(0, width), *rc::gen::inRange(0, height)};
      if (*rc::gen::element(0, 1, 2) == 0) {
        RC_ASSERT(live.setMark(at.first, at.second, *rc::gen::element(0, 1) != 0));
        continue;
      }
      const float z = *rc::gen::element(0.25F, -3.7F, 12.1F, kNan);
      edited[at] = z;
      RC_ASSERT(live.setHeight(at.first, at.second, z));
    }
    felt = live.snapshot();
    const SeenField next = afterEdit(now, felt);
    JobControl job;
    RC_ASSERT(contentHash(*restored(felt, job)) == contentHash(next.restored()));
    expectSeen(next);
    RC_ASSERT(next.restored().form() == field.form());
    const FieldReader before = now.restored().reader();
    const FieldReader after = next.restored().reader();
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) {
        RC_ASSERT(after.markedAt(c, r) == felt.reader().markedAt(c, r));
        const auto found = edited.find({c, r});
        if (found == edited.end()) {
          RC_ASSERT(bitsAt(now.restored(), c, r) == bitsAt(next.restored(), c, r));
          continue;
        }
        const float z = found->second;
        RC_ASSERT(std::isnan(after.heightAt(c, r)) == std::isnan(z));
        if (std::isnan(z)) continue;
        const double want = z + before.sign() * field.form()->heightAt(c, r);
        // Half a unit in the last place; the form's rounding is far below it.
        RC_ASSERT(std::abs(after.heightAt(c, r) - want) <=
                  0.51 * std::numeric_limits<float>::epsilon() * std::abs(want) + 1e-12);
        edits[{c, r}] = z;
      }
    now = next;
  }
  // Out again: what was never edited is the scan, bit by bit.
  const Version out = now.restored().withForm(nullptr);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      if (!edits.contains({c, r}) && !std::isnan(out.reader().heightAt(c, r)))
        RC_ASSERT(bitsAt(out, c, r) == bitsAt(field, c, r));
}

// Found by a random field: terms that were added to a base of 5e6 one by one were each rounded to 1e-9.
TEST(SeenField, ALargeBaseIsRoundedOnce) {
  const Version field = roughField(111, 88, -5e6F, 53);
  const FieldForm form = someForm(field, 3, -5e6, 53);
  PolynomialForm terms = *form->polynomial();
  terms.base = 0.0;
  std::vector<double> heights(std::size_t{kTileSide} * kTileSide);
  form->readHeights({0, 0, kTileSide, kTileSide}, heights.data(), kTileSide);
  for (int r = 0; r < kTileSide; ++r)
    for (int c = 0; c < kTileSide; ++c) {
      // Half a unit in the last place of 5e6, and the rounding of the terms, some 1e2 each.
      const double exact = terms.heightAt(c, r), read = heights[static_cast<std::size_t>(r * kTileSide + c)];
      ASSERT_NEAR(read + 5e6, exact, 0x1p-31 + 1e-12) << c << " " << r;
    }
}

// A step that is taken back at once, and the same in two: the loop's field is never computed again in between.
TEST(SeenField, ASampleEditedOnceIsNotChangedBySteps) {
  const Version scan = roughField(200, 130, 1e6F, 3);
  const SeenField start = seenOf(scan.withForm(someForm(scan, 2, 1e6, 3)));
  LiveField live(start.seen(), Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(10, 20, 0.013F));  // far below the last place of 1e6
  SeenField steps = afterEdit(start, live.snapshot());
  const std::uint32_t once = bitsAt(steps.restored(), 10, 20);
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(live.setHeight(11, 20, static_cast<float>(k)));
    steps = afterEdit(steps, live.snapshot());
    EXPECT_EQ(bitsAt(steps.restored(), 10, 20), once);
  }
  EXPECT_EQ(contentHash(afterEdit(start, live.snapshot()).restored()), contentHash(steps.restored()));
}

// A filter's result may come in new memory, tile by tile the same: nothing was edited then.
TEST(SeenField, AFieldWithOtherTilesOfTheSameContentChangesNothing) {
  const Version scan = roughField(150, 130, 50.0F, 4);
  const SeenField start = seenOf(scan.withForm(someForm(scan, 1, 50.0, 4)));
  const FieldReader from = start.seen().reader();
  auto builder = FieldBuilder::create(start.seen().grid(), "test");
  std::vector<float> z(150 * 130);
  std::vector<std::uint8_t> marks(150 * 130);
  from.readHeights(0, 0, 150, 130, z.data(), 150);
  from.readMarks(0, 0, 150, 130, marks.data(), 150);
  z[7] = 1.5F;
  builder->writeHeights(0, 0, 150, 130, z.data(), 150);
  builder->writeMarks(0, 0, 150, 130, marks.data(), 150);
  const SeenField after = afterEdit(start, std::move(*builder).build());
  // The tile of the sample alone is another.
  EXPECT_EQ(changedTiles(start.restored(), after.restored()).size(), 1U);
  EXPECT_EQ(changedTiles(start.seen(), after.seen()).size(), 1U);
}

// States of a field that is worked on: edits, undo to any of them and work from there. What is stored of a state is a
// function of the state alone, and states that share a tile share what is stored of it.
RC_GTEST_PROP(StoredStates, AreTheSameOnEveryPath, ()) {
  JobControl job;
  const int width = *rc::gen::inRange(1, 300);
  const int height = *rc::gen::inRange(1, 300);
  const float level = *rc::gen::element(0.0F, 1000.0F, -5e6F);
  const Version scan = roughField(width, height, level, 7);
  const Version start = seenOf(scan.withForm(someForm(scan, 2, level, 7))).seen();
  std::vector<Version> states{start, scan};
  StoredStates stored;
  for (int k = 0; k < 12; ++k) {
    const Version from = states[*rc::gen::inRange<std::size_t>(0, states.size())];
    const Version before = *stored.of(from, job);
    LiveField live(from, Growth::kAllowed);
    for (int n = *rc::gen::inRange(0, 4); n > 0; --n)
      RC_ASSERT(live.setHeight(*rc::gen::inRange(0, width), *rc::gen::inRange(0, height),
                               *rc::gen::element(0.25F, -3.7F, kNan)));
    if (*rc::gen::element(0, 1, 2, 3) == 0)
      RC_ASSERT(live.setMark(*rc::gen::inRange(0, width), *rc::gen::inRange(0, height), true));
    const Version to = live.snapshot();
    const Version after = *stored.of(to, job);
    RC_ASSERT(contentHash(after) == contentHash(*restored(to, job)));
    RC_ASSERT(after.form() == to.formOver());
    RC_ASSERT(changedTiles(before, after).size() <= changedTiles(from, to).size());
    // What is seen of it afresh, near it and near another field.
    const Version seen = seenOf(after).seen();
    RC_ASSERT(contentHash(*seenNear(after, to, job)) == contentHash(seen));
    RC_ASSERT(contentHash(*seenNear(after, scan, job)) == contentHash(seen));
    states.push_back(to);
  }
}

TEST(StoredStates, EqualTilesAreSharedAndHeightsMadeOfWhatIsSeen) {
  JobControl job;
  const Version scan = roughField(300, 200, 10.0F, 8);
  const Version seen = seenOf(scan.withForm(someForm(scan, 1, 10.0, 8))).seen();
  LiveField live(seen, Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(5, 5, 1.0F));
  ASSERT_TRUE(live.setHeight(250, 150, 1.0F));
  const Version once = *restored(live.snapshot(), job), again = *restored(live.snapshot(), job);
  EXPECT_EQ(changedTiles(once, again).size(), 2U);
  const Version shared = *sharingEqualTiles(again, once);
  EXPECT_EQ(changedTiles(once, shared).size(), 0U);
  EXPECT_EQ(contentHash(shared), contentHash(again));
  EXPECT_EQ(changedTiles(scan, *sharingEqualTiles(once, scan)).size(), 2U);
  const Version heights = madeHeights(live.snapshot());
  EXPECT_EQ(heights.seenOf(), nullptr);
  EXPECT_EQ(contentHash(heights), contentHash(live.snapshot()));
  EXPECT_EQ(*restored(heights, job), heights);
  EXPECT_EQ(heights.grid(), scan.grid());
}

// Undo and redo: as if it were computed afresh, with the tiles shared.
TEST(SeenField, AnotherStateIsSeenAsIfComputedAfresh) {
  const Version scan = roughField(300, 200, 200.0F, 5);
  const SeenField start = seenOf(scan.withForm(someForm(scan, 3, 200.0, 5)));
  LiveField live(start.seen(), Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(70, 80, 1.0F));
  ASSERT_TRUE(live.setHeight(250, 10, 3.0F));
  const SeenField edited = afterEdit(start, live.snapshot());
  JobControl job;
  const SeenField undone = *edited.at(start.restored(), job);
  EXPECT_EQ(contentHash(undone.seen()), contentHash(start.seen()));
  EXPECT_EQ(changedTiles(undone.seen(), edited.seen()).size(), 2U);
  const SeenField redone = *undone.at(edited.restored(), job);
  EXPECT_EQ(contentHash(redone.seen()), contentHash(edited.seen()));
  EXPECT_EQ(contentHash(redone.seen()), contentHash(seenOf(edited.restored()).seen()));
  const SeenField out = *redone.at(edited.restored().withForm(nullptr), job);
  EXPECT_EQ(out.seen(), edited.restored().withForm(nullptr));
}

TEST(SeenField, LinesAndSignAreThoseOfTheFieldThatWasEdited) {
  const Version scan = roughField(80, 70, 0.0F, 6);
  const SeenField start = seenOf(scan.withForm(someForm(scan, 1, 0.0, 6)));
  std::vector<EdgeLine> lines(1);
  lines[0].points.resize(2);
  lines[0].points[1].position = {5.0, 5.0};
  const Version changed =
      start.seen().withLines(std::make_shared<const std::vector<EdgeLine>>(std::move(lines))).inverted();
  const SeenField after = afterEdit(start, changed);
  EXPECT_EQ(after.restored().lines(), changed.lines());
  EXPECT_EQ(after.seen().lines(), changed.lines());
  EXPECT_EQ(after.restored().reader().sign(), -1.0F);
  EXPECT_EQ(after.restored().inverted().withLines(nullptr).form(), start.restored().form());
  EXPECT_EQ(contentHash(after.restored().inverted()), contentHash(scan));
}

TEST(SeenField, HardHeightsStayHeights) {
  constexpr float kMost = std::numeric_limits<float>::max();
  const std::vector<float> heights{kMost, -kMost, 0.0F, -0.0F, 1e-42F, kNan, 1.0F, -1.0F};
  const Version scan = makeField(seenGrid(8, 1), heights);
  for (const double base : {3e38, -3e38, 1e-45, 0.0}) {
    const auto form = std::make_shared<const NominalForm>(PolynomialForm{0, 8, 1, base, {0.0}});
    const SeenField start = seenOf(scan.withForm(form));
    for (int c = 0; c < 8; ++c)
      EXPECT_EQ(std::isfinite(start.seen().reader().heightAt(c, 0)), c != 5) << base << ' ' << c;
    // One of them edited, all others are as they were.
    for (int edit = 0; edit < 8; ++edit) {
      LiveField live(start.seen(), Growth::kAllowed);
      ASSERT_TRUE(live.setHeight(edit, 0, -kMost));
      const Version after = afterEdit(start, live.snapshot()).restored();
      for (int c = 0; c < 8; ++c) {
        if (c == edit) continue;
        EXPECT_EQ(bitsAt(after, c, 0), bitsAt(scan, c, 0)) << base << ' ' << c;
      }
      EXPECT_TRUE(std::isfinite(after.reader().heightAt(edit, 0)));
    }
  }
}

TEST(SeenField, AFieldOfHolesHasNothingToSee) {
  const Version holes = makeField(seenGrid(70, 3), std::vector<float>(210, kNan));
  const SeenField seen = seenOf(holes.withForm(someForm(holes, 5, 1.0, 7)));
  EXPECT_EQ(summarize(seen.seen()).no_data, 210);
  EXPECT_TRUE(seen.seen().reader().bounds().empty());
}

TEST(SeenField, TheNumberOfThreadsChangesNoBit) {
  const Version scan = roughField(500, 400, 10.0F, 8);
  const Version formed = scan.withForm(someForm(scan, 5, 10.0, 8));
  const std::uint64_t many = contentHash(seenOf(formed).seen());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(contentHash(seenOf(formed).seen()), many);
}

TEST(SeenField, ACancelledJobGivesNothing) {
  const Version scan = roughField(100, 100, 0.0F, 9);
  const Version formed = scan.withForm(someForm(scan, 1, 0.0, 9));
  JobControl cancelled;
  cancelled.cancel();
  EXPECT_EQ(SeenField::of(formed, cancelled).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(seenOf(formed).edited(seenOf(formed).seen(), cancelled).error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
