#include "haptic/contact/descent.h"

#include <random>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::randomField;
using tests::uniform;

// A bound of rounds that ends a search earlier leaves it farther away or as far, never nearer. The distance may rise by rounding
// (kSame in descent.cpp).
TEST(Descent, MoreRoundsAreNeverFarther) {
  std::mt19937_64 random(21);
  int nearer = 0;
  for (int i = 0; i < 400; ++i) {
    const engine::Version field = randomField(random, 9, 7, i, 1.0, i % 4 == 0 ? 0.25 : 1.0);
    Surface surface(field.reader());
    const double high = field.grid().spacingYMm();
    for (int k = 0; k < 12; ++k) {
      const CellIndex start{2 + k % 4, 1 + k / 4};
      const double u = k % 2, v = k / 2 % 2;
      const glm::dvec3 e{uniform(random, 0.0, 8.0), uniform(random, 0.0, 6.0 * high),
                         uniform(random, -3.0, 3.0)};
      Patch patch;
      ASSERT_TRUE(surface.patch(start, patch));
      const glm::dvec3 d = patch.at(u, v) - e;
      double before = glm::dot(d, d);
      for (int rounds = 2; rounds <= 24; ++rounds) {
        const SearchResult found = searchDownhill(surface, e, start, u, v, rounds);
        ASSERT_LE(found.point.distance2_mm2, before * (1.0 + 1e-9)) << i << ' ' << k << ' ' << rounds;
        nearer += found.point.distance2_mm2 < before ? 1 : 0;
        before = found.point.distance2_mm2;
      }
    }
  }
  EXPECT_GT(nearer, 4000);
}

}  // namespace
}  // namespace fettle::haptic
