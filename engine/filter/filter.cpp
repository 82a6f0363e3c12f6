#include "engine/filter/filter.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/filter/block.h"
#include "engine/filter/pass.h"

namespace fettle::engine {

namespace {

constexpr std::array<std::pair<FilterKind, std::string_view>, 3> kNames{{
    {FilterKind::kBox, "box"},
    {FilterKind::kGaussian, "gaussian"},
    {FilterKind::kMedian, "median"},
}};

struct TileReport {
  std::int64_t changed = 0;
  double max_change = 0.0;
  double squares = 0.0;
};

// Sums go to one of 16 places by column, so that their order is fixed and they can be taken side by side.
FETTLE_EACH_CPU TileReport reportTile(const float* before, const float* after) noexcept {
  constexpr int kAbreast = 16;
  double squares[kAbreast] = {};
  double most[kAbreast] = {};
  std::int32_t changed[kAbreast] = {};
  for (int i = 0; i < kTileSamples; i += kAbreast)
    for (int k = 0; k < kAbreast; ++k) {
      const double difference = static_cast<double>(after[i + k]) - static_cast<double>(before[i + k]);
      const double d = difference == difference ? difference : 0.0;  // a hole stays a hole
      const double size = std::fabs(d);
      changed[k] += d != 0.0 ? 1 : 0;
      most[k] = size > most[k] ? size : most[k];
      squares[k] += d * d;
    }
  TileReport report;
  for (int k = 0; k < kAbreast; ++k) {
    report.changed += changed[k];
    report.max_change = std::max(report.max_change, most[k]);
    report.squares += squares[k];
  }
  return report;
}

std::int64_t samplesThatAreNotHoles(const Version& version) noexcept {
  const FieldReader reader = version.reader();
  std::int64_t n = 0;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc)
      n += kTileSamples - std::int64_t{reader.tile(tc, tr).nan_samples};
  return n;
}

// Compares the result with the input, and shares again what came back to where it was: over several passes a
// tile may. The sums are taken tile by tile in a fixed order.
Result<Filtered> report(const Version& input, Version result) {
  const std::vector<TileChange> changes = changedTiles(input, result);
  std::vector<TileReport> reports(changes.size());
  tbb::parallel_for(std::size_t{0}, changes.size(), [&](std::size_t i) {
    reports[i] = reportTile(changes[i].before->samples.data(), changes[i].after->samples.data());
  });

  Filtered filtered;
  double squares = 0.0;
  std::vector<TileChange> undone;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    filtered.report.changed += reports[i].changed;
    filtered.report.max_change = std::max(filtered.report.max_change, reports[i].max_change);
    squares += reports[i].squares;
    if (reports[i].changed == 0) undone.push_back(changes[i]);
  }
  const std::int64_t samples = samplesThatAreNotHoles(input);
  if (samples > 0) filtered.report.rms_change = std::sqrt(squares / static_cast<double>(samples));

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

std::optional<FilterKind> filterKindFromName(std::string_view name) {
  for (const auto& [kind, text] : kNames)
    if (text == name) return kind;
  return std::nullopt;
}

std::string_view name(FilterKind kind) {
  for (const auto& [known, text] : kNames)
    if (known == kind) return text;
  return {};
}

Status validate(const FilterSpec& spec) {
  if (spec.window < 1 || spec.window > FilterSpec::kMaxWindow || spec.window % 2 == 0)
    return inputError(fmt::format("a filter window of {} samples cannot be used", spec.window), "window",
                      fmt::format("give an odd number from 1 to {}", FilterSpec::kMaxWindow));
  if (!std::isfinite(spec.sigma) || spec.sigma < 0.0)
    return inputError(fmt::format("a sigma of {} samples cannot be used", spec.sigma), "sigma",
                      "give a positive number of samples, or 0 for binomial weights");
  if (spec.sigma != 0.0 && spec.kind != FilterKind::kGaussian)
    return inputError(fmt::format("a {} filter has no sigma", name(spec.kind)), "sigma",
                      "leave it out, or use the gaussian filter");
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

Result<Filtered> applyFilter(const Version& input, const Version& original, const FilterSpec& spec,
                             const FilterTuning& tuning, JobControl& job) {
  if (Status valid = validate(spec); !valid) return tl::unexpected(valid.error());
  assert(input.grid().width == original.grid().width && input.grid().height == original.grid().height);
  assert(tuning.block_side % kTileSide == 0);
  try {
    job.begin("filtering",
              static_cast<std::uint64_t>(input.grid().samples()) * static_cast<std::uint64_t>(spec.passes));
    tbb::task_arena arena(spec.threads == 0 ? tbb::task_arena::automatic : spec.threads);
    return arena.execute([&]() -> Result<Filtered> {
      Version state = input;
      for (int pass = 0; pass < spec.passes; ++pass) {
        Result<Version> next = filterOnce(state, original, spec, tuning.block_side, job);
        if (!next) return tl::unexpected(std::move(next.error()));
        state = std::move(*next);
      }
      return report(input, std::move(state));
    });
  } catch (const std::bad_alloc&) {
    return failure("memory for filtering could not be had", "filter",
                   "use a smaller window or fewer threads");
  }
}

Result<Filtered> applyFilter(const Version& input, const Version& original, const FilterSpec& spec,
                             JobControl& job) {
  return applyFilter(input, original, spec, FilterTuning{}, job);
}

}  // namespace fettle::engine
