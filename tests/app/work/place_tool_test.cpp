#include "app/work/place_tool.h"

#include <memory>

#include <gtest/gtest.h>

#include "engine/filter/filter.h"
#include "engine/scanner/counter_random.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using State = PlaceTool::State;
using tests::LoopClientBench;

constexpr int kPlacesWide = 300, kPlacesHigh = 200;

// Two steps of 1.7 times the noise.
engine::Version lowSteps() {
  const engine::CounterRandom random(11, 3);
  return tests::fieldOf(
      kPlacesWide, kPlacesHigh,
      [&](int c, int r) {
        return (c > 80 ? 0.034 : 0.0) + (c > 200 ? 0.034 : 0.0) + 0.02 * random.normal(c, r);
      },
      0.1, 0.1);
}

class PlaceToolTest : public ::testing::Test {
 protected:
  void poll() { (void)tool.poll(bench.client(), bench.noticesToFill()); }
  bool found() {
    return bench.until([&] {
      poll();
      return tool.found() != nullptr;
    });
  }
  // A line along a place, as a step.
  void draw(std::size_t place) {
    engine::EdgeLine line{1, false, {}};
    for (const glm::dvec2& p : tool.found()->places[place].path) {
      engine::EdgePoint point;
      point.position = p;
      point.located = true;
      line.points.push_back(point);
    }
    const engine::Version before = bench.client().newest();
    const auto lines =
        std::make_shared<const std::vector<engine::EdgeLine>>(std::vector<engine::EdgeLine>{line});
    ASSERT_TRUE(bench.client().change(before, before.withLines(lines), "line"));
    ASSERT_TRUE(bench.settled());
    poll();
  }

  LoopClientBench bench{lowSteps()};
  PlaceTool tool;
};

TEST_F(PlaceToolTest, places_are_gone_through_done_by_a_line_and_open_again_without_it) {
  EXPECT_FALSE(tool.on());
  EXPECT_FALSE(tool.next());
  tool.search(bench.client());
  EXPECT_TRUE(tool.on());
  ASSERT_TRUE(found());
  const std::size_t n = tool.found()->places.size();
  ASSERT_GE(n, 2U);
  EXPECT_EQ(tool.present(), 0U);
  EXPECT_EQ(tool.takeArrival(), 0U);
  EXPECT_EQ(tool.takeArrival(), std::nullopt) << "once";
  EXPECT_EQ(tool.count(State::kOpen), n);

  const std::uint64_t before = tool.revision();
  draw(0);
  EXPECT_EQ(tool.state(0), State::kDone);
  EXPECT_NE(tool.revision(), before);
  EXPECT_EQ(tool.count(State::kDone), 1U);
  ASSERT_TRUE(tool.next());
  EXPECT_EQ(tool.present(), 1U);
  EXPECT_EQ(tool.state(0), State::kDone) << "not skipped";

  bench.client().undo();
  ASSERT_TRUE(bench.settled());
  poll();
  EXPECT_EQ(tool.state(0), State::kOpen);
}

TEST_F(PlaceToolTest, what_is_left_without_a_line_is_skipped_until_none_is_open) {
  tool.search(bench.client());
  ASSERT_TRUE(found());
  const std::size_t n = tool.found()->places.size();
  for (std::size_t i = 1; i < n; ++i) {
    ASSERT_TRUE(tool.next());
    EXPECT_EQ(tool.state(i - 1), State::kSkipped);
  }
  EXPECT_FALSE(tool.next());
  EXPECT_EQ(tool.present(), std::nullopt);
  EXPECT_EQ(tool.count(State::kSkipped), n);
  // A line there still counts.
  draw(0);
  EXPECT_EQ(tool.state(0), State::kDone);
}

TEST_F(PlaceToolTest, dropped_they_are_gone_even_when_they_are_found_afterwards) {
  tool.search(bench.client());
  tool.drop();
  ASSERT_TRUE(bench.until([&] {
    poll();
    return !tool.busy();
  }));
  EXPECT_FALSE(tool.on());
  EXPECT_EQ(tool.found(), nullptr);
  EXPECT_TRUE(bench.notices().empty());
}

TEST_F(PlaceToolTest, places_are_outdated_while_heights_differ_from_those_searched) {
  tool.search(bench.client());
  ASSERT_TRUE(found());
  draw(0);
  EXPECT_FALSE(tool.outdated()) << "a line changes no height";
  const engine::Version before = bench.client().newest();
  engine::JobControl job;
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kBox;
  spec.window = 3;
  const auto filtered = engine::applyFilter(before, before, spec, job);
  ASSERT_TRUE(filtered);
  ASSERT_TRUE(bench.client().change(before, filtered->field, "filter"));
  ASSERT_TRUE(bench.settled());
  poll();
  EXPECT_TRUE(tool.outdated());
  ASSERT_TRUE(bench.client().change(bench.client().newest(), before, "back"));
  ASSERT_TRUE(bench.settled());
  poll();
  EXPECT_FALSE(tool.outdated());
  tool.drop();
  EXPECT_FALSE(tool.outdated());
}

}  // namespace
}  // namespace fettle::app
