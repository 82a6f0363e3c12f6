// Planes in shiftable windows: in all windows of half-widths 1, 2, 3 and 5 a plane is fitted by least squares; those
// whose residual is no more than noise count, and a sample is the mean of all that cover it, each with the weight of its
// samples. A window need not be around the sample: next to an edge those count that lie on its side (M. Nagao and
// T. Matsuyama, Edge preserving smoothing, 1979; with planes for means).
//
// Worked out in squares of the field, so that the reference that heights are taken from, and with it every bit, does not
// depend on how the field is cut.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/line_sides.h"
#include "engine/filter/middle_height.h"
#include "engine/filter/planes.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/planes-inl.h"
#include "engine/simd/each_cpu-inl.h"

// The reference is the middle of the heights of every fourth column and row: it only has to be near them.
constexpr int kReferenceStep = 4;
constexpr double kTallestHeight = 1e15;  // [noises]; the sums of squares stay finite

// The residual of a window of noise alone is below it in 99 of 100: its mean, and 2.5 of its standard deviations.
double mostOfNoise(double samples) {
  return (samples - 3.0) + 2.5 * std::sqrt(2.0 * (samples - 3.0));
}

// Counts places in rectangles of a block.
class PlacesInBlock {
 public:
  void clear(int columns, int rows) {
    columns_ = columns;
    rows_ = rows;
    before_.clear();
  }
  void add(int c, int r) {
    if (before_.empty())
      before_.assign((static_cast<std::size_t>(columns_) + 1) * (static_cast<std::size_t>(rows_) + 1), 0);
    before_[corner(c + 1, r + 1)] = 1;
  }
  // Once, after all were added.
  void sum() noexcept {
    if (before_.empty()) return;
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c)
        before_[corner(c + 1, r + 1)] +=
            before_[corner(c, r + 1)] + before_[corner(c + 1, r)] - before_[corner(c, r)];
  }
  [[nodiscard]] bool none() const noexcept { return before_.empty(); }
  [[nodiscard]] bool any(int c0, int c1, int r0, int r1) const noexcept {
    return !before_.empty() && before_[corner(c1 + 1, r1 + 1)] - before_[corner(c0, r1 + 1)] -
                                       before_[corner(c1 + 1, r0)] + before_[corner(c0, r0)] !=
                                   0;
  }

 private:
  [[nodiscard]] std::size_t corner(int c, int r) const noexcept {
    return static_cast<std::size_t>(r) * (static_cast<std::size_t>(columns_) + 1) +
           static_cast<std::size_t>(c);
  }
  int columns_ = 0, rows_ = 0;
  std::vector<std::int32_t> before_;  // of the places before a column and row, their number
};

// Rows of doubles with room around them for vectors, zero at first.
class Rows {
 public:
  void resize(int columns, std::size_t rows) {
    stride_ = (columns + 7) / 8 * 8 + kBefore + kBehind;
    values_.assign(rows * static_cast<std::size_t>(stride_), 0.0);
  }
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return stride_; }
  [[nodiscard]] double* row(std::size_t r) noexcept {
    return values_.data() + kBefore + static_cast<std::ptrdiff_t>(r) * stride_;
  }

 private:
  static constexpr std::ptrdiff_t kBefore = 8, kBehind = 24;
  std::ptrdiff_t stride_ = 0;
  std::vector<double> values_;
};

// Row after row goes through all stages while it is in the cache: the windows around a row are fitted as soon as the
// last of their rows is there, and a row is gathered as soon as the last window is that covers it.
class PlanesFilter final : public BlockFilter {
 public:
  PlanesFilter(const FilterSpec& spec, CpuLevel level) : noise_(spec.range_sigma), level_(level) {}

  bool run(const Block& block, const JobControl& job) override {
    take(block);
    const int end = block.first_row + block.out_rows;
    for (int r = std::max(block.first_row - 2 * kReach, 0); r < end + 2 * kReach; ++r) {
      if (job.cancelled()) return false;
      takeRow(block, r);
      if (r - kReach >= std::max(block.first_row - kReach, 0)) fitRow(r - kReach);
      if (r - 2 * kReach >= block.first_row) writeRow(block, r - 2 * kReach);
    }
    return true;
  }

 private:
  static constexpr std::size_t kWindows = std::size(planes::kHalfWidths);
  static constexpr int kReach = planes::kHalfWidths[kWindows - 1];
  static constexpr std::size_t kKept = 2 * kReach + 1;  // rows at a time
  static constexpr std::size_t kSums = 3 * kWindows, kFigures = 4 * kWindows;
  static_assert(kReach == 5 && kWindows == 4, "as in planes-inl.h");

  // Where a row is kept; those before the first have places, too, and hold the zeros of the beginning.
  static std::size_t placeOf(int r) noexcept {
    return static_cast<std::size_t>(r + 2 * static_cast<int>(kKept)) % kKept;
  }

  void take(const Block& block) {
    columns_ = block.columns;
    rows_ = block.rows;
    heights_.resize(columns_, kKept);
    sums_.resize(columns_, kSums);
    planes_.resize(columns_, kKept * kFigures);
    gathered_.resize(columns_, kSums);
    counts_.resize(columns_, kWindows + 1);
    for (std::size_t k = 0; k < kSums; ++k) {
      sum_rows_[k] = sums_.row(k);
      gathered_rows_[k] = gathered_.row(k);
    }
    for (std::size_t w = 0; w < kWindows; ++w)
      for (int c = planes::kHalfWidths[w]; c < columns_ - planes::kHalfWidths[w]; ++c)
        counts_.row(w)[c] = samplesOf(planes::kHalfWidths[w]);
    reference_ = middleHeight(block, scratch_, kReferenceStep);
    holes_.clear(columns_, rows_);
    if (block.holes)
      for (int r = 0; r < rows_; ++r)
        for (int c = 0; c < columns_; ++c)
          if (std::isnan(block.row(r)[c])) holes_.add(c, r);
    holes_.sum();
    takeLines(block);
  }

  // A window reaches over a line where it has both samples of a cut link.
  void takeLines(const Block& block) {
    LineSides lines;
    cut_right_.clear(columns_, rows_);
    cut_up_.clear(columns_, rows_);
    if (!lines.take(block)) return;
    lines.forEachCut([this](std::int32_t c, std::int32_t r, std::uint8_t links) {
      if ((links & LineCut::kRight) != 0) cut_right_.add(c, r);
      if ((links & LineCut::kUp) != 0) cut_up_.add(c, r);
    });
    cut_right_.sum();
    cut_up_.sum();
  }

  static double samplesOf(int h) noexcept { return (2.0 * h + 1.0) * (2.0 * h + 1.0); }

  void takeRow(const Block& block, int r) {
    double* to = heights_.row(placeOf(r));
    if (r >= rows_)
      std::fill_n(to, columns_, 0.0);
    else
      FETTLE_AT_LEVEL(level_, heightsInNoises)
    (block.row(r), columns_, reference_, 1.0 / noise_, kTallestHeight, to);
    // What a vector took from beyond the last column may be anything.
    std::fill_n(to + columns_, 8, 0.0);
  }

  // The samples of each window of half-width `planes::kHalfWidths[w]` around a row, 0 where it is not whole.
  const double* countsAt(std::size_t w, int r) noexcept {
    if (holes_.none() && cut_right_.none() && cut_up_.none()) return counts_.row(w);
    const int h = planes::kHalfWidths[w];
    double* own = counts_.row(kWindows);
    std::fill_n(own, columns_, 0.0);
    for (int c = h; c < columns_ - h; ++c)
      if (!holes_.any(c - h, c + h, r - h, r + h) && !cut_right_.any(c - h, c + h - 1, r - h, r + h) &&
          !cut_up_.any(c - h, c + h, r - h, r + h - 1))
        own[c] = samplesOf(h);
    return own;
  }

  [[nodiscard]] double* planesOf(int r) noexcept { return planes_.row(placeOf(r) * kFigures); }

  void fitRow(int r) {
    if (r < rows_) {
      std::array<const double*, kKept> heights{};
      for (int k = -kReach; k <= kReach; ++k)
        heights[static_cast<std::size_t>(k + kReach)] = heights_.row(placeOf(r + k));
      FETTLE_AT_LEVEL(level_, sumColumns)(heights.data() + kReach, columns_, sum_rows_.data());
    }
    for (std::size_t w = 0; w < kWindows; ++w) {
      const int h = planes::kHalfWidths[w];
      double* to = planesOf(r) + static_cast<std::ptrdiff_t>(4 * w) * planes_.stride();
      const auto figure = [&](std::ptrdiff_t k) { return to + k * planes_.stride(); };
      if (r < h || r >= rows_ - h) {
        for (std::ptrdiff_t k = 0; k < 4; ++k) std::fill_n(figure(k), columns_, 0.0);
        continue;
      }
      FETTLE_AT_LEVEL(level_, fitWindows)
      (h, sum_rows_[3 * w], sum_rows_[3 * w + 1], sum_rows_[3 * w + 2], countsAt(w, r), columns_,
       mostOfNoise(samplesOf(h)), figure(0), figure(1), figure(2), figure(3));
    }
  }

  void writeRow(const Block& block, int r) {
    std::array<const double*, kKept> rows{};
    for (int k = -kReach; k <= kReach; ++k) rows[static_cast<std::size_t>(k + kReach)] = planesOf(r + k);
    FETTLE_AT_LEVEL(level_, gatherColumns)
    (rows.data() + kReach, planes_.stride(), columns_, gathered_rows_.data());
    std::array<const double*, kSums> from{};
    for (std::size_t k = 0; k < kSums; ++k) from[k] = gathered_rows_[k] + block.first_column;
    FETTLE_AT_LEVEL(level_, writeRow)
    (from.data(), heights_.row(placeOf(r)) + block.first_column, block.row(r) + block.first_column,
     block.out_columns, noise_, block.out + (r - block.first_row) * block.out_stride);
  }

  double noise_;
  CpuLevel level_;
  double reference_ = 0.0;
  int columns_ = 0, rows_ = 0;
  Rows heights_, sums_, planes_, gathered_, counts_;
  std::array<double*, kSums> sum_rows_{}, gathered_rows_{};
  std::vector<float> scratch_;
  PlacesInBlock holes_, cut_right_, cut_up_;
};

}  // namespace

std::unique_ptr<BlockFilter> makePlanesFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<PlanesFilter>(spec, level);
}

}  // namespace fettle::engine
