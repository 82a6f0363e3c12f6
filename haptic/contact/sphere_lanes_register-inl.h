// The registers of the kernels of sphere_contact_lanes-inl.h.

// One register, whatever its width: GCC 12 compiles comparisons of wider vectors lane by lane.
inline constexpr int kWidth = FETTLE_LEVEL == 0 ? 2 : 4;
inline constexpr unsigned kAllLanes = (1u << kWidth) - 1u;
using Lanes = double __attribute__((vector_size(kWidth * sizeof(double))));
using LaneMask = long long __attribute__((vector_size(kWidth * sizeof(long long))));

// By reference throughout: no ABI defines how a vector wider than the processor's is passed by value.
inline void load(Lanes& to, const double* from) noexcept {
  std::memcpy(&to, from, sizeof to);
}

inline void store(double* to, const Lanes& from) noexcept {
  std::memcpy(to, &from, sizeof from);
}

// 0, 1, 2 ...
inline void numbered(Lanes& to) noexcept {
  constexpr double kNumbers[kSphereContactLanes] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
  load(to, kNumbers);
}

inline unsigned bits(const LaneMask& mask) noexcept {
#if FETTLE_LEVEL > 0
  __m256d m;
  std::memcpy(&m, &mask, sizeof m);
  return static_cast<unsigned>(_mm256_movemask_pd(m));
#elif defined(__SSE2__)
  __m128d m;
  std::memcpy(&m, &mask, sizeof m);
  return static_cast<unsigned>(_mm_movemask_pd(m));
#else
  unsigned out = 0;
  for (int k = 0; k < kWidth; ++k) out |= mask[k] != 0 ? 1u << k : 0u;
  return out;
#endif
}

inline void larger(Lanes& a, const Lanes& b) noexcept {
  a = a > b ? a : b;
}
inline void smaller(Lanes& a, const Lanes& b) noexcept {
  a = a < b ? a : b;
}
inline void absolute(Lanes& a) noexcept {
  larger(a, -a);
}

inline void squareRoot(Lanes& a) noexcept {
#if FETTLE_LEVEL > 0
  __m256d m;
  std::memcpy(&m, &a, sizeof m);
  m = _mm256_sqrt_pd(m);
  std::memcpy(&a, &m, sizeof m);
#else
  for (int k = 0; k < kWidth; ++k) a[k] = std::sqrt(a[k]);
#endif
}

// The first two, or three, of the doubles at each of kWidth places, those of a place in one lane.
#if FETTLE_LEVEL > 0
inline void across(const double* const* at, Lanes& first, Lanes& second) noexcept {
  __m128d p[kWidth];
  for (int k = 0; k < kWidth; ++k) p[k] = _mm_loadu_pd(at[k]);
  const __m256d even = _mm256_insertf128_pd(_mm256_castpd128_pd256(p[0]), p[2], 1);
  const __m256d odd = _mm256_insertf128_pd(_mm256_castpd128_pd256(p[1]), p[3], 1);
  const __m256d low = _mm256_unpacklo_pd(even, odd);
  const __m256d high = _mm256_unpackhi_pd(even, odd);
  std::memcpy(&first, &low, sizeof low);
  std::memcpy(&second, &high, sizeof high);
}

inline void across(const double* const* at, Lanes& first, Lanes& second, Lanes& third) noexcept {
  across(at, first, second);
  const __m128d a = _mm_loadh_pd(_mm_load_sd(at[0] + 2), at[1] + 2);
  const __m128d b = _mm_loadh_pd(_mm_load_sd(at[2] + 2), at[3] + 2);
  const __m256d two = _mm256_insertf128_pd(_mm256_castpd128_pd256(a), b, 1);
  std::memcpy(&third, &two, sizeof two);
}
#else
inline void across(const double* const* at, Lanes& first, Lanes& second) noexcept {
  for (int k = 0; k < kWidth; ++k) {
    first[k] = at[k][0];
    second[k] = at[k][1];
  }
}

inline void across(const double* const* at, Lanes& first, Lanes& second, Lanes& third) noexcept {
  across(at, first, second);
  for (int k = 0; k < kWidth; ++k) third[k] = at[k][2];
}
#endif

// Cells from `at` on, those of `lanes`.
inline void keep(LaneContacts& out, int at, unsigned lanes, const LaneMask& found, const Lanes& mx,
                 const Lanes& my, const Lanes& mz, const Lanes& d2) noexcept {
  const unsigned those = bits(found) & lanes;
  if (those == 0) return;
  out.found |= those << at;
  store(out.mx.data() + at, mx);
  store(out.my.data() + at, my);
  store(out.mz.data() + at, mz);
  store(out.d2.data() + at, d2);
}
