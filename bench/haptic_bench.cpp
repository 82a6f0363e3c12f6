#include "bench/haptic_bench.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include "bench/least_ball.h"
#include "bench/least_search.h"
#include "bench/machine.h"
#include "bench/plain_search.h"
#include "bench/repeats.h"
#include "engine/base/stopwatch.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/replay.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {

namespace {

struct HapticCase {
  const char* name;
  haptic::Tool tool;
  haptic::ContactLevel level;
  std::int64_t share;   // runs ticks / share
  double ball_samples;  // radius of the tip; 0 is a point
  int search_rounds = 2048;
  int ball_searches = haptic::kBallSearches;
  haptic::BallMinima ball_minima = haptic::BallMinima::kAll;
  haptic::BallSteps ball_steps = haptic::BallSteps::kInPlan;
};

// Of the ticks a ball runs one in so many; its radius in samples.
constexpr std::int64_t kBallShare = 10;
constexpr double kHapticBallSamples = 2.0;

constexpr HapticCase kHapticCases[] = {
    {"paper, feel", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, 1, 0.0},
    {"descent, feel", haptic::Tool::kFeel, haptic::ContactLevel::kDescent, 1, 0.0},
    {"paper, 3x3 smoothing", haptic::Tool::kSmooth, haptic::ContactLevel::kPaper, 1, 0.0},
    {"certified radius 2, feel", haptic::Tool::kFeel, haptic::ContactLevel::kCertified, 10, 0.0},
    {"ball r = 2 samples, to rest", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, kBallShare,
     kHapticBallSamples},
    {"the same, 4 steps per tick", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, kBallShare,
     kHapticBallSamples, 5},
    {"the same, minima of equal pieces", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, kBallShare,
     kHapticBallSamples, 2048, haptic::kBallSearches, haptic::BallMinima::kPieces},
    {"the same, as before contact revision 4", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, kBallShare,
     kHapticBallSamples, 2048, 64, haptic::BallMinima::kPieces, haptic::BallSteps::kInSpace},
};

std::span<const haptic::StrokeSample> partOf(std::span<const haptic::StrokeSample> strokes,
                                             std::int64_t share) {
  return strokes.first(std::max<std::size_t>(1, strokes.size() / static_cast<std::size_t>(share)));
}

// A field that is difficult for a search of the closest point.
struct HardGround {
  const char* name;
  // Height of sample (column, row) [mm].
  float (*height)(std::int32_t column, std::int32_t row) noexcept;
};
// Needles 1e6 mm high, cells with a twist of 10 of their sides, walls of 200 sides height eight cells apart,
// and pits whose slopes change from 1 to 1000.
constexpr HardGround kHardGrounds[] = {
    {"needles",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 7 == 3 && r % 5 == 2 ? 1e6F : 0.0F; }},
    {"twisted cells",
     [](std::int32_t c, std::int32_t r) noexcept { return (c + r) % 2 == 0 ? -0.25F : 0.25F; }},
    {"walls", [](std::int32_t c, std::int32_t) noexcept { return c / 8 % 2 == 0 ? 0.0F : 10.0F; }},
    {"pits",
     [](std::int32_t c, std::int32_t r) noexcept {
       return (c % 4 == 0 ? -50.0F : 0.0F) + (r % 3 == 0 ? -0.05F : 0.0F);
     }},
};

engine::Version makeGround(const HardGround& ground, std::int32_t side, double spacing_mm) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = spacing_mm;
  std::vector<float> z;
  z.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r)
    for (std::int32_t c = 0; c < side; ++c) z.push_back(ground.height(c, r));
  return engine::makeField(grid, z);
}

constexpr std::size_t kTimedTicks = 100'000;

std::uint64_t hashWith(std::uint64_t hash, double value) noexcept {
  return std::rotl(hash, 7) ^ std::bit_cast<std::uint64_t>(value);
}

// Times of single ticks, separate from the runs that measure ticks per second: reading the clock takes a
// noticeable part of a tick. A tick does the same work in each of `repeats` passes, so the least of them leaves out what else
// the machine did. Adds what was felt to the hash, since a tick that only feels leaves every field as it was; false when
// two passes felt differently.
[[nodiscard]] bool timeTicks(const haptic::Scene& scene, const engine::Version& field,
                             std::span<const haptic::StrokeSample> strokes, int repeats,
                             HapticBenchRow& row) {
  const auto timed = strokes.first(std::min(strokes.size(), kTimedTicks));
  std::vector<double> ns(timed.size(), std::numeric_limits<double>::infinity());
  const haptic::DenormalScope as_in_the_loop;
  std::uint64_t first = 0;
  for (int pass = 0; pass < repeats; ++pass) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, field);
    std::uint64_t hash = row.hash;
    for (std::size_t i = 0; i < timed.size(); ++i) {
      const engine::Stopwatch watch;
      const haptic::ForceSample felt = tick.run(timed[i]);
      ns[i] = std::min(ns[i], watch.ns());
      for (const glm::dvec3& of : {felt.force_n, felt.proxy_mm})
        hash = hashWith(hashWith(hashWith(hash, of.x), of.y), of.z);
    }
    if (pass == 0) first = hash;
    if (hash != first) return false;
  }
  row.hash = first;
  std::sort(ns.begin(), ns.end());
  const auto quantile = [&](double q) {
    return ns[std::min(ns.size() - 1, static_cast<std::size_t>(q * static_cast<double>(ns.size())))];
  };
  row.p50_ns = quantile(0.5);
  row.p99_ns = quantile(0.99);
  row.p999_ns = quantile(0.999);
  row.p9999_ns = quantile(0.9999);
  row.worst_ns = ns.back();
  return true;
}

engine::Result<HapticBenchRow> run(const HapticCase& test_case, const engine::Version& field,
                                   std::vector<haptic::StrokeSample>& strokes, double& raised_mm,
                                   const HapticBenchOptions& options, engine::JobControl& job) {
  haptic::Scene scene = haptic::defaultScene();
  scene.level = test_case.level;
  scene.search_rounds = test_case.search_rounds;
  scene.ball_searches = test_case.ball_searches;
  scene.ball_minima = test_case.ball_minima;
  scene.ball_steps = test_case.ball_steps;
  const double radius_mm = test_case.ball_samples * kSpacingMm;
  if (radius_mm > 0.0) {
    scene.tip = haptic::TipShape::kSphere;
    scene.tip_radius_mm = radius_mm;
  }
  for (haptic::StrokeSample& s : strokes) {
    s.tool = test_case.tool;
    s.tip_mm.z += radius_mm - raised_mm;
  }
  raised_mm = radius_mm;
  const auto part = partOf(strokes, test_case.share);
  const auto differ = [&] {
    return engine::failure("two runs of the same strokes differ", test_case.name, "please report this");
  };
  HapticBenchRow row;
  row.name = test_case.name;
  std::vector<double> rates;
  for (int i = 0; i < options.repeats; ++i) {
    const auto result = haptic::replay(field, field, part, scene, {}, job);
    if (!result) return tl::unexpected(result.error());
    const std::uint64_t hash = engine::contentHash(result->field);
    if (i > 0 && hash != row.hash) return differ();
    row.hash = hash;
    row.ticks = result->report.ticks;
    row.contact_ticks = result->report.contact_ticks;
    rates.push_back(result->report.ticks_per_second);
  }
  std::sort(rates.begin(), rates.end());
  row.slowest = rates.front();
  row.median = rates[rates.size() / 2];
  row.fastest = rates.back();
  if (!timeTicks(scene, field, part, options.repeats, row)) return differ();
  return row;
}

// The yardstick's rate over the same strokes.
engine::Result<HapticBenchRow> runPlain(const engine::Version& field,
                                        std::span<const haptic::StrokeSample> strokes,
                                        const HapticBenchOptions& options, engine::JobControl& job) {
  const double stiffness = haptic::defaultScene().stiffness_n_per_mm;
  HapticBenchRow row;
  row.name = "plain array, the source's search";
  row.ticks = static_cast<std::int64_t>(strokes.size());
  PlainSearch search(field);
  std::vector<double> rates;
  for (int i = 0; i < options.repeats; ++i) {
    if (job.cancelled()) return engine::cancelled();
    row.contact_ticks = 0;
    row.hash = 0;
    const engine::Stopwatch watch;
    for (const haptic::StrokeSample& sample : strokes) {
      const glm::dvec3 force = search.tick(sample.tip_mm, stiffness);
      row.contact_ticks += force.z != 0.0 ? 1 : 0;
      row.hash = hashWith(row.hash, force.z);
    }
    rates.push_back(static_cast<double>(strokes.size()) / watch.seconds());
    search.reset();
  }
  std::sort(rates.begin(), rates.end());
  row.slowest = rates.front();
  row.median = rates[rates.size() / 2];
  row.fastest = rates.back();
  return row;
}

// A lower bound over the same strokes, LeastSearch or LeastBall: rates of all ticks, though only those in contact are computed.
template <class Least>
HapticBenchRow runLeast(const char* name, const Least& least, std::span<const haptic::StrokeSample> strokes,
                        const HapticBenchOptions& options) {
  HapticBenchRow row;
  row.name = name;
  row.ticks = static_cast<std::int64_t>(strokes.size());
  row.contact_ticks = least.contacts();
  row.cells = least.cells();
  row.newton_cells = least.newtonCells();
  row.bytes = least.bytes();
  std::vector<double> rates;
  for (int i = 0; i < options.repeats; ++i) {
    const engine::Stopwatch watch;
    row.hash = std::bit_cast<std::uint64_t>(least.run());
    rates.push_back(static_cast<double>(strokes.size()) / watch.seconds());
  }
  std::sort(rates.begin(), rates.end());
  row.slowest = rates.front();
  row.median = rates[rates.size() / 2];
  row.fastest = rates.back();
  return row;
}

struct Touched {
  const char* ground;
  const engine::Version& field;
  double speed_mm_s;
  std::int64_t ticks;
};

engine::Status touch(const Touched& what, const HapticBenchOptions& options, engine::JobControl& job,
                     HapticBenchReport& report) {
  trials::HandMotion motion;
  motion.ticks = what.ticks;
  motion.speed_mm_s = what.speed_mm_s;
  std::vector<haptic::StrokeSample> strokes = trials::handStroke(what.field, motion);
  const auto add = [&](engine::Result<HapticBenchRow> row) -> engine::Status {
    if (!row) return tl::unexpected(row.error());
    row->ground = what.ground;
    row->speed_mm_s = what.speed_mm_s;
    report.rows.push_back(*std::move(row));
    return {};
  };
  if (auto done = add(runPlain(what.field, strokes, options, job)); !done) return done;
  if (auto done = add(runLeast("plain array, the least of level paper", LeastSearch(what.field, strokes),
                               strokes, options));
      !done)
    return done;
  double raised_mm = 0.0;  // a ball's endpoint is its centre: for the same press it is one radius higher
  for (const HapticCase& test_case : kHapticCases)
    if (auto done = add(run(test_case, what.field, strokes, raised_mm, options, job)); !done) return done;
  const std::span<const haptic::StrokeSample> balls = partOf(strokes, kBallShare);
  return add(runLeast("plain array, the least of a ball",
                      LeastBall(what.field, kHapticBallSamples * kSpacingMm, balls), balls, options));
}

}  // namespace

engine::Result<HapticBenchReport> benchHaptic(const HapticBenchOptions& options, engine::JobControl& job) {
  if (options.side < 64 || options.side > 32768 || options.ticks < 10 || options.ticks > 100'000'000 ||
      options.repeats < 1 || options.repeats > 100 || options.speeds_mm_s.empty() ||
      !std::all_of(options.speeds_mm_s.begin(), options.speeds_mm_s.end(),
                   [](double speed) { return speed > 0.0 && speed <= 1e4; }))
    return engine::inputError("an option of the benchmark is out of range", "bench haptic",
                              "side 64 to 32768, ticks 10 to 1e8, repeats 1 to 100, speeds above 0 to 10000");
  HapticBenchReport report;
  report.machine = machine();
  report.copy_bytes_per_s = copyBytesPerSecond();
  constexpr std::int32_t kSmallSide = 1024;
  constexpr double kSpeed = 20.0;
  const engine::Version part = trials::workpiece(options.side, kSpacingMm);
  for (const double speed : options.speeds_mm_s)
    if (auto done = touch({"rough part", part, speed, options.ticks}, options, job, report); !done)
      return tl::unexpected(done.error());
  const engine::Version clean = trials::workpiece(std::min(options.side, kSmallSide), kSpacingMm, 0.0);
  if (auto done = touch({"clean part", clean, kSpeed, options.ticks}, options, job, report); !done)
    return tl::unexpected(done.error());
  for (const HardGround& ground : kHardGrounds) {
    const engine::Version hard = makeGround(ground, std::min(options.side, kSmallSide), kSpacingMm);
    if (auto done = touch({ground.name, hard, kSpeed, options.ticks}, options, job, report); !done)
      return tl::unexpected(done.error());
  }
  return report;
}

}  // namespace fettle::bench
