#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "bench/accuracy/literal_search.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/subjects.h"
#include "engine/base/stopwatch.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/contact/certified.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {
namespace {

constexpr int kPaperRepeats = 5;
constexpr double kTruthRadiusMm = 1.0;  // deeper than the hand presses
constexpr double kSamePointMm = 1e-7;   // tests/bench/literal_search_test.cpp derives it
constexpr double kBallCells = 2.0;      // of the smaller spacing
constexpr const char* kBallName = "ball, radius 2 cells";
constexpr double kNearestMm = 1e-9;  // farther than the nearest by less counts as nearest

// What one method felt in every tick.
struct Felt {
  std::vector<bool> touches;
  std::vector<glm::dvec3> proxy_mm;
  std::vector<double> tick_ns;
};

// `tick` takes a sample of the stroke and says whether it touches, and where.
template <class T>
Felt feel(const std::vector<haptic::StrokeSample>& strokes, T&& tick) {
  Felt felt;
  for (const haptic::StrokeSample& s : strokes) {
    glm::dvec3 proxy_mm(0.0);
    const engine::Stopwatch watch;
    const bool touches = tick(s, proxy_mm);
    felt.tick_ns.push_back(watch.ns());
    felt.touches.push_back(touches);
    felt.proxy_mm.push_back(proxy_mm);
  }
  return felt;
}

double p999Us(const Felt& felt) {
  std::vector<double> ns = felt.tick_ns;
  const auto at = ns.begin() + static_cast<std::ptrdiff_t>(ns.size() * 999 / 1000);
  std::nth_element(ns.begin(), at, ns.end());
  return 1e-3 * *at;
}

// A hand on a ground, and the distance of the nearest point in every tick.
struct Touched {
  const Subject& ground;
  const std::vector<haptic::StrokeSample>& strokes;
  const std::vector<double>& nearest_mm;
};

AccuracyRow paperRow(const Touched& hand, const char* method, const Felt& felt, const Felt& literal) {
  AccuracyRow row{hand.ground.name, method};
  std::vector<double> distances;
  std::int64_t not_nearest = 0, other_flags = 0, other_points = 0;
  for (std::size_t i = 0; i < hand.strokes.size(); ++i) {
    other_flags += felt.touches[i] != literal.touches[i] ? 1 : 0;
    if (!felt.touches[i]) continue;
    const double distance_mm = glm::length(felt.proxy_mm[i] - hand.strokes[i].tip_mm);
    distances.push_back(distance_mm);
    not_nearest += distance_mm > hand.nearest_mm[i] + kNearestMm ? 1 : 0;
    const double aside_mm = glm::length(felt.proxy_mm[i] - literal.proxy_mm[i]);
    other_points += literal.touches[i] && aside_mm > kSamePointMm ? 1 : 0;
    row.hash = std::rotl(row.hash, 7) ^ std::bit_cast<std::uint64_t>(distance_mm);
  }
  row.wrong = static_cast<double>(not_nearest) / std::max(1.0, static_cast<double>(distances.size()));
  summarise(std::move(distances), row);
  row.more = {static_cast<double>(other_flags), static_cast<double>(other_points), p999Us(felt)};
  return row;
}

Felt feelLiteral(const Touched& hand) {
  LiteralTracker search(hand.ground.field);
  return feel(hand.strokes, [&](const haptic::StrokeSample& s, glm::dvec3& proxy_mm) {
    LiteralPoint point;
    const bool touches = search.update(s.tip_mm, point);
    proxy_mm = point.position_mm;
    return touches;
  });
}

// Ticks of a scene, timed all together and one by one; the row has the cost alone. A tick does the same work in each pass, so the
// least of its times leaves out what else the machine did.
Felt feelScene(const Touched& hand, const haptic::Scene& scene, AccuracyRow& row) {
  const haptic::DenormalScope as_in_the_loop;
  std::vector<double> ns;
  for (int i = 0; i < kPaperRepeats; ++i) {
    engine::LiveField live(hand.ground.field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, hand.ground.field);
    const engine::Stopwatch watch;
    for (const haptic::StrokeSample& s : hand.strokes) (void)tick.run(s);
    ns.push_back(watch.ns() / static_cast<double>(hand.strokes.size()));
  }
  spread(std::move(ns), row);
  Felt all;
  for (int i = 0; i < kPaperRepeats; ++i) {
    engine::LiveField live(hand.ground.field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, hand.ground.field);
    Felt felt = feel(hand.strokes, [&](const haptic::StrokeSample& s, glm::dvec3& proxy_mm) {
      const bool touches = tick.run(s).contact;
      // Of a point the proxy, of a ball its centre.
      if (touches) proxy_mm = s.tip_mm + tick.contact().penetration_mm;
      return touches;
    });
    for (std::size_t k = 0; k < all.tick_ns.size(); ++k)
      felt.tick_ns[k] = std::min(felt.tick_ns[k], all.tick_ns[k]);
    all = std::move(felt);
  }
  return all;
}

haptic::Scene plainScene() {
  haptic::Scene scene = haptic::defaultScene();
  scene.effects = {haptic::EffectKind::kSpring};
  return scene;
}

AccuracyRow levelRow(const Touched& hand, const char* name, haptic::ContactLevel level, const Felt& literal) {
  haptic::Scene scene = plainScene();
  scene.level = level;
  scene.certified_radius_cells = 8;
  AccuracyRow cost;
  const Felt felt = feelScene(hand, scene, cost);
  AccuracyRow row = paperRow(hand, name, felt, literal);
  row.cost = cost.cost;
  row.cost_worst = cost.cost_worst;
  return row;
}

// The same hand with a ball, whose endpoint is its centre: for the same press one radius higher. It rests at its first
// contacts, so that neither the nearest point nor a point tip's contact is its reference.
AccuracyRow ballRow(const Touched& hand) {
  haptic::Scene scene = plainScene();
  scene.tip = haptic::TipShape::kSphere;
  const engine::Grid& grid = hand.ground.field.grid();
  scene.tip_radius_mm = kBallCells * std::min(grid.spacingXMm(), grid.spacingYMm());
  std::vector<haptic::StrokeSample> raised = hand.strokes;
  for (haptic::StrokeSample& s : raised) s.tip_mm.z += scene.tip_radius_mm;
  const Touched ball{hand.ground, raised, hand.nearest_mm};
  AccuracyRow cost;
  const Felt felt = feelScene(ball, scene, cost);
  AccuracyRow row = paperRow(ball, kBallName, felt, felt);
  row.cost = cost.cost;
  row.cost_worst = cost.cost_worst;
  row.wrong = row.more[0] = row.more[1] = std::numeric_limits<double>::quiet_NaN();
  row.note = "distance of its centre from the endpoint";
  return row;
}

}  // namespace

engine::Result<Study> paperStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"paper",
              "Contact: the source's search, word for word",
              "Does level paper feel what the source's text says, and how much nearer are the others?",
              {"time per tick", "ns"},
              {"mean distance from the endpoint to the point felt", "mm"}};
  study.wrong_name = "ticks not at the closest point";
  study.columns = {"contact flags that differ from the literal search", "points that differ", "p99.9 [us]",
                   "ticks per second [M]"};
  auto grounds = searchGrounds(256);
  if (!grounds) return tl::unexpected(grounds.error());
  constexpr struct {
    const char* name;
    haptic::ContactLevel level;
  } kLevels[] = {{"descent", haptic::ContactLevel::kDescent},
                 {"paper", haptic::ContactLevel::kPaper},
                 {"certified, 8 cells", haptic::ContactLevel::kCertified}};
  job.begin("the source's search", grounds->size() * (2 + std::size(kLevels)));
  std::int64_t ticks = 0;
  double flags = 0.0, points = 0.0;
  for (const Subject& ground : *grounds) {
    trials::HandMotion motion;
    motion.ticks = std::max<std::int64_t>(500, std::llround(50'000 * options.effort));
    motion.speed_mm_s = 20.0;
    const std::vector<haptic::StrokeSample> strokes = trials::handStroke(ground.field, motion);
    ticks += motion.ticks;
    haptic::Surface surface(ground.field.reader());
    std::vector<double> nearest_mm;
    for (const haptic::StrokeSample& s : strokes) {
      if (nearest_mm.size() % 256 == 0 && job.cancelled()) return engine::cancelled();
      haptic::SurfacePoint closest;
      const bool found = haptic::certifiedClosest(surface, s.tip_mm, kTruthRadiusMm, closest);
      nearest_mm.push_back(found ? std::sqrt(closest.distance2_mm2)
                                 : std::numeric_limits<double>::infinity());
    }
    const Touched hand{ground, strokes, nearest_mm};
    const Felt literal = feelLiteral(hand);
    AccuracyRow first = paperRow(hand, "literal paper", literal, literal);
    first.cost = first.cost_worst = std::accumulate(literal.tick_ns.begin(), literal.tick_ns.end(), 0.0) /
                                    static_cast<double>(strokes.size());
    study.rows.push_back(std::move(first));
    job.advance();
    for (const auto& chosen : kLevels) {
      if (job.cancelled()) return engine::cancelled();
      study.rows.push_back(levelRow(hand, chosen.name, chosen.level, literal));
      if (chosen.level == haptic::ContactLevel::kPaper) {
        flags += study.rows.back().more[0];
        points += study.rows.back().more[1];
      }
      job.advance();
    }
    if (job.cancelled()) return engine::cancelled();
    study.rows.push_back(ballRow(hand));
    job.advance();
  }
  for (AccuracyRow& row : study.rows) row.more.push_back(1e3 / row.cost);
  study.reference =
      "The literal search (bench/accuracy/literal_search.h) is the source's text in plain double precision "
      "on a "
      "plain array: the bounded closest point of every cell is looked for at 65 places along each parameter "
      "and "
      "refined; no neighbour is left out. The nearest point is that of all cells within 1 mm (level "
      "certified).";
  const auto noise = [&](const char* method) -> const AccuracyRow& { return rowOf(study, "noise", method); };
  study.answer = fmt::format(
      "Of {} ticks on seven grounds level paper felt another point than the literal search in {:.0f}, and in "
      "{:.0f} "
      "only one of the two touched. On noise its point is {:.4f} mm away on average and not the nearest in "
      "{:.1f} % "
      "of the ticks (literal {:.4f} mm, {:.1f} %; descent {:.4f} mm, {:.1f} %; nearest {:.4f} mm).",
      ticks, points, flags, noise("paper").error, 100 * noise("paper").wrong, noise("literal paper").error,
      100 * noise("literal paper").wrong, noise("descent").error, 100 * noise("descent").wrong,
      noise("certified, 8 cells").error);
  return study;
}

}  // namespace fettle::bench
