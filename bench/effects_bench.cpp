#include "bench/effects_bench.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "bench/bench_forms.h"
#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/base/stopwatch.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {

namespace {

constexpr double kBallSamples = 2.0;
// Counting may have to be done in single steps of 5 to 20 us: in a short run, of fewer ticks.
constexpr std::size_t kCountedTicks = 24;
constexpr std::size_t kTicksPerCounted = 250;
constexpr std::size_t kCountedBallTicks = 2;
constexpr int kTouchingBefore = 20;
constexpr std::size_t kTicksPerCheck = 4096;

struct EffectCase {
  std::string name;
  haptic::Scene scene;
  std::optional<haptic::EffectKind> effect;  // whose bytes the row reports
  engine::Version field = {};                // another than the workpiece
};

haptic::Scene sceneOf(std::vector<haptic::EffectKind> effects) {
  haptic::Scene scene = haptic::defaultScene();
  scene.effects = std::move(effects);
  return scene;
}

// Every kind: a new one is included automatically. Those that need the spring are run with it, and their name
// states it.
std::vector<EffectCase> cases() {
  std::vector<EffectCase> all = {{"none", sceneOf({}), std::nullopt}};
  std::vector<haptic::EffectKind> kinds;
  for (int k = 0; k < haptic::kEffectKinds; ++k) {
    const auto kind = static_cast<haptic::EffectKind>(k);
    kinds.push_back(kind);
    const std::string name(haptic::effectName(kind));
    if (!haptic::sceneProblem(sceneOf({kind})))
      all.push_back({name, sceneOf({kind}), kind});
    else
      all.push_back({"spring + " + name, sceneOf({haptic::EffectKind::kSpring, kind}), kind});
  }
  all.push_back({"all", sceneOf(kinds), std::nullopt});
  EffectCase ball{"sphere tip, none", sceneOf({}), std::nullopt};
  ball.scene.tip = haptic::TipShape::kSphere;
  ball.scene.tip_radius_mm = kBallSamples * kSpacingMm;
  all.push_back(ball);
  ball.name = "sphere tip, all";
  ball.scene.effects = kinds;
  all.push_back(ball);
  return all;
}

// Without effects over fields that lie under a form.
engine::Status addFormCases(const engine::Version& field, std::vector<EffectCase>& all,
                            engine::JobControl& job) {
  for (const auto& [name, form] : {std::pair("under a plane", benchPlane(field.grid())),
                                   {"under a sphere", benchSphere(field.grid())}}) {
    auto seen = bentAndSeen(field, form, job);
    if (!seen) return tl::unexpected(seen.error());
    all.push_back({name, sceneOf({}), std::nullopt, *std::move(seen)});
  }
  return {};
}

// The workpiece with a marked line every 64 rows, for edge snap.
engine::Version markedWorkpiece(std::int32_t side) {
  const engine::Version plain = trials::workpiece(side, kSpacingMm);
  const auto samples = static_cast<std::size_t>(side);
  std::vector<float> heights(samples * samples);
  plain.reader().readHeights(0, 0, side, side, heights.data(), side);
  std::vector<std::uint8_t> marks(samples * samples, 0);
  for (std::size_t row = 32; row < samples; row += 64)
    std::fill_n(marks.begin() + static_cast<std::ptrdiff_t>(row * samples), samples, std::uint8_t{1});
  return engine::makeField(plain.grid(), heights, marks);
}

// Combines words as Boost and Fowler-Noll-Vo do; depends on their order.
void fold(std::uint64_t& hash, double value) noexcept {
  hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3;
}

struct Outcome {
  double ns_a_tick = 0.0;
  std::int64_t contact_ticks = 0;
  std::int64_t bytes = 0;
  std::uint64_t hash = 0xcbf29ce484222325;
};

// A hand for a ball is one radius higher: its endpoint is the centre.
double raiseFor(const haptic::Scene& scene) noexcept {
  return scene.tip == haptic::TipShape::kSphere ? scene.tip_radius_mm : 0.0;
}

engine::Result<Outcome> run(const EffectCase& what, const engine::Version& field,
                            std::span<const haptic::StrokeSample> strokes, engine::JobControl& job) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(what.scene, live, field);
  const double raise = raiseFor(what.scene);
  Outcome out;
  const haptic::DenormalScope as_in_the_loop;
  double spent_ns = 0.0;
  for (std::size_t i = 0; i < strokes.size(); i += kTicksPerCheck) {
    if (job.cancelled()) return engine::cancelled();
    const auto part = strokes.subspan(i, std::min(kTicksPerCheck, strokes.size() - i));
    const engine::Stopwatch watch;
    for (haptic::StrokeSample sample : part) {
      sample.tip_mm.z += raise;
      const haptic::ForceSample force = tick.run(sample);
      out.contact_ticks += force.contact ? 1 : 0;
      fold(out.hash, force.force_n.x);
      fold(out.hash, force.force_n.y);
      fold(out.hash, force.force_n.z);
      fold(out.hash, force.proxy_mm.z);
    }
    spent_ns += watch.ns();
  }
  out.ns_a_tick = spent_ns / static_cast<double>(strokes.size());
  out.hash ^= engine::contentHash(live.snapshot());
  const haptic::EffectList& effects = tick.effects();
  out.bytes = static_cast<std::int64_t>(what.effect ? effects.bytesOf(*what.effect)
                                                    : effects.bytes() + tick.tipBytes());
  if (!what.field.empty()) out.bytes += bytesOfSeen(what.field);
  return out;
}

// After the tip has touched for a while: ticks in free space cost almost nothing in any scene.
InstructionCount count(const EffectCase& what, const engine::Version& field,
                       std::span<const haptic::StrokeSample> strokes) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(what.scene, live, field);
  const bool ball = what.scene.tip == haptic::TipShape::kSphere;
  const std::size_t counted =
      std::min(ball ? kCountedBallTicks : kCountedTicks, strokes.size() / kTicksPerCounted);
  std::vector<haptic::StrokeSample> samples(strokes.begin(), strokes.end());
  for (haptic::StrokeSample& sample : samples) sample.tip_mm.z += raiseFor(what.scene);
  const haptic::DenormalScope as_in_the_loop;
  std::size_t at = 0;
  for (int touching = 0; at + counted < samples.size() && touching < kTouchingBefore; ++at)
    touching = tick.run(samples[at]).contact ? touching + 1 : 0;
  InstructionCount result = countInstructions([&] {
    for (std::size_t i = at; i < at + counted; ++i) (void)tick.run(samples[i]);
  });
  if (result.instructions) *result.instructions /= static_cast<std::int64_t>(counted);
  return result;
}

}  // namespace

engine::Result<EffectsBenchReport> benchEffects(const EffectsBenchOptions& options, engine::JobControl& job) {
  if (options.side < 64 || options.side > 32768 || options.ticks < 1000 || options.ticks > 100'000'000 ||
      options.repeats < 1 || options.repeats > 100)
    return engine::inputError("an option of the benchmark is out of range", "bench effects",
                              "side 64 to 32768, ticks 1000 to 1e8, repeats 1 to 100");
  EffectsBenchReport report;
  report.machine = machine();
  const engine::Version field = markedWorkpiece(options.side);
  trials::HandMotion motion;
  motion.ticks = options.ticks;
  motion.tool = haptic::Tool::kSmooth;  // does nothing where the scene has no smoothing
  const std::vector<haptic::StrokeSample> strokes = trials::handStroke(field, motion);
  std::vector<EffectCase> all = cases();
  if (auto added = addFormCases(field, all, job); !added) return tl::unexpected(added.error());
  const auto fieldOf = [&](const EffectCase& what) { return what.field.empty() ? field : what.field; };
  std::vector<std::vector<double>> times(all.size());
  report.rows.resize(all.size());
  job.begin("measuring", all.size() * (static_cast<std::size_t>(options.repeats) + 1));

  for (std::size_t k = 0; k < all.size(); ++k) {
    if (job.cancelled()) return engine::cancelled();
    EffectsBenchRow& row = report.rows[k];
    row.name = all[k].name;
    const InstructionCount counted = count(all[k], fieldOf(all[k]), strokes);
    if (counted.instructions) row.instructions = static_cast<double>(*counted.instructions);
    if (counted.by != CountedBy::kNothing) report.counted_by = counted.by;
    job.advance(1);
  }
  for (int i = 0; i < options.repeats; ++i)
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto outcome = run(all[k], fieldOf(all[k]), strokes, job);
      if (!outcome) return tl::unexpected(outcome.error());
      EffectsBenchRow& row = report.rows[k];
      if (i > 0 && outcome->hash != row.hash)
        return engine::failure("two runs of the same strokes differ", row.name, "please report this");
      row.hash = outcome->hash;
      row.bytes = outcome->bytes;
      row.contact_ticks = outcome->contact_ticks;
      times[k].push_back(outcome->ns_a_tick);
      job.advance(1);
    }
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::sort(times[k].begin(), times[k].end());
    report.rows[k].fastest_ns = times[k].front();
    report.rows[k].median_ns = times[k][times[k].size() / 2];
    report.rows[k].worst_ns = times[k].back();
  }
  return report;
}

}  // namespace fettle::bench
