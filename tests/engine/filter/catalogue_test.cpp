#include "engine/filter/catalogue.h"

#include <limits>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/markdown_table.h"

namespace fettle::engine::tests {
namespace {

using fettle::tests::markdownTable;

TEST(Catalogue, FindsEachFilterByItsWord) {
  std::set<std::string_view> words;
  for (const Filter& filter : filters()) {
    EXPECT_EQ(filterNamed(filter.word), &filter);
    EXPECT_EQ(&filterOf(filter.kind), &filter);
    EXPECT_TRUE(words.insert(filter.word).second) << filter.word;
  }
  EXPECT_EQ(filterNamed("mean"), nullptr);
}

TEST(Catalogue, TriesOnlySpecsThatAreValid) {
  for (const Filter& filter : filters())
    for (const FilterTrial& trial : filter.trials) {
      FilterSpec spec;
      spec.kind = filter.kind;
      spec.window = trial.window;
      spec.passes = trial.passes;
      spec.range_sigma = trial.noises;
      EXPECT_TRUE(validate(spec)) << filter.word << " " << validate(spec).error().line();
    }
}

TEST(Catalogue, WhatLiesOutsideAStatedRangeIsRefusedAndItsEndsAreNot) {
  const auto wrong = [](const FilterSpec& spec) {
    const Status status = validate(spec);
    EXPECT_TRUE(status || status.error().kind == ErrorKind::kInput);
    return !status;
  };
  for (const Filter& filter : filters()) {
    FilterSpec spec;
    spec.kind = filter.kind;
    if (filter.range_sigma.exists()) spec.range_sigma = filter.range_sigma.most;
    if (filter.nesting.exists()) {
      for (const double bad :
           {0.0, -1.0, 1.5 * filter.nesting.most, std::numeric_limits<double>::quiet_NaN()}) {
        spec.nesting_mm = bad;
        EXPECT_TRUE(wrong(spec)) << filter.word << ' ' << bad;
      }
      spec.nesting_mm = filter.nesting.most;
    }
    EXPECT_FALSE(wrong(spec)) << filter.word;
    if (filter.range_sigma.exists()) {
      for (const double good : {filter.range_sigma.least, filter.range_sigma.most}) {
        spec.range_sigma = good;
        EXPECT_FALSE(wrong(spec)) << filter.word << ' ' << good;
      }
      for (const double bad : {-1.0, 0.5 * filter.range_sigma.least, 1.5 * filter.range_sigma.most,
                               std::numeric_limits<double>::quiet_NaN()}) {
        spec.range_sigma = bad;
        EXPECT_EQ(wrong(spec), bad != filter.range_sigma.least) << filter.word << ' ' << bad;
      }
      spec.range_sigma = filter.range_sigma.most;
    } else {
      spec.range_sigma = 1.0;
      EXPECT_TRUE(wrong(spec)) << filter.word;
      spec.range_sigma = 0.0;
    }
    if (!filter.window.exists()) continue;
    const int least = static_cast<int>(filter.window.least), most = static_cast<int>(filter.window.most);
    for (const int good : {least, most}) {
      spec.window = good;
      EXPECT_FALSE(wrong(spec)) << filter.word << ' ' << good;
    }
    for (const int bad : {least - 2, least + 1, most + 2, -3}) {
      spec.window = bad;
      EXPECT_TRUE(wrong(spec)) << filter.word << ' ' << bad;
    }
  }
}

TEST(Catalogue, SaysWhatAFilterOfDefaultsIs) {
  for (const Filter& filter : filters()) {
    EXPECT_EQ(filter.window.usual, filter.window.exists() ? FilterSpec{}.window : 0) << filter.word;
    EXPECT_EQ(filter.sigma.usual, FilterSpec{}.sigma) << filter.word;
    EXPECT_EQ(filter.noises > 0.0, filter.range_sigma.exists()) << filter.word;
  }
}

TEST(Catalogue, ListsWords) {
  EXPECT_EQ(filterWords([](const Filter& filter) { return filter.kind == FilterKind::kMedian; }), "median");
  EXPECT_EQ(filterWords([](const Filter& filter) { return filter.kind <= FilterKind::kMedian; }, " or "),
            "box, gaussian or median");
  EXPECT_EQ(filterWords([](const Filter&) { return false; }), "");
}

TEST(Catalogue, IsTheTableOfTheDocuments) {
  std::vector<std::vector<std::string>> rows;
  for (const Filter& filter : filters())
    rows.push_back(
        {fmt::format("`{}`", filter.word), filter.title, filter.keeps_edges ? "yes" : "no",
         filter.window.exists() ? fmt::format("{:g} to {:g}", filter.window.least, filter.window.most) : "",
         filter.sigma.exists() ? std::string(filter.sigma.when_zero) : "",
         filter.range_sigma.exists() ? fmt::format("{:g} of the noise", filter.noises) : ""});
  EXPECT_EQ(markdownTable("docs/commands.md", "| filter | title |"), rows);
}

}  // namespace
}  // namespace fettle::engine::tests
