#include "bench/growth_bench.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/commit_times.h"
#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/field/live_field.h"
#include "engine/field/tile.h"
#include "engine/filter/catalogue.h"
#include "engine/history/history.h"
#include "haptic/base/rt_thread.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"
#include "render/live/live_picture.h"

namespace fettle::bench {
namespace {

constexpr double kTicks = 50'000;
constexpr int kWindows[] = {3, 5, 11, 21, 41, 101};
constexpr double kBrushes[] = {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0};
constexpr double kWindowSide = 1024;  // of the field for the windows
constexpr std::int32_t kBrushSide = 1024;

GrowthPoint pointOf(double work, std::vector<double> costs) {
  std::sort(costs.begin(), costs.end());
  return {work, costs[costs.size() / 2], costs.back()};
}

void add(Growth& growth, const std::string& series, const GrowthPoint& point, double target = 0.0) {
  for (GrowthSeries& s : growth.series)
    if (s.name == series) return s.points.push_back(point);
  growth.series.push_back({series, {point}, 0.0, target});
}

// Nanoseconds per tick, without timing single ticks: all strokes, three times.
GrowthPoint ticks(const engine::Version& field, const haptic::Scene& scene, haptic::Tool tool, double work,
                  double effort) {
  trials::HandMotion motion;
  motion.ticks = std::llround(kTicks * effort);
  motion.speed_mm_s = 20.0;
  motion.tool = tool;
  const std::vector<haptic::StrokeSample> strokes = trials::handStroke(field, motion);
  std::vector<double> ns;
  const haptic::DenormalScope as_in_the_loop;
  for (int i = 0; i < 3; ++i) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, field);
    ns.push_back(1e9 / static_cast<double>(strokes.size()) * secondsOf([&] {
                   for (const haptic::StrokeSample& s : strokes) (void)tick.run(s);
                 }));
  }
  return pointOf(work, std::move(ns));
}

// A snapshot, the first edit after it, which copies a tile and its nodes, and an undo of that edit.
void versions(const engine::Version& field, double work, double effort, Growth& growth) {
  constexpr int kParts = 5;
  const int rounds = std::max(20, static_cast<int>(2000 * effort));
  std::vector<double> snapshot, edit, undo;
  engine::LiveField live(field, engine::Growth::kAllowed);
  const engine::Grid& grid = field.grid();
  for (int part = 0; part < kParts; ++part) {
    double taken = 0.0, edited = 0.0, undone = 0.0;
    for (int i = 0; i < rounds; ++i) {
      const auto column = static_cast<std::int32_t>(static_cast<std::int64_t>(i) * 7919 % grid.width);
      const auto row = static_cast<std::int32_t>(static_cast<std::int64_t>(i) * 104729 % grid.height);
      engine::Version before;
      taken += secondsOf([&] { before = live.snapshot(); });
      engine::History history(before);
      edited += secondsOf([&] { (void)live.setHeight(column, row, 1.0F + static_cast<float>(i)); });
      (void)history.push({}, live.snapshot());
      undone += secondsOf([&] { (void)live.adopt(*history.undo()); });
    }
    snapshot.push_back(1e9 * taken / rounds);
    edit.push_back(1e9 * edited / rounds);
    undo.push_back(1e9 * undone / rounds);
  }
  add(growth, "snapshot", pointOf(work, std::move(snapshot)), 1e4);
  add(growth, "edit of a sample", pointOf(work, std::move(edit)));
  add(growth, "undo", pointOf(work, std::move(undo)), 1e6);
}

// Writing a stroke to the disk.
engine::Status commits(const engine::Version& field, double work, double effort, Growth& growth,
                       engine::JobControl& job) {
  engine::JobControl quiet;
  auto times = commitTimes(field, std::max(3, static_cast<int>(100 * effort)), quiet);
  if (!times) return tl::unexpected(times.error());
  if (job.cancelled()) return engine::cancelled();
  add(growth, "on the disk", pointOf(work, std::move(times->durable_ms)), 1e3);
  add(growth, "the window waits", pointOf(work, std::move(times->waits_ms)));
  return {};
}

engine::Result<GrowthPoint> filtering(const engine::Version& field, engine::FilterKind kind, int window,
                                      int threads, double work, double unit, engine::JobControl& job) {
  engine::FilterSpec spec;
  spec.kind = kind;
  spec.window = window;
  spec.threads = threads;
  std::vector<double> costs;
  for (int i = 0; i < 3; ++i) {
    if (job.cancelled()) return engine::cancelled();
    engine::Status status;
    engine::JobControl quiet;
    costs.push_back(unit * secondsOf([&] {
                      const auto done = engine::applyFilter(field, field, spec, quiet);
                      if (!done) status = tl::unexpected(done.error());
                    }));
    if (!status) return tl::unexpected(status.error());
    if (costs.back() > 5.0 * unit) break;  // one repeat is enough
  }
  return pointOf(work, std::move(costs));
}

// Tiles changed by one sample each, until the picture shows them.
engine::Result<Growth> uploads(engine::JobControl& job) {
  Growth growth{"upload",
                "Uploading",
                "changed tiles",
                "time on the drawing thread [ms]",
                "1: only changes are compared and moved",
                {}};
  const engine::Version start = trials::workpiece(4096, kSpacingMm);
  auto created = render::LivePicture::create();
  if (!created) return tl::unexpected(created.error());
  render::LivePicture& picture = **created;
  render::FrameInput input;
  input.view.width = 640;
  input.view.height = 480;
  engine::LiveField live(start, engine::Growth::kAllowed);
  const auto upload = [&]() -> engine::Result<double> {
    if (auto ok = picture.update(live.snapshot()); !ok) return tl::unexpected(ok.error());
    double ms = 0.0;
    for (int i = 0; i < 10'000; ++i) {
      const auto frame = picture.drawAndWait(input);
      if (!frame) return tl::unexpected(frame.error());
      ms += frame->upload.ms;
      if (frame->upload.pending_tiles == 0) break;
    }
    return ms;
  };
  if (const auto first = upload(); !first) return tl::unexpected(first.error());
  const std::int32_t side = start.grid().width >> engine::kTileShift;
  float height = 0.0F;
  for (std::int32_t tiles = 1; tiles <= side * side; tiles *= 4) {
    std::vector<double> ms;
    for (int i = 0; i < 5; ++i) {
      if (job.cancelled()) return engine::cancelled();
      height += 0.01F;
      for (std::int32_t t = 0; t < tiles; ++t)
        (void)live.setHeight((t % side) << engine::kTileShift, (t / side) << engine::kTileShift, height);
      const auto took = upload();
      if (!took) return tl::unexpected(took.error());
      ms.push_back(*took);
    }
    add(growth, "one sample per tile", pointOf(tiles, std::move(ms)));
  }
  return growth;
}

}  // namespace

double slopeOf(const std::vector<GrowthPoint>& points) {
  if (points.size() < 2) return 0.0;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const GrowthPoint& p : points) {
    const double a = std::log(p.work), b = std::log(p.median);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  const auto n = static_cast<double>(points.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

engine::Result<GrowthReport> benchGrowth(const GrowthOptions& options, engine::JobControl& job) {
  if (options.largest < 256 || options.largest > 32768)
    return engine::inputError("the largest side is out of range", "bench growth", "256 to 32768");
  if (!(options.effort >= 0.01 && options.effort <= 1.0))
    return engine::inputError("the effort is out of range", "bench growth", "0.01 to 1");
  using engine::FilterKind;
  const std::vector<FilterKind> kinds = engine::plainFilters();
  GrowthReport report;
  report.machine = machine();
  report.copy_bytes_per_s = copyBytesPerSecond();
  Growth tick{"tick",
              "A tick over the field's size",
              "samples of the field",
              "time per tick [ns]",
              "0: a tick only reads samples near the tip",
              {}};
  Growth version{"version",   "Versions over the field's size", "samples of the field",
                 "time [ns]", "0: a tree of shared tiles",      {}};
  Growth commit{"commit",    "A stroke kept in the session over the field's size", "samples of the field",
                "time [ms]", "0: only what the stroke changed is written",         {}};
  Growth filter{"filter",
                "Filters over the field's size",
                "samples of the field",
                "time, all cores [ms]",
                "1: each sample is read and written once",
                {}};
  Growth window{"window",
                "Filters over the window",
                "side of the window [samples]",
                "time per sample, one core [ns]",
                "box 0 (running sums), Gaussian 1 (rows, then columns), median 0 for large windows",
                {}};
  Growth brush{"brush",
               "A tick over the brush",
               "radius of the brush [samples]",
               "time per tick [ns]",
               "2: every sample within is smoothed in the tick",
               {}};

  std::vector<std::int32_t> sides;
  for (std::int32_t side = options.largest; side >= 256; side /= 2) sides.push_back(side);
  job.begin("growth", sides.size() + std::size(kWindows) + std::size(kBrushes) + 1);
  haptic::Scene scene = haptic::defaultScene();
  for (auto side = sides.rbegin(); side != sides.rend(); ++side) {
    if (job.cancelled()) return engine::cancelled();
    const engine::Version field = trials::workpiece(*side, kSpacingMm);
    const double samples = static_cast<double>(*side) * *side;
    add(tick, "feel", ticks(field, scene, haptic::Tool::kFeel, samples, options.effort));
    add(tick, "3 x 3 smoothing", ticks(field, scene, haptic::Tool::kSmooth, samples, options.effort));
    versions(field, samples, options.effort, version);
    if (engine::Status kept = commits(field, samples, options.effort, commit, job); !kept)
      return tl::unexpected(kept.error());
    for (const FilterKind kind : kinds) {
      const auto point = filtering(field, kind, 11, 0, samples, 1e3, job);
      if (!point) return tl::unexpected(point.error());
      add(filter, fmt::format("{} 11 x 11", engine::name(kind)), *point);
    }
    job.advance();
  }
  {
    const auto window_side = static_cast<std::int32_t>(kWindowSide * std::sqrt(options.effort));
    const double samples = static_cast<double>(window_side) * window_side;
    const engine::Version field = trials::workpiece(window_side, kSpacingMm);
    for (const int side : kWindows) {
      for (const FilterKind kind : kinds) {
        const auto point = filtering(field, kind, side, 1, side, 1e9 / samples, job);
        if (!point) return tl::unexpected(point.error());
        add(window, std::string(engine::name(kind)), *point);
      }
      job.advance();
    }
  }
  {
    const engine::Version field = trials::workpiece(kBrushSide, kSpacingMm);
    for (const double radius : kBrushes) {
      if (job.cancelled()) return engine::cancelled();
      scene.brush_radius_samples = radius;
      add(brush, "smoothing", ticks(field, scene, haptic::Tool::kSmooth, radius, options.effort));
      job.advance();
    }
  }
  report.growths = {std::move(tick),   std::move(version), std::move(commit),
                    std::move(filter), std::move(window),  std::move(brush)};
  if (options.picture) {
    auto upload = uploads(job);
    if (!upload) return tl::unexpected(upload.error());
    report.growths.push_back(*std::move(upload));
  }
  job.advance();
  for (Growth& growth : report.growths)
    for (GrowthSeries& series : growth.series) series.slope = slopeOf(series.points);
  return report;
}

}  // namespace fettle::bench
