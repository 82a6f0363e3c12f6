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

class PlanesFilter final : public BlockFilter {
 public:
  PlanesFilter(const FilterSpec& spec, CpuLevel level) : noise_(spec.range_sigma), level_(level) {}

  bool run(const Block& block, const JobControl& job) override {
    take(block);
    for (const int h : planes::kHalfWidths) {
      if (2 * h + 1 > columns_ || 2 * h + 1 > rows_) continue;
      findWhole(h);
      if (!fit(h, job) || !gather(h, job)) return false;
    }
    write(block);
    return true;
  }

 private:
  enum Array : std::size_t {
    kHeights,
    kWhole,
    kWeight,
    kPlane,
    kAlong,
    kAcross,
    kTotalWeight,
    kTotal,
    kArrays
  };

  [[nodiscard]] double* row(Array array, int r) noexcept {
    return arrays_[array].data() + static_cast<std::ptrdiff_t>(r) * columns_;
  }

  void take(const Block& block) {
    columns_ = block.columns;
    rows_ = block.rows;
    const std::size_t samples = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
    for (std::vector<double>& array : arrays_) array.assign(samples, 0.0);
    for (std::vector<double>& sums : sums_) sums.resize(static_cast<std::size_t>(columns_));
    reference_ = middleHeight(block, scratch_);
    holes_.clear(columns_, rows_);
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c) {
        const float z = block.row(r)[c];
        if (!(z == z)) {
          holes_.add(c, r);
          continue;
        }
        const double above = (static_cast<double>(z) - reference_) / noise_;
        row(kHeights, r)[c] = std::clamp(above, -kTallestHeight, kTallestHeight);
      }
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

  void findWhole(int h) {
    for (int r = h; r < rows_ - h; ++r)
      for (int c = h; c < columns_ - h; ++c) {
        const bool whole = !holes_.any(c - h, c + h, r - h, r + h) &&
                           !cut_right_.any(c - h, c + h - 1, r - h, r + h) &&
                           !cut_up_.any(c - h, c + h, r - h, r + h - 1);
        row(kWhole, r)[c] = whole ? 1.0 : 0.0;
      }
  }

  bool fit(int h, const JobControl& job) {
    const auto sum_columns = FETTLE_AT_LEVEL(level_, sumColumns);
    const auto fit_windows = FETTLE_AT_LEVEL(level_, fitWindows);
    const double side = 2.0 * h + 1.0, most = mostOfNoise(side * side);
    for (const Array array : {kWeight, kPlane, kAlong, kAcross}) std::ranges::fill(arrays_[array], 0.0);
    for (int r = h; r < rows_ - h; ++r) {
      if (job.cancelled()) return false;
      std::array<const double*, kMostRows> rows{};
      for (int k = -h; k <= h; ++k) rows[static_cast<std::size_t>(k + h)] = row(kHeights, r + k);
      sum_columns(rows.data(), h, columns_, sums_[0].data(), sums_[1].data(), sums_[2].data());
      fit_windows(sums_[0].data(), sums_[1].data(), sums_[2].data(), row(kWhole, r), h, columns_, most,
                  row(kWeight, r), row(kPlane, r), row(kAlong, r), row(kAcross, r));
    }
    return true;
  }

  bool gather(int h, const JobControl& job) {
    const auto gather_columns = FETTLE_AT_LEVEL(level_, gatherColumns);
    const auto gather_row = FETTLE_AT_LEVEL(level_, gatherRow);
    // Rows and columns that fewer windows cover have them, too: beyond the block there are none.
    const std::vector<double> none(static_cast<std::size_t>(columns_) + 2U * static_cast<std::size_t>(h),
                                   0.0);
    std::array<std::vector<double>, 3> wide;
    for (std::vector<double>& sums : wide) sums.assign(none.size(), 0.0);
    wide_total_.resize(none.size());
    wide_weight_.resize(none.size());
    for (int r = 0; r < rows_; ++r) {
      if (job.cancelled()) return false;
      std::array<std::array<const double*, kMostRows>, 4> planes{};
      for (int k = -h; k <= h; ++k)
        for (std::size_t a = 0; a < planes.size(); ++a)
          planes[a][static_cast<std::size_t>(k + h)] =
              r + k >= 0 && r + k < rows_ ? row(static_cast<Array>(kWeight + a), r + k) : none.data();
      gather_columns(planes[0].data(), planes[1].data(), planes[2].data(), planes[3].data(), h, columns_,
                     wide[0].data() + h, wide[1].data() + h, wide[2].data() + h);
      std::ranges::fill(wide_total_, 0.0);
      std::ranges::fill(wide_weight_, 0.0);
      gather_row(wide[0].data(), wide[1].data(), wide[2].data(), h, static_cast<int>(none.size()),
                 wide_weight_.data(), wide_total_.data());
      for (int c = 0; c < columns_; ++c) {
        row(kTotalWeight, r)[c] += wide_weight_[static_cast<std::size_t>(c + h)];
        row(kTotal, r)[c] += wide_total_[static_cast<std::size_t>(c + h)];
      }
    }
    return true;
  }

  // Through the difference to the height, which is of the order of the noise.
  void write(const Block& block) {
    for (int r = 0; r < block.out_rows; ++r) {
      const int from = block.first_row + r;
      const float* heights = block.row(from) + block.first_column;
      float* out = block.out + r * block.out_stride;
      for (int c = 0; c < block.out_columns; ++c) {
        const int column = block.first_column + c;
        const double weight = row(kTotalWeight, from)[column];
        const double change =
            weight > 0.0 ? row(kTotal, from)[column] / weight - row(kHeights, from)[column] : 0.0;
        out[c] = static_cast<float>(static_cast<double>(heights[c]) + noise_ * change);
      }
    }
  }

  static constexpr std::size_t kMostRows = 2 * planes::kHalfWidths[std::size(planes::kHalfWidths) - 1] + 1;

  double noise_;
  CpuLevel level_;
  double reference_ = 0.0;
  int columns_ = 0, rows_ = 0;
  std::array<std::vector<double>, kArrays> arrays_;
  std::array<std::vector<double>, 3> sums_;
  std::vector<double> wide_total_, wide_weight_;
  std::vector<float> scratch_;
  PlacesInBlock holes_, cut_right_, cut_up_;
};

}  // namespace

std::unique_ptr<BlockFilter> makePlanesFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<PlanesFilter>(spec, level);
}

}  // namespace fettle::engine
