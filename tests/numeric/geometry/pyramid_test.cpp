// The min/max pyramid against brute force: after any sequence of edits every square of every level has the
// very lowest and highest of its samples, and the flags of every node say what is below it. Exact: no
// tolerance.

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/filter/filter.h"
#include "engine/filter/region.h"
#include "tests/engine/filter/reference.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {

/// One step of an editing session. Any step can be cut out, and places are numbers of a short list, taken
/// modulo the field's size: so a failing session can be made smaller.
struct EditStep {
  enum class Kind : std::uint8_t { kSample, kRectangle, kMark, kUndo, kRedo, kInvert, kAdopt, kFilter };
  Kind kind = Kind::kSample;
  int column = 0, row = 0, columns = 1, rows = 1;
  float height = 0.0F;
};

std::ostream& operator<<(std::ostream& out, const EditStep& s) {
  constexpr const char* kNames[] = {"sample", "rectangle", "mark",  "undo",
                                    "redo",   "invert",    "adopt", "filter"};
  return out << fmt::format("{}({}, {}, {} x {}, {})", kNames[static_cast<std::size_t>(s.kind)], s.column,
                            s.row, s.columns, s.rows, s.height);
}

}  // namespace fettle::engine::tests

namespace rc {

template <>
struct Arbitrary<fettle::engine::tests::EditStep> {
  using Step = fettle::engine::tests::EditStep;
  static Gen<Step> arbitrary() {
    using fettle::kInf;
    using fettle::kNan;
    return gen::build<Step>(
        // Single samples most of all: it is they whose bounds are kept up by halves.
        gen::set(&Step::kind, gen::weightedElement<Step::Kind>({{12, Step::Kind::kSample},
                                                                {4, Step::Kind::kRectangle},
                                                                {2, Step::Kind::kMark},
                                                                {3, Step::Kind::kUndo},
                                                                {2, Step::Kind::kRedo},
                                                                {1, Step::Kind::kInvert},
                                                                {1, Step::Kind::kAdopt},
                                                                {1, Step::Kind::kFilter}})),
        gen::set(&Step::column, gen::inRange(0, 9)), gen::set(&Step::row, gen::inRange(0, 4)),
        gen::set(&Step::columns, gen::inRange(1, 90)), gen::set(&Step::rows, gen::inRange(1, 90)),
        // Few values, so that extremes are often shared, taken away, and equal but for the sign of zero.
        gen::set(&Step::height,
                 gen::element(0.0F, -0.0F, 1.0F, -1.0F, 1e6F, -1e6F, 1e-42F, 3.4e38F, kNan, kInf, -kInf)));
  }
};

}  // namespace rc

namespace fettle::engine::tests {
namespace {

HeightBounds bruteBounds(const PlainField& field, int c0, int r0, int side) {
  HeightBounds b{kInf, -kInf};
  for (int r = r0; r < std::min(r0 + side, field.height); ++r)
    for (int c = c0; c < std::min(c0 + side, field.width); ++c)
      if (const float z = field.at(c, r); !std::isnan(z)) b = {std::min(b.min, z), std::max(b.max, z)};
  return b;
}

// Flags of one node and all below it: marked, holed.
struct Flags {
  bool marked = false, holed = false;
};
Flags checkFlags(const Node& node, const PlainField& field, int column, int row, std::string& wrong) {
  Flags all;
  const int side = 8 << (3 * (node.level - 1));  // of a child [samples]
  for (int k = 0; k < kFanOut; ++k) {
    const int c = column + (k % 8) * side, r = row + (k / 8) * side;
    if (node.children[static_cast<std::size_t>(k)] == nullptr) continue;
    Flags below;
    if (node.level > 2) {
      below = checkFlags(*static_cast<const Node*>(node.children[static_cast<std::size_t>(k)]), field, c, r,
                         wrong);
    } else {
      for (int y = r; y < std::min(r + side, field.height); ++y)
        for (int x = c; x < std::min(c + side, field.width); ++x) {
          below.marked |= field.marked(x, y);
          below.holed |= std::isnan(field.at(x, y));
        }
    }
    const bool marked = ((node.marked_children >> k) & 1U) != 0,
               holed = ((node.holed_children >> k) & 1U) != 0;
    if (marked != below.marked || holed != below.holed)
      wrong += fmt::format("level {} at ({}, {}): marked {} holed {}\n", node.level, c, r, marked, holed);
    all = {all.marked || below.marked, all.holed || below.holed};
  }
  return all;
}

// Every square of every level, a ring of squares outside the field, the root, and all flags.
std::string wrongBounds(const Version& version, const PlainField& field) {
  const FieldReader reader = version.reader();
  std::string wrong;
  const auto differ = [](const HeightBounds& a, const HeightBounds& b) {
    return a.empty() && b.empty() ? false : !(a == b);
  };
  for (int level = 0; level <= reader.topLevel() + 1; ++level) {
    const int side = 8 << (3 * level);
    for (int y = -1; y * side < field.height + side; ++y)
      for (int x = -1; x * side < field.width + side; ++x) {
        const bool outside = x < 0 || y < 0;
        const HeightBounds want =
            outside ? HeightBounds{kInf, -kInf} : bruteBounds(field, x * side, y * side, side);
        const HeightBounds got = reader.bounds(level, x, y);
        if (differ(got, want) && wrong.size() < 1000)
          wrong += fmt::format("level {} ({}, {}): [{}, {}] for [{}, {}]\n", level, x, y, got.min, got.max,
                               want.min, want.max);
      }
  }
  if (differ(reader.bounds(), bruteBounds(field, 0, 0, 1 << 24))) wrong += "the whole field\n";
  checkFlags(reader.root(), field, 0, 0, wrong);
  return wrong;
}

// A session on a field of one size: the live field by every way there is to write it, the plain one next to
// it.
class Session {
 public:
  explicit Session(const PlainField& start)
      : plain_(start),
        live_(toVersion(start), Growth::kAllowed),
        kept_(live_.snapshot()),
        kept_plain_(start) {}

  void step(const EditStep& s) {
    // Few places, about the borders of squares: so that one sample is often written again, up and down.
    constexpr int kColumns[] = {0, 1, 7, 8, 63, 64, 511, 512, 529}, kRows[] = {0, 7, 8, 64};
    const int c = kColumns[static_cast<std::size_t>(s.column)] % plain_.width;
    const int r = kRows[static_cast<std::size_t>(s.row)] % plain_.height;
    const Version before = live_.snapshot();
    const PlainField plain_before = plain_;
    switch (s.kind) {
      case EditStep::Kind::kSample:
        RC_ASSERT(live_.setHeight(c, r, s.height));
        put(c, r, s.height);
        break;
      case EditStep::Kind::kRectangle: {
        const int w = std::min(s.columns, plain_.width - c), h = std::min(s.rows, plain_.height - r);
        const std::vector<float> block(static_cast<std::size_t>(w) * h, s.height);
        RC_ASSERT(live_.writeHeights(c, r, w, h, block.data(), w));
        for (int y = r; y < r + h; ++y)
          for (int x = c; x < c + w; ++x) put(x, y, s.height);
        break;
      }
      case EditStep::Kind::kMark:
        RC_ASSERT(live_.setMark(c, r, s.height > 0.0F));
        plain_.marks[static_cast<std::size_t>(r) * plain_.width + c] = s.height > 0.0F ? 1 : 0;
        break;
      case EditStep::Kind::kUndo:
        move(done_, undone_, false);
        return;
      case EditStep::Kind::kRedo:
        move(undone_, done_, true);
        return;
      case EditStep::Kind::kInvert:
        live_.invert();
        for (float& z : plain_.z) z = -z;
        // Plain copies of earlier steps have the other sign.
        done_.clear();
        undone_.clear();
        return;
      case EditStep::Kind::kAdopt: {
        // Another version comes in from outside, the present one is kept to come back later.
        Version left = live_.adopt(kept_);
        kept_ = std::move(left);
        std::swap(plain_, kept_plain_);
        done_.clear();
        undone_.clear();
        return;
      }
      case EditStep::Kind::kFilter: {
        // A filtered version is adopted; its samples are what the filter says, its bounds are looked at.
        FilterSpec spec = makeSpec(s.column % 2 == 0 ? FilterKind::kBox : FilterKind::kMedian, 3);
        spec.threads = 1;
        (void)live_.adopt(filtered(before, spec).field);
        plain_ = toPlain(live_.snapshot());
        break;
      }
    }
    done_.push_back({changedTiles(before, live_.snapshot()), plain_before, plain_});
    undone_.clear();
  }

  [[nodiscard]] std::string wrong() const {
    if (!sameHeights(toPlain(live_.snapshot()), plain_)) return "heights differ\n";
    return wrongBounds(live_.snapshot(), plain_);
  }

 private:
  struct Done {
    std::vector<TileChange> changes;
    PlainField before, after;
  };
  static bool sameHeights(const PlainField& a, const PlainField& b) {
    return std::equal(a.z.begin(), a.z.end(), b.z.begin(), b.z.end(),
                      [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  }
  void put(int c, int r, float z) { plain_.at(c, r) = std::isinf(z) ? kNan : z; }
  void move(std::vector<Done>& from, std::vector<Done>& to, bool forward) {
    if (from.empty()) return;
    const bool moved = forward ? redo(live_, from.back().changes) : undo(live_, from.back().changes);
    RC_ASSERT(moved);
    plain_ = forward ? from.back().after : from.back().before;
    to.push_back(std::move(from.back()));
    from.pop_back();
  }

  PlainField plain_;
  LiveField live_;
  Version kept_;
  PlainField kept_plain_;
  std::vector<Done> done_, undone_;
};

PlainField flatField(int width, int height) {
  PlainField field = formed(width, height, [](int, int) { return 0.5F; });
  field.marks.assign(field.z.size(), 0);
  return field;
}

RC_GTEST_PROP(Pyramid, EqualsBruteForceAfterAnySequenceOfEdits, ()) {
  // Sides around 8 and 64, so that squares are cut short at either end, and one above 512 for a third level.
  const int width = *rc::gen::element(1, 7, 8, 9, 63, 64, 65, 130, 530).as("width");
  const int height = *rc::gen::element(1, 8, 9, 64, 65, 71).as("height");
  const auto steps = *rc::gen::arbitrary<std::vector<EditStep>>().as("edits of a field of 0.5");
  Session session(flatField(width, height));
  for (const EditStep& s : steps) session.step(s);
  const std::string wrong = session.wrong();
  if (!wrong.empty()) RC_FAIL(wrong);
}

TEST(Pyramid, FollowsALoweredMaximumUpEveryLevel) {
  // The highest sample of the field goes down a step at a time, alone and while others are as high.
  const int side = 600;
  PlainField plain = flatField(side, 70);
  LiveField live(toVersion(plain), Growth::kAllowed);
  for (const float z : {9.0F, 8.0F, 0.5F, -3.0F, kNan, 0.5F}) {
    for (const auto& [c, r] : {std::pair{0, 0}, {7, 7}, {63, 63}, {64, 64}, {511, 5}, {512, 69}, {599, 69}}) {
      ASSERT_TRUE(live.setHeight(c, r, z));
      plain.at(c, r) = z;
      ASSERT_EQ(wrongBounds(live.snapshot(), plain), "") << z << " at " << c << " " << r;
    }
  }
}

class PyramidOfHardFields : public testing::TestWithParam<std::string> {};

TEST_P(PyramidOfHardFields, EqualsBruteForceWhenBuiltWrittenAndTurnedOver) {
  PlainField plain = hardField(GetParam());
  plain.marks.assign(plain.z.size(), 0);
  const Version built = toVersion(plain);
  ASSERT_EQ(wrongBounds(built, plain), "");
  PlainField over = plain;
  for (float& z : over.z) z = -z;
  ASSERT_EQ(wrongBounds(built.inverted(), over), "");
  // The same samples written row by row over another field.
  LiveField live(toVersion(flatField(plain.width, plain.height)), Growth::kAllowed);
  for (int r = 0; r < plain.height; ++r)
    ASSERT_TRUE(live.writeHeights(
        0, r, plain.width, 1, plain.z.data() + static_cast<std::ptrdiff_t>(r) * plain.width, plain.width));
  ASSERT_EQ(wrongBounds(live.snapshot(), plain), "");
  // And a filtered part put onto it.
  JobControl job;
  const Result<Version> part =
      filterRange(built, built, built, makeSpec(FilterKind::kBox, 5), TileRange{0, 0, 1, 1}, job);
  ASSERT_TRUE(part);
  ASSERT_EQ(wrongBounds(*part, toPlain(*part)), "");
}

INSTANTIATE_TEST_SUITE_P(Geometry, PyramidOfHardFields, testing::ValuesIn(hardFieldNames()),
                         [](const auto& test) {
                           std::string text = test.param;
                           std::replace(text.begin(), text.end(), ' ', '_');
                           return text;
                         });

TEST(Infinities, BecomeCountedHolesInABuilderAndHolesInALiveField) {
  // Nothing of a field may hold one: bounds of an empty square are infinite, and mean that.
  Grid grid;
  grid.width = 70;
  grid.height = 3;
  std::vector<float> heights(210, 2.0F);
  heights[5] = kInf;
  heights[69] = -kInf;
  heights[70] = kNan;
  heights[71] = std::numeric_limits<float>::signaling_NaN();
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "test");
  ASSERT_TRUE(builder);
  builder->writeHeights(0, 0, 70, 3, heights.data(), 70);
  EXPECT_EQ(builder->infinities(), 2);
  const Version version = std::move(*builder).build();
  PlainField plain = toPlain(version);
  EXPECT_EQ(std::count_if(plain.z.begin(), plain.z.end(), [](float z) { return std::isnan(z); }), 4);
  EXPECT_EQ(wrongBounds(version, plain), "");
  LiveField live(version, Growth::kAllowed);
  for (const float z : {kInf, -kInf}) {
    ASSERT_TRUE(live.setHeight(1, 1, z));
    EXPECT_TRUE(std::isnan(live.reader().heightAt(1, 1)));
    ASSERT_TRUE(live.setHeight(1, 1, 3.0F));
    EXPECT_EQ(live.reader().bounds().max, 3.0F);
  }
}

}  // namespace
}  // namespace fettle::engine::tests
