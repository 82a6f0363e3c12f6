#include "app/window/preview_change.h"

#include <gtest/gtest.h>

#include "tests/render/support/fields.h"

namespace fettle::app {
namespace {

TEST(PreviewChange, IsOneThatComesGoesOrHasOtherHeightsAndNoneOfTheFieldItself) {
  const auto level = [](double z) {
    return render::fieldOf(render::gridOf(8, 8, 0.1, 0.1), [z](int, int) { return z; });
  };
  const engine::Version field = level(0), edited = level(1), mean = level(2), median = level(3);
  const auto shows = [](std::vector<engine::Version> versions) {
    render::Shown shown;
    shown.versions = std::move(versions);
    return shown;
  };
  EXPECT_FALSE(previewsDiffer(shows({field, mean}), shows({field, mean})));
  EXPECT_FALSE(previewsDiffer(shows({field, mean}), shows({edited, mean}))) << "an edit";
  EXPECT_TRUE(previewsDiffer(shows({field, mean}), shows({field, median})));
  EXPECT_TRUE(previewsDiffer(shows({field}), shows({field, mean})));
  EXPECT_TRUE(previewsDiffer(shows({field, mean}), shows({field})));
  EXPECT_FALSE(previewsDiffer(shows({}), shows({field, mean}))) << "the first picture";
  EXPECT_TRUE(onlyPreviewsDiffer(shows({field, mean}), shows({field, median})));
  EXPECT_FALSE(onlyPreviewsDiffer(shows({field, mean}), shows({edited, median}))) << "an edit, too";
  EXPECT_FALSE(onlyPreviewsDiffer(shows({field}), shows({field, mean}))) << "one that comes";
  EXPECT_FALSE(onlyPreviewsDiffer(shows({}), shows({})));
}

}  // namespace
}  // namespace fettle::app
