// The highest or lowest few samples of a window that stand apart from all others in it. Counting them against the
// window's reach is what tells a spike from a rib: of a rib of one sample's width, straight or askew, the window around any
// of its samples, the last one too, holds at least one sample more than it reaches, and of an edge or a corner many more.
// Where holes or the field's border leave no two samples opposite each other, the plane through those that are there
// takes their place.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/padded_block.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

constexpr int kOutputs = 16;  // counted at once

#define FETTLE_KERNEL "engine/filter/outliers-inl.h"
#include "engine/simd/each_cpu-inl.h"

class OutlierFilter final : public BlockFilter {
 public:
  OutlierFilter(const FilterSpec& spec, CpuLevel level)
      : level_(level), range_(static_cast<float>(spec.range_sigma)), radius_(spec.window / 2) {}

  bool run(const Block& block, const JobControl& job) override {
    // Past the field's other side there are holes alone.
    const int reach_x = std::min(radius_, block.columns - 1), reach_y = std::min(radius_, block.rows - 1);
    padded_.fill(block, radius_, kOutputs);
    const int chunks = (block.out_columns + kOutputs - 1) / kOutputs;
    const auto outputs = static_cast<std::size_t>(chunks * kOutputs);
    const auto count_row = FETTLE_AT_LEVEL(level_, countRow);
    for (int r = 0; r < block.out_rows; ++r) {
      there_.assign(outputs, 0);
      below_.assign(outputs, 0);
      above_.assign(outputs, 0);
      const float* const centre = padded_.row(r);
      for (int dy = -reach_y; dy <= reach_y; ++dy) {
        if (job.cancelled()) return false;
        count_row(centre, padded_.row(r + dy), reach_x, range_, chunks, there_.data(), below_.data(),
                  above_.data());
      }
      float* const out = block.out + r * block.out_stride;
      std::copy_n(centre, block.out_columns, out);
      for (int c = 0; c < block.out_columns; ++c) {
        const auto i = static_cast<std::size_t>(c);
        const std::int32_t apart = std::max(below_[i], above_[i]), others = there_[i] - apart;
        if (others > radius_ || apart <= others) continue;
        const Window window{padded_.row(r) + c, reach_x, reach_y, below_[i] > above_[i]};
        const Opposite opposite = oppositeSamples(window);
        if (opposite == Opposite::kNear) continue;
        gatherApart(window);
        if (!isFarFrom(*window.centre)) continue;
        if (opposite == Opposite::kNone && !isFarFromPlane(window)) continue;
        out[c] = middleOfApart();
      }
    }
    return true;
  }

 private:
  // Of a sample that may stand apart: above all the others, or below them.
  struct Window {
    const float* centre;
    int reach_x, reach_y;
    bool above;
  };

  [[nodiscard]] bool apart(const Window& window, float sample) const noexcept {
    return (window.above ? *window.centre - sample : sample - *window.centre) > range_;
  }

  // Two samples opposite each other across it.
  enum class Opposite : std::uint8_t {
    kNone,   // of each two at least one is a hole or beyond the border
    kNear,   // of none does it stand apart from both
    kApart,  // it does of some
  };
  // In a corner of a steep plane one stands apart from all others, but never from two opposite each other.
  [[nodiscard]] Opposite oppositeSamples(const Window& window) const noexcept {
    Opposite found = Opposite::kNone;
    for (int dy = 0; dy <= window.reach_y; ++dy)
      for (int dx = dy == 0 ? 1 : -window.reach_x; dx <= window.reach_x; ++dx) {
        const std::ptrdiff_t off = dy * padded_.stride() + dx;
        const float one = window.centre[off], other = window.centre[-off];
        if (apart(window, one) && apart(window, other)) return Opposite::kApart;
        if (one == one && other == other) found = Opposite::kNear;
      }
    return found;
  }

  void gatherApart(const Window& window) {
    apart_.clear();
    for (int dy = -window.reach_y; dy <= window.reach_y; ++dy)
      for (int dx = -window.reach_x; dx <= window.reach_x; ++dx)
        if (const float sample = window.centre[dy * padded_.stride() + dx]; apart(window, sample))
          apart_.push_back(sample);
    std::ranges::sort(apart_);
  }

  // Where a steep plane meets a wall, the last sample is below all others by the plane's slope, as these are among each
  // other.
  [[nodiscard]] bool isFarFrom(float centre) const noexcept {
    const std::size_t last = std::min(static_cast<std::size_t>(2 * radius_), apart_.size() - 1);
    const bool above = centre > apart_.back();
    const double nearest = above ? apart_.back() : apart_.front();
    const double next = above ? apart_[apart_.size() - 1 - last] : apart_[last];
    return std::abs(static_cast<double>(centre) - nearest) >
           static_cast<double>(range_) + std::abs(next - nearest);
  }

  // Whether it stands apart from the least-squares plane through those that it stands apart from, by more than the range and
  // what the farthest of them is off it: a steep plane that ends at a ragged hole goes on to its last sample. Three at least
  // that do not lie on one line.
  [[nodiscard]] bool isFarFromPlane(const Window& window) const noexcept {
    const double from = *window.centre;  // sums of differences keep their digits
    double n = 0.0, x = 0.0, y = 0.0, z = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, xz = 0.0, yz = 0.0;
    const auto each = [&](const auto& take) {
      for (int dy = -window.reach_y; dy <= window.reach_y; ++dy)
        for (int dx = -window.reach_x; dx <= window.reach_x; ++dx)
          if (const float sample = window.centre[dy * padded_.stride() + dx]; apart(window, sample))
            take(static_cast<double>(dx), static_cast<double>(dy), static_cast<double>(sample) - from);
    };
    each([&](double dx, double dy, double dz) {
      n += 1.0, x += dx, y += dy, z += dz;
      xx += dx * dx, xy += dx * dy, yy += dy * dy, xz += dx * dz, yz += dy * dz;
    });
    // About the middle of the samples, n times; places are whole numbers, so that those of one line give exactly 0.
    const double a = n * xx - x * x, b = n * xy - x * y, c = n * yy - y * y;
    const double determinant = a * c - b * b;
    if (!(determinant > 0.0)) return false;
    const double u = n * xz - x * z, v = n * yz - y * z;
    const double slope_x = (u * c - v * b) / determinant, slope_y = (v * a - u * b) / determinant;
    const double here = (z - slope_x * x - slope_y * y) / n;
    double most = 0.0;
    each([&](double dx, double dy, double dz) {
      most = std::max(most, std::abs(dz - (here + slope_x * dx + slope_y * dy)));
    });
    return (window.above ? -here : here) > static_cast<double>(range_) + most;
  }

  // Their median; of an even number the mean of the middle two.
  [[nodiscard]] float middleOfApart() const noexcept {
    const std::size_t half = apart_.size() / 2;
    if (apart_.size() % 2 != 0) return apart_[half];
    return static_cast<float>(0.5 *
                              (static_cast<double>(apart_[half - 1]) + static_cast<double>(apart_[half])));
  }

  CpuLevel level_;
  float range_;
  int radius_;
  PaddedBlock padded_;
  std::vector<float> apart_;
  std::vector<std::int32_t> there_, below_, above_;  // of a row of outputs
};

}  // namespace

std::unique_ptr<BlockFilter> makeOutlierFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<OutlierFilter>(spec, level);
}

}  // namespace fettle::engine
