#include "engine/shard/band_filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>
#include <vector>

#include "engine/field/content_hash.h"
#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

// One row before and after.
void addRow(const float* before, const float* after, std::int32_t width, BandReport& report) noexcept {
  double squares = 0.0;
  for (std::int32_t c = 0; c < width; ++c) {
    if (before[c] != before[c]) {
      ++report.holes;
      continue;
    }
    ++report.samples;
    if (before[c] == after[c]) continue;
    const double change = std::fabs(static_cast<double>(after[c]) - static_cast<double>(before[c]));
    ++report.changed;
    report.max_change = std::max(report.max_change, change);
    squares += change * change;
  }
  report.squares += squares;
}

}  // namespace

Result<BandReport> filterBand(const Version& input, const Version& original, const FilterSpec* spec,
                              const RowSpan& read, const RowSpan& own, const TakeRows& take,
                              JobControl& job) try {
  assert(read.first <= own.first && own.end() <= read.end() && input.grid().height == read.count);
  Version result = input;
  if (spec != nullptr) {
    Result<Filtered> filtered = applyFilter(input, original, *spec, job);
    if (!filtered) return tl::unexpected(filtered.error());
    result = std::move(filtered->field);
  }
  const FieldReader before = input.reader(), after = result.reader();
  const std::int32_t width = before.width();
  const auto row_samples = static_cast<std::size_t>(width);
  std::vector<float> was(row_samples), now(row_samples * static_cast<std::size_t>(kTileSide));
  BandReport report;
  ContentHash hash(width, own.count);
  job.begin("writing", static_cast<std::uint64_t>(own.count));
  for (std::int32_t row = own.first; row < own.end(); row += kTileSide) {
    if (job.cancelled()) return cancelled();
    const std::int32_t rows = std::min(kTileSide, own.end() - row);
    after.readHeights(0, row - read.first, width, rows, now.data(), width);
    for (std::int32_t r = 0; r < rows; ++r) {
      const float* const made = now.data() + static_cast<std::size_t>(r) * row_samples;
      before.readHeights(0, row - read.first + r, width, 1, was.data(), width);
      addRow(was.data(), made, width, report);
      hash.addRow(made, nullptr);
    }
    if (Status taken = take(row, rows, now.data()); !taken) return tl::unexpected(taken.error());
    job.advance(static_cast<std::uint64_t>(rows));
  }
  report.hash = hash.value();
  return report;
} catch (const std::bad_alloc&) {
  return failure("memory for the band could not be had", "filter", "take more shards, or fewer threads");
}

}  // namespace fettle::engine
