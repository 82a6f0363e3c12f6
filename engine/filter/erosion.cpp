// Erosion by flat elements and by balls: J. Serra, Image analysis and mathematical morphology, 1982; for surfaces, M. Shunmugam and V.
// Radhakrishnan, Two- and three-dimensional analyses of surfaces according to the E-system, 1974, and S. Lou, X. Jiang, P.
// Scott, Algorithms for morphological profile filters and their comparison, 2012, which also has faster ways than going over the
// element. Theirs for balls, by alpha shapes, takes a triangulation of all samples; a bound on what a block of samples can come to gives the
// same result to the bit of going over the element, on any processor and for any cut of the field.

#include "engine/filter/erosion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/filter/disk_erosion.h"
#include "engine/filter/erosion_rows.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/erosion-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr double kNoDepth = std::numeric_limits<double>::infinity();
// A radius of three spacings reaches three samples, though 3 * 0.1 / 0.1 is less.
constexpr double kRoundUp = 1.0 + 1e-9;
constexpr std::int64_t kLargestTable = std::int64_t{1} << 20;  // depths
constexpr std::int32_t kRowsAtOnce = 32;
constexpr std::int32_t kStrip = 64;            // columns of leastDown
constexpr std::int32_t kWide = 16, kHigh = 8;  // results of lowerToBlock
constexpr std::int32_t kBlock = 8, kMany = 8;  // samples of a block's side, blocks of a larger one's

std::int32_t reachIn(double length, double spacing, std::int32_t samples) {
  return static_cast<std::int32_t>(std::min(std::floor(length / spacing * kRoundUp), samples - 1.0));
}

bool erodeRectangle(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
                    CpuLevel level, ErosionScratch& scratch, const JobControl& job) {
  const auto lower = FETTLE_AT_LEVEL(level, lowerByShift);
  const auto lesserRow = FETTLE_AT_LEVEL(level, lesserOf);
  const auto down = FETTLE_AT_LEVEL(level, leastDown);
  const std::int32_t n = to.rect.columns, window = 2 * element.columns + 1;
  const std::int32_t first = std::max(to.rect.row - element.rows, from.rect.row);
  const std::int32_t end =
      std::min(to.rect.row + to.rect.rows + element.rows, from.rect.row + from.rect.rows);
  const std::ptrdiff_t stride = (n + kStrip - 1) / kStrip * kStrip + 16;
  scratch.part.resize(static_cast<std::size_t>(stride * (end - first)));
  inParts(end - first, kRowsAtOnce, parallel, [&](std::int32_t begin, std::int32_t stop) {
    std::vector<float> own;
    std::vector<float>& line = parallel ? own : scratch.line;
    line.resize(static_cast<std::size_t>(n + window + 128));
    for (std::int32_t r = begin; r < stop && !job.cancelled(); ++r) {
      takeRow(from, first + r, to.rect.column, n, element.columns, line.data());
      int length = 1;
      // Least of `length` samples from each one on.
      for (; 2 * length <= window; length *= 2) lower(line.data(), length, n + window - 2 * length);
      lesserRow(line.data(), line.data() + window - length, scratch.part.data() + r * stride, n);
    }
  });
  const std::int32_t strips = (n + kStrip - 1) / kStrip, high = 2 * element.rows + 1;
  inParts(strips, 1, parallel, [&](std::int32_t begin, std::int32_t stop) {
    std::vector<float> ends(static_cast<std::size_t>(std::min(high, to.rect.rows) * kStrip));
    std::vector<float> out(static_cast<std::size_t>(to.rect.rows) * kStrip);
    for (std::int32_t s = begin; s < stop && !job.cancelled(); ++s) {
      const std::int32_t c = s * kStrip, wide = std::min(kStrip, n - c);
      down(scratch.part.data() + c, stride, end - first, to.rect.row - element.rows - first, high,
           ends.data(), out.data(), kStrip, to.rect.rows);
      for (std::int32_t r = 0; r < to.rect.rows; ++r)
        std::copy_n(out.data() + r * kStrip, wide, to.row(to.rect.row + r) + c);
    }
  });
  return !job.cancelled();
}

// Values to be eroded in whole blocks, with the least of each and of 8 x 8 blocks. The first result lies at a multiple of
// 64 samples in both directions.
struct BallSource {
  std::int32_t column = 0, row = 0;    // of the field, of the first value
  std::int32_t columns = 0, rows = 0;  // of larger blocks
  std::ptrdiff_t stride = 0;
  const double* values = nullptr;
  const double* least = nullptr;          // row-major, kMany * columns a row
  const double* least_of_many = nullptr;  // row-major

  [[nodiscard]] std::ptrdiff_t blocksAcross() const noexcept { return std::ptrdiff_t{columns} * kMany; }
};

BallSource sourceOf(const Patch<double>& from, const Patch<double>& to, bool parallel, CpuLevel level,
                    ErosionScratch& scratch) {
  const auto leastOf = FETTLE_AT_LEVEL(level, leastOfBlock);
  constexpr std::int32_t kSide = kBlock * kMany;
  BallSource source;
  source.column = to.rect.column - (to.rect.column - from.rect.column + kSide - 1) / kSide * kSide;
  source.row = to.rect.row - (to.rect.row - from.rect.row + kSide - 1) / kSide * kSide;
  source.columns = (from.rect.column + from.rect.columns - source.column + kSide - 1) / kSide;
  source.rows = (from.rect.row + from.rect.rows - source.row + kSide - 1) / kSide;
  source.stride = std::ptrdiff_t{source.columns} * kSide;
  scratch.source.resize(static_cast<std::size_t>(source.stride) * static_cast<std::size_t>(source.rows) *
                        kSide);
  scratch.least.resize(static_cast<std::size_t>(source.blocksAcross()) *
                       static_cast<std::size_t>(source.rows) * kMany);
  scratch.least_of_many.resize(static_cast<std::size_t>(source.columns) *
                               static_cast<std::size_t>(source.rows));
  inParts(source.rows, 1, parallel, [&](std::int32_t begin, std::int32_t end) {
    for (std::int32_t big = begin; big < end; ++big) {
      for (std::int32_t r = big * kSide; r < (big + 1) * kSide; ++r) {
        double* const out = scratch.source.data() + r * source.stride;
        const std::int32_t of_field = source.row + r;
        if (of_field < from.rect.row || of_field >= from.rect.row + from.rect.rows) {
          std::fill_n(out, source.stride, kNoDepth);
          continue;
        }
        const std::ptrdiff_t before = from.rect.column - source.column;
        std::fill_n(out, before, kNoDepth);
        std::copy_n(from.row(of_field), from.rect.columns, out + before);
        std::fill_n(out + before + from.rect.columns, source.stride - before - from.rect.columns, kNoDepth);
      }
      for (std::int32_t many = 0; many < source.columns; ++many) {
        double all = kNoDepth;
        for (std::int32_t j = big * kMany; j < (big + 1) * kMany; ++j)
          for (std::int32_t i = many * kMany; i < (many + 1) * kMany; ++i) {
            const double least =
                leastOf(scratch.source.data() + j * kBlock * source.stride + i * kBlock, source.stride);
            scratch.least[static_cast<std::size_t>(j * source.blocksAcross() + i)] = least;
            all = std::min(all, least);
          }
        scratch.least_of_many[static_cast<std::size_t>(big * source.columns + many)] = all;
      }
    }
  });
  source.values = scratch.source.data();
  source.least = scratch.least.data();
  source.least_of_many = scratch.least_of_many.data();
  return source;
}

// Erodes kHigh rows of kWide results at a time.
class BallAtWork {
 public:
  BallAtWork(const BallElement& element, const BallSource& source, CpuLevel level)
      : element_(element), source_(source), level_(level) {
    none_.fill(kNoDepth);
  }

  // The results whose first one is at the source's column x and row y; `low` is infinite, -infinite where there is none.
  void run(std::int32_t x, std::int32_t y, double* low) {
    const std::int32_t i0 = x / kBlock, j0 = y / kBlock;
    const std::int32_t across = source_.columns * kMany, up = source_.rows * kMany;
    const std::int32_t left = std::max(i0 - element_.blockColumns(), 0),
                       right = std::min(i0 + 1 + element_.blockColumns(), across - 1);
    const std::int32_t lowest = std::max(j0 - element_.blockRows(), 0),
                       highest = std::min(j0 + element_.blockRows(), up - 1);
    double most = kNoDepth;
    if (std::all_of(low, low + kWide * kHigh, [](double z) { return z < 0.0; })) return;
    large_.clear();
    for (std::int32_t j = lowest / kMany; j <= highest / kMany; ++j)
      for (std::int32_t i = left / kMany; i <= right / kMany; ++i) {
        const std::int32_t dx = std::max({0, i0 - (i * kMany + kMany - 1), i * kMany - i0 - 1});
        const std::int32_t dy = std::max({0, j0 - (j * kMany + kMany - 1), j * kMany - j0});
        large_.push_back(
            {source_.least_of_many[j * source_.columns + i] + element_.depthOfBlocks(dx, dy), i, j});
      }
    while (!large_.empty()) {
      const Bound best = takeLeast(large_);
      if (!(best.least < most)) return;
      small_.clear();
      for (std::int32_t j = std::max(best.j * kMany, lowest);
           j <= std::min(best.j * kMany + kMany - 1, highest); ++j)
        for (std::int32_t i = std::max(best.i * kMany, left);
             i <= std::min(best.i * kMany + kMany - 1, right); ++i) {
          const std::int32_t dx = std::max({0, i0 - i, i - i0 - 1}), dy = std::abs(j - j0);
          const double least = source_.least[j * source_.blocksAcross() + i] + element_.depthOfBlocks(dx, dy);
          if (least < most) small_.push_back({least, i, j});
        }
      while (!small_.empty()) {
        const Bound block = takeLeast(small_);
        if (!(block.least < most)) break;
        most = lower(x, y, block.i, block.j, low);
      }
    }
  }

 private:
  struct Bound {
    double least;
    std::int32_t i, j;
  };

  static Bound takeLeast(std::vector<Bound>& bounds) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < bounds.size(); ++k)
      if (bounds[k].least < bounds[best].least) best = k;
    const Bound bound = bounds[best];
    bounds[best] = bounds.back();
    bounds.pop_back();
    return bound;
  }

  double lower(std::int32_t x, std::int32_t y, std::int32_t i, std::int32_t j, double* low) {
    constexpr int kRows = 2 * kBlock - 1;
    std::array<const double*, kRows> depths{};
    const std::int32_t dx = x - i * kBlock, dy = y - j * kBlock;
    for (int k = 0; k < kRows; ++k) {
      const std::int32_t row = std::abs(dy + k - (kBlock - 1));
      if (row > element_.rows()) {
        depths[static_cast<std::size_t>(k)] = none_.data() + kBlock - 1;
        continue;
      }
      if (const double* const table = element_.tableRow(row)) {
        depths[static_cast<std::size_t>(k)] = table + dx;
        continue;
      }
      double* const own = own_.data() + k * kOwn;
      for (int c = 0; c < kOwn; ++c) own[c] = element_.depthAt(dx - (kBlock - 1) + c, row);
      depths[static_cast<std::size_t>(k)] = own + kBlock - 1;
    }
    return FETTLE_AT_LEVEL(level_, lowerToBlock(source_.values + j * kBlock * source_.stride + i * kBlock,
                                                source_.stride, depths.data(), low));
  }

  static constexpr int kOwn = kWide + kBlock;
  const BallElement& element_;
  const BallSource& source_;
  CpuLevel level_;
  std::vector<Bound> large_, small_;
  std::array<double, (2 * kBlock - 1) * kOwn> own_;  // depths of one block where there is no table
  std::array<double, kOwn> none_;                    // beyond the ball
};

}  // namespace

FlatElement::FlatElement(Element element, double radius_mm, const Grid& grid)
    : columns(reachIn(radius_mm, grid.spacingXMm(), grid.width)),
      rows(reachIn(radius_mm, grid.spacingYMm(), grid.height)) {
  if (element == Element::kSquare) return;
  for (std::int32_t d = 0; d <= rows; ++d) {
    const double y = d * grid.spacingYMm();
    const double rest = std::sqrt(std::max(0.0, radius_mm * radius_mm * kRoundUp - y * y));
    half.push_back(reachIn(rest, grid.spacingXMm(), grid.width));
  }
}

BallElement::BallElement(double radius_mm, double relief, const Grid& grid)
    : radius_(radius_mm),
      squared_(radius_mm * radius_mm),
      most_(squared_ * kRoundUp),
      spacing_x_(grid.spacingXMm()),
      spacing_y_(grid.spacingYMm()),
      height_mm_(grid.height_unit.mm) {
  const double wide = Grid::kMaxSide * spacing_x_, high = Grid::kMaxSide * spacing_y_;
  const double far = std::min(squared_, wide * wide + high * high);
  deepest_ = far / (radius_ + std::sqrt(squared_ - far)) / height_mm_;
  // The last one that is no deeper than the relief.
  const auto reach = [&](std::int32_t samples, const auto& depth) {
    std::int32_t low = 0, high_end = samples;
    while (low + 1 < high_end) {
      const std::int32_t middle = low + (high_end - low) / 2;
      (depth(middle) <= relief ? low : high_end) = middle;
    }
    return low;
  };
  columns_ = reach(grid.width, [&](std::int32_t d) { return depthAt(d, 0); });
  rows_ = reach(grid.height, [&](std::int32_t d) { return depthAt(0, d); });
  block_columns_ = (columns_ + 7) / kBlock + 1;
  block_rows_ = (rows_ + 7) / kBlock + 1;
  const auto gap = [](std::int32_t k) { return k == 0 ? 0 : std::int64_t{kBlock} * k - 7; };
  for (std::int32_t j = 0; j < block_rows_; ++j)
    for (std::int32_t i = 0; i < block_columns_; ++i) blocks_.push_back(depthAt(gap(i), gap(j)));
  const std::int64_t stride = 2 * (std::int64_t{columns_} + kMargin) + 1;
  if (stride * (rows_ + 1) > kLargestTable) return;
  table_stride_ = stride;
  table_.reserve(static_cast<std::size_t>(stride * (rows_ + 1)));
  for (std::int32_t r = 0; r <= rows_; ++r)
    for (std::int64_t c = -columns_ - kMargin; c <= columns_ + kMargin; ++c) table_.push_back(depthAt(c, r));
}

double BallElement::depthAt(std::int64_t columns, std::int64_t rows) const noexcept {
  const double x = static_cast<double>(columns) * spacing_x_, y = static_cast<double>(rows) * spacing_y_;
  const double distance = x * x + y * y;
  if (distance > most_) return kNoDepth;
  // Not radius - root, whose digits cancel.
  return distance / (radius_ + std::sqrt(std::max(squared_ - distance, 0.0))) / height_mm_;
}

const double* BallElement::tableRow(std::int64_t row) const noexcept {
  return table_.empty() ? nullptr : table_.data() + row * table_stride_ + columns_ + kMargin;
}

bool erode(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
           CpuLevel level, ErosionScratch& scratch, const JobControl& job) {
  return element.half.empty() ? erodeRectangle(element, from, to, parallel, level, scratch, job)
                              : erodeDisk(element, from, to, parallel, level, job);
}

bool erode(const BallElement& element, const Patch<double>& from, Patch<double>& to, bool parallel,
           CpuLevel level, ErosionScratch& scratch, const JobControl& job) {
  const BallSource source = sourceOf(from, to, parallel, level, scratch);
  const std::int32_t x0 = to.rect.column - source.column, y0 = to.rect.row - source.row;
  constexpr std::int32_t kAtOnce = 64;
  const std::int32_t across = (to.rect.columns + kAtOnce - 1) / kAtOnce,
                     up = (to.rect.rows + kAtOnce - 1) / kAtOnce;
  inParts(across * up, 1, parallel, [&](std::int32_t begin, std::int32_t end) {
    BallAtWork at_work(element, source, level);
    std::array<double, static_cast<std::size_t>(kWide * kHigh)> low;
    for (std::int32_t k = begin; k < end && !job.cancelled(); ++k) {
      const std::int32_t c_end = std::min((k % across + 1) * kAtOnce, to.rect.columns);
      const std::int32_t r_end = std::min((k / across + 1) * kAtOnce, to.rect.rows);
      for (std::int32_t r = k / across * kAtOnce; r < r_end; r += kHigh)
        for (std::int32_t c = k % across * kAtOnce; c < c_end; c += kWide) {
          const std::int32_t wide = std::min(kWide, c_end - c), high = std::min(kHigh, r_end - r);
          for (std::int32_t j = 0; j < kHigh; ++j)
            for (std::int32_t i = 0; i < kWide; ++i)
              low[static_cast<std::size_t>(j * kWide + i)] =
                  i < wide && j < high && source.values[(y0 + r + j) * source.stride + x0 + c + i] < kNoDepth
                      ? kNoDepth
                      : -kNoDepth;
          at_work.run(x0 + c, y0 + r, low.data());
          for (std::int32_t j = 0; j < high; ++j)
            std::copy_n(low.data() + j * kWide, wide, to.row(to.rect.row + r + j) + c);
        }
    }
  });
  return !job.cancelled();
}

}  // namespace fettle::engine
