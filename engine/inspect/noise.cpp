#include "engine/inspect/noise.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "engine/compare/tile_select.h"

namespace fettle::engine {

namespace {

// 1 / the third quartile of the standard normal distribution.
constexpr double kSigmaOfMedian = 1.482602218505602;
constexpr double kSigmaOfMask = 6.0;

constexpr auto kMiddle = [](std::int64_t count) { return (count - 1) / 2; };

NoiseEstimate noiseOfMedian(const Selected& median) {
  return {kSigmaOfMedian * median.value / kSigmaOfMask, median.count};
}

// The magnitudes of d in a rectangle, of which row 0 is the row `below` of the reader. Samples outside the reader's field
// are NaN, and so are results that use them.
void takeDetail(const FieldReader& reader, const SampleRect& rect, std::int32_t below_rows, auto&& take) {
  constexpr int kSide = kTileSide + 2;
  float z[kSide * kSide];
  reader.readHeights(rect.column - 1, rect.row + below_rows - 1, rect.columns + 2, rect.rows + 2, z, kSide);
  const auto across = [](const float* row) { return double{row[0]} - 2.0 * row[1] + double{row[2]}; };
  for (int r = 0; r < rect.rows; ++r)
    for (int c = 0; c < rect.columns; ++c) {
      const float* below = z + r * kSide + c;
      take(std::abs(across(below) - 2.0 * across(below + kSide) + across(below + 2 * kSide)));
    }
}

}  // namespace

Result<NoiseEstimate> estimateNoise(const Version& field, JobControl& job) {
  const FieldReader reader = field.reader();
  job.begin("estimating noise", kSelectPasses * tileCount(reader));
  const Selected median = selectFromTiles(
      reader, job, kMiddle, [&](const SampleRect& rect, auto&& take) { takeDetail(reader, rect, 0, take); });
  if (job.cancelled()) return cancelled();
  return noiseOfMedian(median);
}

Result<NoiseEstimate> estimateNoiseByRows(const Grid& grid, const RowsSource& source,
                                          std::int32_t rows_at_once, JobControl& job) {
  assert(rows_at_once % kTileSide == 0);
  const auto parts = static_cast<std::uint64_t>((grid.height + rows_at_once - 1) / rows_at_once);
  std::uint64_t done = 0;
  Status status;
  const Selected median =
      selectByCounting(kMiddle, [&](const SelectDigit& digit, SelectDigit::Counts& counts) {
        for (std::int32_t row = 0; row < grid.height; row += rows_at_once) {
          const std::int32_t end = std::min(row + rows_at_once, grid.height);
          const RowSpan read{std::max(row - 1, 0), std::min(end + 1, grid.height) - std::max(row - 1, 0)};
          JobControl part = JobControl::partOf(job);
          const Result<Version> rows = source(read, part);
          if (!rows) {
            status = tl::unexpected(rows.error());
            return false;
          }
          const FieldReader reader = rows->reader();
          Grid own = grid;
          own.height = end - row;
          const FieldReader tiles(nullptr, &own, 1.0F);  // cut into the tiles of these rows alone
          if (!countTiles(tiles, part, digit, counts, [&](const SampleRect& rect, auto&& take) {
                takeDetail(reader, rect, row - read.first, take);
              })) {
            status = cancelled();
            return false;
          }
          job.begin("estimating noise", kSelectPasses * parts);
          job.advance(++done);
        }
        return true;
      });
  if (!status) return tl::unexpected(status.error());
  return noiseOfMedian(median);
}

}  // namespace fettle::engine
