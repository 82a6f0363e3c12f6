#include "engine/filter/lone_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fettle::engine {

namespace {

constexpr int kCompany = 3;         // counts that a sample needs
constexpr float kSame = 4.0F;       // of two heights on one surface, but for one pair of 200
constexpr float kContinues = 2.0F;  // how far a side continues, in its own spread
constexpr int kFewest = 4;          // samples between surfaces that are not chance

class Heights {
 public:
  Heights(const float* heights, std::ptrdiff_t stride, std::int32_t columns, std::int32_t rows)
      : heights_(heights), stride_(stride), columns_(columns), rows_(rows) {}

  [[nodiscard]] bool has(std::int32_t column, std::int32_t row) const noexcept {
    return column >= 0 && row >= 0 && column < columns_ && row < rows_;
  }
  [[nodiscard]] float operator()(std::int32_t column, std::int32_t row) const noexcept {
    return heights_[row * stride_ + column];
  }

  [[nodiscard]] bool isAlone(std::int32_t column, std::int32_t row) const noexcept {
    const float z = (*this)(column, row);
    int count = 0;
    bool twin = false;  // a sample next to it of the same height
    // The nearest first: on most surfaces they are enough.
    for (const std::int32_t reach : {1, 2})
      for (std::int32_t y = -reach; y <= reach; ++y)
        for (std::int32_t x = -reach; x <= reach; ++x) {
          if (std::max(std::abs(x), std::abs(y)) != reach || !has(column + x, row + y)) continue;
          if (!(std::fabs((*this)(column + x, row + y) - z) <= kSame)) continue;
          twin = twin || reach == 1;
          if (++count >= kCompany) return false;
        }
    for (std::int32_t y = -1; y <= 1; ++y)
      for (std::int32_t x = -1; x <= 1; ++x) {
        if (x != 0 || y != 0) count += leadsTo(z, column, row, x, y);
        if (count >= kCompany) return false;
      }
    return !joinsASide(column, row) && !(twin && sticksOut(column, row));
  }

  // Whether it lies above or below all of the samples next to it that have another height.
  [[nodiscard]] bool sticksOut(std::int32_t column, std::int32_t row) const noexcept {
    const float z = (*this)(column, row);
    bool above = true, below = true;
    for (std::int32_t y = row - 1; y <= row + 1; ++y)
      for (std::int32_t x = column - 1; x <= column + 1; ++x) {
        if (!has(x, y)) continue;
        above = above && !((*this)(x, y) > z + kSame);
        below = below && !((*this)(x, y) < z - kSame);
      }
    return above || below;
  }

 private:
  // Whether it continues the nearer of the two sides that the samples next to it fall into at their largest
  // gap: where a surface is so steep or curved that they differ by as much themselves.
  [[nodiscard]] bool joinsASide(std::int32_t column, std::int32_t row) const noexcept {
    const float z = (*this)(column, row);
    std::array<float, 8> next;
    next.fill(std::numeric_limits<float>::infinity());
    std::size_t n = 0;
    for (std::int32_t y = row - 1; y <= row + 1; ++y)
      for (std::int32_t x = column - 1; x <= column + 1; ++x)
        if (has(x, y) && (x != column || y != row) && (*this)(x, y) == (*this)(x, y))
          next[n++] = (*this)(x, y);
    if (n < 4) return false;
    std::ranges::sort(next);
    float widest = 0.0F;
    for (std::size_t i = 1; i < n; ++i) widest = std::max(widest, next[i] - next[i - 1]);
    for (std::size_t i = 1; i < n; ++i) {
      // Of equal gaps any counts, as of sides equally near: what is upside down has the same company.
      if (next[i] - next[i - 1] < widest) continue;
      const float to_low = z - next[i - 1], to_high = next[i] - z;
      if (to_low <= to_high && continues(to_low, next[0] - z, i, next[i - (i > 3 ? 2 : 1)] - next[0]))
        return true;
      if (to_high <= to_low &&
          continues(to_high, z - next[n - 1], n - i, next[n - 1] - next[i + (n - i > 3 ? 1 : 0)]))
        return true;
    }
    return false;
  }

  // How far it lies from a side of so many samples, in the gap or past its other end. The spread is that
  // without the sample nearest to the gap, which may be a lone one itself; of few samples that of all.
  [[nodiscard]] static bool continues(float in_gap, float past, std::size_t samples, float spread) noexcept {
    if (in_gap <= 0.0F && past <= 0.0F) return samples > 1;
    return samples > 1 && in_gap <= kContinues * spread && past < spread;
  }

  [[nodiscard]] int leadsTo(float z, std::int32_t column, std::int32_t row, std::int32_t x,
                            std::int32_t y) const noexcept {
    if (!has(column + 2 * x, row + 2 * y)) return 0;
    const float a = (*this)(column + x, row + y);
    const float b = (*this)(column + 2 * x, row + 2 * y);
    const float slope = std::fabs(a - b);
    const float line = std::fabs(2.0F * a - b - z);
    float parabola = line;
    if (has(column + 3 * x, row + 3 * y))
      parabola = std::fabs(3.0F * (a - b) + (*this)(column + 3 * x, row + 3 * y) - z);
    if (line <= 4.0F + 0.1F * slope || parabola <= 6.0F + 0.1F * slope) return 2;
    return line <= 8.0F + 0.3F * slope || parabola <= 12.0F + 0.3F * slope ? 1 : 0;
  }

  const float* heights_;
  std::ptrdiff_t stride_;
  std::int32_t columns_, rows_;
};

}  // namespace

std::vector<LoneSample> findLoneSamples(const float* heights, std::ptrdiff_t stride, std::int32_t columns,
                                        std::int32_t rows) {
  const Heights z(heights, stride, columns, rows);
  std::vector<LoneSample> lone;
  for (std::int32_t r = 0; r < rows; ++r)
    for (std::int32_t c = 0; c < columns; ++c)
      if (z(c, r) == z(c, r) && z.isAlone(c, r)) lone.push_back({c, r, z(c, r)});
  const auto between = [&z](const LoneSample& s) { return !z.sticksOut(s.column, s.row); };
  if (std::ranges::count_if(lone, between) < kFewest) std::erase_if(lone, between);
  const auto isLone = [&lone](std::int32_t c, std::int32_t r) {
    const auto at = std::ranges::lower_bound(
        lone, r * std::int64_t{1} << 32 | c, {},
        [](const LoneSample& s) { return s.row * std::int64_t{1} << 32 | s.column; });
    return at != lone.end() && at->column == c && at->row == r;
  };
  for (LoneSample& sample : lone) {
    std::array<float, 24> around{};
    int count = 0;
    for (std::int32_t y = sample.row - 2; y <= sample.row + 2; ++y)
      for (std::int32_t x = sample.column - 2; x <= sample.column + 2; ++x)
        if (z.has(x, y) && z(x, y) == z(x, y) && !isLone(x, y))
          around[static_cast<std::size_t>(count++)] = z(x, y);
    if (count == 0) continue;
    // The mean of the two middle ones of an even count: what is upside down has the same between.
    std::sort(around.begin(), around.begin() + count);
    const auto low = static_cast<std::size_t>((count - 1) / 2), high = static_cast<std::size_t>(count / 2);
    sample.between = low == high ? around[low] : 0.5F * (around[low] + around[high]);
  }
  return lone;
}

}  // namespace fettle::engine
