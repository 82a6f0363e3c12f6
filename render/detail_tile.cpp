// The kernel of DetailMeasure: one tile, one level.
#include <algorithm>
#include <cmath>
#include <limits>

#include "render/detail.h"

namespace fettle::render {
namespace {

constexpr int kColumns = kTileStride;

// Everything about one row of coarse cells, spread over the columns of samples, so that the loop over a row
// of samples is the same few operations on every column.
struct CoarseRow {
  alignas(64) float low_left[kColumns];    // along the lower edge, at this column
  alignas(64) float left_rise[kColumns];   // upper left minus lower left vertex
  alignas(64) float top_right[kColumns];   // along the upper edge, at this column
  alignas(64) float right_fall[kColumns];  // lower right minus upper right vertex
};

struct Columns {
  alignas(64) float deviation[kColumns];
  alignas(64) float lowest[kColumns];
  alignas(64) float highest[kColumns];
  alignas(64) float hole[kColumns];  // > 0: some sample is one
  float kink[kColumns];              // of cells cut short
};

// One row of samples at height v (0 .. 1) of the coarse row: deviations, extremes, holes.
[[gnu::target_clones("avx2", "default")]] void addRow(const float* z, const CoarseRow& row, const float* u,
                                                      float v, int columns, Columns& sum) {
  const float w = 1.0F - v;
  for (int c = 0; c < columns; ++c) {
    const float lower = row.low_left[c] + v * row.left_rise[c];
    const float upper = row.top_right[c] + w * row.right_fall[c];
    const float drawn = u[c] <= w ? lower : upper;
    const float d = std::fabs(z[c] - drawn);
    // Comparisons with NaN are false: holes leave all but the last as they are.
    sum.deviation[c] = d > sum.deviation[c] ? d : sum.deviation[c];
    sum.lowest[c] = z[c] < sum.lowest[c] ? z[c] : sum.lowest[c];
    sum.highest[c] = z[c] > sum.highest[c] ? z[c] : sum.highest[c];
    sum.hole[c] = z[c] == z[c] ? sum.hole[c] : 1.0F;
  }
}

}  // namespace

void measureTileLevel(const float* heights, glm::ivec2 cells, int level, const float* vertices,
                      int patch_cells, int across, DetailMeasure::Error* out) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const int stride = 1 << level, vertex_stride = (engine::kTileSide >> level) + 1;
  const int coarse_columns = (cells.x + stride - 1) / stride, coarse_rows = (cells.y + stride - 1) / stride;
  if (coarse_columns <= 0 || coarse_rows <= 0) return;
  const int columns = cells.x + 1;

  alignas(64) float u[kColumns];
  for (int c = 0; c < columns; ++c) {
    const int i = std::min(c / stride, coarse_columns - 1);
    u[c] = static_cast<float>(c - i * stride) / static_cast<float>(std::min(stride, cells.x - i * stride));
  }
  Columns sum;
  float largest = 0.0F;  // magnitude, for rounding
  CoarseRow row;
  for (int j = 0; j < coarse_rows; ++j) {
    const float* below = vertices + j * vertex_stride;
    const float* above = below + vertex_stride;
    const int first = j * stride, tall = std::min(stride, cells.y - first);
    const bool begins = j % patch_cells == 0,
               ends = j % patch_cells == patch_cells - 1 || j == coarse_rows - 1;
    for (int c = 0; c < columns; ++c) {
      const int i = std::min(c / stride, coarse_columns - 1);
      row.low_left[c] = below[i] + u[c] * (below[i + 1] - below[i]);
      row.left_rise[c] = above[i] - below[i];
      row.top_right[c] = above[i + 1] + (1.0F - u[c]) * (above[i] - above[i + 1]);
      row.right_fall[c] = below[i + 1] - above[i + 1];
      if (begins) sum.deviation[c] = sum.kink[c] = 0.0F;
      sum.lowest[c] = kInfinity;
      sum.highest[c] = -kInfinity;
      sum.hole[c] = 0.0F;
    }
    for (int r = 0; r <= tall; ++r)
      addRow(heights + (first + r) * kTileStride, row, u, static_cast<float>(r) / static_cast<float>(tall),
             columns, sum);

    DetailMeasure::Error* line = out + (j / patch_cells) * across;
    for (int i = 0; i < coarse_columns; ++i) {
      const int from = i * stride, to = std::min(from + stride, cells.x);
      float lowest = kInfinity, highest = -kInfinity, hole = 0.0F;
      for (int c = from; c <= to; ++c) {
        lowest = std::min(lowest, sum.lowest[c]);
        highest = std::max(highest, sum.highest[c]);
        hole = std::max(hole, sum.hole[c]);
      }
      if (lowest > highest) continue;  // nothing but holes: nothing is drawn
      DetailMeasure::Error& error = line[i / patch_cells];
      const float v[] = {below[i], below[i + 1], above[i], above[i + 1]};
      const auto [low, high] = std::minmax({v[0], v[1], v[2], v[3]});
      error.excess = hole > 0.0F ? kInfinity : std::max({error.excess, low - lowest, highest - high});
      largest = std::max({largest, std::fabs(lowest), std::fabs(highest)});
      const int wide = to - from;
      if (wide != stride || tall != stride) {
        // The diagonal of a cell cut short is none of the fine surface's: its kink shows between samples.
        const float twist = std::fabs(v[0] - v[1] - v[2] + v[3]);
        const float kink =
            0.25F * twist * (1.0F / static_cast<float>(wide) + 1.0F / static_cast<float>(tall));
        for (int c = from; c <= to; ++c) sum.kink[c] = std::max(sum.kink[c], kink);
      }
    }
    if (!ends) continue;
    const int patches = (coarse_columns + patch_cells - 1) / patch_cells;
    for (int p = 0; p < patches; ++p) {
      const int from = p * patch_cells * stride, to = std::min(from + patch_cells * stride, cells.x);
      float worst = 0.0F;
      for (int c = from; c <= to; ++c) worst = std::max(worst, sum.deviation[c] + sum.kink[c]);
      line[p].deviation = std::max(line[p].deviation, worst);
    }
  }
  for (int p = 0; p < across * ((coarse_rows + patch_cells - 1) / patch_cells); ++p) {
    DetailMeasure::Error& error = out[p];
    const float rounding = 4.0F * std::numeric_limits<float>::epsilon() * largest;
    // Sums of such magnitudes overflow or are a missing vertex's: no bound is known.
    if (!(error.deviation < 1e28F) || largest > 1e30F)
      error = {kInfinity, kInfinity};
    else if (error.deviation > 0.0F)
      error = {error.deviation + rounding, error.excess + rounding};
  }
}

}  // namespace fettle::render
