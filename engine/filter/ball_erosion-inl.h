// The kernels of ball_erosion.cpp; see each_cpu-inl.h.

#if FETTLE_LEVEL == 2
FETTLE_INLINE unsigned below(const Floats& a, const Floats& b) noexcept {
  return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
FETTLE_INLINE Floats rootOf(const Floats& v) noexcept {
  return _mm512_sqrt_ps(v);
}
FETTLE_INLINE Floats sizeOf(const Floats& v) noexcept {
  return _mm512_abs_ps(v);
}
// The lanes of `bits` one behind the other; 16 elements are written.
FETTLE_INLINE void keepOf(unsigned bits, const Floats& v, float* to) noexcept {
  _mm512_storeu_ps(to, _mm512_maskz_compress_ps(static_cast<__mmask16>(bits), v));
}
FETTLE_INLINE void keepOf(unsigned bits, const Ints& v, std::int32_t* to) noexcept {
  _mm512_storeu_si512(
      to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), reinterpret_cast<__m512i>(v)));
}
FETTLE_INLINE Floats spreadFloat(float x) noexcept {
  return _mm512_set1_ps(x);
}
FETTLE_INLINE float leastLane(const Floats& v) noexcept {
  return _mm512_reduce_min_ps(v);
}
#else
FETTLE_INLINE Floats spreadFloat(float x) noexcept {
  return Floats{x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x};
}
FETTLE_INLINE Floats sizeOf(const Floats& v) noexcept {
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(v) & 0x7fffffff);
}
#ifdef FETTLE_CPU_LEVELS
FETTLE_INLINE unsigned below(const Floats& a, const Floats& b) noexcept {
  unsigned bits = 0;
  for (std::size_t at = 0; at < sizeof a; at += sizeof(FloatPack)) {
#if FETTLE_LEVEL == 1
    const int part = _mm256_movemask_ps(_mm256_cmp_ps(packOf(a, at), packOf(b, at), _CMP_LT_OQ));
#else
    const int part = _mm_movemask_ps(_mm_cmplt_ps(packOf(a, at), packOf(b, at)));
#endif
    bits |= static_cast<unsigned>(part) << (at / sizeof(float));
  }
  return bits;
}
FETTLE_INLINE Floats rootOf(const Floats& v) noexcept {
  Floats root;
  for (std::size_t at = 0; at < sizeof v; at += sizeof(FloatPack)) {
#if FETTLE_LEVEL == 1
    const FloatPack one = _mm256_sqrt_ps(packOf(v, at));
#else
    const FloatPack one = _mm_sqrt_ps(packOf(v, at));
#endif
    std::memcpy(reinterpret_cast<char*>(&root) + at, &one, sizeof one);
  }
  return root;
}
#else
FETTLE_INLINE unsigned below(const Floats& a, const Floats& b) noexcept {
  unsigned bits = 0;
  for (int l = 0; l < kLanes; ++l) bits |= static_cast<unsigned>(a[l] < b[l]) << l;
  return bits;
}
FETTLE_INLINE Floats rootOf(const Floats& v) noexcept {
  Floats root;
  for (int l = 0; l < kLanes; ++l) root[l] = __builtin_sqrtf(v[l]);
  return root;
}
#endif
template <class Vector, class Element>
FETTLE_INLINE void keepOf(unsigned bits, const Vector& v, Element* to) noexcept {
  Element lanes[kLanes];
  std::memcpy(lanes, &v, sizeof v);
  for (; bits != 0; bits &= bits - 1) *to++ = lanes[__builtin_ctz(bits)];
}
FETTLE_INLINE float leastLane(const Floats& v) noexcept {
  float least = v[0];
  for (int l = 1; l < kLanes; ++l) least = v[l] < least ? v[l] : least;
  return least;
}
#endif

FETTLE_INLINE Floats counted() noexcept {
  return Floats{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
FETTLE_INLINE Ints numbered() noexcept {
  return Ints{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
// Of 4 x 4.
FETTLE_INLINE Floats across() noexcept {
  return Floats{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
}
FETTLE_INLINE Floats down() noexcept {
  return Floats{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
}
FETTLE_INLINE Ints inRows(std::int32_t stride) noexcept {
  return Ints{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3} * stride +
         Ints{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
}

// Of 16 bowls whose samples lie ux, uy from a place: what they add to their heights there, and their slopes there.
struct BowlsThere {
  Floats depth, slope_x, slope_y;
};
FETTLE_INLINE BowlsThere bowlsThere(const BowlShape& shape, const Floats& ux, const Floats& uy) noexcept {
  const Floats sx = ux * shape.square_x, sy = uy * shape.square_y, s = ux * sx + uy * sy;
  const Floats within = lesser(s, spreadFloat(shape.bend)), root = rootOf(shape.squared - within),
               sum = shape.radius + root;
  const Floats part = shape.per_unit / (root * sum), w = sum * part;
  // Less than what rounding can do to it.
  return {(within * (root * part) + (s - within) * shape.slope_beyond) * 0.99999F, -sx * w, -sy * w};
}

FETTLE_INLINE void keepBowls(const Floats& z, const Floats& a, const Floats& b, const BowlsThere& there,
                             float half_group, const GroupBowls& out, int at) noexcept {
  const Floats middle = z + there.depth;
  store(out.middle + at, middle);
  store(out.least + at,
        middle - sizeOf(there.slope_x - a) * half_group - sizeOf(there.slope_y - b) * half_group);
  store(out.slope_x + at, there.slope_x);
  store(out.slope_y + at, there.slope_y);
}

FETTLE_INLINE unsigned canBeLower(const Floats& least, const Floats& gx, const Floats& gy,
                                  const BowlTest& test) noexcept {
  return below(least - sizeOf(gx - test.slope_x) * test.half_x - sizeOf(gy - test.slope_y) * test.half_y,
               spreadFloat(test.most));
}

// The number of the least of n values, rounded up to 16.
inline int leastOf(const float* values, int n) noexcept {
  Floats low = load<Floats>(values);
  for (int i = kLanes; i < n; i += kLanes) low = lesser(load<Floats>(values + i), low);
  const Floats least = spreadFloat(leastLane(low));
  for (int i = 0; i < n; i += kLanes)
    if (const unsigned higher = below(least, load<Floats>(values + i)); higher != 0xffff)
      return i + __builtin_ctz(~higher);
  return 0;
}

// Bowls of large groups, 16 places a row or a multiple of that: infinite beyond its end. Returns how many places.
inline int boundLarge(const LargeGroups& in, const BowlShape& shape, const GroupBowls& out) noexcept {
  int taken = 0;
  const Floats none = spreadFloat(__builtin_inff());
  for (int j = 0; j < in.rows; ++j)
    for (int i = 0; i < in.columns; i += kLanes, taken += kLanes) {
      const BowlsThere there = bowlsThere(shape, (counted() + static_cast<float>(i)) * 16.0F + in.x,
                                          spreadFloat(in.y + 16.0F * static_cast<float>(j)));
      const std::ptrdiff_t at = j * in.stride + i;
      keepBowls(load<Floats>(in.least + at), load<Floats>(in.slope_x + at), load<Floats>(in.slope_y + at),
                there, 7.5F, out, taken);
      if (in.columns - i < kLanes) {
        std::memcpy(out.middle + taken + (in.columns - i), &none,
                    sizeof(float) * static_cast<std::size_t>(kLanes - (in.columns - i)));
        std::memcpy(out.least + taken + (in.columns - i), &none,
                    sizeof(float) * static_cast<std::size_t>(kLanes - (in.columns - i)));
      }
    }
  return taken;
}

// The numbers of those of n places that can be lower.
inline int takeGroups(const GroupBowls& in, int n, const BowlTest& test, std::int32_t* out) noexcept {
  int taken = 0;
  for (int i = 0; i < n; i += kLanes) {
    const unsigned bits = canBeLower(load<Floats>(in.least + i), load<Floats>(in.slope_x + i),
                                     load<Floats>(in.slope_y + i), test);
    if (bits == 0) continue;
    keepOf(bits, numbered() + i, out + taken);
    taken += __builtin_popcount(bits);
  }
  return taken;
}

// The one of 16 samples or small groups, `step` apart, that is lowest at the place from which x, y of the first one count, and its
// slopes there; -1 if all are steeper.
inline int lowestOfFour(const float* z, float x, float y, float step, const BowlShape& shape, float steepest,
                        float* slopes) noexcept {
  const BowlsThere there = bowlsThere(shape, across() * step + x, down() * step + y);
  const Floats f = load<Floats>(z) + there.depth;
  const Floats steep =
      there.slope_x * there.slope_x * shape.steep_x + there.slope_y * there.slope_y * shape.steep_y;
  const unsigned fits = below(steep, spreadFloat(steepest)) & below(f, spreadFloat(__builtin_inff()));
  float values[3][kLanes];
  store(values[0], f);
  store(values[1], there.slope_x);
  store(values[2], there.slope_y);
  int best = -1;
  if (fits == 0xffff) {
    best = leastOf(values[0], kLanes);
  } else {
    for (unsigned bits = fits; bits != 0; bits &= bits - 1)
      if (const int lane = __builtin_ctz(bits); best < 0 || values[0][lane] < values[0][best]) best = lane;
  }
  if (best < 0) return best;
  slopes[0] = values[1][best];
  slopes[1] = values[2][best];
  return best;
}

FETTLE_INLINE void endList(const SmallGroups& list, int taken) noexcept {
  store(list.least + taken, spreadFloat(__builtin_inff()));
}

// The 16 small groups of a large one from number `first` on that can be lower, behind `taken` others. slope_x, slope_y: of the plane that
// all of them lie above by `least`; x, y: of the first one from the first one of 16 x 16 results.
inline int takeSmall(const float* least, float slope_x, float slope_y, float x, float y, std::int32_t first,
                     const BowlShape& shape, const BowlTest& test, const SmallGroups& out,
                     int taken) noexcept {
  const Floats ux = across() * 4.0F + x, uy = down() * 4.0F + y;
  const BowlsThere there = bowlsThere(shape, ux - test.x, uy - test.y);
  const Floats z = load<Floats>(least), a = spreadFloat(slope_x), b = spreadFloat(slope_y);
  const Floats lowest = z + there.depth - sizeOf(there.slope_x - a) * 1.5F - sizeOf(there.slope_y - b) * 1.5F;
  const unsigned bits = canBeLower(lowest, there.slope_x, there.slope_y, test);
  if (bits == 0) return taken;
  keepOf(bits, z, out.least + taken);
  store(out.slope_x + taken, a);
  store(out.slope_y + taken, b);
  keepOf(bits, ux, out.x + taken);
  keepOf(bits, uy, out.y + taken);
  keepOf(bits, numbered() + first, out.number + taken);
  taken += __builtin_popcount(bits);
  endList(out, taken);
  return taken;
}

// Bowls of a list at x, y.
inline void boundSmall(const SmallGroups& in, int count, float x, float y, const BowlShape& shape,
                       const GroupBowls& out) noexcept {
  for (int i = 0; i < count; i += kLanes)
    keepBowls(load<Floats>(in.least + i), load<Floats>(in.slope_x + i), load<Floats>(in.slope_y + i),
              bowlsThere(shape, load<Floats>(in.x + i) - x, load<Floats>(in.y + i) - y), 1.5F, out, i);
}

// Those of a list that can be lower; kAll: with their bounds too, beside where they are.
template <bool kAll>
inline int takeSmallOf(const SmallGroups& in, const GroupBowls& bowls, int count, const BowlTest& test,
                       const SmallGroups& out) noexcept {
  int taken = 0;
  for (int i = 0; i < count; i += kLanes) {
    const unsigned bits = canBeLower(load<Floats>(bowls.least + i), load<Floats>(bowls.slope_x + i),
                                     load<Floats>(bowls.slope_y + i), test);
    if (bits == 0) continue;
    if constexpr (kAll) {
      keepOf(bits, load<Floats>(in.least + i), out.least + taken);
      keepOf(bits, load<Floats>(in.slope_x + i), out.slope_x + taken);
      keepOf(bits, load<Floats>(in.slope_y + i), out.slope_y + taken);
    }
    keepOf(bits, load<Floats>(in.x + i), out.x + taken);
    keepOf(bits, load<Floats>(in.y + i), out.y + taken);
    keepOf(bits, load<Ints>(in.number + i), out.number + taken);
    taken += __builtin_popcount(bits);
  }
  if constexpr (kAll) endList(out, taken);
  return taken;
}

// Of a list's groups the samples that can be lower. Infinite ones never are. With patches (ball_element.h), or worked out. Places
// count from the first of 16 x 16 results.
template <bool kPatches>
inline int takeSamples(const float* z, const SmallGroups& in, int count, const float* patches,
                       std::ptrdiff_t patch_stride, const BowlShape& shape, const BowlTest& test,
                       std::ptrdiff_t height_stride, std::ptrdiff_t depth_stride,
                       const BowlPlaces& out) noexcept {
  int taken = 0;
  const Floats most = spreadFloat(test.most), gx = spreadFloat(test.slope_x), gy = spreadFloat(test.slope_y);
  const Floats half_x = spreadFloat(test.half_x), half_y = spreadFloat(test.half_y);
  const auto height_step = static_cast<std::int32_t>(height_stride),
             depth_step = static_cast<std::int32_t>(depth_stride);
  const Ints heights = inRows(height_step), depths = -inRows(depth_step);
  constexpr float kMore = 0.25F;  // than what the halves are larger by
  const int left = static_cast<int>(test.x - test.half_x + kMore),
            top = static_cast<int>(test.y - test.half_y + kMore);
  for (int i = 0; i < count; i += kLanes) {
    std::int32_t height[kLanes], depth[kLanes], patch[kLanes];
    const Floats x = load<Floats>(in.x + i) - 1.5F, y = load<Floats>(in.y + i) - 1.5F;
    const Ints dx = __builtin_convertvector(x, Ints), dy = __builtin_convertvector(y, Ints);
    store(height, dy * height_step + dx);
    store(depth, dy * depth_step + dx);
    // Multiples of four.
    if constexpr (kPatches)
      store(patch, ((dy - top) >> 2) * static_cast<std::int32_t>(patch_stride) + (dx - left) * 12);
    const int groups = count - i < kLanes ? count - i : kLanes;
    for (int k = 0; k < groups; ++k) {
      BowlsThere there;
      if constexpr (kPatches) {
        const float* const from = patches + patch[k];
        there = {load<Floats>(from), load<Floats>(from + 16), load<Floats>(from + 32)};
      } else {
        there = bowlsThere(shape, across() + (in.x[i + k] - 1.5F - test.x),
                           down() + (in.y[i + k] - 1.5F - test.y));
      }
      const Floats f = load<Floats>(z + std::ptrdiff_t{in.number[i + k]} * 16) + there.depth;
      const unsigned bits =
          below(f - sizeOf(there.slope_x - gx) * half_x - sizeOf(there.slope_y - gy) * half_y, most);
      keepOf(bits, heights + height[k], out.height + taken);
      keepOf(bits, depths - depth[k], out.depth + taken);
      taken += __builtin_popcount(bits);
    }
  }
  return taken;
}

// Registers of doubles: compilers take comparisons of wider vectors apart to single numbers.
#ifdef FETTLE_CPU_LEVELS
#if FETTLE_LEVEL == 2
FETTLE_INLINE void spreadTo(double x, __m512d& v) noexcept {
  v = _mm512_set1_pd(x);
}
FETTLE_INLINE __m512d lowered(const __m512d& z, const __m512d& depth, const __m512d& low) noexcept {
  return _mm512_min_pd(_mm512_add_pd(z, depth), low);
}
#endif
#if FETTLE_LEVEL >= 1
FETTLE_INLINE void spreadTo(double x, __m256d& v) noexcept {
  v = _mm256_set1_pd(x);
}
FETTLE_INLINE __m256d lowered(const __m256d& z, const __m256d& depth, const __m256d& low) noexcept {
  return _mm256_min_pd(_mm256_add_pd(z, depth), low);
}
#else
FETTLE_INLINE void spreadTo(double x, __m128d& v) noexcept {
  v = _mm_set1_pd(x);
}
FETTLE_INLINE __m128d lowered(const __m128d& z, const __m128d& depth, const __m128d& low) noexcept {
  return _mm_min_pd(_mm_add_pd(z, depth), low);
}
#endif
#else
FETTLE_INLINE void spreadTo(double x, double& v) noexcept {
  v = x;
}
FETTLE_INLINE double lowered(const double& z, const double& depth, const double& low) noexcept {
  return z + depth < low ? z + depth : low;
}
#endif

#if !defined(FETTLE_CPU_LEVELS)
using WideLane = double;
#elif FETTLE_LEVEL == 2
using WideLane = __m512d;
#elif FETTLE_LEVEL == 1
using WideLane = __m256d;
#else
using WideLane = __m128d;
#endif

// Lowers four rows of kWide results, `low`, 16 a row, to samples plus their depths.
template <int kWide, class Lane, class T>
FETTLE_INLINE void lowerTo(const T* heights, const double* depths, std::ptrdiff_t stride,
                           const BowlPlaces& places, int count, double* low) noexcept {
  constexpr int kLane = sizeof(Lane) / sizeof(double), kParts = kWide / kLane;
  Lane at[4][kParts];
#pragma GCC unroll 4
  for (int r = 0; r < 4; ++r)
#pragma GCC unroll 8
    for (int k = 0; k < kParts; ++k) at[r][k] = load<Lane>(low + r * 16 + k * kLane);
  for (int i = 0; i < count; ++i) {
    Lane z;
    spreadTo(static_cast<double>(heights[places.height[i]]), z);
    const double* const from = depths + places.depth[i];
#pragma GCC unroll 4
    for (int r = 0; r < 4; ++r)
#pragma GCC unroll 8
      for (int k = 0; k < kParts; ++k)
        at[r][k] = lowered(z, load<Lane>(from + r * stride + k * kLane), at[r][k]);
  }
#pragma GCC unroll 4
  for (int r = 0; r < 4; ++r)
#pragma GCC unroll 8
    for (int k = 0; k < kParts; ++k) store(low + r * 16 + k * kLane, at[r][k]);
}

// `high` rows, a multiple of four, of 8 results from x, y of 16 x 16 on, `low`.
template <class T>
void lowerEight(const T* heights, const double* table, std::ptrdiff_t stride, const BowlPlaces& places,
                int count, int x, int y, int high, double* low) noexcept {
  for (const int end = y + high; y < end; y += 4)
    lowerTo<8, WideLane>(heights, table + y * stride + x, stride, places, count, low + y * 16 + x);
}

// Without a table.
template <class T>
void lowerFar(const T* heights, std::ptrdiff_t height_stride, const float* z, const SmallGroups& in,
              int count, const BallDepth& ball, const BowlShape& shape, const BowlTest& test, int x, int y,
              int high, double* low) noexcept {
  for (int i = 0; i < count; ++i) {
    const int dx = static_cast<int>(in.x[i] - 1.5F), dy = static_cast<int>(in.y[i] - 1.5F);
    const BowlsThere there = bowlsThere(shape, across() + (static_cast<float>(dx) - test.x),
                                        down() + (static_cast<float>(dy) - test.y));
    const Floats f = load<Floats>(z + std::ptrdiff_t{in.number[i]} * 16) + there.depth;
    unsigned bits = canBeLower(f, there.slope_x, there.slope_y, test);
    for (; bits != 0; bits &= bits - 1) {
      const int lane = __builtin_ctz(bits), qx = dx + lane % 4, qy = dy + lane / 4;
      const auto height = static_cast<double>(heights[qy * height_stride + qx]);
      for (int r = y; r < y + high; ++r)
        for (int c = x; c < x + 8; c += 4) {
          double sums[4];
          for (int l = 0; l < 4; ++l)
            sums[l] =
                height + depthOfBall(ball, static_cast<double>(c + l - qx), static_cast<double>(r - qy));
          for (int l = 0; l < 4; ++l)
            low[r * 16 + c + l] = sums[l] < low[r * 16 + c + l] ? sums[l] : low[r * 16 + c + l];
        }
    }
  }
}

// 16 rows of 16 samples, `rows`, into 16 groups of 4 x 4 from below, `blocked`, and what bounds these and all of them. `most`: of
// slopes along rows and columns.
template <class T>
void groupSamples(const T* const* rows, double base, float most_x, float most_y, float* blocked,
                  float* small_least, float* large) noexcept {
  const Floats none = spreadFloat(__builtin_inff());
  Floats z[kLanes], upper = Floats{}, lower = Floats{};
#pragma GCC unroll 16
  for (int r = 0; r < kLanes; ++r) {
    float line[kLanes];
    for (int c = 0; c < kLanes; ++c) {
      // What lies so far up that it is no float any more is bounded all the same.
      const double height = static_cast<double>(rows[r][c]) - base;
      line[c] = static_cast<float>(height > 1e30 && height < __builtin_inf() ? 1e30 : height);
    }
    const Floats exact = load<Floats>(line), size = sizeOf(exact);
    z[r] = exact - (size < none ? size * 0x1p-20F : Floats{});
    (r < 8 ? upper : lower) += z[r];
  }
  float sums[2][kLanes];
  store(sums[0], upper + lower);
  store(sums[1], lower - upper);
  float slope_x = 0.0F, slope_y = 0.0F;
  for (int c = 0; c < kLanes; ++c) {
    slope_x += c < 8 ? -sums[0][c] : sums[0][c];
    slope_y += sums[1][c];
  }
  // 128 differences of means 8 apart.
  slope_x /= 1024.0F;
  slope_y /= 1024.0F;
  const bool whole = slope_x - slope_x == 0.0F && slope_y - slope_y == 0.0F;
  slope_x = !whole ? 0.0F : slope_x > most_x ? most_x : slope_x < -most_x ? -most_x : slope_x;
  slope_y = !whole ? 0.0F : slope_y > most_y ? most_y : slope_y < -most_y ? -most_y : slope_y;
  const float rounding =
      0x1p-17F * ((slope_x < 0.0F ? -slope_x : slope_x) + (slope_y < 0.0F ? -slope_y : slope_y)) * 16.0F;
  float all = __builtin_inff();
  const Floats plane = (counted() - 7.5F) * slope_x;
  for (int j = 0; j < 4; ++j) {
    Floats least = none;
    for (int r = 4 * j; r < 4 * j + 4; ++r) {
      least = lesser(z[r] - plane - (static_cast<float>(r) - 7.5F) * slope_y, least);
      float line[kLanes];
      store(line, z[r]);
      for (int i = 0; i < 4; ++i)
        std::memcpy(blocked + (j * 4 + i) * 16 + (r - 4 * j) * 4, line + 4 * i, 4 * sizeof(float));
    }
    float lanes[kLanes];
    store(lanes, least);
    for (int i = 0; i < 4; ++i) {
      float low = lanes[4 * i];
      for (int l = 1; l < 4; ++l) low = lanes[4 * i + l] < low ? lanes[4 * i + l] : low;
      if (low < __builtin_inff()) low -= (low < 0.0F ? -low : low) * 0x1p-20F + rounding;
      all = low < all ? low : all;
      small_least[j * 4 + i] =
          low + ((static_cast<float>(4 * i) - 6.0F) * slope_x + (static_cast<float>(4 * j) - 6.0F) * slope_y);
    }
  }
  large[0] = all;
  large[1] = slope_x;
  large[2] = slope_y;
}
