#include "bench/preview_bench.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/base/stopwatch.h"
#include "engine/filter/filter_view.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {
namespace {

// As the window's thread looks at it, but for drawing.
constexpr std::chrono::milliseconds kFrame{1};

engine::Result<PreviewBenchRow> preview(const engine::Version& field, const engine::FilterSpec& spec,
                                        const engine::FieldView& seen, double limit_s,
                                        engine::JobControl& job) {
  PreviewBenchRow row;
  row.side = field.grid().width;
  row.seen = seen.tiles.tiles() * engine::kTileSamples;
  const bool all = seen.tiles == engine::allTiles(field.grid());
  engine::JobControl part = engine::JobControl::partOf(job);
  engine::Result<engine::FilterView::Done> result = engine::cancelled();
  std::atomic<bool> ended{false};
  const engine::Stopwatch watch;
  engine::FilterView view(field, field, seen);
  std::jthread worker([&] {
    result = view.run(spec, part);
    // Release: publishes the result.
    ended.store(true, std::memory_order_release);
  });
  while (true) {
    // Before the picture: the last one is looked at.
    const bool last = ended.load(std::memory_order_acquire);
    const engine::FilterView::Picture now = view.picture();
    if (!now.field.empty()) {
      if (row.first == 0.0 && now.untouched == 0.0) {
        row.first = watch.seconds();
        row.step = now.step;
      }
      if (row.exact == 0.0 && now.exact == 1.0) row.exact = watch.seconds();
      if (now.off) {
        row.off_rms = now.off->rms;
        row.off_most = now.off->most;
        row.estimated = now.off->estimated;
      }
    }
    if (last) break;
    if (watch.seconds() > limit_s || (!all && row.exact > 0.0)) part.cancel();
    std::this_thread::sleep_for(kFrame);
  }
  worker.join();
  if (job.cancelled()) return engine::cancelled();
  if (result) {
    if (all) row.whole = watch.seconds();
    row.change_rms = result->filtered.report.rms_change;
  } else if (result.error().kind != engine::ErrorKind::kCancelled) {
    return tl::unexpected(result.error());
  }
  return row;
}

}  // namespace

engine::FieldView middleView(const engine::Grid& grid, std::int32_t columns, std::int32_t rows) {
  const auto tilesOf = [](std::int32_t side, std::int32_t seen) {
    const std::int32_t first = (side - std::min(side, seen)) / 2, end = first + std::min(side, seen);
    return std::pair{first / engine::kTileSide,
                     (end + engine::kTileSide - 1) / engine::kTileSide - first / engine::kTileSide};
  };
  const auto [c, across] = tilesOf(grid.width, columns);
  const auto [r, up] = tilesOf(grid.height, rows);
  return {{c, r, across, up}, grid.width / 2, grid.height / 2};
}

engine::Result<PreviewBenchReport> benchPreviews(const PreviewBenchOptions& options,
                                                 engine::JobControl& job) {
  for (const int side : options.sides)
    if (side < 256 || side > 32768)
      return engine::inputError("a side is out of range", "bench previews", "256 to 32768");
  if (!(options.limit_s > 0.0 && options.limit_s <= 1e6))
    return engine::inputError("the limit is out of range", "bench previews", "more than 0, to 1e6");
  PreviewBenchReport report;
  report.machine = machine();
  for (const int side : options.sides) {
    const engine::Version field = trials::workpiece(side, kSpacingMm);
    const engine::Grid& grid = field.grid();
    for (const engine::FilterKind kind : options.kinds) {
      engine::FilterSpec spec;
      spec.kind = kind;
      const engine::Filter& filter = engine::filterOf(kind);
      if (filter.window.exists()) spec.window = options.window;
      spec.nesting_mm = engine::usualNesting(filter, grid);
      for (const engine::FieldView& seen : {middleView(grid, side, side), middleView(grid, 1280, 800)}) {
        auto row = preview(field, spec, seen, options.limit_s, job);
        if (!row) return tl::unexpected(row.error());
        row->filter = filter.window.exists() ? fmt::format("{} {}", filter.word, spec.window)
                                             : std::string(filter.word);
        report.rows.push_back(*std::move(row));
      }
    }
    if (auto done = benchHeightPreviews(side, options.fill, options.level, report.heights, job); !done)
      return tl::unexpected(done.error());
  }
  return report;
}

}  // namespace fettle::bench
