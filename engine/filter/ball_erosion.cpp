// Erosion by a ball: how high it can lie below a sample is, by where its middle is, a bowl of the ball's shape; the result is the least
// of all bowls. Bowls are convex, and none is curved less than the ball at its top. So one lies nowhere below another one on a block
// of results if it does not at the block's middle, with the differences of their slopes there taken from it: a test of a few
// operations that leaves, of any ground, little more than those samples that the ball touches (docs/decisions/rolled-balls.md).
// Groups of samples are left out the same way, by a plane that none of them lies below.

#include "engine/filter/ball_erosion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/filter/ball_near.h"
#include "engine/filter/bowls.h"
#include "engine/filter/erosion_rows.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/ball_erosion-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr std::int32_t kSide = 16;  // of large groups and of blocks of results
constexpr int kListed = 8192;       // small groups that are gone through at once
constexpr int kCrowd = 512;         // small groups at whose number no test pays any more
constexpr float kAnything = 3e38F;  // above all that is no sample
constexpr double kNoSample = std::numeric_limits<double>::infinity();
constexpr float kSteepestSlope = 4.0F;  // that groups are tilted by
constexpr std::size_t kPad = 16;

// Values to be eroded and their groups. The first result lies at a multiple of 16 samples from the first group.
template <class T>
struct BowlField {
  const Patch<T>& from;
  const BallScratch& groups;
  double base;                 // that floats count from
  std::int32_t column, row;    // of the field, of the first group
  std::int32_t columns, rows;  // of large groups
  std::ptrdiff_t stride;       // of large groups
};

// A height that most others are not far from, so that floats from there on are fine.
template <class T>
double middleOf(const Patch<T>& from, const BallElement& element) {
  const double largest = std::max(std::fabs(element.lowest()), std::fabs(element.highest()));
  if (largest > 1e30) return -largest;
  constexpr std::int64_t kLooks = 64;
  const std::int64_t count = std::int64_t{from.rect.columns} * from.rect.rows;
  std::array<double, kLooks> seen{};
  std::size_t n = 0;
  for (std::int64_t k = 0; k < kLooks; ++k) {
    const std::int64_t at = (2 * k + 1) * count / (2 * kLooks);
    const auto z = static_cast<double>(
        from.row(from.rect.row + static_cast<std::int32_t>(at / from.rect.columns))[at % from.rect.columns]);
    if (z < kNoSample) seen[n++] = z;
  }
  if (n == 0) return 0.0;
  std::nth_element(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(n / 2),
                   seen.begin() + static_cast<std::ptrdiff_t>(n));
  return seen[n / 2];
}

template <class T>
BowlField<T> fieldOf(const BallElement& element, const Patch<T>& from, const SampleRect& to, bool parallel,
                     CpuLevel level, BallScratch& scratch) {
  const auto group = FETTLE_AT_LEVEL(level, groupSamples<T>);
  const std::int32_t column = to.column - (to.column - from.rect.column + kSide - 1) / kSide * kSide,
                     row = to.row - (to.row - from.rect.row + kSide - 1) / kSide * kSide;
  const std::int32_t columns = (from.rect.column + from.rect.columns - column + kSide - 1) / kSide,
                     rows = (from.rect.row + from.rect.rows - row + kSide - 1) / kSide;
  BowlField<T> field{from, scratch, middleOf(from, element), column, row, columns, rows, columns};
  const std::size_t large = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  for (std::vector<float>* each : {&scratch.large_least, &scratch.large_x, &scratch.large_y})
    each->resize(large + kPad);
  scratch.small_least.resize(16 * large);
  scratch.blocked.resize(256 * large);
  const double height = element.depth().height_mm;
  const auto most_x = static_cast<float>(kSteepestSlope * element.depth().spacing_x / height),
             most_y = static_cast<float>(kSteepestSlope * element.depth().spacing_y / height);
  inParts(rows, 4, parallel, [&](std::int32_t begin, std::int32_t end) {
    std::array<T, kSide * kSide> edge;
    std::array<const T*, kSide> lines{};
    for (std::int32_t j = begin; j < end; ++j)
      for (std::int32_t i = 0; i < columns; ++i) {
        const std::int32_t c = column + i * kSide, r = row + j * kSide;
        const std::int32_t c0 = std::max(c, from.rect.column),
                           c1 = std::min(c + kSide, from.rect.column + from.rect.columns);
        const std::int32_t r0 = std::max(r, from.rect.row),
                           r1 = std::min(r + kSide, from.rect.row + from.rect.rows);
        const bool whole = c1 - c0 == kSide && r1 - r0 == kSide;
        if (!whole) {
          edge.fill(std::numeric_limits<T>::infinity());
          for (std::int32_t y = r0; y < r1; ++y)
            std::copy_n(from.row(y) + (c0 - from.rect.column), c1 - c0,
                        edge.data() + (y - r) * kSide + (c0 - c));
        }
        for (std::int32_t k = 0; k < kSide; ++k)
          lines[static_cast<std::size_t>(k)] =
              whole ? from.row(r + k) + (c - from.rect.column) : edge.data() + k * kSide;
        const std::size_t at =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
        std::array<float, 3> bound{};
        group(lines.data(), field.base, most_x, most_y, scratch.blocked.data() + 256 * at,
              scratch.small_least.data() + 16 * at, bound.data());
        scratch.large_least[at] = bound[0];
        scratch.large_x[at] = bound[1];
        scratch.large_y[at] = bound[2];
      }
  });
  return field;
}

// Lists of small groups and what they come to.
class GroupList {
 public:
  GroupList() : floats_(kWidth * 9), numbers_(kWidth) {}

  [[nodiscard]] SmallGroups groups() noexcept { return {at(0), at(1), at(2), at(3), at(4), numbers_.data()}; }
  [[nodiscard]] GroupBowls bowls() noexcept { return {at(5), at(6), at(7), at(8)}; }

 private:
  static constexpr std::size_t kWidth = kListed + 3 * kPad;
  float* at(std::size_t k) noexcept { return floats_.data() + k * kWidth; }
  std::vector<float> floats_;
  std::vector<std::int32_t> numbers_;
};

// Erodes 16 x 16 results at a time.
template <class T>
class BowlsAtWork {
 public:
  BowlsAtWork(const BallElement& element, const BowlField<T>& field, CpuLevel level)
      : element_(element), field_(field), level_(level), heights_(kPlaces + kPad), depths_(kPlaces + kPad) {
    const std::size_t across = static_cast<std::size_t>(2 * element.columns() + 2 * kSide) / kSide + 2;
    const std::size_t up = static_cast<std::size_t>(2 * element.rows() + 2 * kSide) / kSide + 2;
    // Whole vectors for each row.
    const std::size_t most =
        std::min<std::size_t>((across + kPad) * up, (static_cast<std::size_t>(field.columns) + kPad) *
                                                        static_cast<std::size_t>(field.rows));
    large_.resize(4 * (most + kPad));
    large_numbers_.resize(most + kPad);
    for (const std::int32_t side : {16, 8})
      steepest_[static_cast<std::size_t>(side)] = element.steepest(side);
    // Sums are rounded once, depths a few times.
    rounding_ =
        0x1p-48 * (std::max(std::fabs(element.lowest()), std::fabs(element.highest())) + element.deepest());
  }

  // The results from x, y on, samples from the first group; 16 a row in `low`, infinite before.
  void run(std::int32_t x, std::int32_t y, double* low) {
    x_ = x;
    y_ = y;
    low_ = low;
    const Patch<T>& from = field_.from;
    origin_ = from.values.data() + (field_.row + y - from.rect.row) * from.stride +
              (field_.column + x - from.rect.column);
    const std::int32_t i0 = std::max(x - element_.columns(), 0) / kSide,
                       j0 = std::max(y - element_.rows(), 0) / kSide;
    const std::int32_t i1 = std::min((x + kSide - 1 + element_.columns()) / kSide, field_.columns - 1),
                       j1 = std::min((y + kSide - 1 + element_.rows()) / kSide, field_.rows - 1);
    const std::int32_t wide = i1 - i0 + 1, rounded = (wide + 15) / 16 * 16;
    const std::size_t first = static_cast<std::size_t>(j0 * field_.stride + i0);
    const BallScratch& all = field_.groups;
    const LargeGroups window{all.large_least.data() + first,
                             all.large_x.data() + first,
                             all.large_y.data() + first,
                             field_.stride,
                             wide,
                             j1 - j0 + 1,
                             static_cast<float>(i0 * kSide - x),
                             static_cast<float>(j0 * kSide - y)};
    float* const scratch = large_.data();
    const std::size_t length = large_.size() / 4;
    const GroupBowls bowls{scratch, scratch + length, scratch + 2 * length, scratch + 3 * length};
    const int n = FETTLE_AT_LEVEL(level_, boundLarge)(window, element_.shape(), bowls);
    const int best = FETTLE_AT_LEVEL(level_, leastOf)(bowls.middle, n);
    const std::int32_t best_i = i0 + best % rounded, best_j = j0 + best / rounded;
    const std::ptrdiff_t best_large = best_j * field_.stride + best_i;
    const auto best_x = static_cast<float>(best_i * kSide - x),
               best_y = static_cast<float>(best_j * kSide - y);
    constexpr float kFirstMiddle = 1.5F - 0.5F * (kSide - 1);  // of a small group, from the results' middle
    std::array<float, 2> slopes{};
    const int lane = std::max(FETTLE_AT_LEVEL(level_, lowestOfFour)(
                                  all.small_least.data() + 16 * best_large, best_x + kFirstMiddle,
                                  best_y + kFirstMiddle, 4.0F, element_.shape(), kAnything, slopes.data()),
                              0);
    const int lane_x = lane % 4 * 4, lane_y = lane / 4 * 4;
    const Tests test =
        anyTestOf(static_cast<std::int32_t>(16 * best_large + lane), best_x + static_cast<float>(lane_x),
                  best_y + static_cast<float>(lane_y), {0, 0, kSide, kSide});
    const int taken = FETTLE_AT_LEVEL(level_, takeGroups)(bowls, n, test.large, large_numbers_.data());
    const auto take = FETTLE_AT_LEVEL(level_, takeSmall);
    int listed = 0;
    for (int k = 0; k < taken; ++k) {
      const std::int32_t place = large_numbers_[static_cast<std::size_t>(k)], i = i0 + place % rounded,
                         j = j0 + place / rounded;
      const std::ptrdiff_t at = j * field_.stride + i;
      listed = take(all.small_least.data() + 16 * at, all.large_x[static_cast<std::size_t>(at)],
                    all.large_y[static_cast<std::size_t>(at)], static_cast<float>(i * kSide - x) + 1.5F,
                    static_cast<float>(j * kSide - y) + 1.5F, static_cast<std::int32_t>(16 * at),
                    element_.shape(), test.groups, block_.groups(), listed);
      if (listed > kListed - 16) {
        goThrough(listed);
        listed = 0;
      }
    }
    if (listed > 0) goThrough(listed);
  }

 private:
  // What small groups and samples have to be lower than.
  struct Tests {
    BowlTest large, groups;
    float samples;
  };

  // Results, from the first one of 16 x 16.
  struct Block {
    int x, y, wide, high;
  };

  // A bowl of small group `number`, its first sample at x, y from the 16 x 16 results, against which others are held on a block.
  Tests testOf(std::int32_t number, float x, float y, const Block& block) {
    const double half_x = 0.5 * (block.wide - 1), half_y = 0.5 * (block.high - 1);
    const auto middle_x = static_cast<float>(block.x + half_x),
               middle_y = static_cast<float>(block.y + half_y);
    std::array<float, 2> slopes{};
    const int lane = FETTLE_AT_LEVEL(level_, lowestOfFour)(
        field_.groups.blocked.data() + std::ptrdiff_t{number} * 16, x - middle_x, y - middle_y, 1.0F,
        element_.shape(), steepest_[static_cast<std::size_t>(block.wide)], slopes.data());
    // A little more than half, as the slopes' differences are rounded.
    constexpr float kRounding = 1.0F + 0x1p-15F;
    const BowlTest none{middle_x,
                        middle_y,
                        static_cast<float>(half_x) * kRounding,
                        static_cast<float>(half_y) * kRounding,
                        slopes[0],
                        slopes[1],
                        kAnything};
    Tests tests{none, none, kAnything};
    if (lane < 0) return tests;
    const int qx = static_cast<int>(x) + lane % 4, qy = static_cast<int>(y) + lane / 4;
    const double z = static_cast<double>(origin_[qy * field_.from.stride + qx]) - field_.base;
    // Convex, so that it is highest above a plane at a corner.
    double above = -kNoSample, deepest = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int cx = k % 2 == 0 ? block.x : block.x + block.wide - 1,
                cy = k < 2 ? block.y : block.y + block.high - 1;
      const double depth = depthOf(cx - qx, cy - qy);
      deepest = std::max(deepest, depth);
      above = std::max(above, z + depth - slopes[0] * (cx - static_cast<double>(middle_x)) -
                                  slopes[1] * (cy - static_cast<double>(middle_y)));
    }
    if (!(above < 1e37)) return tests;
    // All bowls are curved at least so much, which needs no slope.
    const double curved_x = element_.curvedX() * half_x, curved_y = element_.curvedY() * half_y;
    const double shared = 0.5 * (curved_x * half_x + curved_y * half_y);
    const double size = std::fabs(z) + deepest + 8.0 * (std::fabs(slopes[0]) + std::fabs(slopes[1])) + shared;
    // Of a group's samples, whose middles lie 1.5 samples from the group's at most, that is true but for their distance.
    tests.large.most = static_cast<float>(above + 0x1p-16 * size + rounding_);
    tests.groups.most = static_cast<float>(std::min(above, above - shared + (curved_x + curved_y) * 1.5) +
                                           0x1p-16 * size + rounding_);
    tests.samples = static_cast<float>(above - shared + 0x1p-19 * size + rounding_);
    return tests;
  }

  [[nodiscard]] double depthOf(int columns, int rows) const noexcept {
    const double* const table = element_.table();
    return table == nullptr ? element_.depthAt(columns, rows)
                            : table[rows * element_.tableStride() + columns];
  }

  // The groups that are listed in block_, for 16 x 16 results.
  void goThrough(int listed) {
    for (int by = 0; by < kSide; by += 8)
      for (int bx = 0; bx < kSide; bx += 8) {
        const Block part{bx, by, 8, 8};
        const Tests tests = leastAt(block_, listed, part);
        const int n = FETTLE_AT_LEVEL(level_, takeSmallOf<true>)(block_.groups(), block_.bowls(), listed,
                                                                 tests.groups, part_.groups());
        if (n > kCrowd) {
          BowlTest any = tests.groups;
          any.most = kAnything;
          lower(part_.groups(), n, any, part, nullptr);
          continue;
        }
        for (const Block& half : {Block{bx, by, 8, 4}, Block{bx, by + 4, 8, 4}}) {
          Tests few = leastAt(part_, n, half);
          const int m = FETTLE_AT_LEVEL(level_, takeSmallOf<false>)(part_.groups(), part_.bowls(), n,
                                                                    few.groups, few_.groups());
          few.groups.most = few.samples;
          lower(few_.groups(), m, few.groups, half, element_.patches());
        }
      }
  }

  Tests leastAt(GroupList& list, int count, const Block& block) {
    const SmallGroups groups = list.groups();
    FETTLE_AT_LEVEL(level_, boundSmall)
    (groups, count, static_cast<float>(block.x) + 0.5F * static_cast<float>(block.wide - 1),
     static_cast<float>(block.y) + 0.5F * static_cast<float>(block.high - 1), element_.shape(), list.bowls());
    const int best = FETTLE_AT_LEVEL(level_, leastOf)(list.bowls().middle, count);
    return anyTestOf(groups.number[best], groups.x[best] - 1.5F, groups.y[best] - 1.5F, block);
  }

  // As testOf, and where that bowl ends within the block, by one at its middle.
  Tests anyTestOf(std::int32_t number, float x, float y, const Block& block) {
    const Tests tests = testOf(number, x, y, block);
    if (tests.samples < kAnything) return tests;
    const int i = (block.x + block.wide / 2) / 4, j = (block.y + block.high / 2) / 4;
    const std::ptrdiff_t large = y_ / kSide * field_.stride + x_ / kSide;
    return testOf(static_cast<std::int32_t>(16 * large + 4 * j + i), static_cast<float>(4 * i),
                  static_cast<float>(4 * j), block);
  }

  // Lowers results to those samples of the first `count` groups that can be lower.
  void lower(const SmallGroups& groups, int count, const BowlTest& test, const Block& block,
             const float* patches) {
    const float* const z = field_.groups.blocked.data();
    const double* const table = element_.table();
    if (table == nullptr) {
      FETTLE_AT_LEVEL(level_, lowerFar<T>)
      (origin_, field_.from.stride, z, groups, count, element_.depth(), element_.shape(), test, block.x,
       block.y, block.high, low_);
      return;
    }
    const auto take = patches == nullptr ? FETTLE_AT_LEVEL(level_, takeSamples<false>)
                                         : FETTLE_AT_LEVEL(level_, takeSamples<true>);
    const BowlPlaces places{heights_.data(), depths_.data()};
    for (int k = 0; k < count; k += kPlaces / 16) {
      const SmallGroups some{nullptr, nullptr, nullptr, groups.x + k, groups.y + k, groups.number + k};
      const int n = take(z, some, std::min(count - k, kPlaces / 16), patches, element_.patchStride(),
                         element_.shape(), test, field_.from.stride, element_.tableStride(), places);
      FETTLE_AT_LEVEL(level_, lowerEight<T>)
      (origin_, table, element_.tableStride(), places, n, block.x, block.y, block.high, low_);
    }
  }

  static constexpr int kPlaces = 2048;  // samples at once
  const BallElement& element_;
  const BowlField<T>& field_;
  CpuLevel level_;
  double rounding_ = 0.0;
  std::array<float, 17> steepest_{};
  std::int32_t x_ = 0, y_ = 0;
  const T* origin_ = nullptr;
  double* low_ = nullptr;
  std::vector<float> large_;
  std::vector<std::int32_t> large_numbers_;
  GroupList block_, part_, few_;
  std::vector<std::int32_t> heights_, depths_;
};

template <class T>
bool erodeByBowls(const BallElement& element, const Patch<T>& from, Patch<double>& to, bool parallel,
                  CpuLevel level, BallScratch& scratch, const JobControl& job) {
  const BowlField<T> field = fieldOf(element, from, to.rect, parallel, level, scratch);
  constexpr std::int32_t kAtOnce = 64;
  const std::int32_t across = (to.rect.columns + kAtOnce - 1) / kAtOnce,
                     up = (to.rect.rows + kAtOnce - 1) / kAtOnce;
  const std::int32_t left = to.rect.column - field.column, top = to.rect.row - field.row;
  inParts(up, 1, parallel, [&](std::int32_t begin, std::int32_t end) {
    BowlsAtWork<T> at_work(element, field, level);
    alignas(64) std::array<double, static_cast<std::size_t>(kSide * kSide)> low;
    for (std::int32_t k = begin * across; k < end * across && !job.cancelled(); ++k) {
      const std::int32_t c_end = std::min((k % across + 1) * kAtOnce, to.rect.columns);
      const std::int32_t r_end = std::min((k / across + 1) * kAtOnce, to.rect.rows);
      for (std::int32_t r = k / across * kAtOnce; r < r_end; r += kSide)
        for (std::int32_t c = k % across * kAtOnce; c < c_end; c += kSide) {
          const std::int32_t wide = std::min(kSide, c_end - c), high = std::min(kSide, r_end - r);
          const auto sampleAt = [&](std::int32_t j) {
            return from.row(to.rect.row + r + j) + (to.rect.column + c - from.rect.column);
          };
          bool any = false;
          for (std::int32_t j = 0; j < high && !any; ++j)
            any = std::any_of(sampleAt(j), sampleAt(j) + wide,
                              [](T z) { return z < std::numeric_limits<T>::infinity(); });
          low.fill(kNoSample);
          if (any) at_work.run(left + c, top + r, low.data());
          for (std::int32_t j = 0; j < high; ++j) {
            double* const out = to.row(to.rect.row + r + j) + c;
            const T* const z = sampleAt(j);
            for (std::int32_t i = 0; i < wide; ++i)
              out[i] = z[i] < std::numeric_limits<T>::infinity()
                           ? low[static_cast<std::size_t>(j * kSide + i)]
                           : -kNoSample;
          }
        }
    }
  });
  return !job.cancelled();
}

template <class T>
bool erodeByBall(const BallElement& element, const Patch<T>& from, Patch<double>& to, bool parallel,
                 CpuLevel level, BallScratch& scratch, const JobControl& job) {
  return isNear(element) ? erodeNear(element, from, to, parallel, level, job)
                         : erodeByBowls(element, from, to, parallel, level, scratch, job);
}

}  // namespace

bool erode(const BallElement& element, const Patch<float>& from, Patch<double>& to, bool parallel,
           CpuLevel level, BallScratch& scratch, const JobControl& job) {
  return erodeByBall(element, from, to, parallel, level, scratch, job);
}

bool erode(const BallElement& element, const Patch<double>& from, Patch<double>& to, bool parallel,
           CpuLevel level, BallScratch& scratch, const JobControl& job) {
  return erodeByBall(element, from, to, parallel, level, scratch, job);
}

}  // namespace fettle::engine
