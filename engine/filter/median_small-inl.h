// The kernel of median_small.cpp, which includes it once for each kind of processor, each time in a namespace
// of its own and with other instructions allowed. No include guard for that reason, and no includes.

// One register with AVX-512, two with AVX, four with SSE: the compiler cuts it to what there is.
using Heights = float __attribute__((vector_size(kAbreast * sizeof(float))));

inline void load(Heights& to, const float* from) noexcept {
  std::memcpy(&to, from, sizeof to);
}

inline void exchange(Heights& a, Heights& b) noexcept {
  const Heights low = a < b ? a : b;
  const Heights high = a < b ? b : a;
  a = low;
  b = high;
}

// Moves the smallest of a[0 .. n) to a[0] and the largest to a[n - 1].
inline void extremesOutward(Heights* a, int n) noexcept {
  for (int i = 0; i < n / 2; ++i) exchange(a[i], a[n - 1 - i]);
  for (int i = 1; i < (n + 1) / 2; ++i) exchange(a[0], a[i]);
  for (int i = n / 2; i < n - 1; ++i) exchange(a[i], a[n - 1]);
}

// The median of an odd number of samples, 2 p + 1, while seeing p + 2 at a time: the largest and the smallest
// of p + 2 cannot be the median, so both are forgotten and one more sample is looked at ("forgetful
// selection"; N. Devillard, Fast median search: an ANSI C implementation, 1998, cites it for 3 x 3 and 5 x
// 5). Loops are left as loops: written out for 7 x 7 they took the compiler three minutes and 0.9 GB.
template <int kSide>
inline void medianRow(const float* corner, std::ptrdiff_t stride, float* out) noexcept {
  constexpr int kCount = kSide * kSide;
  constexpr int kSeen = kCount / 2 + 2;
  Heights a[kSeen];
  for (int i = 0; i < kSeen; ++i) load(a[i], corner + i / kSide * stride + i % kSide);
  int next = kSeen;
  for (int n = kSeen; n >= 3; --n) {
    extremesOutward(a, n);
    if (n == 3) break;
    load(a[0], corner + next / kSide * stride + next % kSide);
    ++next;
  }
  std::memcpy(out, &a[1], sizeof a[1]);
}

// 3 x 3: sort each column; the median of nine is the median of the largest low, the middle middle and the
// smallest high (J. L. Smith, Implementing median filters in XC4000E FPGAs, 1996).
template <>
inline void medianRow<3>(const float* corner, std::ptrdiff_t stride, float* out) noexcept {
  Heights low[3], middle[3], high[3];
  for (int i = 0; i < 3; ++i) {
    load(low[i], corner + i);
    load(middle[i], corner + stride + i);
    load(high[i], corner + 2 * stride + i);
    exchange(low[i], middle[i]);
    exchange(middle[i], high[i]);
    exchange(low[i], middle[i]);
  }
  exchange(low[0], low[1]);
  exchange(low[1], low[2]);
  exchange(high[0], high[1]);
  exchange(high[0], high[2]);
  exchange(middle[0], middle[1]);
  exchange(middle[1], middle[2]);
  exchange(middle[0], middle[1]);
  Heights a = low[2];
  Heights b = middle[1];
  Heights c = high[0];
  exchange(a, b);
  exchange(b, c);
  exchange(a, b);
  std::memcpy(out, &b, sizeof b);
}

template <int kSide>
inline void medianRun(const float* corner, std::ptrdiff_t stride, float* out, int chunks) noexcept {
  for (int i = 0; i < chunks; ++i) medianRow<kSide>(corner + i * kAbreast, stride, out + i * kAbreast);
}
