// The kernels of box_doubles.cpp; see kernel.h. With AVX2 alone.
#if FETTLE_LEVEL == 1

// The least magnitude of a row's samples but 0: its bits less one. A 0 and a hole are above all others.
inline std::uint32_t leastBits(const Row& row, const Part* parts, std::size_t n) noexcept {
  const __m256i size = _mm256_set1_epi32(0x7fffffff), one = _mm256_set1_epi32(1);
  __m256i least = _mm256_set1_epi32(-1);
  for (std::size_t p = 0; p < n; ++p)
    for (int i = 0; i < parts[p].columns; i += 8) {
      const __m256i bits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row.tiles[p] + row.at + i));
      least = _mm256_min_epu32(least, _mm256_sub_epi32(_mm256_and_si256(bits, size), one));
    }
  __m128i four = _mm_min_epu32(_mm256_castsi256_si128(least), _mm256_extracti128_si256(least, 1));
  four = _mm_min_epu32(four, _mm_shuffle_epi32(four, 0x4e));
  four = _mm_min_epu32(four, _mm_shuffle_epi32(four, 0xb1));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(four));
}

// Four samples in one lane or cut into two; a hole is 0.
template <bool kHoles, int kLanes>
FETTLE_INLINE void takeFour(const float* from, const __m256d& cut, __m256d* lanes, __m256d& there) noexcept {
  __m256d x = _mm256_cvtps_pd(_mm_loadu_ps(from));
  if constexpr (kHoles) {
    const __m256d is = _mm256_cmp_pd(x, x, _CMP_ORD_Q);
    there = _mm256_and_pd(is, _mm256_set1_pd(1.0));
    x = _mm256_and_pd(is, x);
  }
  lanes[0] = x;
  if constexpr (kLanes == 2) {
    lanes[0] = _mm256_sub_pd(_mm256_add_pd(x, cut), cut);
    lanes[1] = _mm256_sub_pd(x, lanes[0]);
  }
}

FETTLE_INLINE void addTo(double* sums, const __m256d& more) noexcept {
  _mm256_storeu_pd(sums, _mm256_add_pd(_mm256_loadu_pd(sums), more));
}

// Adds samples to the sums of their columns and takes others away.
template <bool kEnter, bool kLeave, bool kHoles, int kLanes>
FETTLE_INLINE void moveFours(const float* enter, const float* leave, int columns, int inside, double cut,
                             const Sums& sums) noexcept {
  const __m256d at = _mm256_set1_pd(cut);
  int i = 0;
  for (const int end = kHoles ? columns : inside / 4 * 4; i < end; i += 4) {
    __m256d in[kLanes], out[kLanes], come, gone;
    if constexpr (kEnter) takeFour<kHoles, kLanes>(enter + i, at, in, come);
    if constexpr (kLeave) takeFour<kHoles, kLanes>(leave + i, at, out, gone);
    for (int l = 0; l < kLanes; ++l) {
      double* const to = sums.lanes[l] + i;
      if constexpr (kEnter && kLeave)
        addTo(to, _mm256_sub_pd(in[l], out[l]));
      else
        addTo(to, kEnter ? in[l] : _mm256_sub_pd(_mm256_setzero_pd(), out[l]));
    }
    if constexpr (kHoles) {
      if constexpr (kEnter && kLeave)
        addTo(sums.counts + i, _mm256_sub_pd(come, gone));
      else
        addTo(sums.counts + i, kEnter ? come : _mm256_sub_pd(_mm256_setzero_pd(), gone));
    }
  }
  if constexpr (!kHoles)
    for (; i < inside; ++i) {
      const double in = kEnter ? static_cast<double>(enter[i]) : 0.0;
      const double out = kLeave ? static_cast<double>(leave[i]) : 0.0;
      const double upper_in = kLanes == 2 ? (in + cut) - cut : in;
      const double upper_out = kLanes == 2 ? (out + cut) - cut : out;
      sums.lanes[0][i] += upper_in - upper_out;
      if constexpr (kLanes == 2) sums.lanes[1][i] += (in - upper_in) - (out - upper_out);
    }
}

template <bool kEnter, bool kLeave, bool kHoles, int kLanes>
FETTLE_INLINE void moveParts(const Row& enter, const Row& leave, const Part* parts, std::size_t n, double cut,
                             const Sums& sums) noexcept {
  for (std::size_t p = 0; p < n; ++p) {
    const Part& part = parts[p];
    moveFours<kEnter, kLeave, kHoles, kLanes>(
        kEnter ? enter.tiles[p] + enter.at : nullptr, kLeave ? leave.tiles[p] + leave.at : nullptr,
        part.columns, part.inside, cut,
        {{sums.lanes[0] + part.at, sums.lanes[1] + part.at}, kHoles ? sums.counts + part.at : nullptr});
  }
}

template <bool kHoles, int kLanes>
void moveRow(const Row& enter, const Row& leave, const Part* parts, std::size_t n, double cut,
             const Sums& sums) noexcept {
  if (enter.tiles != nullptr && leave.tiles != nullptr)
    moveParts<true, true, kHoles, kLanes>(enter, leave, parts, n, cut, sums);
  else if (enter.tiles != nullptr)
    moveParts<true, false, kHoles, kLanes>(enter, leave, parts, n, cut, sums);
  else if (leave.tiles != nullptr)
    moveParts<false, true, kHoles, kLanes>(enter, leave, parts, n, cut, sums);
}

// to[i] = from[i] + .. + from[i + 3], i in 0 .. n rounded up to 4; five more are read.
inline void sumFours(const double* from, int n, double* to) noexcept {
  const auto pairs = [&](int i) __attribute__((always_inline)) {
    return _mm256_add_pd(_mm256_loadu_pd(from + i), _mm256_loadu_pd(from + i + 1));
  };
  __m256d here = pairs(0);
  for (int i = 0; i < n; i += 4) {
    const __m256d next = pairs(i + 4);
    _mm256_storeu_pd(to + i, _mm256_add_pd(here, _mm256_permute2f128_pd(here, next, 0x21)));
    here = next;
  }
}

// Sums of the windows of four outputs side by side, then of the next four. Of windows of kDirect columns each is a sum of its own; else
// (kDirect 0) the four outputs before gain four sums of four columns and lose four.
template <int kDirect>
class Window {
 public:
  // sums[1] is the first column of the first window.
  Window(const double* sums, const double* fours, int window) noexcept
      : leave_(kDirect == 0 ? fours + 1 : sums + 1), enter_(leave_ + window) {
    if constexpr (kDirect == 0) {
      double first[4] = {};
      for (int j = 1; j <= window; ++j) first[0] += sums[j];
      for (int i = 1; i < 4; ++i) first[i] = first[i - 1] + (sums[window + i] - sums[i]);
      sum_ = _mm256_loadu_pd(first);
    }
  }

  // Of the outputs c .. c + 3; c goes up by 4 from call to call.
  FETTLE_INLINE __m256d at(int c) noexcept {
    if constexpr (kDirect == 0) {
      const __m256d here = sum_;
      sum_ = _mm256_add_pd(here, _mm256_sub_pd(_mm256_loadu_pd(enter_ + c), _mm256_loadu_pd(leave_ + c)));
      return here;
    } else {
      __m256d sum = _mm256_loadu_pd(leave_ + c);
#pragma GCC unroll 8
      for (int j = 1; j < kDirect; ++j) sum = _mm256_add_pd(sum, _mm256_loadu_pd(leave_ + c + j));
      return sum;
    }
  }

 private:
  const double *leave_, *enter_;
  __m256d sum_{};
};

// out[c] = sum of the window / count, as a division in double and a rounding to float, for c in 0 .. n rounded up to 4.
// Where all windows are full the division is a multiplication and a correction, which has its bits: box_integers-inl.h.
template <int kDirect, int kLanes, bool kHoles>
void slideFours(const Slide& s, float* out, int n, int full_begin, int full_end) noexcept {
  Window<kDirect> upper(s.sums.lanes[0], s.fours.lanes[0], s.window);
  Window<kDirect> lower(s.sums.lanes[kLanes - 1], s.fours.lanes[kLanes - 1], s.window);
  Window<kDirect> counted(kHoles ? s.sums.counts : s.sums.lanes[0],
                          kHoles ? s.fours.counts : s.fours.lanes[0], s.window);
  const __m256d rows = _mm256_set1_pd(s.rows), full = _mm256_set1_pd(s.full_count),
                inverse = _mm256_set1_pd(1.0 / s.full_count);
  const auto step = [&]<bool kFull>(int c, std::bool_constant<kFull>) __attribute__((always_inline)) {
    __m256d sum = upper.at(c);
    if constexpr (kLanes == 2) sum = _mm256_add_pd(sum, lower.at(c));
    bool whole = kFull;
    __m256d count = full;
    if constexpr (kHoles)
      count = counted.at(c);
    else if constexpr (!kFull)
      count = _mm256_mul_pd(
          _mm256_cvtepi32_pd(_mm_loadu_si128(reinterpret_cast<const __m128i*>(s.column_count + c))), rows);
    if constexpr (!kFull) whole = _mm256_movemask_pd(_mm256_cmp_pd(count, full, _CMP_NEQ_UQ)) == 0;
    __m256d mean;
    if (whole) {
      const __m256d q = _mm256_mul_pd(sum, inverse);
      mean = _mm256_fmadd_pd(_mm256_fnmadd_pd(q, full, sum), inverse, q);
    } else {
      mean = _mm256_div_pd(sum, count);
    }
    _mm_storeu_ps(out + c, _mm256_cvtpd_ps(mean));
  };
  int c = 0;
  if constexpr (!kHoles) {
    for (; c < full_begin; c += 4) step(c, std::false_type{});
    for (; c < full_end; c += 4) step(c, std::true_type{});
  }
  for (; c < n; c += 4) step(c, std::false_type{});
}

#endif
