#include "app/work/edge_tool.h"

#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

#include "app/work/line_edits.h"
#include "engine/marks/change_marks.h"
#include "engine/session/line_codec.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/session_sink.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using haptic::Tool;
using tests::LoopClientBench;
using tests::markedSamples;
using tests::sameMarks;

constexpr int kWidth = 200, kHeight = 140, kStep = 90;

// A step of a millimetre along a column, in noise.
engine::Version stepped() {
  std::mt19937_64 random(7);
  return tests::fieldOf(
      kWidth, kHeight,
      [&](int c, int) { return (c >= kStep ? 1.0 : 0.0) + 0.01 * tests::uniform(random, -1.0, 1.0); }, 0.1,
      0.1);
}

// The steps of a session, as their journal has them.
class StepsMade final : public haptic::SessionSink {
 public:
  void commit(std::int64_t, engine::Step, std::vector<engine::JournalEntry> journal) override {
    take(journal);
  }
  void moveTo(std::int64_t, std::vector<engine::JournalEntry> journal) override { take(journal); }
  void note(std::vector<engine::JournalEntry> journal) override { take(journal); }

  [[nodiscard]] const std::vector<haptic::journal::StepMade>& steps() const { return steps_; }

 private:
  void take(const std::vector<engine::JournalEntry>& journal) {
    for (const engine::JournalEntry& row : journal) {
      const auto entry = haptic::journalEntry(row.action);
      ASSERT_TRUE(entry) << entry.error().line();
      if (const auto* step = std::get_if<haptic::journal::StepMade>(&*entry)) steps_.push_back(*step);
    }
  }

  std::vector<haptic::journal::StepMade> steps_;
};

class EdgeToolTest : public ::testing::Test {
 protected:
  bool shown() {
    return bench.until([&] {
      (void)tool.poll(bench.client(), bench.noticesToFill());
      return tool.suggestion() != nullptr && !tool.busy();
    });
  }
  engine::Version seen() { return tool.over(bench.client().field()); }

  StepsMade made;
  LoopClientBench bench{stepped(), haptic::defaultScene(), &made};
  EdgeTool tool;
};

TEST_F(EdgeToolTest, a_suggestion_is_seen_and_is_no_mark_until_it_is_taken) {
  EXPECT_TRUE(seen() == bench.client().field());
  EXPECT_FALSE(tool.accept(bench.client()));
  tool.search(bench.client());
  EXPECT_TRUE(tool.on());
  ASSERT_TRUE(shown());
  EXPECT_EQ(tool.suggestion()->lines, 1);
  EXPECT_EQ(bench.client().history().last(), 0);
  EXPECT_EQ(markedSamples(bench.client().field()), 0);
  const engine::Version suggested = seen();
  EXPECT_GT(markedSamples(suggested), kHeight / 2);
  for (std::int32_t r = 0; r < kHeight; ++r)
    for (std::int32_t c = 0; c < kWidth; ++c)
      ASSERT_TRUE(!suggested.reader().markedAt(c, r) || std::abs(c - kStep) <= 4) << c << ' ' << r;

  EXPECT_TRUE(tool.accept(bench.client()));
  EXPECT_FALSE(tool.on());
  EXPECT_EQ(tool.suggestion(), nullptr);
  ASSERT_TRUE(bench.settled());
  EXPECT_EQ(bench.client().history().number(), 1);
  EXPECT_EQ(bench.client().history().info(1).kind, engine::StepKind::kMark);
  EXPECT_TRUE(sameMarks(bench.client().upright(), suggested));
  EXPECT_TRUE(seen() == bench.client().field());
}

TEST_F(EdgeToolTest, dropped_it_leaves_nothing_even_when_it_is_found_afterwards) {
  tool.search(bench.client());
  tool.drop();
  // What was under way may end well; it is not shown.
  ASSERT_TRUE(bench.until([&] {
    (void)tool.poll(bench.client(), bench.noticesToFill());
    return !tool.busy();
  }));
  EXPECT_FALSE(tool.on());
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  tool.drop();
  EXPECT_FALSE(tool.on());
  EXPECT_TRUE(seen() == bench.client().field());
  EXPECT_FALSE(tool.accept(bench.client()));
  EXPECT_EQ(bench.client().history().last(), 0);
  EXPECT_TRUE(bench.notices().empty());
}

TEST_F(EdgeToolTest, another_choice_is_drawn_without_another_search) {
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  const engine::EdgeMap* found = tool.map();
  const std::int64_t thin = markedSamples(seen());
  // Turned several times while one is drawn: the last counts.
  for (const double thickness : {2.0, 3.0, 5.0}) {
    tool.choice.thickness = thickness;
    tool.redraw(bench.client());
  }
  ASSERT_TRUE(bench.until([&] {
    (void)tool.poll(bench.client(), bench.noticesToFill());
    return !tool.busy();
  }));
  EXPECT_EQ(tool.map(), found);
  engine::JobControl job;
  const auto expected = engine::suggestMarks(bench.client().upright(), *found, tool.choice, job);
  ASSERT_TRUE(expected);
  EXPECT_TRUE(sameMarks(seen(), expected->field));
  EXPECT_GT(markedSamples(seen()), 2 * thin);
  // Nothing stands out of the noise so far.
  tool.choice.sensitivity = 0.0;
  tool.redraw(bench.client());
  ASSERT_TRUE(bench.until([&] {
    (void)tool.poll(bench.client(), bench.noticesToFill());
    return !tool.busy();
  }));
  EXPECT_LE(markedSamples(seen()), markedSamples(expected->field));
}

TEST_F(EdgeToolTest, work_goes_on_under_it_and_is_in_what_is_seen_and_taken) {
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  const engine::Version suggested = seen();
  ASSERT_TRUE(bench.stroke(Tool::kSmooth, {3.0, 5.0, 0.0}));
  const engine::Version smoothed = bench.client().upright();
  const engine::Version both = seen();
  EXPECT_TRUE(sameMarks(both, suggested));
  for (std::int32_t r = 0; r < kHeight; ++r)
    for (std::int32_t c = 0; c < kWidth; ++c)
      ASSERT_EQ(both.reader().heightAt(c, r), smoothed.reader().heightAt(c, r)) << c << ' ' << r;
  ASSERT_TRUE(tool.accept(bench.client()));
  ASSERT_TRUE(bench.settled());
  EXPECT_EQ(bench.client().history().number(), 2);
  EXPECT_TRUE(sameMarks(bench.client().upright(), suggested));
  bench.client().undo();
  ASSERT_TRUE(bench.settled());
  EXPECT_TRUE(bench.client().upright() == smoothed);
}

TEST_F(EdgeToolTest, what_is_taken_is_recorded_with_the_numbers_that_find_it_again) {
  tool.sigma = 2.0;
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  tool.choice.thickness = 2.5;
  tool.redraw(bench.client());
  ASSERT_TRUE(shown());
  tool.choice.sensitivity = 0.9;  // not drawn yet: what is seen is taken
  const engine::Version before = bench.client().upright();
  ASSERT_TRUE(tool.accept(bench.client()));
  ASSERT_TRUE(bench.settled());
  ASSERT_EQ(made.steps().size(), 1U);
  const auto numbers = made.steps()[0].suggested;
  ASSERT_TRUE(numbers);
  EXPECT_TRUE(made.steps()[0].marks);
  engine::JobControl job;
  const auto map = engine::findEdges(before, numbers->scale, job);
  ASSERT_TRUE(map);
  const auto again = engine::suggestMarks(before, *map, {numbers->sensitivity, numbers->thickness, 0}, job);
  ASSERT_TRUE(again);
  EXPECT_TRUE(sameMarks(again->field, bench.client().upright()));
}

TEST_F(EdgeToolTest, lines_of_a_suggestion_are_recorded_with_the_numbers_that_find_them_again) {
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  // Marks of a hand meanwhile change nothing of what is found.
  ASSERT_TRUE(bench.stroke(Tool::kMark, {3.0, 5.0, 0.0}));
  const engine::Version before = bench.client().upright();
  MarkEdit edit;
  ASSERT_TRUE(tool.acceptAsLines(edit));
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  ASSERT_TRUE(bench.settled());
  ASSERT_EQ(made.steps().size(), 2U);
  EXPECT_FALSE(made.steps()[0].suggested);
  const auto numbers = made.steps()[1].suggested;
  ASSERT_TRUE(numbers);
  EXPECT_TRUE(made.steps()[1].lines);
  engine::JobControl job;
  const auto map = engine::findEdges(before, numbers->scale, job);
  ASSERT_TRUE(map);
  const auto again = drawSuggestion(before, *map, {numbers->sensitivity, numbers->thickness, 0}, job);
  ASSERT_TRUE(again);
  ASSERT_TRUE(again->lines());
  EXPECT_EQ(engine::packLines(again->lines()), engine::packLines(bench.client().upright().lines()));
  EXPECT_TRUE(sameMarks(*again, bench.client().upright()));
}

TEST_F(EdgeToolTest, numbers_that_would_not_find_it_again_are_not_recorded) {
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  ASSERT_TRUE(bench.stroke(Tool::kSmooth, {9.0, 5.0, 0.5}));
  ASSERT_TRUE(tool.accept(bench.client()));
  ASSERT_TRUE(bench.settled());
  ASSERT_EQ(made.steps().size(), 2U);
  EXPECT_TRUE(made.steps()[1].marks);
  EXPECT_FALSE(made.steps()[1].suggested);
}

TEST_F(EdgeToolTest, it_is_seen_upside_down_as_well) {
  tool.search(bench.client());
  ASSERT_TRUE(shown());
  const engine::Version upright = seen();
  haptic::Scene scene = bench.client().scene();
  scene.invert = true;
  ASSERT_TRUE(bench.client().setScene(scene));
  ASSERT_TRUE(bench.until([&] { return bench.client().field().reader().sign() < 0.0F; }));
  const engine::Version inverted = seen();
  EXPECT_LT(inverted.reader().sign(), 0.0F);
  EXPECT_TRUE(sameMarks(inverted, upright));
}

}  // namespace
}  // namespace fettle::app
