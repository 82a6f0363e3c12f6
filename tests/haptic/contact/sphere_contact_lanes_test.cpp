// Cells in vector lanes against one after the other: the same touches, bit for bit.
#include "haptic/contact/sphere_contact_lanes.h"

#include <gtest/gtest.h>

#include "haptic/contact/sphere_window.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::randomField;
using tests::uniform;

bool sameContact(const SphereContact& a, const SphereContact& b) {
  return a.point_mm == b.point_mm && a.normal == b.normal && a.distance_mm == b.distance_mm &&
         a.cell == b.cell && a.u == b.u && a.v == b.v;
}

TEST(SphereContactLanes, FindWhatOneCellAfterTheOtherFinds) {
  std::mt19937_64 random(19);
  SphereWindow window;
  SphereContactList vectorised;
  SphereContactList plain;
  int found = 0;
  int insides = 0;
  for (int i = 0; i < 240; ++i) {
    const double sy = i % 2 == 0 ? 1.0 : 0.6;
    // Every kind of field, a few of them with holes; radii from a part of a cell to rows of three chunks.
    const engine::Version field = randomField(random, 60, 80, i, 1.0, sy, i % 7 == 0 ? 0.02 : 0.0);
    const Surface surface(field.reader());
    const double reach = i % 5 == 0 ? 9.0 : (i % 5 == 1 ? 0.6 : 2.1);
    for (int k = 0; k < 40; ++k) {
      glm::dvec3 centre{uniform(random, 12, 46), uniform(random, 12, 36), 0.0};
      window.load(surface, centre, reach, 0.5);
      const double ground = window.heightUnder(centre);
      centre.z = (std::isfinite(ground) ? ground : 0.0) + uniform(random, -0.2, 1.1) * reach;
      window.contactsSearched(centre, reach, vectorised);
      window.contactsCellByCell(centre, reach, plain);
      ASSERT_EQ(vectorised.count, plain.count) << "field " << i << " centre " << k;
      ASSERT_EQ(vectorised.nearest_mm, plain.nearest_mm);
      for (int t = 0; t < plain.count; ++t) {
        const SphereContact& touch = plain.contacts[static_cast<std::size_t>(t)];
        ASSERT_TRUE(sameContact(vectorised.contacts[static_cast<std::size_t>(t)], touch))
            << "field " << i << " centre " << k << " touch " << t;
        insides += touch.u > 0.0 && touch.u < 1.0 && touch.v > 0.0 && touch.v < 1.0 ? 1 : 0;
      }
      found += plain.count;
    }
  }
  EXPECT_GT(found, 5000);
  EXPECT_GT(insides, 500);
}

// A centre that moves by steps of all sizes, over noise, steps, needles and holes: what was gathered around one
// search serves those nearby.
TEST(SphereContactLanes, WhatWasGatheredHoldsEveryContactNearby) {
  std::mt19937_64 random(20);
  SphereWindow window;
  SphereContactList near;
  SphereContactList plain;
  long searches = 0;
  long among_gathered = 0;
  long cells = 0;
  double below_ball = 0.0;  // cells in the square around it
  long found = 0;
  for (int i = 0; i < 180; ++i) {
    const double sx = i % 4 == 3 ? 0.05 : 1.0;
    const double sy = i % 2 == 0 ? sx : 0.6 * sx;
    const engine::Version field = randomField(random, 60, 80, i, sx, sy, i % 5 == 0 ? 0.02 : 0.0);
    const Surface surface(field.reader());
    const double reach = sx * (i % 5 == 1 ? 9.0 : (i % 5 == 2 ? 0.6 : 2.1));
    const double room = sx * (i % 3 == 0 ? 0.1 : (i % 3 == 1 ? 0.02 : 0.5));
    for (int k = 0; k < 8; ++k) {
      glm::dvec3 centre{sx * uniform(random, 14, 44), sy * uniform(random, 20, 60), 0.0};
      window.load(surface, centre, reach, 2.0 * sx);
      const double ground = window.heightUnder(centre);
      centre.z = (std::isfinite(ground) ? ground : 0.0) + uniform(random, -0.2, 1.1) * reach;
      for (int step = 0; step < 30; ++step) {
        const double size = std::pow(10.0, uniform(random, -9.0, 0.0)) * room;
        centre += size * glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        if (!window.holds(centre)) break;
        window.contacts(centre, reach, room, near);
        window.contactsCellByCell(centre, reach, plain);
        ASSERT_EQ(near.count, plain.count) << "field " << i << " centre " << k << " step " << step;
        ASSERT_EQ(near.nearest_mm, plain.nearest_mm);
        for (int t = 0; t < plain.count; ++t)
          ASSERT_TRUE(sameContact(near.contacts[static_cast<std::size_t>(t)],
                                  plain.contacts[static_cast<std::size_t>(t)]))
              << "field " << i << " centre " << k << " step " << step << " touch " << t;
        ++searches;
        found += plain.count;
        if (window.gatheredCells() < 0) continue;
        ++among_gathered;
        cells += window.gatheredCells();
        below_ball += (2.0 * reach / sx + 1.0) * (2.0 * reach / sy + 1.0);
      }
    }
  }
  EXPECT_GT(found, 20'000);
  EXPECT_GT(among_gathered, searches / 2);
  EXPECT_LT(static_cast<double>(cells), 0.25 * below_ball);
}

TEST(SphereContactLanes, ABallOnSamplesAndEdgesOfAFlatTouchesOnce) {
  // Level with everything around: seams decide, in lanes as one by one.
  const engine::Version field = fieldOf(30, 30, [](int, int) { return 1.0; });
  const Surface surface(field.reader());
  SphereWindow window;
  SphereContactList vectorised;
  SphereContactList plain;
  for (const double x : {12.0, 12.25, 12.5, 13.0})
    for (const double y : {12.0, 12.5, 13.75}) {
      const glm::dvec3 centre{x, y, 3.0};
      window.load(surface, centre, 2.5, 0.5);
      window.contactsSearched(centre, 2.5, vectorised);
      window.contactsCellByCell(centre, 2.5, plain);
      ASSERT_GE(plain.count, 1);
      ASSERT_EQ(vectorised.count, plain.count);
      for (int t = 0; t < plain.count; ++t)
        EXPECT_TRUE(sameContact(vectorised.contacts[static_cast<std::size_t>(t)],
                                plain.contacts[static_cast<std::size_t>(t)]));
    }
}

}  // namespace
}  // namespace fettle::haptic
