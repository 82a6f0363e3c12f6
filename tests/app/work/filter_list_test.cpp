#include "app/work/filter_list.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "engine/filter/catalogue.h"

namespace fettle::app {
namespace {

using engine::FilterKind;

TEST(FilterList, has_every_filter_once_with_outliers_first) {
  std::set<FilterKind> listed;
  std::size_t entries = 0;
  for (const FilterGroup& group : filterGroups()) {
    EXPECT_FALSE(group.filters.empty()) << group.heading;
    entries += group.filters.size();
    listed.insert(group.filters.begin(), group.filters.end());
  }
  EXPECT_EQ(entries, engine::filters().size());
  EXPECT_EQ(listed.size(), engine::filters().size());
  EXPECT_EQ(filterGroups().front().filters, std::vector{FilterKind::kOutliers});
}

// The key for the next filter comes to all of them, in the order of the list.
TEST(FilterList, the_next_one_goes_round_through_all) {
  std::set<FilterKind> seen;
  FilterKind now = FilterKind::kBox;
  EXPECT_EQ(filterAfter(now), FilterKind::kGaussian);
  EXPECT_EQ(filterAfter(FilterKind::kOutliers), FilterKind::kBox);
  for (std::size_t i = 0; i < engine::filters().size(); ++i) {
    seen.insert(now);
    now = filterAfter(now);
  }
  EXPECT_EQ(now, FilterKind::kBox);
  EXPECT_EQ(seen.size(), engine::filters().size());
}

}  // namespace
}  // namespace fettle::app
