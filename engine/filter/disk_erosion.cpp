// Erosion by disks, chord by chord: the least of a row's samples within half a chord is the lesser of two rows of least of 1, 2,
// 4 ... samples (E. Urbach and M. Wilkinson, Efficient 2-D grayscale morphological transformations with arbitrary flat
// structuring elements, 2008, has chords of any element by such rows).

#include "engine/filter/disk_erosion.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "engine/filter/erosion_rows.h"
#include "engine/filter/opening.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/disk_erosion-inl.h"
#include "engine/simd/each_cpu-inl.h"

// Where the least of a row's samples within `half` of each column lies in the rows of least of 1, 2, 4 ... samples.
struct Chord {
  int power = 0;
  std::ptrdiff_t begin = 0, other = 0;
};

std::vector<Chord> chordsOf(const FlatElement& element) {
  std::vector<Chord> chords;
  for (const std::int32_t half : element.half) {
    const int power = std::max(static_cast<int>(std::bit_width(static_cast<unsigned>(2 * half + 1))) - 1, 0);
    chords.push_back({power, element.columns - half, element.columns + half + 1 - (1 << power)});
  }
  return chords;
}

// Where the rows of least of 1, 2, 4 ... samples of one row are kept, for a strip of results: those that chords take.
class Powers {
 public:
  Powers(const std::vector<Chord>& chords, std::ptrdiff_t length)
      : length_(length),
        all_(std::ranges::max(chords, {}, &Chord::power).power + 1),
        places_(static_cast<std::size_t>(all_), -1) {
    for (const Chord& chord : chords) places_[static_cast<std::size_t>(chord.power)] = 0;
    for (std::ptrdiff_t& place : places_)
      if (place == 0) place = kept_++ * length;
  }

  [[nodiscard]] std::ptrdiff_t placeOf(int power) const noexcept {
    return places_[static_cast<std::size_t>(power)];
  }
  // An odd number of cache lines: those of the rows above each other share no place in the cache.
  [[nodiscard]] std::ptrdiff_t size() const noexcept { return (kept_ * length_ / 16 | 1) * 16; }

  // Of a row of `columns` samples in lines[0] that ends with as many of none as the longest chord; lines: two of `length`.
  void make(float* const (&lines)[2], std::int32_t columns, float* kept, const auto& lesserRow) const {
    const float* before = lines[0];
    for (int power = 0; power < all_; ++power) {
      float* const to = placeOf(power) >= 0 ? kept + placeOf(power) : lines[power % 2];
      const std::int32_t n = columns + 1 - (1 << power);
      if (power > 0)
        lesserRow(before, before + (std::ptrdiff_t{1} << (power - 1)), to, n);
      else if (to != before)
        std::copy_n(before, columns, to);
      before = to;
    }
  }

 private:
  std::ptrdiff_t length_;
  int all_;
  std::ptrdiff_t kept_ = 0;
  std::vector<std::ptrdiff_t> places_;  // by power; -1: not kept
};

constexpr std::int32_t kAtOnce = 64, kTogether = 4;  // columns and rows of leastOfChords

// Each result at once, in registers, from the rows that its disk reaches: these are kept.
bool erodeNear(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
               CpuLevel level, const JobControl& job) {
  const auto lesserRow = FETTLE_AT_LEVEL(level, lesserOf);
  const auto least = FETTLE_AT_LEVEL(level, leastOfChords);
  const std::vector<Chord> chords = chordsOf(element);
  // The wider, the less is read twice; the rows that a small disk reaches stay near the core (at 128 samples they
  // are 4.5 MB).
  const std::int32_t strip = element.columns <= 8 ? 8 * kAtOnce : 2 * kAtOnce;
  const std::int32_t columns = strip + 2 * element.columns, high = 2 * element.rows + kTogether;
  // Vectors may read and write beyond their end, and takeRow() fills as much.
  const std::ptrdiff_t length = (columns + 31) / 16 * 16 + kAtOnce;
  const Powers powers(chords, length);
  std::vector<std::ptrdiff_t> one, other;
  for (std::int32_t d = -element.rows; d <= element.rows; ++d) {
    const Chord& chord = chords[static_cast<std::size_t>(std::abs(d))];
    one.push_back(powers.placeOf(chord.power) + chord.begin);
    other.push_back(powers.placeOf(chord.power) + chord.other);
  }
  const std::vector<float> none(static_cast<std::size_t>(powers.size() + kAtOnce),
                                std::numeric_limits<float>::infinity());
  const std::int32_t first = to.rect.row - element.rows, end = from.rect.row + from.rect.rows;
  inParts((to.rect.columns + strip - 1) / strip, 1, parallel, [&](std::int32_t begin, std::int32_t stop) {
    std::vector<float> lines(static_cast<std::size_t>(2 * length));
    float* const two[2] = {lines.data(), lines.data() + length};
    std::vector<float> kept(static_cast<std::size_t>(powers.size() * high) + kAtOnce);
    std::vector<const float*> rows(static_cast<std::size_t>(to.rect.rows + high + kTogether));
    for (std::int32_t s = begin; s < stop; ++s) {
      if (job.cancelled()) return;
      const std::int32_t c0 = to.rect.column + s * strip;
      const std::int32_t wide = std::min(strip, to.rect.column + to.rect.columns - c0);
      std::ranges::fill(rows, none.data());
      std::int32_t there = std::max(first, from.rect.row);  // the rows before it are kept, or were
      for (std::int32_t r = 0; r < to.rect.rows; r += kTogether) {
        for (; there < std::min(first + r + high, end); ++there) {
          takeRow(from, there, c0, strip, element.columns, lines.data());
          float* const row = kept.data() + (there - first) % high * powers.size();
          powers.make(two, columns, row, lesserRow);
          rows[static_cast<std::size_t>(there - first)] = row;
        }
        for (std::int32_t c = 0; c < wide; c += kAtOnce) {
          float results[kTogether * kAtOnce];
          least(rows.data() + r, c, one.data(), other.data(), 2 * element.rows + 1, results);
          for (std::int32_t j = 0; j < std::min(kTogether, to.rect.rows - r); ++j)
            std::copy_n(results + j * kAtOnce, std::min(kAtOnce, wide - c),
                        to.row(to.rect.row + r + j) + (c0 + c - to.rect.column));
        }
      }
    }
  });
  return !job.cancelled();
}

// A row at a time, into all results that it reaches: few samples are held of an element of any size.
bool erodeFar(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
              CpuLevel level, const JobControl& job) {
  const auto lesserRow = FETTLE_AT_LEVEL(level, lesserOf);
  const auto two = FETTLE_AT_LEVEL(level, lowerTwo);
  const auto one = FETTLE_AT_LEVEL(level, lowerOne);
  const std::vector<Chord> chords = chordsOf(element);
  const int powers = std::bit_width(static_cast<unsigned>(2 * element.columns + 1));
  // Strips of columns and rows whose results stay near the core.
  constexpr std::int32_t kColumnsAtOnce = 128, kRowsAtOnce = 32;
  const std::int32_t n = to.rect.columns, bands = (n + kColumnsAtOnce - 1) / kColumnsAtOnce;
  const std::int32_t rows_at_once = std::max(kRowsAtOnce, 2 * element.rows);
  const std::int32_t parts = (to.rect.rows + rows_at_once - 1) / rows_at_once;
  inParts(bands * parts, 1, parallel, [&](std::int32_t begin, std::int32_t stop) {
    std::vector<float> line, results;
    for (std::int32_t i = begin; i < stop; ++i) {
      const std::int32_t c0 = to.rect.column + i % bands * kColumnsAtOnce;
      const std::int32_t wide = std::min(kColumnsAtOnce, to.rect.column + n - c0);
      const std::int32_t r0 = to.rect.row + i / bands * rows_at_once;
      const std::int32_t r1 = std::min(r0 + rows_at_once, to.rect.row + to.rect.rows);
      const std::ptrdiff_t length = wide + 2 * element.columns + 128, room = (wide + 31) / 16 * 16;
      line.resize(static_cast<std::size_t>(length * powers));
      results.assign(static_cast<std::size_t>(room * (r1 - r0)), std::numeric_limits<float>::infinity());
      const std::int32_t last = std::min(r1 + element.rows, from.rect.row + from.rect.rows);
      for (std::int32_t r = std::max(r0 - element.rows, from.rect.row); r < last; ++r) {
        if (job.cancelled()) return;
        takeRow(from, r, c0, wide, element.columns, line.data());
        for (int k = 1; k < powers; ++k)
          lesserRow(line.data() + (k - 1) * length, line.data() + (k - 1) * length + (1 << (k - 1)),
                    line.data() + k * length, wide + 2 * element.columns + 1 - (1 << k));
        for (std::int32_t d = 0; d <= element.rows; ++d) {
          const Chord& chord = chords[static_cast<std::size_t>(d)];
          const float* const a = line.data() + chord.power * length + chord.begin;
          const float* const b = line.data() + chord.power * length + chord.other;
          float* const above = r + d >= r0 && r + d < r1 ? results.data() + (r + d - r0) * room : nullptr;
          float* const below =
              d > 0 && r - d >= r0 && r - d < r1 ? results.data() + (r - d - r0) * room : nullptr;
          if (above != nullptr && below != nullptr)
            two(a, b, above, below, wide);
          else if (above != nullptr || below != nullptr)
            one(a, b, above != nullptr ? above : below, wide);
        }
      }
      for (std::int32_t r = r0; r < r1; ++r)
        std::copy_n(results.data() + (r - r0) * room, wide, to.row(r) + (c0 - to.rect.column));
    }
  });
  return !job.cancelled();
}

}  // namespace

bool erodeDisk(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
               CpuLevel level, const JobControl& job) {
  return (std::max(element.columns, element.rows) <= kMostReachInBlocks ? erodeNear : erodeFar)(
      element, from, to, parallel, level, job);
}

}  // namespace fettle::engine
