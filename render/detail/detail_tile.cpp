// The loops over whole rows are compiled for each kind of processor; all give the same bits.
#include "render/detail/detail_tile.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/simd/kernel.h"

namespace fettle::render {
namespace {

constexpr float kInfiniteError = std::numeric_limits<float>::infinity();
constexpr int kColumns = kTileStride;

// The values of one row of coarse cells, spread over the columns of samples, so that the loop over a row of
// samples does the same few operations at every column.
struct CoarseRow {
  alignas(64) float low_left[kColumns] = {};    // along the lower edge, at this column
  alignas(64) float left_rise[kColumns] = {};   // upper left minus lower left vertex
  alignas(64) float top_right[kColumns] = {};   // along the upper edge, at this column
  alignas(64) float right_fall[kColumns] = {};  // lower right minus upper right vertex
};

// `below` and `above`: the vertices of the row's edges. `u`: how far into its cell a column lies, 0 .. 1. The
// level is a constant so that the inner loop has a constant length.
template <int kLevel>
void spread(const float* below, const float* above, const float* u, int columns, CoarseRow& row) {
  const auto cell = [&](int i, int from, int to) {
    const float low = below[i], low_rise = below[i + 1] - low, left_rise = above[i] - low;
    const float top = above[i + 1], top_rise = above[i] - top, right_fall = below[i + 1] - top;
    for (int c = from; c < to; ++c) {
      row.low_left[c] = low + u[c] * low_rise;
      row.left_rise[c] = left_rise;
      row.top_right[c] = top + (1.0F - u[c]) * top_rise;
      row.right_fall[c] = right_fall;
    }
  };
  constexpr int kStride = 1 << kLevel;
  const int last = (columns - 2) >> kLevel;
  for (int i = 0; i < last; ++i) cell(i, i * kStride, i * kStride + kStride);
  cell(last, last * kStride, columns);
}
constexpr decltype(&spread<1>) kSpread[] = {nullptr,   spread<1>, spread<2>, spread<3>,
                                            spread<4>, spread<5>, spread<6>};
static_assert(std::size(kSpread) == DetailMeasure::kTileLevels + 1);

#define FETTLE_KERNEL "render/detail/detail_tile-inl.h"
#include "engine/simd/each_cpu-inl.h"

const auto kAddRows = FETTLE_AT_LEVEL(engine::bestCpuLevel(), addRows);
const auto kExtremesOfRows = FETTLE_AT_LEVEL(engine::bestCpuLevel(), extremesOfRows);
const auto kExcessOfRow = FETTLE_AT_LEVEL(engine::bestCpuLevel(), excessOfRow);

}  // namespace

void TileExtremes::ofSamples(const float* heights, glm::ivec2 cells) {
  count = (cells + 1) / 2;
  alignas(64) float low[kColumns], high[kColumns], any[kColumns], most[kColumns] = {};
  for (int j = 0; j < count.y; ++j) {
    const float* first = heights + 2 * j * kTileStride;
    const float* second = first + kTileStride;
    kExtremesOfRows(first, second, 2 * j + 2 <= cells.y ? second + kTileStride : second, low, high, any,
                    most);
    for (int i = 0; i < count.x; ++i) {
      const int a = 2 * i, b = a + 1, c = std::min(a + 2, cells.x), to = j * kMost + i;
      lowest[to] = std::min({low[a], low[b], low[c]});
      highest[to] = std::max({high[a], high[b], high[c]});
      hole[to] = std::max({any[a], any[b], any[c]});
    }
  }
  largest = *std::max_element(most, most + cells.x + 1);
}

void TileExtremes::coarsen() {
  const glm::ivec2 fine = count;
  count = (fine + 1) / 2;
  // In place: a cell is written after the four cells that it is made of were read, and lies before them in
  // memory.
  for (int j = 0; j < count.y; ++j)
    for (int i = 0; i < count.x; ++i) {
      const int low = 2 * j * kMost, high = std::min(2 * j + 1, fine.y - 1) * kMost;
      const int a = 2 * i, b = std::min(a + 1, fine.x - 1), to = j * kMost + i;
      lowest[to] = std::min({lowest[low + a], lowest[low + b], lowest[high + a], lowest[high + b]});
      highest[to] = std::max({highest[low + a], highest[low + b], highest[high + a], highest[high + b]});
      hole[to] = std::max({hole[low + a], hole[low + b], hole[high + a], hole[high + b]});
    }
}

void measureTileLevel(const float* heights, glm::ivec2 cells, int level, const float* vertices,
                      const TileExtremes& extremes, int patch_cells, int across, DetailMeasure::Error* out) {
  const int stride = 1 << level, vertex_stride = (engine::kTileSide >> level) + 1;
  const glm::ivec2 coarse = extremes.count;
  const glm::ivec2 patches = (coarse + patch_cells - 1) / patch_cells;
  const int columns = cells.x + 1;

  alignas(64) float u[kColumns] = {};
  for (int c = 0; c < columns; ++c) {
    const int begin = std::min(c >> level, coarse.x - 1) << level;
    u[c] = static_cast<float>(c - begin) / static_cast<float>(std::min(stride, cells.x - begin));
  }
  float v[kTileRows];
  alignas(64) float deviation[kColumns] = {};
  float kink[kColumns] = {};  // of cells cut short
  float excess[TileExtremes::kMost];
  CoarseRow row;
  for (int j = 0; j < coarse.y; ++j) {
    const float* below = vertices + j * vertex_stride;
    const float* above = below + vertex_stride;
    const int first = j * stride, tall = std::min(stride, cells.y - first);
    const bool ends = j % patch_cells == patch_cells - 1 || j == coarse.y - 1;
    if (j == 0 || tall != stride)
      for (int r = 0; r <= tall; ++r) v[r] = static_cast<float>(r) / static_cast<float>(tall);
    kSpread[level](below, above, u, columns, row);
    // The row of samples between two rows of cells is the first of the next row; each patch contains both its
    // edge rows.
    kAddRows(heights + first * kTileStride, ends ? tall + 1 : tall, v, row, u, deviation);

    DetailMeasure::Error* line = out + (j / patch_cells) * across;
    const int at = j * TileExtremes::kMost;
    kExcessOfRow(below, above, extremes.lowest + at, extremes.highest + at, extremes.hole + at, coarse.x,
                 excess);
    for (int p = 0; p < patches.x; ++p)
      for (int i = p * patch_cells; i < std::min((p + 1) * patch_cells, coarse.x); ++i)
        line[p].excess = std::max(line[p].excess, excess[i]);
    // The diagonal of a cell that is cut short is not an edge of the fine surface: its kink shows between
    // samples.
    const int whole = tall == stride ? cells.x >> level : 0;
    for (int i = whole; i < coarse.x; ++i) {
      if (extremes.lowest[at + i] > extremes.highest[at + i]) continue;
      const int from = i * stride, wide = std::min(stride, cells.x - from);
      const float twist = std::fabs(below[i] - below[i + 1] - above[i] + above[i + 1]);
      const float most = 0.25F * twist * (1.0F / static_cast<float>(wide) + 1.0F / static_cast<float>(tall));
      for (int c = from; c <= from + wide; ++c) kink[c] = std::max(kink[c], most);
    }
    if (!ends) continue;
    for (int p = 0; p < patches.x; ++p) {
      const int from = p * patch_cells * stride, to = std::min(from + patch_cells * stride, cells.x);
      for (int c = from; c <= to; ++c)
        line[p].deviation = std::max(line[p].deviation, deviation[c] + kink[c]);
    }
    std::fill_n(deviation, kColumns, 0.0F);
    std::fill_n(kink, kColumns, 0.0F);
  }
  const float rounding = 4.0F * std::numeric_limits<float>::epsilon() * extremes.largest;
  for (int p = 0; p < across * patches.y; ++p) {
    DetailMeasure::Error& error = out[p];
    // Sums of such magnitudes overflow or contain a missing vertex: no bound is known.
    if (!(error.deviation < 1e28F) || extremes.largest > 1e30F)
      error = {kInfiniteError, kInfiniteError};
    else if (error.deviation > 0.0F)
      error = {error.deviation + rounding, error.excess + rounding};
  }
}

}  // namespace fettle::render
