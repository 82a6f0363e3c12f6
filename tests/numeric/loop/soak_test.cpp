// Ticks without end: a hand goes round the same lap, and nothing is left behind. Every lap after the first
// two gives the same forces and leaves the same state, bit for bit, however many went before: nothing drifts
// and nothing accumulates. Time is part of it: its steps are 2^-10 s, exact in a double for 2^53 of them, so
// that ticks after 11 days get the same differences of time as the first.
//
// 10 million ticks; FETTLE_SOAK_TICKS asks for more: ctest -C Soak -L soak goes round 1e9.
#include <malloc.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::haptic {
namespace {

using tests::Choice;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr std::int64_t kTicks = 1'000'000;  // ten times slower there
#else
constexpr std::int64_t kTicks = 10'000'000;
#endif
constexpr std::size_t kLap = 65536;
constexpr double kPeriod_s = 0x1p-10;

std::int64_t ticksAsked() {
  const char* asked = std::getenv("FETTLE_SOAK_TICKS");
  return asked != nullptr ? std::atoll(asked) : kTicks;
}

// Steps, a ridge, noise and holes; more than one tile.
engine::Version ground() {
  return tests::fieldOf(100, 100, [](int c, int r) {
    if ((c * 31 + r * 17) % 211 == 0) return static_cast<double>(tests::kHole);
    return 0.4 * std::sin(0.7 * c) * std::cos(0.5 * r) + (c % 23 == 0 ? 1.0 : 0.0) + (r > 60 ? 2.0 : 0.0);
  });
}

// A closed way over all of it, in and out of contact, outside the field too.
std::vector<glm::dvec3> lap() {
  std::vector<glm::dvec3> way;
  for (std::size_t i = 0; i < kLap; ++i) {
    const double t = 6.283185307179586 * static_cast<double>(i) / kLap;
    way.emplace_back(49.5 + 51.0 * std::sin(7.0 * t), 49.5 + 51.0 * std::cos(5.0 * t),
                     0.8 + 1.6 * std::sin(61.0 * t) + (49.5 + 51.0 * std::cos(5.0 * t) > 60.0 ? 2.0 : 0.0));
  }
  return way;
}

std::uint64_t mixed(std::uint64_t hash, double value) {
  // Murmur's finaliser, half of it: order and every bit count.
  hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0xff51afd7ed558ccdULL;
  return hash ^ (hash >> 33U);
}

class Soak : public ::testing::TestWithParam<Choice> {};

TEST_P(Soak, EveryLapIsTheSameToTheLastBit) {
  const std::int64_t ticks =
      GetParam() == Choice::kPaper ? ticksAsked() : std::min(ticksAsked(), kTicks) / 10;
  const engine::Version field = ground();
  Scene scene = tests::sceneFor(GetParam(), field.grid());
  scene.effects = {EffectKind::kSpring, EffectKind::kFriction, EffectKind::kViscosity};
  scene.certified_radius_cells = 3;
  scene.force_limit_n = 8.0;
  engine::LiveField live(field, engine::Growth::kNever);
  Tick tick(scene, live, field);
  const std::vector<glm::dvec3> way = lap();
  const std::int64_t laps = std::max<std::int64_t>((ticks - 1) / static_cast<std::int64_t>(kLap) + 1, 4);
  std::vector<glm::dvec3> third(kLap);  // proxies of the third lap
  std::uint64_t first_hash = 0;
  std::int64_t different = 0, contacts = 0, at = 0;
  double drift = 0.0;
  TickCounters before, a_lap;
  const std::size_t held = mallinfo2().uordblks;
  const auto begin = std::chrono::steady_clock::now();
  for (std::int64_t n = 0; n < laps; ++n) {
    std::uint64_t hash = 0;
    before = tick.counters();
    for (std::size_t i = 0; i < kLap; ++i) {
      const ForceSample felt = tick.run({kPeriod_s * static_cast<double>(at++), way[i], Tool::kFeel});
      hash = mixed(mixed(mixed(hash, felt.force_n.x), felt.force_n.y), felt.force_n.z);
      hash = mixed(mixed(mixed(hash, felt.proxy_mm.x), felt.proxy_mm.y), felt.proxy_mm.z);
      contacts += felt.contact ? 1 : 0;
      if (n == 2) third[i] = felt.proxy_mm;
      if (n == laps - 1) drift = std::max(drift, glm::length(felt.proxy_mm - third[i]));
    }
    if (n == 2) {
      first_hash = hash;
      a_lap = tick.counters();
      a_lap.over_hole -= before.over_hole;
    }
    if (n > 2 && hash != first_hash) ++different;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const std::size_t grown = mallinfo2().uordblks - held;
  std::printf(
      "%s: %lld ticks in %lld laps, %.0f s of hand, %lld contacts, %lld laps different, drift %.1e mm, %zu "
      "bytes more held, hash %016llx, %.2f M ticks/s\n",
      tests::choiceName(GetParam()).c_str(), static_cast<long long>(at), static_cast<long long>(laps),
      kPeriod_s * static_cast<double>(at), static_cast<long long>(contacts),
      static_cast<long long>(different), drift, grown, static_cast<unsigned long long>(first_hash),
      1e-6 * static_cast<double>(at) / took.count());
  tests::tellRare(tests::choiceName(GetParam()), tick.counters());
  EXPECT_EQ(different, 0);
  EXPECT_EQ(drift, 0.0);
  EXPECT_EQ(grown, 0U);
  EXPECT_GT(contacts, at / 5);
  // Rare events come lap by lap too: as many in the last as in the third.
  EXPECT_EQ(tick.counters().over_hole - before.over_hole, a_lap.over_hole);
}

INSTANTIATE_TEST_SUITE_P(Numeric, Soak, ::testing::ValuesIn(tests::kChoices),
                         [](const auto& one) { return tests::choiceName(one.param); });

}  // namespace
}  // namespace fettle::haptic
