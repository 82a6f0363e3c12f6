// What must hold through any sequence of global passes and strokes by hand: no sample ends farther than the
// largest change from the original, marked samples keep their bits, holes stay holes. Exact: no tolerance. A
// failing sequence is made smaller, sample by sample and step by step, and written as a folder to be worked
// through with the built program.

#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/field/live_field.h"
#include "engine/formats/formats.h"
#include "engine/io/raster/marks.h"
#include "haptic/tick/brush.h"
#include "tests/engine/filter/reference.h"
#include "tests/numeric/support/work_case.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {

using fettle::tests::WorkStep;

/// A step in small numbers, so that it can be made smaller; numbers are taken modulo what there is.
struct SmallStep {
  enum class Kind : std::uint8_t { kFilter, kSmooth, kMark, kUnmark };
  Kind kind = Kind::kFilter;
  int filter = 0;  ///< of kKinds
  int radius = 1;  ///< of the window, the brush or the marks [samples]
  int times = 1;   ///< passes or ticks
  bool only_marks = false;
  int column = 0, row = 0;  ///< cell under the tip
  int press = 8;            ///< [N], of 8
};

// New kinds go here.
constexpr FilterKind kKinds[] = {FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian};

std::ostream& operator<<(std::ostream& out, const SmallStep& s) {
  if (s.kind == SmallStep::Kind::kFilter)
    return out << fmt::format("{} {} x{}{}", name(kKinds[s.filter]), 2 * s.radius + 1, s.times,
                              s.only_marks ? " only marks" : "");
  constexpr const char* kTools[] = {"", "smooth", "mark", "unmark"};
  return out << fmt::format("{} ({}, {}) radius {} x{} press {}", kTools[static_cast<std::size_t>(s.kind)],
                            s.column, s.row, s.radius, s.times, s.press);
}

}  // namespace fettle::engine::tests

namespace rc {

template <>
struct Arbitrary<fettle::engine::tests::SmallStep> {
  using Step = fettle::engine::tests::SmallStep;
  static Gen<Step> arbitrary() {
    return gen::build<Step>(
        gen::set(&Step::kind, gen::weightedElement<Step::Kind>({{4, Step::Kind::kFilter},
                                                                {5, Step::Kind::kSmooth},
                                                                {1, Step::Kind::kMark},
                                                                {1, Step::Kind::kUnmark}})),
        gen::set(&Step::filter, gen::inRange(0, static_cast<int>(std::size(fettle::engine::tests::kKinds)))),
        gen::set(&Step::radius, gen::inRange(0, 5)), gen::set(&Step::times, gen::inRange(1, 5)),
        gen::set(&Step::only_marks, gen::weightedElement<bool>({{3, false}, {1, true}})),
        gen::set(&Step::column, gen::inRange(0, 16)), gen::set(&Step::row, gen::inRange(0, 16)),
        gen::set(&Step::press, gen::inRange(1, 9)));
  }
};

}  // namespace rc

namespace fettle::engine::tests {
namespace {

// Of a step in small numbers, on the field as it is before it.
WorkStep workStep(const SmallStep& s, const Version& field, double most) {
  WorkStep step;
  if (s.kind == SmallStep::Kind::kFilter) {
    step.filter = makeSpec(kKinds[s.filter], 2 * s.radius + 1);
    step.filter->passes = s.times;
    step.filter->scope = s.only_marks ? FilterScope::kOnlyMarks : FilterScope::kKeepMarks;
    step.filter->max_change = most;
    step.filter->threads = 1;
    return step;
  }
  step.scene.max_change = most;
  step.scene.brush_radius_samples = s.radius;
  step.scene.mark_radius_samples = s.radius;
  const FieldReader reader = field.reader();
  if (reader.width() < 2 || reader.height() < 2) return step;  // no cell, no contact
  const int c = s.column % (reader.width() - 1), r = s.row % (reader.height() - 1);
  const float z = reader.heightAt(c, r);
  constexpr haptic::Tool kTools[] = {haptic::Tool::kFeel, haptic::Tool::kSmooth, haptic::Tool::kMark,
                                     haptic::Tool::kUnmark};
  for (int t = 0; t < s.times; ++t)
    step.strokes.push_back({0.001 * t,
                            {c + 0.25, r + 0.25, static_cast<double>(std::isnan(z) ? 0.0F : z) - s.press},
                            kTools[static_cast<std::size_t>(s.kind)]});
  return step;
}

// |a - b| > most in exact arithmetic: the difference in double and what it lost (Knuth, The Art of Computer
// Programming, volume 2, 4.2.2, theorem B).
bool farther(float a, float b, double most) {
  const double x = a, y = -static_cast<double>(b);
  const double sum = x + y, virtual_y = sum - x;
  const double lost = (x - (sum - virtual_y)) + (y - virtual_y);
  const double size = std::fabs(sum), more = sum < 0.0 ? -lost : lost;
  return size > most || (size == most && more > 0.0);
}

std::string complaint(const PlainField& original, const PlainField& before, const PlainField& after,
                      const SmallStep& s, double most) {
  const bool heights_stay = s.kind == SmallStep::Kind::kMark || s.kind == SmallStep::Kind::kUnmark;
  for (int r = 0; r < original.height; ++r)
    for (int c = 0; c < original.width; ++c) {
      const float was = before.at(c, r), is = after.at(c, r);
      if (std::isnan(was) != std::isnan(is)) return fmt::format("({}, {}): a hole came or went", c, r);
      if (std::isnan(is)) continue;
      if (farther(is, original.at(c, r), most))
        return fmt::format("({}, {}): {:a} is more than {:a} from {:a}", c, r, is, most, original.at(c, r));
      const bool keeps =
          s.kind == SmallStep::Kind::kFilter && s.only_marks ? !before.marked(c, r) : before.marked(c, r);
      if ((keeps || heights_stay) && !sameBits(was, is))
        return fmt::format("({}, {}): {:a} was to be kept and is {:a}", c, r, was, is);
      if (!heights_stay && before.marked(c, r) != after.marked(c, r))
        return fmt::format("({}, {}): marks differ", c, r);
    }
  return {};
}

rc::Gen<float> height() {
  // Last bits on both sides of round numbers, spikes, denormals, both zeros and the largest float.
  return rc::gen::weightedOneOf<float>(
      {{3, rc::gen::map(rc::gen::inRange(-64, 65), [](int x) { return static_cast<float>(x) * 0.1F; })},
       {3, rc::gen::element(0.0F, 1.0F, -0.0F, 1.0F + 0x1p-23F, 1.0F - 0x1p-24F, 1e6F, -1e6F, 5e6F + 0.5F)},
       {1, rc::gen::element(0x1p-149F, -0x1p-126F, 1e-42F, std::numeric_limits<float>::max(),
                            -std::numeric_limits<float>::max())},
       {1, rc::gen::just(kNan)}});
}

RC_GTEST_PROP(Changes, StayWithinTheLimitAndOffTheMarksThroughAnyPassesAndStrokes, ()) {
  const int width = *rc::gen::inRange(1, 9).as("width");
  const int height_of = *rc::gen::inRange(1, 9).as("height");
  const auto samples = static_cast<std::size_t>(width * height_of);
  PlainField original{
      width, height_of, *rc::gen::container<std::vector<float>>(samples, height()).as("heights"), {}};
  for (const bool marked : *rc::gen::container<std::vector<bool>>(
                                samples, rc::gen::weightedElement<bool>({{7, false}, {1, true}}))
                                .as("marks"))
    original.marks.push_back(marked ? 1 : 0);
  const double most = *rc::gen::element(0.0, 0.1, 0.5, 0.5 - 0x1p-54, 0.02 / 3, 1.0, 1.0 - 0x1p-53, 1e-9,
                                        0x1p-149, 1e6, 1e300)
                           .as("max change");
  const auto small = *rc::gen::arbitrary<std::vector<SmallStep>>().as("steps");

  const Version start = toVersion(original);
  Version now = start;
  std::vector<WorkStep> steps;
  PlainField before = original;
  for (const SmallStep& s : small) {
    steps.push_back(workStep(s, now, most));
    now = fettle::tests::worked(now, start, steps.back());
    const PlainField after = toPlain(now);
    const std::string wrong = complaint(original, before, after, s, most);
    if (!wrong.empty()) RC_FAIL(wrong + "\n" + fettle::tests::writeCase("changes", wrong, start, steps));
    before = after;
  }
}

TEST(Changes, OfTheBrushStopShortWhereTheLimitItselfIsRoundedUp) {
  // Found by the property above. 1 + most is 1.5 - 2^-54; as a double that is 1.5, a float 2^-54 too far.
  const double most = 0.5 - 0x1p-54;
  const Version start = toVersion(formed(3, 3, [](int c, int r) { return c == 1 && r == 1 ? 1.0F : 40.0F; }));
  for (const float sign : {1.0F, -1.0F}) {
    LiveField live(sign > 0 ? start : start.inverted(), Growth::kAllowed);
    haptic::Brush brush(0.0, most, live.snapshot());
    ASSERT_TRUE(brush.apply(live, 1, 1, 1.0));
    EXPECT_EQ(live.reader().heightAt(1, 1), sign * std::nextafter(1.5F, 0.0F));
  }
}

TEST(Changes, OfDenormalHeightsAreNoneWhereTheHapticThreadFlushesThem) {
  // Found by the property above. A replay flushes denormals as the loop does; marked samples, those next to
  // the disc within its square, and those that a limit holds must keep their bits all the same, either way
  // up.
  const PlainField plain = [] {
    PlainField p = formed(9, 9, [](int c, int r) { return (c + r) % 2 == 0 ? 1e-42F : -3e-41F; });
    p.marks.assign(81, 0);
    p.marks[40] = p.marks[41] = 1;
    return p;
  }();
  const Version start = toVersion(plain);
  for (const bool invert : {false, true})
    for (const bool limited : {false, true}) {
      WorkStep step = workStep({SmallStep::Kind::kSmooth, 0, 2, 2, false, 4, 4, 8}, start, 1e-3);
      step.scene.invert = invert;
      if (!limited) step.scene.max_change.reset();
      const PlainField after = toPlain(fettle::tests::worked(start, start, step));
      int changed = 0;
      for (int r = 0; r < 9; ++r)
        for (int c = 0; c < 9; ++c) {
          const bool inside = (c - 4) * (c - 4) + (r - 4) * (r - 4) <= 4;
          const bool same = sameBits(after.at(c, r), plain.at(c, r));
          changed += !same;
          EXPECT_TRUE(same || (inside && !plain.marked(c, r) && !limited)) << c << " " << r;
        }
      // Thirteen samples in the disc less two marked ones: the brush was there.
      EXPECT_EQ(changed, limited ? 0 : 11);
    }
}

TEST(Changes, AreDrawnBackExactlyWhereTheDifferenceOfTwoFloatsIsNone) {
  // Heights of 2^100 and limits far below their last bit: nothing may move, by any filter.
  const PlainField plain =
      formed(20, 20, [](int c, int r) { return (c + r) % 2 == 0 ? 0x1p100F : 0x1.000002p100F; });
  const Version start = toVersion(plain);
  for (const FilterKind kind : kKinds)
    for (const double most : {0.0, 1.0, 0x1p76}) {
      FilterSpec spec = makeSpec(kind, 5);
      spec.max_change = most;
      spec.passes = 3;
      EXPECT_TRUE(filtered(start, spec).field == start) << name(kind) << " " << most;
    }
}

TEST(Changes, AreWrittenAsACaseThatWorksOutTheSame) {
  // The folder of a failing case holds the very same field, strokes and scene.
  PlainField plain =
      formed(9, 7, [](int c, int r) { return c == 3 && r == 3 ? kNan : 0.1F * static_cast<float>(c * r); });
  plain.marks.assign(63, 0);
  plain.marks[20] = 1;
  const Version start = toVersion(plain);
  const SmallStep press{SmallStep::Kind::kSmooth, 0, 2, 3, false, 4, 4, 8};
  const WorkStep step = workStep(press, start, 0.02 / 3);
  const std::string report = fettle::tests::writeCase("written", "a test of the test", start, {step});
  const std::string folder = report.substr(3, report.find(":\n") - 3);
  EXPECT_NE(
      report.find("fettle replay scan.tif strokes1.csv step1.tif --scene scene1.toml --marks marks.png"),
      std::string::npos)
      << report;
  JobControl job;
  const auto scan = importField(folder + "/scan.tif", {}, job);
  ASSERT_TRUE(scan) << folder;
  const auto marked = importMarks(scan->field, folder + "/marks.png");
  ASSERT_TRUE(marked);
  WorkStep read;
  read.strokes = *haptic::readStrokes(folder + "/strokes1.csv");
  read.scene = *haptic::loadScene(folder + "/scene1.toml");
  const Version mine = fettle::tests::worked(start, start, step);
  EXPECT_NE(contentHash(mine), contentHash(start));
  EXPECT_EQ(contentHash(fettle::tests::worked(*marked, *marked, read)), contentHash(mine));
}

}  // namespace
}  // namespace fettle::engine::tests
