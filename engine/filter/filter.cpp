#include "engine/filter/filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/filter_work.h"
#include "engine/filter/line_windows.h"
#include "engine/filter/pass.h"
#include "engine/filter/tgv_device.h"

namespace fettle::engine {

namespace {

// Of the samples below a node whose first tile is (tc, tr). Tiles without a hole are not looked at: on the
// disk, each would be a page to wait for.
std::int64_t notHolesBelow(const Node& node, std::int32_t tc, std::int32_t tr, const Grid& grid) noexcept {
  const std::int32_t tiles_a_child = 1 << (3 * (node.level - 2));
  const std::int64_t samples_a_child = std::int64_t{tiles_a_child} * kTileSide;
  std::int64_t n = 0;
  for (int k = 0; k < kFanOut; ++k) {
    if (node.children[k] == nullptr) continue;
    const std::int32_t column = tc + k % 8 * tiles_a_child;
    const std::int32_t row = tr + k / 8 * tiles_a_child;
    if ((node.holed_children >> k & 1) == 0)
      n += std::min(samples_a_child, grid.width - std::int64_t{column} * kTileSide) *
           std::min(samples_a_child, grid.height - std::int64_t{row} * kTileSide);
    else if (node.level == 2)
      n += kTileSamples - std::int64_t{static_cast<const Tile*>(node.children[k])->nan_samples};
    else
      n += notHolesBelow(*static_cast<const Node*>(node.children[k]), column, row, grid);
  }
  return n;
}

std::int64_t samplesThatAreNotHoles(const Version& version) noexcept {
  return notHolesBelow(version.reader().root(), 0, 0, version.grid());
}

// The reports of tiles put together, in their order.
FilterReport total(const std::vector<TileReport>& tiles, std::int64_t samples) noexcept {
  FilterReport report;
  double squares = 0.0;
  for (const TileReport& tile : tiles) {
    report.changed += tile.changed;
    report.max_change = std::max(report.max_change, tile.max_change);
    squares += tile.squares;
  }
  report.samples = samples;
  if (samples > 0) report.rms_change = std::sqrt(squares / static_cast<double>(samples));
  return report;
}

// Compares the result of several passes with the input, and shares again the tiles that came back to what
// they were.
Result<Filtered> compared(const Version& input, Version result) {
  const std::vector<TileChange> changes = changedTiles(input, result);
  std::vector<TileReport> reports(changes.size());
  const CpuLevel level = bestCpuLevel();
  tbb::parallel_for(std::size_t{0}, changes.size(), [&](std::size_t i) {
    reports[i] = compareTiles(*changes[i].before, *changes[i].after, level);
  });

  Filtered filtered;
  filtered.report = total(reports, samplesThatAreNotHoles(input));
  std::vector<TileChange> undone;
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (reports[i].changed == 0) undone.push_back(changes[i]);
  if (undone.size() == changes.size()) {
    filtered.field = input;
  } else {
    LiveField live(std::move(result), Growth::kAllowed);
    if (!undo(live, undone)) return failure("memory for the filtered samples could not be had", "filter");
    filtered.field = live.snapshot();
  }
  return filtered;
}

}  // namespace

std::string warningOf(const FilterReport& report) {
  const double share =
      static_cast<double>(report.weightless) / static_cast<double>(std::max<std::int64_t>(report.samples, 1));
  if (!(share > kManyWeightless)) return {};
  return fmt::format(
      "{:.0f} % of the samples have no weight, so that the surface may not follow the others: take the form "
      "out first, or compare with another cut-off and with the filter that is not robust",
      100.0 * share);
}

std::string warningOf(const FilterSpec& spec, const Grid& grid) {
  const double x = grid.width * grid.spacingXMm(), y = grid.height * grid.spacingYMm();
  if (filterOf(spec.kind).nesting_word != "cutoff" || !(spec.nesting_mm > std::max(x, y))) return {};
  return fmt::format(
      "a cut-off of {:.6g} mm is longer than the field, {:.6g} x {:.6g} mm: what it leaves is of ends alone",
      spec.nesting_mm, x, y);
}

Status validate(const FilterSpec& spec) {
  const Filter& filter = filterOf(spec.kind);
  const FilterParameter& window = filter.window;
  if (!window.exists() && spec.window != FilterSpec{}.window)
    return inputError(
        fmt::format("a {} filter has no window", filter.word), "window",
        fmt::format("leave it out, or use {}",
                    filterWords([](const Filter& each) { return each.window.exists(); }, " or ")));
  if (window.exists() && (spec.window < window.least || spec.window > window.most || spec.window % 2 == 0))
    return inputError(fmt::format("a filter window of {} samples cannot be used", spec.window), "window",
                      fmt::format("give an odd number from {:g} to {:g}", window.least, window.most));
  if (!std::isfinite(spec.sigma) || spec.sigma < 0.0)
    return inputError(fmt::format("a sigma of {} samples cannot be used", spec.sigma), "sigma",
                      "give a positive number of samples, or 0: " + std::string(filter.sigma.when_zero));
  if (spec.sigma != 0.0 && !filter.sigma.exists())
    return inputError(
        fmt::format("a {} filter has no sigma", filter.word), "sigma",
        fmt::format("leave it out, or use {}",
                    filterWords([](const Filter& each) { return each.sigma.exists(); }, " or ")));
  const FilterParameter& range = filter.range_sigma;
  if (range.exists() && !(spec.range_sigma >= range.least && spec.range_sigma <= range.most))
    return inputError(fmt::format("a range sigma of {} cannot be used", spec.range_sigma), "range-sigma",
                      fmt::format("give a height from {} to {}", range.least, range.most));
  if (!range.exists() && spec.range_sigma != 0.0)
    return inputError(
        fmt::format("a {} filter has no range sigma", filter.word), "range-sigma",
        fmt::format("leave it out, or use {}",
                    filterWords([](const Filter& each) { return each.range_sigma.exists(); }, " or ")));
  const FilterParameter& nesting = filter.nesting;
  if (nesting.exists() && !(spec.nesting_mm >= nesting.least && spec.nesting_mm <= nesting.most))
    return spec.nesting_mm == 0.0
               ? inputError(fmt::format("{} has no {}", filter.word, filter.nesting_word),
                            std::string(filter.nesting_word), "give one, as 0.8 in millimetres or 250um")
               : inputError(fmt::format("a {} of {} mm cannot be used", filter.nesting_word, spec.nesting_mm),
                            std::string(filter.nesting_word), "give a positive length");
  if (!nesting.exists() && spec.nesting_mm != 0.0)
    return inputError(fmt::format("a {} filter has no nesting index", filter.word), "cutoff",
                      fmt::format("leave it out, or use {}", filterWords(separatesScales, " or ")));
  if (!filter.has_element && spec.element != FilterSpec{}.element)
    return inputError(fmt::format("a {} filter has no structuring element", filter.word), "element",
                      fmt::format("leave it out, or use {}", filterWords(hasElement, " or ")));
  if (spec.passes < 1 || spec.passes > FilterSpec::kMaxPasses)
    return inputError(fmt::format("a filter cannot be applied {} times", spec.passes), "passes",
                      fmt::format("give a number from 1 to {}", FilterSpec::kMaxPasses));
  if (spec.max_change && (!std::isfinite(*spec.max_change) || *spec.max_change < 0.0))
    return inputError(fmt::format("a largest change of {} cannot be used", *spec.max_change), "max-change",
                      "give a height that is 0 or more");
  if (spec.threads < 0 || spec.threads > FilterSpec::kMaxThreads)
    return inputError(fmt::format("{} threads cannot be used", spec.threads), "threads",
                      fmt::format("give a number from 1 to {}, or 0 for all cores", FilterSpec::kMaxThreads));
  return {};
}

Status validate(const FilterSpec& spec, const Grid& grid) {
  if (Status valid = validate(spec); !valid) return valid;
  const Filter& filter = filterOf(spec.kind);
  const double least = filter.least_nesting * std::max(grid.spacingXMm(), grid.spacingYMm());
  if (filter.nesting.exists() && !(spec.nesting_mm >= least))
    return inputError(
        fmt::format("a {} of {:.6g} mm is shorter than {}", filter.nesting_word, spec.nesting_mm,
                    filter.least_nesting == 1.0 ? "one spacing" : "two samples"),
        std::string(filter.nesting_word), fmt::format("take {:.6g} mm or more", least));
  return {};
}

namespace {

// pass_once(state) applied spec.passes times on as many threads as the spec has. `work` may be null.
Result<Filtered> applyPasses(const Version& input, const FilterSpec& spec, FilterWork* work, JobControl& job,
                             auto&& pass_once) {
  if (Status valid = validate(spec, input.grid()); !valid) return tl::unexpected(valid.error());
  const Filter& filter = filterOf(spec.kind);
  if (input.lines() != nullptr && filter.knows_lines && filter.window.exists() &&
      spec.window > kMostLineWindow)
    return inputError(fmt::format("next to edge lines a window of {} samples is too large", spec.window),
                      "window",
                      fmt::format("give {} at most, take tgv, or remove the lines", kMostLineWindow));
  try {
    job.begin("filtering",
              static_cast<std::uint64_t>(input.grid().samples()) * static_cast<std::uint64_t>(spec.passes));
    tbb::task_arena arena(spec.threads == 0 ? tbb::task_arena::automatic
                                            : std::min(spec.threads, tbb::info::default_concurrency()));
    return arena.execute([&]() -> Result<Filtered> {
      FilterWork::State state{0, input};
      if (work != nullptr) {
        Result<FilterWork::State> begun = work->begin(input);
        if (!begun) return tl::unexpected(std::move(begun.error()));
        state = std::move(*begun);
        job.advance(static_cast<std::uint64_t>(input.grid().samples()) *
                    static_cast<std::uint64_t>(state.passes));
      }
      PassResult last;
      for (; state.passes < spec.passes; ++state.passes) {
        if (work != nullptr)
          if (Status begun = work->beginPass(state); !begun) return tl::unexpected(std::move(begun.error()));
        Result<PassResult> next = pass_once(state.field);
        if (!next) return tl::unexpected(std::move(next.error()));
        last = std::move(*next);
        state.field = last.field;
      }
      Filtered filtered = Filtered{state.field, total(last.reports, samplesThatAreNotHoles(input))};
      if (spec.passes > 1) {
        Result<Filtered> whole = compared(input, std::move(state.field));
        if (!whole) return whole;
        filtered = std::move(*whole);
      }
      filtered.report.weightless = last.weightless;
      return filtered;
    });
  } catch (const std::bad_alloc&) {
    return failure("memory for filtering could not be had", "filter",
                   "use a smaller window or fewer threads");
  }
}

[[maybe_unused]] bool sameSize(const Version& a, const Version& b) noexcept {
  return a.grid().width == b.grid().width && a.grid().height == b.grid().height;
}

}  // namespace

Result<Filtered> applyFilter(const Version& input, const Version& original, const FilterSpec& spec,
                             const FilterTuning& tuning, JobControl& job) {
  assert(sameSize(input, original));
  assert(tuning.block_side % kTileSide == 0);
  return applyPasses(input, spec, tuning.work, job, [&](const Version& state) {
    return filterOf(spec.kind).pass(state, original, spec, tuning, job);
  });
}

Result<Filtered> applyFilter(const Version& input, const Version& original, const FilterSpec& spec,
                             JobControl& job) {
  return applyFilter(input, original, spec, FilterTuning{}, job);
}

Result<Filtered> applyFilter(const Version& input, const Version& original, const FilterSpec& spec,
                             TgvDevice& device, JobControl& job, FilterWork* work) {
  const FilterPassOnDevice on_device = filterOf(spec.kind).on_device;
  assert(on_device != nullptr && sameSize(input, original));
  return applyPasses(input, spec, work, job, [&](const Version& state) {
    return on_device(state, original, spec, device, work, job);
  });
}

}  // namespace fettle::engine
