#include "haptic/closest_point.h"

#include <gtest/gtest.h>

#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

TEST(NumericContact, DenormalHeightsAreSurface) {
  // The lowest positive float and the next: read as doubles they are normal numbers, so nothing is lost.
  const float tiny = std::numeric_limits<float>::denorm_min();
  const engine::Version field =
      fettle::tests::fieldOf(4, 4, [&](int c, int) { return static_cast<float>(c) * tiny; });
  Surface surface(field.reader());
  const SearchResult found = searchClosest(surface, {1.5, 1.5, 0.0}, {1, 1}, 0.2, 0.2);
  EXPECT_EQ(found.end, SearchEnd::kAtRest);
  // The foot moves by the slope times the height, 1e-90: nothing.
  EXPECT_EQ(found.point.position_mm.x, 1.5);
  EXPECT_EQ(found.point.position_mm.z, 1.5 * static_cast<double>(tiny));
}

}  // namespace
}  // namespace fettle::haptic
