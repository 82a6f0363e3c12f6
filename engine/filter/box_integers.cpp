// BoxStrip by integers of 64 bits.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/filter/box_strip.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

#ifdef FETTLE_CPU_LEVELS

namespace {

constexpr int kFloats = 16;  // of a register
constexpr int kLongs = 8;

struct Slide {
  const std::int64_t* sums;          // of the column that leaves at the first output
  const std::int32_t* counts;        // likewise, with holes
  const std::int32_t* column_count;  // columns of each output's window, without holes
  int window;
  int rows;        // of the window that lie in the field
  int full_count;  // of columns x rows: what most windows have
  int exponent;
};

#define FETTLE_KERNEL "engine/filter/box_integers-inl.h"
#include "engine/simd/each_cpu-inl.h"

class IntegerStrip final : public BoxStrip {
 public:
  explicit IntegerStrip(int radius) : BoxStrip(radius) {}

 private:
  // The finest power of two that fits.
  bool clear(const Survey& survey, std::size_t sums) override {
    sums_.assign(sums, 0);
    holes_ = survey.holes;
    if (holes_) counts_.assign(sums, 0);
    // All magnitudes are below 2^top, all sums below 2^(top + bits).
    int top = 0;
    (void)std::frexp(survey.largest, &top);
    const auto bits = static_cast<int>(
        std::bit_width(static_cast<std::uint64_t>(window()) * static_cast<std::uint64_t>(window())));
    exponent_ = std::min(63 - top - bits, 126);
    return exponent_ >= 0;
  }

  bool move(const Samples& enter, const Samples& leave) override {
    const float power = std::ldexp(1.0F, exponent_);
    bool fit = true;
    for (std::size_t i = 0; i < pieces().size(); ++i) {
      const Piece& piece = pieces()[i];
      const float* in = enter.tiles == nullptr ? nullptr : enter.tiles[i] + enter.at;
      const float* out = leave.tiles == nullptr ? nullptr : leave.tiles[i] + leave.at;
      fit &= holes_ ? avx512::moveColumnsOf<true>(in, out, piece.columns, power, sums_.data() + piece.at,
                                                  counts_.data() + piece.at)
                    : avx512::moveColumnsOf<false>(in, out, piece.columns, power, sums_.data() + piece.at,
                                                   nullptr);
    }
    return fit;
  }

  void slide(const Windows& windows, float* out) const override {
    const Slide s{.sums = sums_.data() + windows.at,
                  .counts = holes_ ? counts_.data() + windows.at : nullptr,
                  .column_count = columnCounts(),
                  .window = window(),
                  .rows = windows.rows,
                  .full_count = windows.full,
                  .exponent = exponent_};
    if (holes_)
      avx512::slide<true>(s, out, windows.count, windows.full_begin, windows.full_end);
    else
      avx512::slide<false>(s, out, windows.count, windows.full_begin, windows.full_end);
  }

  std::vector<std::int64_t> sums_;    // of the columns of the window
  std::vector<std::int32_t> counts_;  // samples in them, kept only where there are holes
  bool holes_ = false;
  int exponent_ = 0;  // a sample is an integer times 2^-exponent_
};

}  // namespace

std::unique_ptr<BoxStrip> makeBoxOfIntegers(int radius) {
  return std::make_unique<IntegerStrip>(radius);
}

#else

std::unique_ptr<BoxStrip> makeBoxOfIntegers(int) {
  return nullptr;
}

#endif

}  // namespace fettle::engine
