// The loops over whole rows are compiled for each kind of processor; all give the same bits.
#include "render/detail/detail_tile.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/filter/block.h"

namespace fettle::render {
namespace {

constexpr float kInfiniteError = std::numeric_limits<float>::infinity();
constexpr int kColumns = kTileStride;

// Everything about one row of coarse cells, spread over the columns of samples, so that the loop over a row
// of samples is the same few operations on every column.
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

// `rows` rows of samples, row r at v[r] of the coarse row's height, 0 .. 1. Comparisons with NaN are false:
// holes change nothing.
FETTLE_EACH_CPU void addRows(const float* __restrict z, int rows, const float* v_of, const CoarseRow& coarse,
                             const float* __restrict u, float* __restrict deviation) {
  const float* __restrict low_left = coarse.low_left;
  const float* __restrict left_rise = coarse.left_rise;
  const float* __restrict top_right = coarse.top_right;
  const float* __restrict right_fall = coarse.right_fall;
  for (int r = 0; r < rows; ++r, z += kTileStride) {
    const float v = v_of[r], w = 1.0F - v;
    for (int c = 0; c < kColumns; ++c) {
      // Chosen before they are computed with: arithmetic under a condition is not vectorised.
      const bool lower = u[c] <= w;
      const float base = lower ? low_left[c] : top_right[c];
      const float slope = lower ? left_rise[c] : right_fall[c];
      const float d = std::fabs(z[c] - (base + (lower ? v : w) * slope));
      deviation[c] = d > deviation[c] ? d : deviation[c];
    }
  }
}

// Of three rows of samples, at each column; `most` grows to the largest magnitude.
FETTLE_EACH_CPU void extremesOfRows(const float* first, const float* second, const float* third,
                                    float* __restrict lowest, float* __restrict highest,
                                    float* __restrict hole, float* __restrict most) {
  for (int c = 0; c < kColumns; ++c) {
    const float a = first[c], b = second[c], d = third[c];
    float low = kInfiniteError, high = -kInfiniteError, any = 0.0F;
    low = a < low ? a : low;
    low = b < low ? b : low;
    low = d < low ? d : low;
    high = a > high ? a : high;
    high = b > high ? b : high;
    high = d > high ? d : high;
    any = a == a ? any : 1.0F;
    any = b == b ? any : 1.0F;
    any = d == d ? any : 1.0F;
    lowest[c] = low;
    highest[c] = high;
    hole[c] = any;
    // Of holes alone both are infinite, of opposite signs.
    const float up = high >= low && high > most[c] ? high : most[c];
    most[c] = high >= low && -low > up ? -low : up;
  }
}

// How far the samples of the cells of one row reach beyond their vertices.
FETTLE_EACH_CPU void excessOfRow(const float* __restrict below, const float* __restrict above,
                                 const float* __restrict lowest, const float* __restrict highest,
                                 const float* __restrict hole, int cells, float* __restrict excess) {
  for (int i = 0; i < cells; ++i) {
    const float left_low = above[i] < below[i] ? above[i] : below[i];
    const float right_low = above[i + 1] < below[i + 1] ? above[i + 1] : below[i + 1];
    const float left_high = above[i] > below[i] ? above[i] : below[i];
    const float right_high = above[i + 1] > below[i + 1] ? above[i + 1] : below[i + 1];
    const float under = (right_low < left_low ? right_low : left_low) - lowest[i];
    const float over = highest[i] - (right_high > left_high ? right_high : left_high);
    const float most = under > over ? under : over;
    // Where there are nothing but holes nothing is drawn: both are -infinity.
    const float holed = lowest[i] <= highest[i] ? kInfiniteError : most;
    excess[i] = hole[i] > 0.0F ? holed : most;
  }
}

}  // namespace

void TileExtremes::ofSamples(const float* heights, glm::ivec2 cells) {
  count = (cells + 1) / 2;
  alignas(64) float low[kColumns], high[kColumns], any[kColumns], most[kColumns] = {};
  for (int j = 0; j < count.y; ++j) {
    const float* first = heights + 2 * j * kTileStride;
    const float* second = first + kTileStride;
    extremesOfRows(first, second, 2 * j + 2 <= cells.y ? second + kTileStride : second, low, high, any, most);
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
  // In place: a cell is written after the four that it is made of are read, and before them in memory.
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
  const int columns = cells.x + 1, patches = (coarse.x + patch_cells - 1) / patch_cells;

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
    // The row of samples between two rows of cells is the next one's first; patches have theirs both.
    addRows(heights + first * kTileStride, ends ? tall + 1 : tall, v, row, u, deviation);

    DetailMeasure::Error* line = out + (j / patch_cells) * across;
    const int at = j * TileExtremes::kMost;
    excessOfRow(below, above, extremes.lowest + at, extremes.highest + at, extremes.hole + at, coarse.x,
                excess);
    for (int p = 0; p < patches; ++p)
      for (int i = p * patch_cells; i < std::min((p + 1) * patch_cells, coarse.x); ++i)
        line[p].excess = std::max(line[p].excess, excess[i]);
    // The diagonal of a cell cut short is none of the fine surface's: its kink shows between samples.
    const int whole = tall == stride ? cells.x >> level : 0;
    for (int i = whole; i < coarse.x; ++i) {
      if (extremes.lowest[at + i] > extremes.highest[at + i]) continue;
      const int from = i * stride, wide = std::min(stride, cells.x - from);
      const float twist = std::fabs(below[i] - below[i + 1] - above[i] + above[i + 1]);
      const float most = 0.25F * twist * (1.0F / static_cast<float>(wide) + 1.0F / static_cast<float>(tall));
      for (int c = from; c <= from + wide; ++c) kink[c] = std::max(kink[c], most);
    }
    if (!ends) continue;
    for (int p = 0; p < patches; ++p) {
      const int from = p * patch_cells * stride, to = std::min(from + patch_cells * stride, cells.x);
      for (int c = from; c <= to; ++c)
        line[p].deviation = std::max(line[p].deviation, deviation[c] + kink[c]);
    }
    std::fill_n(deviation, kColumns, 0.0F);
    std::fill_n(kink, kColumns, 0.0F);
  }
  const float rounding = 4.0F * std::numeric_limits<float>::epsilon() * extremes.largest;
  for (int p = 0; p < across * ((coarse.y + patch_cells - 1) / patch_cells); ++p) {
    DetailMeasure::Error& error = out[p];
    // Sums of such magnitudes overflow or are a missing vertex's: no bound is known.
    if (!(error.deviation < 1e28F) || extremes.largest > 1e30F)
      error = {kInfiniteError, kInfiniteError};
    else if (error.deviation > 0.0F)
      error = {error.deviation + rounding, error.excess + rounding};
  }
}

}  // namespace fettle::render
