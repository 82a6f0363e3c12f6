// Where does the energy go? In closed loop with a simulated hand, for every effect and all together, 0.5 to
// 10 kHz: work by the hand minus what is stored and what is dissipated is never negative.
//
// A force F_k is held while the hand goes D from tick k to k + 1. What the scene stores, E, and what holding
// the force may cost, the curvature C of its potential:
//   E_{k+1} - E_k <= -F_k . D + C |D|^2 / 2                                                     (1)
// Spring: E = K d^2 / 2 of the distance d to the proxy. The next proxy is no farther than the old one, and
// the
//   old one's half squared distance has curvature 1 everywhere: C = K, on any surface. Cut to the limit, E is
//   K d^2 / 2 up to it and a line beyond, which bends no more.
// Friction: E = k s^2 / 2, s projected, then perhaps shortened, C = k (friction.h).
// Texture, on a plane: E = K (d + h)^2 / 2, C = K (1 + s^2) + F_max c (texture.h).
// Edge snap: E = on (U + 2 F R / 3), C = 4 F / R along rows and columns (edge_snap.h), in a slanted direction
// no
//   more than their sum; while it comes on, another (on' - on) (U' + 2 F R / 3).
// Gravity: E = -m g z, C = 0.
// A filtered damper c (viscosity, and coupling along the normal of a plane), a = T / (T + tau), has the
// storage
//   S = c T v^2 / (2 a) of the filter's velocity v. With w = D / T and v' = v + a (w - v)
//     S' - S - c v . D = - c T (2 - a) / 2 |v|^2 - c a T v . w + c a T / 2 |w|^2 <= c a / (2 - a) |D|^2 / T,
//   the difference being the square c T (2 - a) / 2 |v + a w / (2 - a)|^2: C / 2 = c a / ((2 - a) T).
//   Coupling is cut where it would pull, and rests in free space; what it then leaves undone, (c v - K d) D
//   or c v D, is no energy of the spring's: it goes to S alone, and the balance is of what can come out,
//   without S.
// The device damps with b: it dissipates at least b |D|^2 / T. Summed, (1) says that nothing comes out while
// b / T >= C / 2: the conditions b > K T / 2 and b > K T / 2 + c a / (2 - a) of Colgate and Schenkel. Both
// are checked: (1) at every tick, and the balance over the whole session at the published damping.
#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/virtual/simulated_hand.h"
#include "haptic/effects/edge_snap.h"
#include "haptic/effects/friction.h"
#include "haptic/effects/stability.h"
#include "haptic/effects/texture.h"
#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::haptic {
namespace {

using tests::Choice;
using tests::HardField;

constexpr double kRates[] = {500.0, 1000.0, 2000.0, 5000.0, 10000.0};
constexpr double kGravity_n_per_kg = 9.80665;

bool lists(const Scene& scene, EffectKind kind) {
  return std::find(scene.effects.begin(), scene.effects.end(), kind) != scene.effects.end();
}

template <class T>
const T* dataOf(const Tick& tick, EffectKind kind) {
  for (const EffectData& data : tick.effects().data)
    if (data.kind == kind) return static_cast<const T*>(data.memory.get());
  return nullptr;
}

// What a scene stores after a tick [mJ], computed independently, and the largest force that holding costs.
class Books {
 public:
  Books(const Scene& scene, double rate_hz)
      : scene_(scene),
        period_s_(1.0 / rate_hz),
        relief_(std::make_shared<TextureTable>(scene.params.texture)) {}

  // C of all effects together [N/mm].
  double curvature() const {
    using std::numbers::pi;
    const EffectParams& p = scene_.params;
    double c = 0.0;
    if (lists(scene_, EffectKind::kSpring)) c += scene_.stiffness_n_per_mm;
    if (lists(scene_, EffectKind::kFriction)) c += p.friction.stiffness_n_per_mm;
    if (lists(scene_, EffectKind::kTexture)) {
      const double wave = pi / p.texture.wavelength_mm;
      const double slope = p.texture.amplitude_mm * wave;
      c += scene_.stiffness_n_per_mm * slope * slope +
           scene_.force_limit_n * 1.02 * 2.0 * p.texture.amplitude_mm * wave * wave;
    }
    if (lists(scene_, EffectKind::kEdgeSnap)) c += 2.0 * 4.0 * p.edge_snap.force_n / p.edge_snap.reach_mm;
    const double a = period_s_ / (period_s_ + 1e-3 * p.velocity.filter_ms);
    double damper = 0.0;
    if (lists(scene_, EffectKind::kViscosity)) damper += p.viscosity.damping_n_s_per_mm;
    if (lists(scene_, EffectKind::kCoupling)) damper += p.coupling.damping_n_s_per_mm;
    return c + 2.0 * damper * a / ((2.0 - a) * period_s_);
  }

  double stored(const Tick& tick, const StrokeSample& at, bool contact) {
    const EffectParams& p = scene_.params;
    double e = 0.0;
    if (lists(scene_, EffectKind::kGravity)) e -= p.gravity.stylus_kg * kGravity_n_per_kg * at.tip_mm.z;
    if (tick.effects().motion) {
      const double a = period_s_ / (period_s_ + 1e-3 * p.velocity.filter_ms);
      const glm::dvec3 v = tick.effects().motion->mmPerS();
      if (lists(scene_, EffectKind::kViscosity))
        e += 0.5 * p.viscosity.damping_n_s_per_mm * period_s_ / a * glm::dot(v, v);
      if (lists(scene_, EffectKind::kCoupling))
        e += 0.5 * p.coupling.damping_n_s_per_mm * period_s_ / a * v.z * v.z;
    }
    coming_on_ = 0.0;
    filters_ =
        e +
        (lists(scene_, EffectKind::kGravity) ? p.gravity.stylus_kg * kGravity_n_per_kg * at.tip_mm.z : 0.0);
    const bool coupled = lists(scene_, EffectKind::kCoupling);
    cut_n_ = coupled ? p.coupling.damping_n_s_per_mm * tick.effects().motion->mmPerS().z : 0.0;
    if (!contact) {
      on_ = 0.0;
      touched_ = false;
      return e;
    }
    const double d = glm::length(tick.contact().penetration_mm);
    if (coupled) cut_n_ = std::max(cut_n_ - scene_.stiffness_n_per_mm * d, 0.0);
    const double k = scene_.stiffness_n_per_mm;
    const double most = scene_.force_limit_n / k;
    if (lists(scene_, EffectKind::kTexture)) {
      const glm::dvec3& proxy = tick.contact().proxy.position_mm;
      const double felt = std::max(d + relief_->at(proxy.x, proxy.y).height_mm, 0.0);
      e += 0.5 * k * felt * felt;
    } else if (lists(scene_, EffectKind::kSpring)) {
      e += d <= most ? 0.5 * k * d * d : k * most * (d - 0.5 * most);
    }
    if (const auto* friction = dataOf<Friction>(tick, EffectKind::kFriction)) {
      const glm::dvec3 strain = at.tip_mm - friction->anchorMm();
      e += 0.5 * p.friction.stiffness_n_per_mm * glm::dot(strain, strain);
    }
    if (const auto* snap = dataOf<EdgeSnap>(tick, EffectKind::kEdgeSnap)) {
      if (!touched_) touched_s_ = at.t;
      touched_ = true;
      const double on = std::min((at.t - touched_s_) / 0.050, 1.0);
      const double height =
          snap->at(at.tip_mm.x, at.tip_mm.y).mj + 2.0 / 3.0 * p.edge_snap.force_n * p.edge_snap.reach_mm;
      coming_on_ = (on - on_) * height;
      e += on * height;
      on_ = on;
    }
    return e;
  }
  // What edge snap gave the hand by coming on in the last tick [mJ].
  double comingOn() const { return coming_on_; }

  // The part of stored() that is the dampers' filter and no energy that could come out [mJ].
  double filters() const { return filters_; }

  // What a coupling that was cut to no pull, or rests in free space, leaves undone over a way along z [mJ]:
  // of the tick that stored() was last asked about.
  double cut(double way_mm) const { return std::max(cut_n_ * way_mm, 0.0); }

 private:
  const Scene& scene_;
  double period_s_;
  std::shared_ptr<const TextureTable> relief_;
  double on_ = 0.0, touched_s_ = 0.0, coming_on_ = 0.0, cut_n_ = 0.0, filters_ = 0.0;
  bool touched_ = false;
};

struct Balance {
  std::int64_t ticks = 0, contacts = 0, entries = 0;
  std::int64_t far_entries = 0;  // of the broken ticks, those in which contact began
  std::int64_t broken = 0;       // ticks in which (1) did not hold
  double worst_mj = 0.0;         // by how much
  double lowest_mj = 0.0;        // work by the hand + damped - stored, the lowest of the session
  double scale_mj = 0.0;         // largest sum that was added up: what roundings are of
  double given_mj = 0.0;  // by edge snap coming on, and by filters that were turning when contact began
  TickCounters counters;
};

// Presses in the middle, drags across and along, lifts, taps.
std::vector<HandTarget> path(double low, double middle, double spacing) {
  const double s = spacing;
  return {{0.0, {middle, middle, low + 3.0}},
          {0.15, {middle, middle, low - 2.0}},
          {0.4, {middle, middle, low - 2.0}},
          {0.9, {middle + 5 * s, middle + s, low - 2.5}},
          {1.3, {middle - 5 * s, middle + 2 * s, low - 1.5}},
          {1.6, {middle, middle + 4 * s, low - 2.0}},
          {1.75, {middle, middle, low + 3.0}},
          {1.85, {middle, middle, low - 2.0}},
          {2.0, {middle + s, middle - s, low + 3.0}},
          {2.1, {middle, middle, low + 3.0}}};
}

Balance session(const engine::Version& field, const Scene& scene, double rate_hz, double device_damping) {
  HandSpec spec;
  spec.rate_hz = rate_hz;
  spec.device_damping_n_s_per_mm = device_damping;
  const engine::Grid& grid = field.grid();
  const double middle = 0.5 * (grid.width - 1) * grid.spacingXMm();
  const double low = static_cast<double>(tests::heightAt(field, middle, middle));
  SimulatedHand hand(path(low, middle, grid.spacingXMm()), spec);
  engine::LiveField live(field, engine::Growth::kAllowed);
  Tick tick(scene, live, field);
  Books books(scene, rate_hz);
  Balance out;
  const double curvature = books.curvature();
  const double period = 1.0 / rate_hz;
  double before = 0.0, sum = 0.0, start = NAN;
  glm::dvec3 force{0.0}, at{0.0};
  bool was_contact = false;
  while (!hand.finished()) {
    const StrokeSample sample{hand.seconds(), hand.read().position_mm, Tool::kFeel};
    const ForceSample felt = tick.run(sample);
    hand.write(felt.force_n);
    const Books cut_before = books;
    const double stored = books.stored(tick, sample, felt.contact);
    if (out.ticks == 0) {
      start = before = stored;
    } else {
      const glm::dvec3 way = sample.tip_mm - at;
      const double work = -glm::dot(force, way);  // by the hand on the scene
      const double given = cut_before.cut(way.z) + books.comingOn();
      const double hold = 0.5 * curvature * glm::dot(way, way);
      const double missing = stored - before - work - hold - given;
      // Sums of products, 16 roundings each, of the largest of them.
      const double scale = std::abs(stored) + std::abs(before) + std::abs(work) + hold;
      // A ball rests within its tolerance, 1e-6 of a cell, and a step of 1e-4 of one: the distance changes by
      // no more than the first and half the square of the second.
      const double ball = scene.tip == TipShape::kSphere ? 1e-5 * (1.0 + std::sqrt(scale)) : 0.0;
      if (missing > tests::ulps(64, scale + 1.0) + ball) {
        ++(felt.contact && !was_contact ? out.far_entries : out.broken);
        out.worst_mj = std::max(out.worst_mj, missing);
      }
      out.given_mj += books.comingOn();
      sum += work + device_damping * glm::dot(way, way) / period;
      out.lowest_mj = std::min(out.lowest_mj, sum + out.given_mj - (stored - books.filters() - start));
      out.scale_mj = std::max({out.scale_mj, std::abs(sum), std::abs(stored)});
    }
    out.contacts += felt.contact ? 1 : 0;
    out.entries += felt.contact && !was_contact ? 1 : 0;
    was_contact = felt.contact;
    before = stored;
    force = felt.force_n;
    at = sample.tip_mm;
    ++out.ticks;
  }
  out.counters = tick.counters();
  return out;
}

Scene sceneOf(std::vector<EffectKind> effects, Choice choice, const engine::Grid& grid) {
  Scene scene = tests::sceneFor(choice, grid);
  scene.effects = std::move(effects);
  scene.force_limit_n = 8.0;
  scene.params.viscosity.medium = ViscousMedium::kEverywhere;
  return scene;
}

void print(const std::string& name, const Balance& b) {
  tests::tellRare(
      name, b.counters,
      fmt::format("{} ticks, {} contacts, {} entries, {} of them far, lowest balance {:.2e} of {:.2g} mJ, {} "
                  "ticks broken by {:.1e} mJ",
                  b.ticks, b.contacts, b.entries, b.far_entries, b.lowest_mj, b.scale_mj, b.broken,
                  b.worst_mj));
}

// Every tick adds a few roundings of the running sum.
double sumError(const Balance& b) {
  return tests::ulps(8.0 * static_cast<double>(b.ticks), b.scale_mj + 1.0);
}

engine::Version marked(const engine::Version& field) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  const engine::Grid& grid = field.grid();
  for (int r = 0; r < grid.height; ++r) {
    static_cast<void>(live.setMark(grid.width / 2 + 1, r, true));
    static_cast<void>(live.setMark(grid.width / 2 - 3 + r % 5, r, true));
  }
  return live.snapshot();
}

struct Listed {
  std::string name;
  std::vector<EffectKind> effects;
};

std::vector<Listed> listings() {
  using K = EffectKind;
  return {{"spring", {K::kSpring}},
          {"friction", {K::kSpring, K::kFriction}},
          {"viscosity", {K::kSpring, K::kViscosity}},
          {"coupling", {K::kSpring, K::kCoupling}},
          {"edge_snap", {K::kSpring, K::kEdgeSnap}},
          {"texture", {K::kSpring, K::kTexture}},
          {"gravity", {K::kSpring, K::kGravity}},
          {"passivity", {K::kSpring, K::kPassivity}},
          {"all",
           {K::kSpring, K::kFriction, K::kViscosity, K::kCoupling, K::kEdgeSnap, K::kTexture, K::kGravity}},
          {"all_with_passivity",
           {K::kSpring, K::kFriction, K::kViscosity, K::kCoupling, K::kEdgeSnap, K::kTexture, K::kGravity,
            K::kPassivity}}};
}

class EnergyOf : public ::testing::TestWithParam<std::string> {
 protected:
  Listed listed() const {
    for (Listed& one : listings_)
      if (one.name == GetParam()) return one;
    return {};
  }

 private:
  mutable std::vector<Listed> listings_ = listings();
};

// On the flat, where all of them are what their headers say, at the damping that the scene asks of its
// device.
TEST_P(EnergyOf, OnTheFlatNothingComesOutAtThePublishedDamping) {
  const engine::Version flat = marked(tests::fieldOf(
      64, 64, [](int, int) { return 0.0; }, 0.25, 0.25));
  for (const Choice choice : {Choice::kPaper, Choice::kDescent, Choice::kCertified})
    for (const double rate : kRates) {
      const Scene scene = sceneOf(listed().effects, choice, flat.grid());
      const double damping = stabilityNeed(scene, rate).device_damping_n_s_per_mm;
      const Balance b = session(flat, scene, rate, damping);
      const std::string name =
          fmt::format("{} {} {} Hz b = {:.2g}", listed().name, tests::choiceName(choice), rate, damping);
      print(name, b);
      EXPECT_GT(b.contacts, b.ticks / 3) << name;
      EXPECT_GE(b.lowest_mj, -sumError(b)) << name;
      // The controller takes force away without taking from what is stored: its own promise is the balance.
      if (!lists(scene, EffectKind::kPassivity)) {
        EXPECT_EQ(b.broken, 0) << name;
      }
    }
}

// On hard fields, what is derived above for any surface. The balance at the published damping, and (1).
class EnergyOn : public ::testing::TestWithParam<std::string> {};

TEST_P(EnergyOn, NothingComesOutOfAnySurface) {
  const HardField hard = tests::hardField(GetParam());
  const engine::Version field = marked(hard.field);
  for (const Listed& listed : listings()) {
    if (listed.name != "spring" && listed.name != "friction" && listed.name != "viscosity" &&
        listed.name != "gravity")
      continue;
    for (const Choice choice : tests::kChoices)
      for (const double rate : kRates) {
        const Scene scene = sceneOf(listed.effects, choice, field.grid());
        const double damping = stabilityNeed(scene, rate).device_damping_n_s_per_mm;
        const Balance b = session(field, scene, rate, damping);
        const std::string name =
            fmt::format("{} {} {} {} Hz", hard.name, listed.name, tests::choiceName(choice), rate);
        print(name, b);
        EXPECT_GE(b.lowest_mj, -sumError(b)) << name;
        // A local search may hand over to a farther minimum where slopes are steep.
        if (!tests::searchesLocally(choice) || hard.slope < 1.0) {
          EXPECT_EQ(b.broken, 0) << name;
          EXPECT_EQ(b.far_entries, 0) << name;
        }
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Numeric, EnergyOn,
                         ::testing::Values("tilted", "waves", "near_vertical_step", "stairs_of_two_cells",
                                           "saddle", "twisted_cells", "concave_corner", "duplicate_minima",
                                           "plateaus", "ridge_one_sample_wide", "diagonal_ridge", "roof",
                                           "pyramid_vertex", "noise", "upside_down", "origin_5e6_away"),
                         [](const auto& one) { return one.param; });

INSTANTIATE_TEST_SUITE_P(Numeric, EnergyOf,
                         ::testing::Values("spring", "friction", "viscosity", "coupling", "edge_snap",
                                           "texture", "gravity", "passivity", "all", "all_with_passivity"),
                         [](const auto& one) { return one.param; });

}  // namespace
}  // namespace fettle::haptic
