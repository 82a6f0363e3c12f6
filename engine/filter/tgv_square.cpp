#include "engine/filter/tgv_square.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/filter/lone_samples.h"
#include "engine/filter/middle_height.h"
#include "engine/filter/tgv_schedule.h"

namespace fettle::engine {

namespace {

using tgv::kWeights;
using tgv::Row;

constexpr float kTallest = 1e15F;  // [noises]; the squares of more would leave float

}  // namespace

void TgvSquare::prepare(const Block& block) {
  makeRoom(block.columns, block.rows);
  takeHeights(block);
  startWeights();
  const bool lines = sides_.take(block);
  setLoneSamplesAside(lines);
  if (lines) cutLinks();
  startSlopes(lines);
}

tgv::Row TgvSquare::row(int r) noexcept {
  std::array<float*, kArrays> at;
  for (std::size_t a = 0; a < kArrays; ++a)
    at[a] = values_.data() + ((r + 1) * kArrays + static_cast<std::ptrdiff_t>(a)) * stride_ + kPad;
  return {at[0], at[1], at[2],  at[3],  at[4],  at[5],  at[6], at[7],
          at[8], at[9], at[10], at[11], at[12], at[13], at[14]};
}

void TgvSquare::makeRoom(int columns, int rows) {
  columns_ = columns;
  rows_ = rows;
  stride_ = (columns + 2 * kPad + 15) / 16 * 16;
  const auto size = static_cast<std::size_t>(stride_ * (rows + 2) * kArrays);
  if (size > values_.capacity()) {
    // Room for the largest square at once: squares at the border are smaller, and to grow from one to the next would hold
    // both.
    constexpr std::ptrdiff_t kLargest = tgv::kSide + 2 * tgv::kHalo;
    values_ = {};
    values_.reserve(std::max(
        size, static_cast<std::size_t>((kLargest + 2 * kPad + 15) / 16 * 16 * (kLargest + 2) * kArrays)));
  }
  values_.assign(size, 0.0F);
  for (int r = -1; r <= rows; ++r)
    std::fill_n(row(r).f - kPad, stride_, std::numeric_limits<float>::quiet_NaN());
}

// Heights less a middle one, so that float has digits for the noise wherever the scan lies.
void TgvSquare::takeHeights(const Block& block) {
  reference_ = middleHeight(block, middle_);
  if (middle_.empty()) return;
  for (int r = 0; r < rows_; ++r) {
    const Row now = row(r);
    const float* heights = block.row(r);
    for (int c = 0; c < columns_; ++c) {
      const double above = (static_cast<double>(heights[c]) - reference_) / noise_;
      const double kept = std::clamp(above, -static_cast<double>(kTallest), static_cast<double>(kTallest));
      now.f[c] = static_cast<float>(above == above ? kept : above);
      now.u[c] = now.u2[c] = now.f[c] == now.f[c] ? now.f[c] : 0.0F;
    }
  }
}

void TgvSquare::startWeights() {
  for (int r = 0; r < rows_; ++r) {
    const Row now = row(r);
    const float* next = row(r + 1).f;
    for (int c = 0; c < columns_; ++c) {
      const bool here = now.f[c] == now.f[c];
      now.wp[c] = here && now.f[c + 1] == now.f[c + 1] ? kWeights.jump : 0.0F;
      now.wq[c] = here && next[c] == next[c] ? kWeights.jump : 0.0F;
      now.wv[c] = kWeights.crease;
    }
  }
}

// What belongs to no surface is not held to its height.
void TgvSquare::setLoneSamplesAside(bool lines) {
  std::vector<LoneSample> lone = findLoneSamples(row(0).f, stride_ * kArrays, columns_, rows_);
  if (lines) sides_.settle(row(0).f, stride_ * kArrays, lone);
  for (const LoneSample& sample : lone) {
    const Row at = row(sample.row);
    at.f[sample.column] = std::numeric_limits<float>::quiet_NaN();
    at.u[sample.column] = at.u2[sample.column] = sample.between;
  }
}

// Heights on both sides of a line have nothing to do with each other. Slopes are still held together: on a strip
// two samples wide nothing else says how it is inclined (ribs with noise x 3, true lines: 8.3 um near edges
// instead of 10.2), and where they differ their weights are lowered soon enough.
void TgvSquare::cutLinks() {
  sides_.forEachCut([this](std::int32_t c, std::int32_t r, std::uint8_t links) {
    const Row now = row(r);
    if ((links & LineCut::kRight) != 0 && now.wp[c] > 0.0F) now.wp[c] = tgv::kCut;
    if ((links & LineCut::kUp) != 0 && now.wq[c] > 0.0F) now.wq[c] = tgv::kCut;
  });
}

// Slopes of planes that leave no more than noise in a window around a sample, or else in some that cover it;
// the largest of two sizes of windows counts. Steps alone need hundreds to come to a steep slope.
void TgvSquare::startSlopes(bool lines) {
  sums_.resize(static_cast<std::size_t>(columns_) * 4);
  const tgv::PlaneSums sums{sums_.data(), sums_.data() + columns_, sums_.data() + 2 * columns_,
                            sums_.data() + 3 * columns_};
  for (const int radius : {2, 3}) {
    const int side = 2 * radius + 1;
    const double n = side * side;
    const double spread = n * radius * (radius + 1) / 3.0;
    const double most = (n - 3.0) + 2.5 * std::sqrt(2.0 * (n - 3.0));  // of squares, in all but 1 of 100
    if (lines) findWindowsOverLines(radius);
    for (int r = 0; r < rows_; ++r) {
      const Row now = row(r);
      std::fill_n(now.x2, columns_, std::numeric_limits<float>::quiet_NaN());
      if (r < radius || r + radius >= rows_) continue;
      std::array<const float*, 7> rows{};
      for (int k = 0; k < side; ++k) rows[static_cast<std::size_t>(k)] = row(r - radius + k).f;
      tgv::sumWindows(level_, rows.data(), radius, columns_, sums);
      for (int c = 0; c < columns_; ++c) {
        if (lines && isOverLine(c, r)) continue;
        const double rest = sums.squares[c] - sums.sum[c] * sums.sum[c] / n -
                            (sums.along[c] * sums.along[c] + sums.across[c] * sums.across[c]) / spread;
        if (!(rest <= most)) continue;
        now.x2[c] = static_cast<float>(sums.along[c] / spread);
        now.y2[c] = static_cast<float>(sums.across[c] / spread);
      }
    }
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c)
        takeSlope(c, r, radius, lines && isOverLine(c, r) ? side : (side * side + 1) / 2);
  }
  for (int r = 0; r < rows_; ++r) {
    std::copy_n(row(r).x, columns_, row(r).x2);
    std::copy_n(row(r).y, columns_, row(r).y2);
  }
}

// Windows with both ends of a cut link.
void TgvSquare::findWindowsOverLines(int radius) {
  over_line_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  sides_.forEachCut([&](std::int32_t c, std::int32_t r, std::uint8_t links) {
    if ((links & LineCut::kRight) != 0) markCentres(c + 1 - radius, c + radius, r - radius, r + radius);
    if ((links & LineCut::kUp) != 0) markCentres(c - radius, c + radius, r + 1 - radius, r + radius);
  });
}

void TgvSquare::markCentres(int c0, int c1, int r0, int r1) {
  for (int r = std::max(r0, 0); r <= std::min(r1, rows_ - 1); ++r)
    for (int c = std::max(c0, 0); c <= std::min(c1, columns_ - 1); ++c)
      over_line_[static_cast<std::size_t>(r * columns_ + c)] = 1;
}

// From x2 and y2 to x and y. Between planes chance may leave more of one window than noise; where half of the
// windows that cover a sample have a plane, their mean is taken; next to a line, where fewer can, `least`.
void TgvSquare::takeSlope(int column, int line, int radius, int least) noexcept {
  const Row now = row(line);
  if (now.x2[column] == now.x2[column]) {
    now.x[column] = now.x2[column];
    now.y[column] = now.y2[column];
    return;
  }
  double x = 0.0, y = 0.0;
  int count = 0;
  for (int r = std::max(line - radius, 0); r <= std::min(line + radius, rows_ - 1); ++r) {
    const Row near = row(r);
    for (int c = std::max(column - radius, 0); c <= std::min(column + radius, columns_ - 1); ++c) {
      if (near.x2[c] != near.x2[c]) continue;
      x += static_cast<double>(near.x2[c]);
      y += static_cast<double>(near.y2[c]);
      ++count;
    }
  }
  if (count < least) return;
  now.x[column] = static_cast<float>(x / count);
  now.y[column] = static_cast<float>(y / count);
}

// Through the difference to the height, which is of the order of the noise, for all but lone samples.
void TgvSquare::write(const Block& block) {
  for (int r = 0; r < block.out_rows; ++r) {
    const Row now = row(block.first_row + r);
    const float* heights = block.row(block.first_row + r) + block.first_column;
    float* out = block.out + r * block.out_stride;
    for (int c = 0; c < block.out_columns; ++c) {
      const double u = now.u[block.first_column + c], f = now.f[block.first_column + c];
      const double from = f == f ? static_cast<double>(heights[c]) : reference_;
      out[c] = static_cast<float>(from + noise_ * (f == f ? u - f : u));
    }
  }
}

}  // namespace fettle::engine
