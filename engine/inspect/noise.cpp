#include "engine/inspect/noise.h"

#include <cmath>

#include "engine/compare/tile_select.h"

namespace fettle::engine {

namespace {

// 1 / the third quartile of the standard normal distribution.
constexpr double kSigmaOfMedian = 1.482602218505602;
constexpr double kSigmaOfMask = 6.0;

}  // namespace

Result<NoiseEstimate> estimateNoise(const Version& field, JobControl& job) {
  const FieldReader reader = field.reader();
  job.begin("estimating noise", kSelectPasses * tileCount(reader));
  const Selected median = selectFromTiles(
      reader, job, [](std::int64_t count) { return (count - 1) / 2; },
      [&](const SampleRect& rect, auto&& take) {
        constexpr int kSide = kTileSide + 2;
        float z[kSide * kSide];  // samples outside the field are NaN, and so are results that use them
        reader.readHeights(rect.column - 1, rect.row - 1, rect.columns + 2, rect.rows + 2, z, kSide);
        const auto across = [](const float* row) { return double{row[0]} - 2.0 * row[1] + double{row[2]}; };
        for (int r = 0; r < rect.rows; ++r)
          for (int c = 0; c < rect.columns; ++c) {
            const float* below = z + r * kSide + c;
            take(std::abs(across(below) - 2.0 * across(below + kSide) + across(below + 2 * kSide)));
          }
      });
  if (job.cancelled()) return cancelled();
  return NoiseEstimate{kSigmaOfMedian * median.value / kSigmaOfMask, median.count};
}

}  // namespace fettle::engine
