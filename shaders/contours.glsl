// Whether a contour line belongs to the surface or to its noise, from a plane through what the colours show on two
// squares around a point, panel.seam.zw steps from it and half as far. Where that plane is level beside what the samples
// deviate from it, the place of a line says nothing: it would ink a plain wherever noise crosses the level.
//
// Independent noise of s gives the plane a rise of 0.46 s (mean) over the larger square's half side, more than 1.2 s once in 200
// places, beside a residual of 0.9 s. A step through the middle gives 4.6 times its residual.
//
// Jones 1998, "A comparison of algorithms used to compute hill slope as a property of the DEM", for planes by least
// squares on such squares.

struct Trend {
  vec2 slope;      // of what the colours show, per step between the samples
  float residual;  // root of the mean square of what the samples deviate from the plane
  float rise;      // along the slope over the half side of the larger square
};

// What the colours show at sample `s`; false where there is none.
bool shownAt(ivec2 s, out float value) {
  value = 0.0;
  if (!inField(s)) return false;
  const uint raw = shadeHeight(s);
  if (kHoles && isHole(raw)) return false;
  value = clamp(heightOf(raw), panel.limits.x, panel.limits.y);
  if (kDeviation) {
    const uint before = texelFetch(original_image, originalTexelOf(s), 0).x;
    if (isHole(before)) return false;
    value = heightOf(raw) - panel.limits.z * uintBitsToFloat(before);
  }
  return true;
}

// Around sample `centre`, which shows `here`.
Trend trendAround(ivec2 centre, float here) {
  // On demand a coarser level may be all that is there.
  const int coarser = shade_log2 - panel.shade.x;
  const vec2 half_side = max(round(panel.seam.zw / float(1 << coarser)), 1.0);
  float n = 1.0, x = 0.0, y = 0.0, z = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, xz = 0.0, yz = 0.0, zz = 0.0;
  for (int k = 0; k < 16; ++k) {
    const int place = k & 7;
    const ivec2 direction = ivec2(place < 3 ? -1 : place < 5 ? 0 : 1, place < 3 ? place - 1 : place == 3 ? -1 : place == 4 ? 1 : place - 6);
    const ivec2 d = direction * ivec2(k < 8 ? half_side : ceil(0.5 * half_side));
    float value;
    if (!shownAt(centre + d, value)) continue;
    const float h = value - here;
    const vec2 at = vec2(d);
    n += 1.0;
    x += at.x;
    y += at.y;
    z += h;
    xx += at.x * at.x;
    xy += at.x * at.y;
    yy += at.y * at.y;
    xz += at.x * h;
    yz += at.y * h;
    zz += h * h;
  }
  const float per = 1.0 / n;
  const float a = xx - x * x * per, b = xy - x * y * per, c = yy - y * y * per;
  const float u = xz - x * z * per, v = yz - y * z * per;
  const float divisor = a * c - b * b;
  Trend trend;
  trend.slope = divisor > 0.0 ? vec2(c * u - b * v, a * v - b * u) / divisor : vec2(0.0);
  trend.residual = sqrt(max(0.0, (zz - z * z * per - trend.slope.x * u - trend.slope.y * v) * per));
  trend.rise = length(trend.slope * half_side);
  return trend;
}
