// What moves with the field: mirrored, turned, moved far away, made larger and smaller. A tick knows no
// direction, no place and no unit.
#include <cmath>
#include <functional>
#include <string_view>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::haptic {
namespace {

using tests::Choice;
using tests::HardField;
using tests::Jumps;
using tests::ulps;

struct Felt {
  bool contact = false;
  glm::dvec3 proxy{0.0}, penetration{0.0};
};

std::vector<Felt> feel(const engine::Version& field, const Scene& scene,
                       const std::vector<StrokeSample>& path, TickCounters& counters) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  Tick tick(scene, live, field);
  std::vector<Felt> all;
  for (const StrokeSample& sample : path) {
    const ForceSample felt = tick.run(sample);
    all.push_back(
        {felt.contact, felt.proxy_mm, felt.contact ? tick.contact().penetration_mm : glm::dvec3(0.0)});
  }
  counters = tick.counters();
  return all;
}

std::vector<StrokeSample> mapped(std::vector<StrokeSample> path,
                                 const std::function<glm::dvec3(glm::dvec3)>& map) {
  for (StrokeSample& sample : path) sample.tip_mm = map(sample.tip_mm);
  return path;
}

// Coordinates on a lattice of 2^-20 mm, so that mirroring and moving them is exact.
std::vector<StrokeSample> onLattice(const std::vector<StrokeSample>& path) {
  return mapped(path, [](glm::dvec3 p) { return glm::round(p * 0x1p20) * 0x1p-20; });
}

class Symmetry : public ::testing::TestWithParam<Choice> {};

// The seven ways to lay a square on itself, besides leaving it.
TEST_P(Symmetry, MirrorsAndQuarterTurnsTurnTheForce) {
  constexpr int kSide = 24;
  for (const char* name : {"waves", "saddle", "noise", "tilted"}) {
    const HardField hard = tests::hardField(name);
    const engine::FieldReader reader = hard.field.reader();
    const std::vector<StrokeSample> path = onLattice(tests::wander(hard, 3000, 11, Jumps::kNo));
    TickCounters counters;
    const std::vector<Felt> plain =
        feel(hard.field, tests::sceneFor(GetParam(), hard.field.grid()), path, counters);
    std::int64_t contacts = 0, other = 0;
    double worst = 0.0;
    for (int way = 1; way < 8; ++way) {
      const auto index = [&](int& c, int& r) {
        if ((way & 1) != 0) c = kSide - 1 - c;
        if ((way & 2) != 0) r = kSide - 1 - r;
        if ((way & 4) != 0) std::swap(c, r);
      };
      const auto point = [&](glm::dvec3 p) {
        if ((way & 1) != 0) p.x = kSide - 1 - p.x;
        if ((way & 2) != 0) p.y = kSide - 1 - p.y;
        if ((way & 4) != 0) std::swap(p.x, p.y);
        return p;
      };
      std::vector<float> turned(kSide * kSide);
      for (int r = 0; r < kSide; ++r)
        for (int c = 0; c < kSide; ++c) {
          int tc = c, tr = r;
          index(tc, tr);
          turned[static_cast<std::size_t>(tr * kSide + tc)] = reader.heightAt(c, r);
        }
      const engine::Version field = engine::makeField(hard.field.grid(), turned);
      const std::vector<Felt> felt =
          feel(field, tests::sceneFor(GetParam(), field.grid()), mapped(path, point), counters);
      for (std::size_t i = 0; i < path.size(); ++i) {
        if (felt[i].contact != plain[i].contact) {
          ++other;
          continue;
        }
        if (!felt[i].contact) continue;
        ++contacts;
        // 1 - u rounds, and so does all that follows: Newton's last step, 1e-7 of a cell, has an error of its
        // square times what curvature and coupling make of it (500), 5e-12 of a cell. A ball rests within
        // 1e-4 of a cell along the surface.
        const double tolerance = GetParam() == Choice::kSphere ? 2e-4 : 1e-11;
        const glm::dvec3& at = path[i].tip_mm;
        const double error =
            glm::length(felt[i].penetration - (point(at + plain[i].penetration) - point(at)));
        if (error > tolerance)
          ++other;
        else
          worst = std::max(worst, error);
      }
    }
    EXPECT_GT(contacts, 3000);
    // Descent takes the diagonal neighbour before the others and u before v: in noise a fork may
    // lead the mirrored one into another minimum, which it then keeps.
    const bool forks = GetParam() == Choice::kDescent && std::string_view(name) == "noise";
    EXPECT_LE(other, forks ? contacts / 10 : 0) << name;
    tests::tellRare(
        std::string(name) + " " + tests::choiceName(GetParam()), counters,
        fmt::format("{} of {} contacts in another minimum, else within {:.1e} mm", other, contacts, worst));
  }
}

// By a power of two every number of a tick scales exactly: the same bits. From 1e-6 to 1e6.
TEST_P(Symmetry, ScalingByPowersOfTwoFrom1eMinus6To1e6ScalesEveryBit) {
  for (const char* name :
       {"waves", "noise", "twisted_cells", "ridge_one_sample_wide", "near_vertical_step"}) {
    const HardField hard = tests::hardField(name);
    const engine::FieldReader reader = hard.field.reader();
    const std::vector<StrokeSample> path = tests::wander(hard, 2000, 12, Jumps::kYes);
    TickCounters counters;
    const std::vector<Felt> plain =
        feel(hard.field, tests::sceneFor(GetParam(), hard.field.grid()), path, counters);
    for (const double scale : {0x1p-20, 0x1p-10, 0x1p10, 0x1p20}) {
      engine::Grid grid = hard.field.grid();
      grid.spacing_x *= scale;
      grid.spacing_y *= scale;
      std::vector<float> heights;
      for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c < grid.width; ++c)
          heights.push_back(static_cast<float>(reader.heightAt(c, r) * scale));
      const engine::Version field = engine::makeField(grid, heights);
      const std::vector<Felt> felt = feel(field, tests::sceneFor(GetParam(), grid),
                                          mapped(path, [&](glm::dvec3 p) { return p * scale; }), counters);
      std::int64_t different = 0;
      for (std::size_t i = 0; i < path.size(); ++i)
        different += felt[i].contact != plain[i].contact ||
                             felt[i].penetration != scale * plain[i].penetration ||
                             (felt[i].contact && felt[i].proxy != scale * plain[i].proxy)
                         ? 1
                         : 0;
      EXPECT_EQ(different, 0) << name << " by " << scale;
    }
  }
}

// A hand at 5e6 mm from the field's first sample, on heights of 5e6 mm: what is felt is what is felt at home,
// but for one rounding of a coordinate of that size (ulp 9.3e-10 mm).
TEST_P(Symmetry, FiveMillionMillimetresFromTheFirstSampleTheSameIsFelt) {
  // Cells of 32 mm, so that column 163840 is 5242880 mm away.
  constexpr int kWide = 163840 + 24;
  constexpr double kCell = 32.0, kAway = 163840.0 * kCell, kUp = 5242880.0;
  // Heights in steps of 1/2 mm, the ulp of a float there.
  const auto height = [](int c, int r) { return 0.5 * ((c * 13 + r * 29) % 64); };
  const engine::Version home = tests::fieldOf(24, 12, height, kCell, kCell);
  const engine::Version away = tests::fieldOf(
      kWide, 12, [&](int c, int r) { return kUp + (c < 163840 ? 0.0 : height(c - 163840, r)); }, kCell,
      kCell);
  const HardField hard = tests::asHardField("home", home);
  const std::vector<StrokeSample> all = onLattice(tests::wander(hard, 3000, 13, Jumps::kNo));
  // A lattice of 2^-20 mm near 5e6 is exact in a double. Away from the left border, which the other field
  // lacks.
  const auto there = [&](glm::dvec3 p) { return p + glm::dvec3(kAway, 0.0, kUp); };
  std::vector<StrokeSample> path;
  for (StrokeSample sample : all) {
    sample.tip_mm.x = std::max(sample.tip_mm.x, 6.0 * kCell);
    path.push_back(sample);
  }
  TickCounters counters;
  Scene scene = tests::sceneFor(GetParam(), home.grid());
  scene.certified_radius_cells = 5;
  const std::vector<Felt> plain = feel(home, scene, path, counters);
  const std::vector<Felt> felt = feel(away, scene, mapped(path, there), counters);
  // A ball's tolerance is 1e-14 of heights and 8e-16 of places more there, 5e-8 mm; and its rest is 1e-4.
  const double tolerance = GetParam() == Choice::kSphere ? 2e-4 * kCell : ulps(4, 2.0 * kAway);
  std::int64_t contacts = 0, other = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    other += felt[i].contact != plain[i].contact ? 1 : 0;
    if (!felt[i].contact || !plain[i].contact) continue;
    ++contacts;
    const double error = glm::length(felt[i].penetration - plain[i].penetration);
    if (error > tolerance)
      ++other;
    else
      worst = std::max(worst, error);
  }
  EXPECT_GT(contacts, 500);
  EXPECT_LE(other, GetParam() == Choice::kSphere ? contacts / 50 : 0);
  tests::tellRare(
      tests::choiceName(GetParam()), counters,
      fmt::format("{} of {} contacts in another minimum, else within {:.1e} mm", other, contacts, worst));
}

// The origin takes no part: the very same bits.
TEST_P(Symmetry, AnOrigin5e6AwayChangesNoBit) {
  HardField hard = tests::hardField("noise");
  engine::Grid grid = hard.field.grid();
  std::vector<float> heights;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) heights.push_back(hard.field.reader().heightAt(c, r));
  grid.origin_x = 5000000.123;
  grid.origin_y = -4999999.877;
  const engine::Version away = engine::makeField(grid, heights);
  const std::vector<StrokeSample> path = tests::wander(hard, 3000, 14, Jumps::kYes);
  TickCounters here, there;
  const std::vector<Felt> plain = feel(hard.field, tests::sceneFor(GetParam(), grid), path, here);
  const std::vector<Felt> felt = feel(away, tests::sceneFor(GetParam(), grid), path, there);
  for (std::size_t i = 0; i < path.size(); ++i) ASSERT_EQ(felt[i].penetration, plain[i].penetration) << i;
  EXPECT_EQ(here, there);
}

INSTANTIATE_TEST_SUITE_P(Numeric, Symmetry, ::testing::ValuesIn(tests::kChoices),
                         [](const auto& one) { return tests::choiceName(one.param); });

}  // namespace
}  // namespace fettle::haptic
