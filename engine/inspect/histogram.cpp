#include "engine/inspect/histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/combinable.h>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

Result<HeightHistogram> countHeights(const Version& field, int bins, JobControl& job) {
  if (bins < 1 || bins > kMostBins)
    return inputError(fmt::format("{} bins are not possible", bins), "histogram",
                      fmt::format("take 1 to {}", kMostBins));
  const FieldReader reader = field.reader();
  const HeightBounds bounds = reader.bounds();
  HeightHistogram histogram;
  histogram.counts.assign(static_cast<std::size_t>(bins), 0);
  if (bounds.empty()) {
    histogram.low = histogram.high = std::numeric_limits<double>::quiet_NaN();
    return histogram;
  }
  histogram.low = bounds.min;
  histogram.high = bounds.max;
  const double range = histogram.high - histogram.low;  // of two floats: no overflow in double
  const double scale = range > 0.0 ? bins / range : 0.0;

  using Counts = std::vector<std::int64_t>;
  tbb::combinable<Counts> parts([bins] { return Counts(static_cast<std::size_t>(bins), 0); });
  job.begin("counting heights", tileCount(reader));
  tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(tileCount(reader)), [&](std::int64_t i) {
    if (job.cancelled()) return;
    const SampleRect rect = tileRect(reader, i);
    Counts& counts = parts.local();
    float z[kTileSamples];
    reader.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        const double height = z[r * kTileSide + c];
        if (std::isnan(height)) continue;
        const int bin = static_cast<int>((height - histogram.low) * scale);
        ++counts[static_cast<std::size_t>(std::min(bin, bins - 1))];
      }
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  parts.combine_each([&](const Counts& counts) {
    for (std::size_t i = 0; i < counts.size(); ++i) histogram.counts[i] += counts[i];
  });
  return histogram;
}

}  // namespace fettle::engine
