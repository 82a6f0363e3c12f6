// What the mouse picks is what the stylus feels: one surface, two ways to find it. A picked point lies on the
// patch that contact has at its cell; certified contact finds it at no distance; before it, on the ray from
// above, nothing is touched, and just behind it something is; and no ray from above to below comes through.
//
// Tolerance. All is double. A place p = from + t d is off by e = 4 u (|from| + |t d|) in each direction,
// u = 2^-53. A surface of slope s turns that into s e of height, and adds the roundings of its own corners
// and of the root, together less than 64 u of the largest height in play. heightError() is that sum. Where a
// ray grazes, a height error h moves the meeting by sqrt(h / curvature) along the ray, but the residual of
// height stays first order: so residuals are compared, never places along the ray.

#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/certified.h"
#include "haptic/contact/collision.h"
#include "haptic/contact/contact.h"
#include "render/detail/pick.h"
#include "tests/engine/filter/reference.h"
#include "tests/numeric/geometry/pebbles.h"
#include "tests/numeric/support/rare.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

using fettle::tests::Rare;

constexpr double kUnit = 0x1p-53;

struct PickField {
  std::string name;
  engine::Version field;
};

// No holes: for what must hold of a closed surface.
std::vector<PickField> closedFields() {
  const auto of = [](const char* name, auto&& z, double sx = 1.0, double sy = 1.0) {
    return PickField{name, fieldOf(gridOf(70, 67, sx, sy), z)};
  };
  std::vector<PickField> all = {
      of("flat", [](int, int) { return 0.0; }),
      of("tilted", [](int c, int r) { return 0.3 * c - 0.7 * r; }),
      of(
          "noise", [](int c, int r) { return 2.0 * pebble(c, r); }, 0.3, 0.7),
      of(
          "near vertical step", [](int c, int) { return c < 35 ? 0.0 : 1000.0; }, 0.1, 0.1),
      of("spikes of a million", [](int c, int r) { return (c * 5 + r * 3) % 17 == 0 ? 1e6 : pebble(c, r); }),
      of("saddle", [](int c, int r) { return 0.02 * ((c - 35) * (c - 35) - (r - 33) * (r - 33)); }),
      of("concave corner", [](int c, int r) { return std::max(std::abs(c - 35), std::abs(r - 33)) * 0.8; }),
      of("twisted cells", [](int c, int r) { return (c + r) % 2 == 0 ? 1.0 : -1.0; }),
      of("duplicate minima", [](int c, int r) { return c % 4 == 2 && r % 4 == 2 ? -0.5 : 0.0; }),
      of("heights near 5e6", [](int c, int r) { return 5e6 + 0.5 * ((c * 3 + r * 5) % 4); }),
      of("denormal heights", [](int c, int r) { return 0x1p-149 * ((c * 3 + r) % 5); }),
      of(
          "spacing of 0.001 and 30", [](int c, int r) { return 3.0 * pebble(c, r); }, 0.001, 30.0),
  };
  all.push_back({"two by two", fieldOf(gridOf(2, 2), [](int c, int r) { return 1.0 * c * r; })});
  all.push_back({"two rows", fieldOf(gridOf(70, 2), [](int c, int r) { return pebble(c, r); })});
  all.push_back(
      {"upside down", fieldOf(gridOf(70, 67), [](int c, int r) { return pebble(c, r); }).inverted()});
  engine::Grid far = gridOf(70, 67, 0.25, 0.5);
  far.origin_x = 5e6;
  far.origin_y = -5e6;
  far.height_unit = {"um", 0.001};
  all.push_back(
      {"origin 5e6 away, heights in um", fieldOf(far, [](int c, int r) { return 900.0 * pebble(c, r); })});
  return all;
}

std::vector<PickField> fieldsWithHoles() {
  return {{"scattered holes",
           fieldOf(gridOf(70, 67),
                   [](int c, int r) { return (c * 5 + r * 3) % 23 == 0 ? kNan : 2.0 * pebble(c, r); })},
          {"a block of holes over tiles",
           fieldOf(gridOf(150, 140),
                   [](int c, int r) { return c > 50 && c < 90 && r > 60 ? kNan : pebble(c, r); })},
          {"islands", fieldOf(gridOf(90, 80), [](int c, int r) {
             return (c % 9 < 3 && r % 9 < 3) ? pebble(c, r) : static_cast<double>(kNan);
           })}};
}

// The extent [mm], and the largest magnitude of heights and places.
struct Size {
  glm::dvec3 low, high;
  double largest;
};
Size sizeOf(const engine::FieldReader& reader) {
  const engine::HeightBounds b = reader.bounds();
  const double unit = reader.grid().height_unit.mm;
  Size s{{0, 0, b.min * unit},
         {(reader.width() - 1) * reader.grid().spacingXMm(),
          (reader.height() - 1) * reader.grid().spacingYMm(), b.max * unit},
         0};
  s.largest = std::max({s.high.x, s.high.y, std::abs(s.low.z), std::abs(s.high.z)});
  return s;
}

double heightError(const haptic::Patch& p, const Size& size, const glm::dvec3& from,
                   const glm::dvec3& travelled) {
  const double e =
      4.0 * kUnit *
      (std::max({std::abs(from.x), std::abs(from.y), std::abs(from.z)}) + glm::length(travelled));
  const double slope = (std::abs(p.b) + std::abs(p.d)) / p.sx + (std::abs(p.c) + std::abs(p.d)) / p.sy;
  return e * (1.0 + slope) + 64.0 * kUnit * size.largest;
}

struct Shot {
  glm::dvec3 from, dir;
};

// Rays from above: at random places, exactly at samples, along edges of cells, and grazing.
class Shots {
 public:
  Shots(const engine::FieldReader& reader, unsigned seed)
      : reader_(reader), size_(sizeOf(reader)), random_(seed) {}
  Shot next(int i) {
    const glm::dvec3 extent = size_.high - size_.low;
    const double relief = std::max(extent.z, 1e-3 * std::max(extent.x, extent.y));
    const double sx = reader_.grid().spacingXMm(), sy = reader_.grid().spacingYMm();
    glm::dvec3 target(unit() * extent.x, unit() * extent.y, size_.low.z + unit() * relief);
    const int column = static_cast<int>(random_() % static_cast<unsigned>(reader_.width()));
    const int row = static_cast<int>(random_() % static_cast<unsigned>(reader_.height()));
    if (i % 4 != 0) target.x = column * sx;
    if (i % 4 > 1) target.y = row * sy;
    if (i % 8 == 7 && !std::isnan(reader_.heightAt(column, row)))
      target.z = reader_.heightAt(column, row) * reader_.grid().height_unit.mm;
    // From straight down to nearly level: dz over the field's extent against its relief.
    const double flat = std::max(extent.x, extent.y);
    glm::dvec3 dir((unit() - 0.5) * flat, (unit() - 0.5) * flat, -relief * (0.01 + unit()));
    if (i % 5 == 1) dir.x = 0.0;
    if (i % 7 == 2) dir.y = 0.0;
    if (i % 9 == 3) dir = {sx, sy, -relief / 50};  // through corners of cells, one after the other
    if (i % 3 != 0) dir = glm::normalize(dir);
    // Begins above everything, wherever that is.
    const double back = (size_.high.z + 0.1 * relief - target.z) / -dir.z;
    return {target - std::max(back, 0.0) * dir, dir};
  }

 private:
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  engine::FieldReader reader_;
  Size size_;
  std::mt19937_64 random_;
};

TEST(PickAndContact, APickedPointLiesOnThePatchThatContactHasThere) {
  int met = 0;
  std::vector<PickField> fields = closedFields();
  for (PickField& f : fieldsWithHoles()) fields.push_back(std::move(f));
  for (const PickField& f : fields) {
    SCOPED_TRACE(f.name);
    const engine::FieldReader reader = f.field.reader();
    const Size size = sizeOf(reader);
    haptic::Surface surface(reader);
    Shots shots(reader, 3);
    for (int i = 0; i < 600; ++i) {
      const Shot shot = shots.next(i);
      const auto hit = meetSurface(reader, shot.from, shot.dir);
      if (!hit) continue;
      ++met;
      haptic::Patch patch;
      ASSERT_TRUE(surface.hasCell({hit->column, hit->row})) << i;
      ASSERT_TRUE(surface.patch({hit->column, hit->row}, patch))
          << "ray " << i << " meets a cell with a hole";
      const glm::dvec3& p = hit->position_mm;
      const double error = heightError(patch, size, shot.from, hit->along * shot.dir);
      const double u = (p.x - patch.x0) / patch.sx, v = (p.y - patch.y0) / patch.sy;
      // In its cell, but for the place's own rounding, in cells.
      const double e = 4.0 * kUnit * (glm::length(shot.from) + glm::length(hit->along * shot.dir));
      ASSERT_GE(u, -e / patch.sx - 4 * kUnit * reader.width()) << i;
      ASSERT_LE(u, 1 + e / patch.sx + 4 * kUnit * reader.width()) << i;
      ASSERT_GE(v, -e / patch.sy - 4 * kUnit * reader.height()) << i;
      ASSERT_LE(v, 1 + e / patch.sy + 4 * kUnit * reader.height()) << i;
      const double residual = p.z - patch.heightAt(std::clamp(u, 0.0, 1.0), std::clamp(v, 0.0, 1.0));
      ASSERT_LE(std::abs(residual), error) << "ray " << i << " at " << u << " " << v;
      // Certified contact has its closest point there: nearer than the height error.
      haptic::SurfacePoint closest;
      ASSERT_TRUE(haptic::certifiedClosest(surface, p, 1.5 * std::max(patch.sx, patch.sy), closest)) << i;
      ASSERT_LE(std::sqrt(closest.distance2_mm2), error + e) << i;
    }
  }
  EXPECT_GT(met, 4000);
}

TEST(PickAndContact, NothingIsTouchedBeforeThePickedPointAndSomethingIsBehindIt) {
  // Along the ray from above: at places before the meeting the endpoint is above the surface of its own cell,
  // so a tip that has come this far is free; a short way behind it is below. Certified contact has no memory
  // and is asked at single places; a tip that moves down the ray is followed by the level of the paper.
  int met = 0;
  Rare unseen("a meeting within rounding of the next: no place between to look at", 0.02);
  for (const PickField& f : closedFields()) {
    SCOPED_TRACE(f.name);
    const engine::FieldReader reader = f.field.reader();
    const Size size = sizeOf(reader);
    Shots shots(reader, 5);
    for (int i = 0; i < 200; ++i) {
      const Shot shot = shots.next(i);
      // A ray that comes from outside the field may come in below the surface, through the wall there.
      if (!(shot.from.x >= 0.0 && shot.from.y >= 0.0 && shot.from.x <= size.high.x &&
            shot.from.y <= size.high.y))
        continue;
      const auto hit = meetSurface(reader, shot.from, shot.dir);
      if (!hit) continue;
      ++met;
      haptic::Surface surface(reader);
      haptic::TickCounters counters;
      haptic::ContactTracker certified(haptic::ContactLevel::kCertified, 2, 2048);
      haptic::Contact contact;
      const auto heightAbove = [&](double t, double& error) {
        const glm::dvec3 p = shot.from + t * shot.dir;
        haptic::CellIndex cell;
        haptic::Patch patch;
        if (!surface.cellUnder(p, cell) || !surface.patch(cell, patch)) return HUGE_VAL;
        error = heightError(patch, size, shot.from, t * shot.dir);
        return p.z - patch.heightAt((p.x - patch.x0) / patch.sx, (p.y - patch.y0) / patch.sy);
      };
      for (int k = 0; k < 40; ++k) {
        const double t = hit->along * k / 40.0;
        double error = 0.0;
        const double above = heightAbove(t, error);
        ASSERT_GE(above, -error) << "ray " << i << ": below the surface before it is met";
        if (above <= error) continue;
        certified.update(surface, shot.from + t * shot.dir, counters, contact);
        ASSERT_FALSE(contact.touching) << i;
      }
      // Behind: the first of a few short steps that is clearly below. A ray that grazes may come out again
      // within them.
      bool below = false;
      for (const double cells : {1e-9, 1e-7, 1e-5, 1e-3, 1e-2}) {
        const double t = hit->along + cells *
                                          std::min(reader.grid().spacingXMm(), reader.grid().spacingYMm()) /
                                          glm::length(shot.dir);
        double error = 0.0;
        const double above = heightAbove(t, error);
        if (!(above < -error)) continue;
        certified.update(surface, shot.from + t * shot.dir, counters, contact);
        ASSERT_TRUE(contact.touching) << i;
        // And the tip that came down the ray within one tick.
        haptic::ContactTracker paper(haptic::ContactLevel::kPaper, 2, 2048);
        haptic::Contact followed;
        paper.update(surface, shot.from, counters, followed);
        paper.update(surface, shot.from + t * shot.dir, counters, followed);
        ASSERT_TRUE(followed.touching) << i;
        below = true;
        break;
      }
      const double steepest = -shot.dir.z / glm::length(shot.dir);
      unseen.saw(!below && steepest > 0.5);
    }
  }
  EXPECT_GT(met, 500);
}

TEST(PickAndContact, NoRayFromAboveToBelowComesThroughAClosedSurface) {
  // Both ends over the field, one above the highest sample, one below the lowest: whatever edge or corner of
  // a cell the ray goes through, it meets the surface.
  int shot_at_corners = 0;
  for (const PickField& f : closedFields()) {
    SCOPED_TRACE(f.name);
    const engine::FieldReader reader = f.field.reader();
    const Size size = sizeOf(reader);
    std::mt19937_64 random(8);
    const auto column = [&] { return static_cast<int>(random() % static_cast<unsigned>(reader.width())); };
    const auto row = [&] { return static_cast<int>(random() % static_cast<unsigned>(reader.height())); };
    const double above = size.high.z + 0.01 * size.largest, under = size.low.z - 0.01 * size.largest;
    for (int i = 0; i < 4000; ++i) {
      // From over one sample, through another sample's very place in the surface, to under the field.
      const int c0 = column(), r0 = row(), c1 = column(), r1 = row();
      const glm::dvec3 from(c0 * size.high.x / (reader.width() - 1), r0 * size.high.y / (reader.height() - 1),
                            above);
      const glm::dvec3 through(c1 * size.high.x / (reader.width() - 1),
                               r1 * size.high.y / (reader.height() - 1),
                               i % 2 == 0 ? reader.heightAt(c1, r1) * reader.grid().height_unit.mm : under);
      glm::dvec3 dir = through - from;
      if (i % 3 == 0) dir = {0.0, 0.0, -1.0};
      if (dir.z == 0.0) continue;
      const glm::dvec3 end = from + (under - from.z) / dir.z * dir;
      if (!(end.x >= 0.0 && end.y >= 0.0 && end.x <= size.high.x && end.y <= size.high.y)) continue;
      ++shot_at_corners;
      ASSERT_TRUE(meetSurface(reader, from, dir)) << fmt::format(
          "ray {} from ({}, {}, {}) along ({}, {}, {})", i, from.x, from.y, from.z, dir.x, dir.y, dir.z);
    }
  }
  EXPECT_GT(shot_at_corners, 20000);
}

TEST(PickAndContact, AgreeOnHeightsAtEverySampleEdgeAndBorder) {
  // Straight down on samples, edges and the far borders: surfaceHeight, meetSurface and the haptic patch give
  // one height; over holes and outside the field all three give none.
  std::vector<PickField> fields = closedFields();
  for (PickField& f : fieldsWithHoles()) fields.push_back(std::move(f));
  for (const PickField& f : fields) {
    SCOPED_TRACE(f.name);
    const engine::FieldReader reader = f.field.reader();
    const Size size = sizeOf(reader);
    haptic::Surface surface(reader);
    const double sx = reader.grid().spacingXMm(), sy = reader.grid().spacingYMm();
    const double above = size.high.z + 1.0 + size.largest;
    for (double row = -0.5; row < reader.height() + 0.5; row += 0.5)
      for (double column = -0.5; column < reader.width() + 0.5; column += 0.5) {
        const glm::dvec3 from(column * sx, row * sy, above);
        haptic::CellIndex cell;
        haptic::Patch patch;
        const bool felt = surface.cellUnder(from, cell) && surface.patch(cell, patch);
        const auto shown = surfaceHeight(reader, from.x, from.y);
        const auto met = meetSurface(reader, from, {0.0, 0.0, -1.0});
        ASSERT_EQ(shown.has_value(), felt) << column << " " << row;
        ASSERT_EQ(met.has_value(), felt) << column << " " << row;
        if (!felt) continue;
        const double error = heightError(patch, size, from, {0, 0, above - size.low.z});
        const double height = patch.heightAt((from.x - patch.x0) / sx, (from.y - patch.y0) / sy);
        ASSERT_LE(std::abs(*shown - height), error) << column << " " << row;
        ASSERT_LE(std::abs(met->position_mm.z - height), error) << column << " " << row;
      }
  }
}

TEST(PickAndContact, RaysFromVeryFarAwayMeetNothingWrong) {
  // So far that a place along the ray is known to whole cells at best, or to nothing at all: what is met is
  // still a cell of the field, without a hole.
  const engine::Version field = fieldOf(gridOf(100, 90), [](int c, int r) { return pebble(c, r); });
  for (const double far : {1e9, 1e15, 1e18, 1e30, 1e150}) {
    for (const glm::dvec3& way :
         {glm::dvec3(1, 0.4, -0.3), glm::dvec3(0.2, -1, -0.9), glm::dvec3(0.1, 0.1, -1)}) {
      const glm::dvec3 from = glm::dvec3(50, 45, 0) - far * way;
      const auto hit = meetSurface(field.reader(), from, way);
      if (!hit) continue;
      EXPECT_GE(hit->column, 0);
      EXPECT_GE(hit->row, 0);
      EXPECT_LT(hit->column, 99);
      EXPECT_LT(hit->row, 89);
    }
  }
}

}  // namespace
}  // namespace fettle::render
