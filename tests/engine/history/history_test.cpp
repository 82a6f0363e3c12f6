#include "engine/history/history.h"

#include <set>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/field/nominal_form.h"

namespace fettle::engine {
namespace {

Grid gridOf(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

Version someField(int width, int height) {
  std::vector<float> z;
  for (int i = 0; i < width * height; ++i) z.push_back(static_cast<float>(i % 101) * 0.25F);
  return makeField(gridOf(width, height), z);
}

StepInfo stroke(const std::string& name) {
  return {name, StepKind::kStroke, stepTimeNow(), {}, 0};
}

Version edited(const Version& from, int column, int row, float z) {
  LiveField live(from, Growth::kAllowed);
  EXPECT_TRUE(live.setHeight(column, row, z));
  return live.snapshot();
}

// The history as the plainest thing it could be: a row of whole copies.
struct PlainState {
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  bool operator==(const PlainState&) const = default;
};

PlainState plainOf(const Version& v) {
  const int w = v.grid().width;
  const int h = v.grid().height;
  PlainState plain{std::vector<float>(static_cast<std::size_t>(w * h)),
                   std::vector<std::uint8_t>(static_cast<std::size_t>(w * h))};
  v.reader().readHeights(0, 0, w, h, plain.z.data(), w);
  v.reader().readMarks(0, 0, w, h, plain.marks.data(), w);
  return plain;
}

// Memory of several versions together beyond that of one, counted object by object.
std::size_t tilesBeyondOne(const std::vector<Version>& versions) {
  std::set<const Tile*> tiles;
  std::size_t one = 0;
  for (const Version& v : versions) {
    const FieldReader r = v.reader();
    one = static_cast<std::size_t>(r.tileColumns()) * r.tileRows();
    for (int tr = 0; tr < r.tileRows(); ++tr)
      for (int tc = 0; tc < r.tileColumns(); ++tc) tiles.insert(&r.tile(tc, tr));
  }
  return tiles.size() - one;
}

RC_GTEST_PROP(History, AnySequenceOfPushesUndosRedosAndBoundsEqualsARowOfCopies, ()) {
  const int width = *rc::gen::inRange(1, 300);
  const int height = *rc::gen::inRange(1, 300);
  const Version start = someField(width, height);
  const std::size_t bound =
      *rc::gen::element(History::kNoBound, std::size_t{0}, std::size_t{60000}, std::size_t{200000});
  History history(start, bound);
  std::vector<PlainState> row{plainOf(start)};  // row[k] = state k, as long as it was reached
  std::int64_t now = 0;
  const int actions = *rc::gen::inRange(1, 60);
  for (int a = 0; a < actions; ++a) {
    switch (*rc::gen::inRange(0, 6)) {
      case 0: {
        const auto version = history.undo();
        RC_ASSERT(version.has_value() == (now > history.first()));
        if (version) --now;
        break;
      }
      case 1: {
        const auto version = history.redo();
        RC_ASSERT(version.has_value() == (now + 1 < static_cast<std::int64_t>(row.size())));
        if (version) ++now;
        break;
      }
      case 2: {
        const std::int64_t to =
            *rc::gen::inRange<std::int64_t>(-1, static_cast<std::int64_t>(row.size()) + 1);
        const bool held = to >= history.first() && to < static_cast<std::int64_t>(row.size());
        RC_ASSERT(history.goTo(to).has_value() == held);
        if (held) now = to;
        break;
      }
      default: {
        LiveField live(history.current(), Growth::kAllowed);
        const int kind = *rc::gen::inRange(0, 3);
        if (kind == 0) live.invert();
        const int w = *rc::gen::inRange(1, width + 1);
        const int h = *rc::gen::inRange(1, height + 1);
        const int c = *rc::gen::inRange(0, width - w + 1);
        const int r = *rc::gen::inRange(0, height - h + 1);
        const std::vector<float> block(static_cast<std::size_t>(w * h), static_cast<float>(a) + 0.125F);
        if (kind == 1) RC_ASSERT(live.writeHeights(c, r, w, h, block.data(), w));
        if (kind == 2) RC_ASSERT(live.setMark(c, r, !live.reader().markedAt(c, r)));
        const Version before = history.current();
        const bool changes = !(live.snapshot() == before);
        RC_ASSERT(history.push(stroke(fmt::format("{}", a)), live.snapshot()) == changes);
        if (!changes) break;
        RC_ASSERT(history.bytes() <= bound || history.first() == history.number() - 1);
        row.resize(static_cast<std::size_t>(++now));
        row.push_back(plainOf(live.snapshot()));
        const SampleRect rect = history.info(now).rect;
        // All that changed lies in the rectangle.
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) {
            const auto i = static_cast<std::size_t>(y * width + x);
            const PlainState& a0 = row[static_cast<std::size_t>(now - 1)];
            const PlainState& a1 = row[static_cast<std::size_t>(now)];
            if (a0.z[i] != a1.z[i] || a0.marks[i] != a1.marks[i])
              RC_ASSERT(x >= rect.column && y >= rect.row && x < rect.column + rect.columns &&
                        y < rect.row + rect.rows);
          }
      }
    }
    RC_ASSERT(history.number() == now);
    RC_ASSERT(history.last() + 1 == static_cast<std::int64_t>(row.size()));
    std::vector<Version> held;
    for (std::int64_t k = history.first(); k <= history.last(); ++k) {
      RC_ASSERT(plainOf(history.state(k)) == row[static_cast<std::size_t>(k)]);
      held.push_back(history.state(k));
      if (k > history.first()) {
        RC_ASSERT(history.step(k).before == history.state(k - 1));
        RC_ASSERT(history.step(k).after == history.state(k));
      }
    }
    // The count kept step by step is that of the objects; nodes come on top.
    std::size_t tiles = 0;
    std::size_t bytes = 0;
    for (std::int64_t k = history.first() + 1; k <= history.last(); ++k) {
      const Change change = measureChange(history.state(k - 1), history.state(k));
      RC_ASSERT(static_cast<std::size_t>(change.tiles) ==
                changedTiles(history.state(k - 1), history.state(k)).size());
      tiles += static_cast<std::size_t>(change.tiles);
      bytes += change.bytes();
    }
    RC_ASSERT(tiles == tilesBeyondOne(held));
    RC_ASSERT(history.bytes() == bytes);
  }
}

TEST(History, TheOldestStepsGoFirstAndNumbersStay) {
  const Version start = someField(640, 640);
  History history(start, 3 * (sizeof(Tile) + 2 * sizeof(Node)));
  for (int k = 0; k < 10; ++k)
    ASSERT_TRUE(history.push(stroke(fmt::format("s{}", k)), edited(history.current(), 64 * k, 5, -1.0F)));
  EXPECT_EQ(history.number(), 10);
  EXPECT_EQ(history.last(), 10);
  EXPECT_EQ(history.first(), 7);
  EXPECT_EQ(history.info(8).name, "s7");
  EXPECT_LE(history.bytes(), history.bound());
  EXPECT_FALSE(history.goTo(6));
  ASSERT_TRUE(history.goTo(7));
  EXPECT_FALSE(history.canUndo());
}

TEST(History, TheNewestStepIsKeptHoweverLarge) {
  History history(someField(640, 640), 1);
  for (int k = 0; k < 4; ++k)
    ASSERT_TRUE(history.push(stroke("s"), edited(history.current(), k, k, static_cast<float>(-k) - 1.0F)));
  EXPECT_EQ(history.first(), 3);
  EXPECT_TRUE(history.undo());
}

TEST(History, APushAfterUndoHandsBackTheStatesThatAreGone) {
  const Version start = someField(100, 100);
  History history(start);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(history.push(stroke("s"), edited(history.current(), k, 0, -2.0F)));
  const Version gone = history.state(3);
  ASSERT_TRUE(history.undo());
  std::vector<Version> dropped;
  ASSERT_TRUE(history.push(stroke("new"), edited(history.current(), 50, 50, 7.0F), dropped));
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_TRUE(dropped[0] == gone);
  EXPECT_FALSE(history.canRedo());
  EXPECT_EQ(history.last(), 3);
}

TEST(History, AStepThatChangesNothingIsNone) {
  History history(someField(10, 10));
  EXPECT_FALSE(history.push(stroke("air"), history.current()));
  EXPECT_EQ(history.last(), 0);
}

// As where the loop's field is compared with the history's state.
TEST(History, TheSameTilesBelowAnotherRootAreTheStateFromThenOn) {
  const Version start = someField(200, 130);
  for (const bool at_start : {true, false}) {
    History history(start);
    if (!at_start) {
      ASSERT_TRUE(history.push(stroke("a"), edited(start, 70, 3, 9.0F)));
    }
    const Version now = history.current(), other = edited(now, 5, 5, 1000.0F);
    LiveField back(other, Growth::kAllowed);
    ASSERT_TRUE(back.replaceTile(0, 0, changedTiles(now, other).front().before));
    const Version same = back.snapshot();
    ASSERT_FALSE(same == now) << "another root";
    EXPECT_FALSE(history.push(stroke("nothing"), same));
    EXPECT_TRUE(history.current() == same);
    EXPECT_EQ(history.last(), at_start ? 0 : 1);
  }
}

TEST(History, AnInversionTouchesNoTileAndUndoesExactly) {
  History history(someField(70, 70));
  const Version start = history.current();
  ASSERT_TRUE(history.push({"Invert", StepKind::kInvert, stepTimeNow(), {}, 0}, start.inverted()));
  EXPECT_EQ(history.bytes(), 0U);
  EXPECT_EQ(history.info(1).rect, (SampleRect{0, 0, 70, 70}));
  EXPECT_TRUE(*history.undo() == start);
}

TEST(History, AFormTouchesNoTileAndUndoesExactly) {
  History history(someField(70, 70));
  const Version start = history.current();
  const auto form = std::make_shared<const NominalForm>(PolynomialForm{0, 70, 70, 1.0, {0.0}});
  ASSERT_TRUE(history.push({"Form", StepKind::kForm, stepTimeNow(), {}, 0}, start.withForm(form)));
  EXPECT_FALSE(history.push({"Form", StepKind::kForm, stepTimeNow(), {}, 0}, start.withForm(form)));
  EXPECT_EQ(history.bytes(), 0U);
  EXPECT_EQ(history.info(1).rect, (SampleRect{0, 0, 70, 70}));
  EXPECT_TRUE(*history.undo() == start);
  EXPECT_EQ(*stepKindFromName(stepKindName(StepKind::kForm)), StepKind::kForm);
}

TEST(History, AnOlderStepCanBePutInFront) {
  const Version start = someField(200, 200);
  const Version one = edited(start, 3, 3, -1.0F);
  const Version two = edited(one, 100, 100, -1.0F);
  History history(one, History::kNoBound, 1);
  ASSERT_TRUE(history.push(stroke("second"), two));
  EXPECT_FALSE(history.goTo(0));
  history.prepend({stroke("first"), start, one});
  EXPECT_EQ(history.first(), 0);
  EXPECT_EQ(history.info(1).name, "first");
  EXPECT_TRUE(*history.goTo(0) == start);
  EXPECT_TRUE(*history.goTo(2) == two);
}

TEST(History, PuttingARowBackGivesTheSameRow) {
  History history(someField(300, 200));
  for (int k = 0; k < 5; ++k)
    ASSERT_TRUE(history.push(stroke(fmt::format("s{}", k)), edited(history.current(), 50 * k, k, -3.0F)));
  ASSERT_TRUE(history.goTo(2));
  std::vector<Step> steps;
  for (std::int64_t k = 1; k <= 5; ++k) steps.push_back(history.step(k));
  const History again(history.current(), 2, 0, steps, History::kNoBound);
  EXPECT_EQ(again.bytes(), history.bytes());
  for (std::int64_t k = 0; k <= 5; ++k) EXPECT_TRUE(again.state(k) == history.state(k));
  EXPECT_EQ(again.number(), 2);
}

TEST(History, DroppingItGivesEveryTileBack) {
  std::shared_ptr<FieldMemory> memory;
  {
    History history(someField(400, 400), 100000);
    memory = history.current().memory();
    for (int k = 0; k < 40; ++k) {
      ASSERT_TRUE(
          history.push(stroke("s"), edited(history.current(), (k * 37) % 400, (k * 91) % 400, -9.0F)));
      const bool undone = k % 5 != 4 || history.undo().has_value();
      ASSERT_TRUE(undone);
    }
  }
  EXPECT_EQ(memory->tiles.liveObjects(), 0U);
  EXPECT_EQ(memory->nodes.liveObjects(), 0U);
}

TEST(History, KindsHaveNamesThatReadBack) {
  for (const StepKind kind : {StepKind::kStroke, StepKind::kFilter, StepKind::kMark, StepKind::kInvert,
                              StepKind::kImport, StepKind::kLines})
    EXPECT_EQ(stepKindFromName(stepKindName(kind)), kind);
  EXPECT_FALSE(stepKindFromName("sculpt"));
}

}  // namespace
}  // namespace fettle::engine
