// The kernels of tile_median.cpp; see tile_rows-inl.h.
#include "engine/filter/tile_rows-inl.h"
#if FETTLE_LEVEL == 2

FETTLE_INLINE __m512 low(__m512 a, __m512 b) noexcept {
  return _mm512_min_ps(a, b);
}
FETTLE_INLINE __m512 high(__m512 a, __m512 b) noexcept {
  return _mm512_max_ps(a, b);
}

// The lanes kBy .. kBy + 15 of `a` and then `b`, kBy in 0 .. 16.
template <int kBy>
FETTLE_INLINE __m512 from(__m512 a, __m512 b) noexcept {
  if constexpr (kBy == 0) return a;
  if constexpr (kBy == 16) return b;
  return _mm512_castsi512_ps(_mm512_alignr_epi32(_mm512_castps_si512(b), _mm512_castps_si512(a), kBy & 15));
}

FETTLE_INLINE __m512 middleOfThree(__m512 a, __m512 b, __m512 c) noexcept {
  return high(low(a, b), low(high(a, b), c));
}

// Columns of three samples, sorted, of two windows below each other that share two rows.
struct ColumnPair {
  __m512 sorted[2][3];
};

FETTLE_INLINE void sortInto(__m512 lower, __m512 upper, __m512 v, __m512* sorted) noexcept {
  sorted[0] = low(lower, v);
  const __m512 rest = high(lower, v);
  sorted[1] = low(upper, rest);
  sorted[2] = high(upper, rest);
}

FETTLE_INLINE ColumnPair columnsOf(const TileRows<2>& rows, int y, int sixteen) noexcept {
  const auto at = [&](int r) { return _mm512_loadu_ps(rows.at(r, 16 * sixteen)); };
  const __m512 b = at(y), c = at(y + 1);
  const __m512 lower = low(b, c), upper = high(b, c);
  ColumnPair pair;
  sortInto(lower, upper, at(y - 1), pair.sorted[0]);
  sortInto(lower, upper, at(y + 2), pair.sorted[1]);
  return pair;
}

// The median of nine is the median of the largest low, the middle middle and the smallest high of sorted columns (J. L. Smith,
// Implementing median filters in XC4000E FPGAs, 1996). A column is sorted once for the three windows that it is in.
inline void medianTile3(const TileAround& around, float* out) noexcept {
  const TileRows<2> rows(around);
  for (int y = 0; y < kTileSide; y += 2) {
    ColumnPair before = columnsOf(rows, y, -1), here = columnsOf(rows, y, 0);
#pragma GCC unroll 4
    for (int q = 0; q < 4; ++q) {
      const ColumnPair after = columnsOf(rows, y, q + 1);
#pragma GCC unroll 2
      for (int j = 0; j < 2; ++j) {
        const __m512 *l = before.sorted[j], *m = here.sorted[j], *r = after.sorted[j];
        const __m512 lows = high(high(from<15>(l[0], m[0]), m[0]), from<1>(m[0], r[0]));
        const __m512 middles = middleOfThree(from<15>(l[1], m[1]), m[1], from<1>(m[1], r[1]));
        const __m512 highs = low(low(from<15>(l[2], m[2]), m[2]), from<1>(m[2], r[2]));
        _mm512_store_ps(out + (y + j) * kTileSide + 16 * q, middleOfThree(lows, middles, highs));
      }
      before = here;
      here = after;
    }
  }
}

#elif FETTLE_LEVEL == 1

FETTLE_INLINE FloatPack middleOfThree(const FloatPack& a, const FloatPack& b, const FloatPack& c) noexcept {
  return greater(lesser(a, b), lesser(greater(a, b), c));
}

// Of two windows below each other that share two rows: the columns of three samples, sorted, of 80 columns.
struct SortedRows {
  static constexpr int kBefore = kFloatPack;  // columns of the tile to the left
  alignas(64) float ranks[2][3][kTileSide + 2 * kFloatPack];
};

FETTLE_INLINE void sortInto(const FloatPack& lower, const FloatPack& upper, const float* third, int at,
                            float (*ranks)[kTileSide + 2 * kFloatPack]) noexcept {
  const FloatPack v = load<FloatPack>(third), rest = greater(lower, v);
  store(ranks[0] + at, lesser(lower, v));
  store(ranks[1] + at, lesser(upper, rest));
  store(ranks[2] + at, greater(upper, rest));
}

// As with AVX-512, with the sorted columns in the nearest cache, where a lane's neighbours are loaded instead of shifted.
inline void medianTile3(const TileAround& around, float* out) noexcept {
  const TileRows<2> rows(around);
  SortedRows sorted;
  for (int y = 0; y < kTileSide; y += 2) {
    for (int c = -kFloatPack; c < kTileSide + kFloatPack; c += kFloatPack) {
      const FloatPack a = load<FloatPack>(rows.at(y, c)), b = load<FloatPack>(rows.at(y + 1, c));
      const FloatPack lower = lesser(a, b), upper = greater(a, b);
      sortInto(lower, upper, rows.at(y - 1, c), c + SortedRows::kBefore, sorted.ranks[0]);
      sortInto(lower, upper, rows.at(y + 2, c), c + SortedRows::kBefore, sorted.ranks[1]);
    }
    for (int j = 0; j < 2; ++j)
      for (int c = 0; c < kTileSide; c += kFloatPack) {
        const auto at = [&](int rank, int by) __attribute__((always_inline)) {
          return load<FloatPack>(sorted.ranks[j][rank] + c + SortedRows::kBefore + by);
        };
        const FloatPack lows = greater(greater(at(0, -1), at(0, 0)), at(0, 1));
        const FloatPack middles = middleOfThree(at(1, -1), at(1, 0), at(1, 1));
        const FloatPack highs = lesser(lesser(at(2, -1), at(2, 0)), at(2, 1));
        store(out + (y + j) * kTileSide + c, middleOfThree(lows, middles, highs));
      }
  }
}

#endif
