// The kernels of box_integers.cpp; see kernel.h. Below AVX-512 there are none.
#if FETTLE_LEVEL == 2

// Integers of 16 samples; a hole is 0. `misfits` gathers lanes whose sample is no integer after scaling.
template <bool kCheck>
FETTLE_INLINE __mmask16 integers(const float* from, __m512 scale, __m512i& low, __m512i& high,
                                 __mmask16& misfits) {
  const __m512 v = _mm512_loadu_ps(from);
  const __mmask16 there = _mm512_cmp_ps_mask(v, v, _CMP_ORD_Q);
  const __m512 scaled = _mm512_maskz_mul_ps(there, v, scale);
  if constexpr (kCheck)
    misfits |= _mm512_cmp_ps_mask(_mm512_roundscale_ps(scaled, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC),
                                  scaled, _CMP_NEQ_UQ);
  low = _mm512_cvtps_epi64(_mm512_castps512_ps256(scaled));
  high = _mm512_cvtps_epi64(_mm512_extractf32x8_ps(scaled, 1));
  return there;
}

// Adds the samples `enter` to the column sums and takes `leave` away, n a multiple of 16. Whether all fit.
template <bool kEnter, bool kLeave, bool kHoles>
FETTLE_INLINE bool moveColumns(const float* enter, const float* leave, int n, float power, std::int64_t* sums,
                               std::int32_t* counts) {
  const __m512 scale = _mm512_set1_ps(power);
  __mmask16 misfits = 0;
  for (int i = 0; i < n; i += kFloats) {
    __m512i low = _mm512_loadu_si512(sums + i);
    __m512i high = _mm512_loadu_si512(sums + i + kLongs);
    __mmask16 come = 0;
    __mmask16 gone = 0;
    __m512i a, b;
    if constexpr (kEnter) {
      come = integers<true>(enter + i, scale, a, b, misfits);
      low = _mm512_add_epi64(low, a);
      high = _mm512_add_epi64(high, b);
    }
    if constexpr (kLeave) {
      gone = integers<false>(leave + i, scale, a, b, misfits);
      low = _mm512_sub_epi64(low, a);
      high = _mm512_sub_epi64(high, b);
    }
    _mm512_storeu_si512(sums + i, low);
    _mm512_storeu_si512(sums + i + kLongs, high);
    if constexpr (kHoles) {
      __m512i count = _mm512_loadu_si512(counts + i);
      count = _mm512_mask_add_epi32(count, come, count, _mm512_set1_epi32(1));
      count = _mm512_mask_sub_epi32(count, gone, count, _mm512_set1_epi32(1));
      _mm512_storeu_si512(counts + i, count);
    }
  }
  return misfits == 0;
}

template <bool kHoles>
bool moveColumnsOf(const float* enter, const float* leave, int n, float power, std::int64_t* sums,
                   std::int32_t* counts) {
  if (enter != nullptr && leave != nullptr)
    return moveColumns<true, true, kHoles>(enter, leave, n, power, sums, counts);
  if (enter != nullptr) return moveColumns<true, false, kHoles>(enter, leave, n, power, sums, counts);
  if (leave != nullptr) return moveColumns<false, true, kHoles>(enter, leave, n, power, sums, counts);
  return true;
}

// Lane i becomes the sum of the lanes 0 .. i (W. D. Hillis, G. L. Steele, Data parallel algorithms, 1986).
FETTLE_INLINE __m512i running(__m512i v) {
  const __m512i none = _mm512_setzero_si512();
  v = _mm512_add_epi64(v, _mm512_alignr_epi64(v, none, 7));
  v = _mm512_add_epi64(v, _mm512_alignr_epi64(v, none, 6));
  return _mm512_add_epi64(v, _mm512_alignr_epi64(v, none, 4));
}

FETTLE_INLINE __m512i running32(__m512i v) {
  const __m512i none = _mm512_setzero_si512();
  v = _mm512_add_epi32(v, _mm512_alignr_epi32(v, none, 15));
  v = _mm512_add_epi32(v, _mm512_alignr_epi32(v, none, 14));
  v = _mm512_add_epi32(v, _mm512_alignr_epi32(v, none, 12));
  return _mm512_add_epi32(v, _mm512_alignr_epi32(v, none, 8));
}

// out[c] = (sum of sums[c + 1 .. c + window]) * 2^-exponent / count, as a division in double and a rounding
// to float, for c in 0 .. n rounded up to 16.
//
// The division is done as a * y, with y = 1 / b rounded, and one correction by fused multiply-adds: with
// q = round(a y) the rest r = a - b q is exact, and round(q + r y) = round(a / b). For |r / b| <= 1.5 ulp(q),
// so q + r y is within 1.5 * 2^-53 ulp of a / b, and a / b is no nearer than 2^-21 ulp to a point where
// rounding changes: b is an integer below 2^20 (times a power of two) and such a point has 54 bits, hence
// |a - b m| is a multiple of ulp / 2, and not 0, because b m would have more than the 53 bits of a.
class Slider {
 public:
  explicit Slider(const Slide& s) noexcept
      : sums_(s.sums),
        counts_(s.counts),
        column_count_(s.column_count),
        window_(s.window),
        rows_(_mm512_set1_epi32(s.rows)),
        full_(_mm512_set1_epi32(s.full_count)),
        power_(_mm512_set1_pd(std::ldexp(1.0, s.exponent))) {
    const double divisor = std::ldexp(static_cast<double>(s.full_count), s.exponent);
    b_ = _mm512_set1_pd(divisor);
    y_ = _mm512_set1_pd(1.0 / divisor);
    std::int64_t before = 0;  // the window before the first output
    for (int j = 0; j < s.window; ++j) before += s.sums[j];
    sum_ = _mm512_set1_epi64(before);
    if (counts_ == nullptr) return;
    std::int32_t count_before = 0;
    for (int j = 0; j < s.window; ++j) count_before += s.counts[j];
    sum_count_ = _mm512_set1_epi32(count_before);
  }

  // Outputs c .. c + 15, c going up by 16 from call to call. kFull: all windows are full.
  template <bool kHoles, bool kFull>
  FETTLE_INLINE void step(int c, float* out) noexcept {
    __m512i count;
    if constexpr (kHoles) {
      const __m512i change =
          _mm512_sub_epi32(_mm512_loadu_si512(counts_ + c + window_), _mm512_loadu_si512(counts_ + c));
      count = _mm512_add_epi32(sum_count_, running32(change));
      sum_count_ = _mm512_permutexvar_epi32(_mm512_set1_epi32(15), count);
    } else if constexpr (!kFull) {
      count = _mm512_mullo_epi32(_mm512_loadu_si512(column_count_ + c), rows_);
    }
    __m512d mean[2];
    for (int h = 0; h < 2; ++h) {
      const std::int64_t* at = sums_ + c + h * kLongs;
      const __m512i within =
          running(_mm512_sub_epi64(_mm512_loadu_si512(at + window_), _mm512_loadu_si512(at)));
      mean[h] = _mm512_cvtepi64_pd(_mm512_add_epi64(sum_, within));
      // The chain from one step to the next is this one addition.
      sum_ = _mm512_add_epi64(sum_, _mm512_permutexvar_epi64(_mm512_set1_epi64(7), within));
    }
    bool full = kFull;
    if constexpr (!kFull) full = _mm512_cmpneq_epi32_mask(count, full_) == 0;
    if (full) {
      for (__m512d& a : mean) {
        const __m512d q = _mm512_mul_pd(a, y_);
        a = _mm512_fmadd_pd(_mm512_fnmadd_pd(q, b_, a), y_, q);
      }
    } else if constexpr (!kFull) {
      const __m512d low = _mm512_cvtepi32_pd(_mm512_castsi512_si256(count));
      const __m512d high = _mm512_cvtepi32_pd(_mm512_extracti32x8_epi32(count, 1));
      mean[0] = _mm512_div_pd(mean[0], _mm512_mul_pd(low, power_));
      mean[1] = _mm512_div_pd(mean[1], _mm512_mul_pd(high, power_));
    }
    _mm256_storeu_ps(out + c, _mm512_cvtpd_ps(mean[0]));
    _mm256_storeu_ps(out + c + kLongs, _mm512_cvtpd_ps(mean[1]));
  }

 private:
  const std::int64_t* sums_;
  const std::int32_t* counts_;
  const std::int32_t* column_count_;
  int window_;
  __m512i rows_, full_, sum_, sum_count_{};
  __m512d power_, b_, y_;
};

// Of the outputs [full_begin, full_end), multiples of 16, no window is cut by a border of the field.
template <bool kHoles>
void slide(const Slide& s, float* out, int n, int full_begin, int full_end) {
  Slider slider(s);
  int c = 0;
  if constexpr (!kHoles) {
    for (; c < full_begin; c += kFloats) slider.step<false, false>(c, out);
    for (; c < full_end; c += kFloats) slider.step<false, true>(c, out);
  }
  for (; c < n; c += kFloats) slider.step<kHoles, false>(c, out);
}

#endif
