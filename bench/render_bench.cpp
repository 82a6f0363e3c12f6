#include "bench/render_bench.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "bench/machine.h"
#include "bench/render_scenes.h"
#include "engine/base/stopwatch.h"
#include "engine/field/live_field.h"
#include "haptic/loop/loop_bench.h"

namespace fettle::bench {
namespace {

double cpuMs() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return 1e3 * static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-3 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

std::int64_t peakBytes() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return std::int64_t{use.ru_maxrss} * 1024;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

std::uint64_t hashOf(const render::Image& image) {
  std::uint64_t h = 14695981039346656037ULL;  // FNV-1a (Fowler, Noll, Vo)
  for (const std::uint8_t byte : image.rgba) h = (h ^ byte) * 1099511628211ULL;
  return h;
}

// The error of half resolution: the same view at both resolutions, from twelve sides.
engine::Status compareSharp(render::LivePicture& picture, const render::FrameInput& moving,
                            RenderBenchRow& row) {
  constexpr int kSides = 12;
  std::uint64_t sum = 0, above = 0, pixels = 0;
  int worst = 0;
  for (int side = 0; side < kSides; ++side) {
    render::FrameInput input = moving;
    input.view.azimuth_deg = 315.0 + 360.0 * side / kSides;
    render::Image half, full;
    if (const auto drawn = picture.draw(input, half); !drawn) return tl::unexpected(drawn.error());
    input.sharpness = render::Sharpness::kFull;
    if (const auto drawn = picture.draw(input, full); !drawn) return tl::unexpected(drawn.error());
    for (std::size_t i = 0; i < full.rgba.size(); i += 4) {
      int off = 0;
      for (std::size_t k = i; k < i + 3; ++k) off = std::max(off, std::abs(half.rgba[k] - full.rgba[k]));
      sum += static_cast<std::uint64_t>(off);
      above += off > 16;
      worst = std::max(worst, off);
      ++pixels;
    }
  }
  row.off_mean = static_cast<double>(sum) / static_cast<double>(pixels);
  row.off_share = static_cast<double>(above) / static_cast<double>(pixels);
  row.off_max = worst;
  return {};
}

engine::Result<RenderBenchRow> run(render::LivePicture& picture, const Scene& scene,
                                   const RenderBenchOptions& options, engine::JobControl& job) {
  const render::Shown& shown = scene.shown;
  render::FrameInput input = scene.input;
  const bool works = scene.brush == Brush::kWorks;
  const bool edits_picture = works || scene.other;
  RenderBenchRow row;
  row.name = scene.name;
  row.samples = shown.versions.front().grid().samples();
  if (auto ok = picture.update(shown); !ok) return tl::unexpected(ok.error());
  // The first frames upload pending data and compile shaders.
  for (int i = 0; i < 3 || i < 2000; ++i) {
    const auto warm = picture.drawAndWait(input);
    if (!warm) return tl::unexpected(warm.error());
    if (i >= 2 && warm->upload.pending_tiles == 0) break;
  }
  engine::LiveField live(shown.versions.front(), engine::Growth::kAllowed);
  const std::int32_t side = live.grid().width;
  std::vector<double> frames, uploads, edits;
  double cpu = 0.0, redrawn = 0.0;
  std::int64_t bytes = 0, changed = 0;
  std::vector<float> patch(31 * 31);
  for (int i = 0; i < options.frames; ++i) {
    if (job.cancelled()) return engine::cancelled();
    if (scene.camera == Camera::kOrbits) input.view.azimuth_deg = 315.0 + 360.0 * i / options.frames;
    if (scene.camera == Camera::kRests && i % render::kRestBands == 0) {
      input.view.azimuth_deg += 360.0 * render::kRestBands / options.frames;
      if (const auto turned = picture.drawAndWait(input); !turned) return tl::unexpected(turned.error());
    }
    if (scene.stylus != Stylus::kNone)
      putStylus(scene.stylus, static_cast<double>(i) / options.frames, input.overlays);
    double cpu_before = cpuMs();
    engine::Stopwatch watch;
    double update_ms = 0.0;
    if (scene.other) {
      render::Shown next = shown;
      if (i % 2 == 0) next.versions = {*scene.other};
      if (auto ok = picture.update(next); !ok) return tl::unexpected(ok.error());
      update_ms = watch.ms();
    }
    if (works) {
      const auto at = static_cast<std::int32_t>(side / 4 + (side / 2 - 40) * i / options.frames);
      live.reader().readHeights(at, at, 31, 31, patch.data(), 31);
      for (float& z : patch) z += 0.01F;
      if (!live.writeHeights(at, at, 31, 31, patch.data(), 31))
        return tl::unexpected(
            engine::failure("memory is exhausted", "benchmark", "use smaller fields").value());
      render::Shown next = shown;
      next.versions = {live.snapshot()};
      // The edit belongs to the haptic loop and is not measured.
      cpu_before = cpuMs();
      watch = {};
      if (auto ok = picture.update(next); !ok) return tl::unexpected(ok.error());
      update_ms = watch.ms();
    }
    const auto stats = picture.drawAndWait(input);
    if (!stats) return tl::unexpected(stats.error());
    frames.push_back(watch.ms());
    if (edits_picture) edits.push_back(frames.back());
    redrawn += stats->redrawn;
    cpu += cpuMs() - cpu_before;
    uploads.push_back(edits_picture ? std::max(update_ms, stats->upload.ms) : 0.0);
    bytes += stats->upload.bytes;
    row.tiles += stats->upload.tiles;
    changed += stats->upload.changed_samples;
    row.stalls += stats->upload.stalls;
    row.vertices = stats->vertices;
    row.triangles = stats->triangles;
    row.bound_px = std::max(row.bound_px, stats->bound_px);
    job.advance();
  }
  row.p50_ms = percentile(frames, 0.5);
  row.p99_ms = percentile(frames, 0.99);
  row.worst_ms = percentile(frames, 1.0);
  row.cpu_ms = cpu / options.frames;
  row.redrawn = redrawn / options.frames;
  row.bytes = bytes;
  if (edits_picture) {
    row.edit_p50_ms = percentile(edits, 0.5);
    row.edit_p99_ms = percentile(edits, 0.99);
  }
  row.upload_ms = percentile(uploads, 0.5);
  row.upload_ratio = changed > 0 ? static_cast<double>(bytes) / (4.0 * static_cast<double>(changed)) : 0.0;
  render::Image image;
  if (const auto last = picture.draw(input, image); !last) return tl::unexpected(last.error());
  row.hash = hashOf(image);
  if (input.sharpness == render::Sharpness::kHalf)
    if (auto ok = compareSharp(picture, input, row); !ok) return tl::unexpected(ok.error());
  return row;
}

// Frames from all sides while the loop runs on its own thread.
engine::Status drawWithLoop(render::LivePicture& picture, const Scene& scene, double seconds,
                            RenderWithLoop& out) {
  if (auto ok = picture.update(scene.shown); !ok) return ok;
  haptic::LoopBenchOptions options;
  options.seconds = seconds;
  engine::JobControl quiet;
  std::optional<engine::Result<haptic::LoopBenchReport>> loop;
  std::atomic<bool> ended{false};
  std::thread hand([&] {
    loop = haptic::benchLoop(options, quiet);
    ended.store(true, std::memory_order_release);  // publishes `loop`
  });
  std::vector<double> frames;
  engine::Status failed;
  render::FrameInput input = scene.input;
  while (!ended.load(std::memory_order_acquire)) {
    input.view.azimuth_deg = 315.0 + 3.0 * static_cast<double>(frames.size() % 120);
    const engine::Stopwatch watch;
    if (const auto stats = picture.drawAndWait(input); !stats) {
      failed = tl::unexpected(stats.error());
      quiet.cancel();
      break;
    }
    frames.push_back(watch.ms());
  }
  hand.join();
  if (!failed) return failed;
  if (!*loop) return tl::unexpected(loop->error());
  const haptic::LoopBenchReport& report = **loop;
  out.ran = !frames.empty();
  if (!out.ran) return {};
  out.frame_p50_ms = percentile(frames, 0.5);
  out.frame_p99_ms = percentile(frames, 0.99);
  const haptic::TimingFigures& late = report.loop.lateness;
  out.late_p50_us = 1e-3 * static_cast<double>(late.p50_ns);
  out.late_p99_us = 1e-3 * static_cast<double>(late.p99_ns);
  out.late_p999_us = 1e-3 * static_cast<double>(late.p999_ns);
  out.p99_ratio = report.p99_ratio;
  out.p999_ratio = report.p999_ratio;
  return {};
}

// The budgets' figures (shared budgets, "Picture"), of this run.
std::vector<RenderTarget> targetsOf(const RenderBenchReport& report, render::Sharpness in_motion) {
  constexpr double kFrame_ms = 1000.0 / 60.0;
  std::vector<RenderTarget> targets;
  for (const RenderBenchRow& row : report.rows) {
    const std::string at = fmt::format("{:.0f}M", static_cast<double>(row.samples) / 1e6);
    const bool half = in_motion == render::Sharpness::kHalf;
    if (row.name == (half ? "moving" : "plain")) {
      const std::string what = half ? " moving frame, half as sharp, " : " moving frame, every pixel, ";
      targets.push_back({at + what + "p50 ms", row.p50_ms, 16.0});
      targets.push_back({at + what + "p99 ms", row.p99_ms, 33.0});
    }
    if (row.name == "brush, still") {
      targets.push_back({at + " edit to pixel p99, frames of 1/60 s", row.edit_p99_ms / kFrame_ms, 2.0});
      targets.push_back({at + " bytes moved over changed", row.upload_ratio, 1.2});
    }
  }
  if (report.loop.ran) {
    targets.push_back({"loop lateness p99 over cyclictest", report.loop.p99_ratio, 1.2});
    targets.push_back({"loop lateness p99.9 over cyclictest", report.loop.p999_ratio, 1.2});
  }
  return targets;
}

}  // namespace

engine::Result<RenderBenchReport> benchRender(const RenderBenchOptions& options, engine::JobControl& job) {
  if (options.frames < 10 || options.frames > 100000 || options.sides.empty())
    return engine::inputError("the number of frames or sides is out of range", "bench render",
                              "give 10 to 100000 frames and a side or more");
  for (const std::int32_t side : options.sides)
    if (side < 64 || side > 32768)
      return engine::inputError("a side is out of range", "bench render", "give 64 to 32768 samples");
  if (std::min(options.width, options.height) < 64 || std::max(options.width, options.height) > 16384)
    return engine::inputError("the size of the picture is out of range", "bench render",
                              "give 64x64 to 16384x16384 pixels");
  if (!(options.loop_seconds >= 0.0 && options.loop_seconds <= 600.0))
    return engine::inputError("the time with the loop is out of range", "bench render", "give 0 to 600 s");
  RenderBenchReport report;
  report.machine = machine();
  render::LiveOptions live;
  live.memory_budget_bytes = options.memory_budget_bytes;
  auto picture = render::LivePicture::create(live);
  if (!picture) return tl::unexpected(picture.error());
  report.device = (*picture)->device();
  render::FrameInput plain;
  plain.view.width = options.width;
  plain.view.height = options.height;
  plain.error_px = options.error_px;
  plain.vertex_budget = options.vertex_budget;
  job.begin("drawing", static_cast<std::uint64_t>(options.frames) * (11 * options.sides.size() + 20));
  for (std::size_t i = 0; i < options.sides.size(); ++i) {
    const auto field = benchPart(options.sides[i]);
    if (!field) return tl::unexpected(field.error());
    Scene all_round = plainScene(*field, plain);
    const engine::Stopwatch watch;
    if (auto ok = (*picture)->update(all_round.shown); !ok) return tl::unexpected(ok.error());
    for (bool first = true, rests = false; !rests; first = false) {
      const auto frame = (*picture)->drawAndWait(plain);
      if (!frame) return tl::unexpected(frame.error());
      if (first) report.first_ms.push_back(watch.ms());
      rests = frame->upload.pending_tiles == 0;
      if (job.cancelled()) return engine::cancelled();
    }
    report.rest_ms.push_back(watch.ms());

    const auto scenes =
        renderScenes(*field, plain, options.in_motion, i == 0 ? SceneSet::kAll : SceneSet::kFrames, job);
    if (!scenes) return tl::unexpected(scenes.error());
    double plain_cpu_ms = 0.0;
    for (const Scene& scene : *scenes) {
      if (!options.scenes.empty() &&
          std::find(options.scenes.begin(), options.scenes.end(), scene.name) == options.scenes.end())
        continue;
      auto row = run(**picture, scene, options, job);
      if (!row) return tl::unexpected(row.error());
      if (scene.name == "plain") plain_cpu_ms = row->cpu_ms;
      row->of_plain = plain_cpu_ms > 0.0 ? row->cpu_ms / plain_cpu_ms : 0.0;
      report.rows.push_back(*std::move(row));
    }
    all_round.input.sharpness = options.in_motion;
    all_round.input.form = render::kShownForm;
    if (i == 0 && options.loop_seconds > 0.0)
      if (auto ok = drawWithLoop(**picture, all_round, options.loop_seconds, report.loop); !ok)
        return tl::unexpected(ok.error());
  }
  report.peak_bytes = peakBytes();
  // The targets are of the usual size.
  if (options.width == RenderBenchOptions().width && options.height == RenderBenchOptions().height)
    report.targets = targetsOf(report, options.in_motion);
  return report;
}

}  // namespace fettle::bench
