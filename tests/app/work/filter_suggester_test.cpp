#include "app/work/filter_suggester.h"

#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>

#include <gtest/gtest.h>

#include "app/work/suggestion_text.h"
#include "engine/inspect/noise_model.h"
#include "engine/scanner/counter_random.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using engine::FilterCandidate;
using tests::LoopClientBench;

constexpr double kNoiseOfSteps = 0.02;

// Two plateaus that are apart by twenty times the noise.
engine::Version noisySteps() {
  const engine::CounterRandom random(5, 3);
  return tests::fieldOf(
      220, 180, [&](int c, int r) { return (c > 110 ? 0.4 : 0.0) + kNoiseOfSteps * random.normal(c, r); },
      0.1, 0.1);
}

engine::FilterSuggestion triedOn(const engine::Version& field, const engine::SuggestionRequest& asked) {
  engine::JobControl job;
  auto found = engine::suggestFilter(field, asked, job);
  EXPECT_TRUE(found) << found.error().line();
  return found ? *std::move(found) : engine::FilterSuggestion{};
}

class FilterSuggesterTest : public ::testing::Test {
 protected:
  bool ended() {
    return bench.until([&] {
      (void)suggester.poll(bench.client(), bench.noticesToFill());
      return !suggester.busy();
    });
  }
  void poll() { (void)suggester.poll(bench.client(), bench.noticesToFill()); }

  LoopClientBench bench{noisySteps()};
  FilterSuggester suggester;
};

TEST_F(FilterSuggesterTest, finds_what_the_command_finds_on_the_same_scan) {
  suggester.tolerance = 0.6 * kNoiseOfSteps;
  suggester.search(bench.client());
  EXPECT_TRUE(suggester.busy());
  ASSERT_TRUE(ended());
  ASSERT_NE(suggester.found(), nullptr) << suggester.nothing();
  engine::SuggestionRequest asked;
  asked.tolerance = 0.6 * kNoiseOfSteps;
  const engine::FilterSuggestion expected = triedOn(bench.client().newest(), asked);
  const engine::FilterSuggestion& found = suggester.found()->suggestion;
  ASSERT_EQ(found.candidates.size(), expected.candidates.size());
  EXPECT_EQ(found.pick, expected.pick);
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    EXPECT_EQ(engine::methodOf(found.candidates[i]), engine::methodOf(expected.candidates[i]));
    EXPECT_TRUE(found.candidates[i].error() == expected.candidates[i].error() ||
                std::isnan(expected.candidates[i].error()));
  }
  EXPECT_TRUE(bench.notices().empty());
}

TEST_F(FilterSuggesterTest, takes_half_of_the_noise_where_no_error_is_given) {
  suggester.search(bench.client());
  ASSERT_TRUE(ended());
  ASSERT_NE(suggester.found(), nullptr);
  EXPECT_NEAR(suggester.found()->asked.tolerance, 0.5 * kNoiseOfSteps, 0.05 * kNoiseOfSteps);
  EXPECT_FALSE(suggester.found()->asked.budget_s.has_value());
}

TEST_F(FilterSuggesterTest, what_is_cancelled_leaves_what_was_found_before) {
  suggester.search(bench.client());
  ASSERT_TRUE(ended());
  const FilterSuggester::Found* const before = suggester.found();
  ASSERT_NE(before, nullptr);
  const double tolerance = before->asked.tolerance;
  suggester.tolerance = 3.0 * tolerance;
  suggester.search(bench.client());
  suggester.cancel();
  EXPECT_FALSE(suggester.busy());
  // The thread ends; nothing of it comes.
  suggester.tolerance = 2.0 * tolerance;
  suggester.search(bench.client());
  ASSERT_TRUE(ended());
  EXPECT_EQ(suggester.found()->asked.tolerance, 2.0 * tolerance);
  EXPECT_TRUE(bench.notices().empty());
}

TEST_F(FilterSuggesterTest, is_of_the_field_before_after_a_stroke_until_that_is_undone) {
  suggester.search(bench.client());
  ASSERT_TRUE(ended());
  EXPECT_FALSE(suggester.outdated());
  ASSERT_TRUE(bench.stroke(haptic::Tool::kMark, {5.0, 9.0, 0.0}));
  poll();
  EXPECT_TRUE(suggester.outdated()) << "marked samples are filtered around";
  bench.client().undo();
  ASSERT_TRUE(bench.settled());
  poll();
  EXPECT_FALSE(suggester.outdated());
  suggester.clear();
  poll();
  EXPECT_EQ(suggester.found(), nullptr);
  EXPECT_FALSE(suggester.outdated());
}

TEST(FilterSuggesterOfPlane, says_that_nothing_helps_where_there_is_no_noise) {
  LoopClientBench bench(tests::fieldOf(
      96, 96, [](int c, int) { return 0.01 * c; }, 0.1, 0.1));
  FilterSuggester suggester;
  suggester.search(bench.client());
  ASSERT_TRUE(bench.until([&] {
    (void)suggester.poll(bench.client(), bench.noticesToFill());
    return !suggester.busy();
  }));
  EXPECT_EQ(suggester.found(), nullptr);
  EXPECT_EQ(suggester.nothing(), "no noise that a filter could remove was found in the scan");
  EXPECT_TRUE(bench.notices().empty());
}

// Errors and costs as they are given.
engine::FilterSuggestion suggestionOf(std::initializer_list<std::array<double, 3>> flat_edge_cost) {
  engine::FilterSuggestion found;
  found.sigma = 10.0;
  for (const auto& [flat, edge, cost] : flat_edge_cost) {
    FilterCandidate c;
    c.spec.window = found.candidates.empty() ? 1 : 3 + 2 * static_cast<int>(found.candidates.size());
    c.error_flat = flat;
    c.error_edge = edge;
    c.cost = cost;
    c.seconds = 0.01 * cost;
    found.candidates.push_back(c);
  }
  return found;
}

TEST(SuggestionText, the_suggested_filter_is_first_and_each_other_is_best_at_something) {
  engine::FilterSuggestion found =
      suggestionOf({{10, 10, 0}, {6, 9, 1}, {5, 7, 4}, {2, 6, 20}, {3, 5, 30}, {5, 12, 2}});
  found.pick = 2;
  found.candidates[2].within = true;
  engine::SuggestionRequest asked;
  asked.tolerance = 7.0;
  const auto listed = listedFilters(found, asked, {"um"});
  ASSERT_EQ(listed.size(), 4U);
  EXPECT_EQ(listed[0].candidate, 2U);
  EXPECT_EQ(listed[0].why, "the least computing of all within 7 um");
  EXPECT_EQ(listed[1].candidate, 4U);
  EXPECT_EQ(listed[1].why, "the least error, the least error near edges");
  EXPECT_EQ(listed[2].candidate, 3U);
  EXPECT_EQ(listed[2].why, "the least error on flats");
  EXPECT_EQ(listed[3].candidate, 1U);
  EXPECT_EQ(listed[3].why, "the least computing of those that help");
  const std::string why = reasonText(found, asked, {{"um"}, engine::methodOf});
  EXPECT_EQ(why.find("The noise of the whole scan, offsets of rows and columns included, is 10 um. "), 0U)
      << why;
  EXPECT_NE(why.find("box 7 leaves 5 um on flats and 7 um near edges, in about 0.04 s"), std::string::npos)
      << why;
  // In another unit.
  EXPECT_EQ(leftText(found.candidates[3], {"nm", 1e3}), "2e+03 nm on flats and 6e+03 nm near edges");
}

TEST(SuggestionText, what_takes_too_long_is_not_listed) {
  engine::FilterSuggestion found = suggestionOf({{10, 10, 0}, {6, 9, 1}, {2, 6, 20}});
  found.pick = 1;
  engine::SuggestionRequest asked;
  asked.tolerance = 7.0;
  asked.budget_s = 0.1;
  const auto listed = listedFilters(found, asked, {"um"});
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_EQ(listed[0].why,
            "nearest to 7 um, the least error, the least error on flats, the least error near edges, the "
            "least computing of those that help");
  const std::string why = reasonText(found, asked, {{"um"}, engine::methodOf});
  EXPECT_NE(
      why.find("box 5 helps most in 0.1 s: it leaves 6 um on flats and 9 um near edges of 10 um on flats "
               "and 10 um near edges, in about 0.01 s. That is 1.3 times 7 um."),
      std::string::npos)
      << why;
  EXPECT_NE(why.find("box 7 does, in about 0.2 s: allow that time."), std::string::npos) << why;
}

// Filters leave what whole lines are off: who reads only of filters looks for a better one.
TEST(SuggestionText, rows_and_columns_that_are_off_are_to_be_levelled_first) {
  engine::FilterSuggestion found = suggestionOf({{10, 10, 0}, {6, 9, 1}});
  found.pick = 1;
  engine::SuggestionRequest asked;
  asked.tolerance = 7.0;
  const auto why = [&] { return reasonText(found, asked, {{"um"}, engine::methodOf}); };
  EXPECT_EQ(why().find("level lines"), std::string::npos);
  found.rows = 4.0;
  EXPECT_NE(why().find("Rows are off by 4 um: level lines first."), std::string::npos) << why();
  found.columns = 5.0;
  EXPECT_NE(why().find("Columns are off by 5 um: level lines first."), std::string::npos) << why();
  found.rows = found.columns = 1.0;
  EXPECT_EQ(why().find("level lines"), std::string::npos) << "a hundredth of the variance";
}

TEST(SuggestionText, where_nothing_helps_nothing_is_listed_and_that_is_said) {
  engine::FilterSuggestion found = suggestionOf({{5, 5, 0}, {2, 9, 1}, {6, 7, 4}});
  engine::SuggestionRequest asked;
  asked.tolerance = 1.0;
  EXPECT_TRUE(listedFilters(found, asked, {"um"}).empty());
  EXPECT_NE(reasonText(found, asked, {{"um"}, engine::methodOf})
                .find("Nothing helps: none leaves less than the unchanged scan, 5 um on flats and 5 um near "
                      "edges: 5 times 1 um. For 1 um take the mean of about 25 scans"),
            std::string::npos);
  asked.tolerance = 6.0;
  found.candidates[0].within = true;
  EXPECT_TRUE(listedFilters(found, asked, {"um"}).empty());
  EXPECT_NE(reasonText(found, asked, {{"um"}, engine::methodOf})
                .find("The unchanged scan stays within 6 um: no filter is needed."),
            std::string::npos);
}

}  // namespace
}  // namespace fettle::app
