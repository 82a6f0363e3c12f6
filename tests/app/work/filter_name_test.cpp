#include "app/work/filter_preview.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(FilterName, says_what_the_filter_does) {
  engine::FilterSpec spec;
  spec.window = 5;
  EXPECT_EQ(filterName(spec), "Box 5 x 5");
  spec.kind = engine::FilterKind::kMedian;
  spec.passes = 3;
  spec.scope = engine::FilterScope::kOnlyMarks;
  EXPECT_EQ(filterName(spec), "Median 5 x 5, 3 passes, only marks");
  spec = {};
  spec.kind = engine::FilterKind::kTotalVariation;
  EXPECT_EQ(filterName(spec), "Total variation 3 x 3");
}

}  // namespace
}  // namespace fettle::app
