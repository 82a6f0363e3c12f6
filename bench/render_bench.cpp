#include "bench/render_bench.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/machine.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "render/live_picture.h"

namespace fettle::bench {
namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double cpuMs() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return 1e3 * static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-3 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

double noise(std::int32_t c, std::int32_t r) {
  auto h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return (h >> 8U) / 8388608.0 - 1.0;
}

// 64 mm wide at any number of samples: a tilted plate with a boss, a groove, a dome and 5 um of noise.
engine::Result<engine::Version> partOf(std::int32_t side) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = 64.0 / side;
  auto builder = engine::FieldBuilder::create(grid, "benchmark field");
  if (!builder) return tl::unexpected(builder.error());
  std::vector<float> row(static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r) {
    for (std::int32_t c = 0; c < side; ++c) {
      const double x = c * grid.spacing_x, y = r * grid.spacing_y;
      double z = 0.02 * x + 0.005 * noise(c, r);
      if (std::hypot(x - 18, y - 40) < 9) z += 5;
      if (y > 8 && y < 12) z -= 3;
      const double dome = std::hypot(x - 45, y - 35);
      if (dome < 12) z += 0.5 * std::sqrt(144 - dome * dome);
      row[static_cast<std::size_t>(c)] = static_cast<float>(z);
    }
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return (*std::move(builder)).build();
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

std::uint64_t hashOf(const render::Image& image) {
  std::uint64_t h = 14695981039346656037ULL;  // FNV-1a (Fowler, Noll, Vo)
  for (const std::uint8_t byte : image.rgba) h = (h ^ byte) * 1099511628211ULL;
  return h;
}

enum class Brush { kRests, kWorks };

engine::Result<RenderBenchRow> run(render::LivePicture& picture, const render::Shown& shown,
                                   render::FrameInput input, const std::string& name, Brush brush,
                                   const RenderBenchOptions& options, engine::JobControl& job) {
  RenderBenchRow row;
  row.name = name;
  row.samples = shown.versions.front().grid().samples();
  if (auto ok = picture.update(shown); !ok) return tl::unexpected(ok.error());
  // The first frames bring over what is pending and compile shaders.
  for (int i = 0; i < 3 || i < 2000; ++i) {
    const auto warm = picture.drawAndWait(input);
    if (!warm) return tl::unexpected(warm.error());
    if (i >= 2 && warm->upload.pending_tiles == 0) break;
  }
  engine::LiveField live(shown.versions.front(), engine::Growth::kAllowed);
  const std::int32_t side = live.grid().width;
  std::vector<double> frames, uploads;
  double cpu = 0.0;
  std::int64_t bytes = 0, changed = 0;
  std::vector<float> patch(31 * 31);
  for (int i = 0; i < options.frames; ++i) {
    if (job.cancelled()) return engine::cancelled();
    input.view.azimuth_deg = 315.0 + 360.0 * i / options.frames;
    const double cpu_before = cpuMs();
    const auto start = Clock::now();
    double update_ms = 0.0;
    if (brush == Brush::kWorks) {
      const auto at = static_cast<std::int32_t>(side / 4 + (side / 2 - 40) * i / options.frames);
      live.reader().readHeights(at, at, 31, 31, patch.data(), 31);
      for (float& z : patch) z += 0.01F;
      if (!live.writeHeights(at, at, 31, 31, patch.data(), 31))
        return tl::unexpected(
            engine::failure("memory is exhausted", "benchmark", "use smaller fields").value());
      render::Shown next = shown;
      next.versions = {live.snapshot()};
      const auto update_start = Clock::now();
      if (auto ok = picture.update(next); !ok) return tl::unexpected(ok.error());
      update_ms = msSince(update_start);
    }
    const auto stats = picture.drawAndWait(input);
    if (!stats) return tl::unexpected(stats.error());
    frames.push_back(msSince(start));
    cpu += cpuMs() - cpu_before;
    uploads.push_back(brush == Brush::kWorks ? std::max(update_ms, stats->upload.ms) : 0.0);
    bytes += stats->upload.bytes;
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
  row.upload_ms = percentile(uploads, 0.5);
  row.upload_ratio = changed > 0 ? static_cast<double>(bytes) / (4.0 * static_cast<double>(changed)) : 0.0;
  render::Image image;
  if (const auto last = picture.draw(input, image); !last) return tl::unexpected(last.error());
  row.hash = hashOf(image);
  return row;
}

}  // namespace

engine::Result<RenderBenchReport> benchRender(const RenderBenchOptions& options, engine::JobControl& job) {
  if (options.frames < 10 || options.frames > 100000 || options.sides.empty())
    return engine::inputError("the number of frames or sides is out of range", "bench render",
                              "give 10 to 100000 frames and a side or more");
  for (const std::int32_t side : options.sides)
    if (side < 64 || side > 16384)
      return engine::inputError("a side is out of range", "bench render", "give 64 to 16384 samples");
  RenderBenchReport report;
  report.machine = machine();
  auto picture = render::LivePicture::create();
  if (!picture) return tl::unexpected(picture.error());
  report.device = (*picture)->device();
  render::FrameInput plain;
  plain.view.width = options.width;
  plain.view.height = options.height;
  plain.error_px = options.error_px;
  plain.vertex_budget = options.vertex_budget;
  const std::size_t effects_at = std::min<std::size_t>(1, options.sides.size() - 1);
  job.begin("drawing", static_cast<std::uint64_t>(options.frames) * (2 * options.sides.size() + 3));
  for (std::size_t i = 0; i < options.sides.size(); ++i) {
    const auto field = partOf(options.sides[i]);
    if (!field) return tl::unexpected(field.error());
    render::Shown shown;
    shown.versions = {*field};
    const auto start = Clock::now();
    if (auto ok = (*picture)->update(shown); !ok) return tl::unexpected(ok.error());
    (*picture)->finish();
    report.first_ms.push_back(msSince(start));
    const auto add = [&](const render::Shown& what, const render::FrameInput& input, const std::string& name,
                         Brush brush) -> engine::Status {
      auto row = run(**picture, what, input, name, brush, options, job);
      if (!row) return tl::unexpected(row.error());
      report.rows.push_back(*std::move(row));
      return {};
    };
    if (auto ok = add(shown, plain, "plain", Brush::kRests); !ok) return tl::unexpected(ok.error());
    if (auto ok = add(shown, plain, "brush works", Brush::kWorks); !ok) return tl::unexpected(ok.error());
    if (i != effects_at) continue;
    render::FrameInput contours = plain;
    contours.contours = render::Contours::kShow;
    render::Shown marks = shown, deviation = shown;
    marks.marks = render::MarksOverlay::kShow;
    deviation.original = *field;
    if (auto ok = add(shown, contours, "contours", Brush::kRests); !ok) return tl::unexpected(ok.error());
    if (auto ok = add(deviation, plain, "deviation", Brush::kRests); !ok) return tl::unexpected(ok.error());
    if (auto ok = add(marks, plain, "marks", Brush::kRests); !ok) return tl::unexpected(ok.error());
  }
  return report;
}

}  // namespace fettle::bench
