// BoxStrip by doubles.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <tbb/cache_aligned_allocator.h>

#include "engine/filter/box_strip.h"
#include "engine/filter/exact_sum.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

#ifdef FETTLE_CPU_LEVELS

namespace {

// Of columns: samples in one lane or two, and how many there are. Without holes there is nothing at `counts`.
struct Sums {
  std::array<double*, 2> lanes;
  double* counts;
};

// A row that enters or leaves, or null: the samples of piece i begin at tiles[i] + at.
struct Row {
  const float* const* tiles;
  std::ptrdiff_t at;
};

// As BoxStrip::Piece.
struct Part {
  std::ptrdiff_t at;
  int columns, inside;
};

struct Slide {
  Sums sums;                         // from the column that leaves at the first output on
  Sums fours;                        // sums of four of these
  const std::int32_t* column_count;  // columns of each output's window, without holes
  int window;
  int rows;        // of the window that lie in the field
  int full_count;  // of columns x rows: what most windows have
};

#define FETTLE_KERNEL "engine/filter/box_doubles-inl.h"
#include "engine/simd/each_cpu-inl.h"

class DoubleStrip final : public BoxStrip {
 public:
  explicit DoubleStrip(int radius) : BoxStrip(radius) {}

 private:
  using Numbers = std::vector<double, tbb::cache_aligned_allocator<double>>;
  static constexpr std::size_t kBeyond = 16;  // read behind the last column

  bool clear(const Survey& survey, std::size_t sums) override {
    holes_ = survey.holes;
    room_ = sums + kBeyond;
    sums_.assign((holes_ ? 3 : 2) * room_, 0.0);
    if (window() > kMostDirect) fours_.resize(sums_.size());
    cuts_ = cutsFor(survey.largest, std::int64_t{window()} * window());
    // What the last bit of a sample's fraction is worth at least where the first lane holds all of it.
    const int last = std::ilogb(cuts_.cut[0]) - 52;
    constexpr int kLeastFloat = -149, kFraction = 23;
    const float least = last <= kLeastFloat ? 0.0F : std::ldexp(1.0F, last + kFraction);
    every_fits_ = survey.least >= least;
    least_bits_ = std::max(std::bit_cast<std::uint32_t>(least), 1U) - 1;
    two_lanes_for_ = 0;
    parts_.clear();
    for (const Piece& piece : pieces()) parts_.push_back({piece.at, piece.columns, piece.inside});
    return true;
  }

  bool move(const Samples& enter, const Samples& leave) override {
    const Row in{enter.tiles, enter.at}, out{leave.tiles, leave.at};
    if (in.tiles != nullptr && !every_fits_ &&
        avx2::leastBits(in, parts_.data(), parts_.size()) < least_bits_ && !held(in, 1)) {
      if (!held(in, 2)) return false;
      two_lanes_for_ = window() + 1;  // until it has left
    }
    two_lanes_ = two_lanes_for_ > 0;
    if (two_lanes_) --two_lanes_for_;
    const auto kernel = holes_       ? two_lanes_ ? avx2::moveRow<true, 2> : avx2::moveRow<true, 1>
                              : two_lanes_ ? avx2::moveRow<false, 2>
                                     : avx2::moveRow<false, 1>;
    kernel(in, out, parts_.data(), parts_.size(), cuts_.cut[0], from(sums_, 0));
    return true;
  }

  void slide(const Windows& windows, float* out) const override {
    const bool direct = window() <= kMostDirect;
    const Slide s{.sums = from(sums_, windows.at),
                  .fours = direct ? Sums{} : from(fours_, windows.at),
                  .column_count = columnCounts(),
                  .window = window(),
                  .rows = windows.rows,
                  .full_count = windows.full};
    if (!direct) {
      const int columns = windows.count + window() + 8;
      for (std::size_t l = 0; l < (two_lanes_ ? 2 : 1); ++l)
        avx2::sumFours(s.sums.lanes[l], columns, s.fours.lanes[l]);
      if (holes_) avx2::sumFours(s.sums.counts, columns, s.fours.counts);
    }
    slideOf()(s, out, windows.count, windows.full_begin, windows.full_end);
  }

  static constexpr int kMostDirect = 5;

  using SlideKernel = void (*)(const Slide&, float*, int, int, int) noexcept;
  template <int kDirect>
  [[nodiscard]] SlideKernel slideOf() const noexcept {
    if (holes_) return two_lanes_ ? avx2::slideFours<kDirect, 2, true> : avx2::slideFours<kDirect, 1, true>;
    return two_lanes_ ? avx2::slideFours<kDirect, 2, false> : avx2::slideFours<kDirect, 1, false>;
  }
  [[nodiscard]] SlideKernel slideOf() const noexcept {
    return window() == 3 ? slideOf<3>() : window() == 5 ? slideOf<5>() : slideOf<0>();
  }

  [[nodiscard]] bool held(const Row& row, int lanes) const noexcept {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (!lanesHold(cuts_, lanes, row.tiles[i] + row.at, parts_[i].columns)) return false;
    return true;
  }

  [[nodiscard]] Sums from(Numbers& numbers, std::ptrdiff_t at) const noexcept {
    double* const begin = numbers.data() + at;
    return {{begin, begin + room_}, begin + 2 * room_};
  }

  mutable Numbers sums_, fours_;  // of the first lane, the second one, and counts
  std::vector<Part> parts_;
  std::size_t room_ = 0;
  bool holes_ = false;
  SumLanes cuts_;
  bool every_fits_ = false;
  std::uint32_t least_bits_ = 0;  // less one, of the magnitudes from which on the first lane holds all
  int two_lanes_for_ = 0;         // rows to come
  bool two_lanes_ = false;
};

}  // namespace

std::unique_ptr<BoxStrip> makeBoxOfDoubles(int radius) {
  return std::make_unique<DoubleStrip>(radius);
}

#else

std::unique_ptr<BoxStrip> makeBoxOfDoubles(int) {
  return nullptr;
}

#endif

}  // namespace fettle::engine
