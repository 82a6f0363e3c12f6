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

TEST(FilterName, a_preview_says_what_it_is_until_it_is_exact) {
  engine::Grid grid;
  engine::FilterView::Picture picture;
  picture.exact = 0.405;
  EXPECT_EQ(previewState(picture, grid), "40 % so far");
  picture.exact = 1.0;
  EXPECT_EQ(previewState(picture, grid), "exact in view");
  picture = {};
  picture.step = 16;
  EXPECT_EQ(previewState(picture, grid), "approximate");
  picture.off = engine::FilterView::Off{0.2384, 3.0, false};
  EXPECT_EQ(previewState(picture, grid), "approximate, off by 238 \u00b5m rms");
  picture.off->estimated = true;
  picture.exact = 0.12;
  picture.untouched = 0.002;
  EXPECT_EQ(previewState(picture, grid),
            "approximate, off by about 238 \u00b5m rms, 12 % exact, 1 % to come");
}

}  // namespace
}  // namespace fettle::app
