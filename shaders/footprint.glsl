// The plane through the samples in the footprint of a ray, by least squares: the shape of the surface at the size of a
// pixel. The slope of a single cell is, where cells are smaller than a pixel, mostly the noise of four samples.
//
// Eight samples: the corners of the cell, which its colour has read, and those of a larger one around it, panel.footprint
// steps outside it. Independent noise of s in the samples gives a slope with s / sqrt(10) per step (1 step outside) or
// s / sqrt(26) (2 steps); that of the cell alone has s. All sixteen samples of the square would give sqrt(20) and
// sqrt(52), but cost three times as many reads. Holes and what lies outside the field are left out; the corners of a
// cell that is drawn are always there, so that the equations have a solution.

struct Plane {
  vec2 slope;      // height units per step between the samples
  float residual;  // root of the mean square of what the samples deviate from it [height units]
};

// `corners`: heights at the corners of `cell`.
Plane footprintPlane(ivec2 cell, vec4 corners) {
  // Heights are clipped as they are drawn, and counted from one of them, so that nothing of a slope is lost beside a
  // large height. Places are counted from the middle of the cell.
  corners = clamp(corners, panel.limits.x, panel.limits.y);
  const float middle = corners.x;
  corners -= middle;
  float n = 4.0, x = 0.0, y = 0.0, xx = 1.0, xy = 0.0, yy = 1.0;
  float z = corners.x + corners.y + corners.z + corners.w;
  float xz = 0.5 * (corners.y - corners.x + corners.w - corners.z);
  float yz = 0.5 * (corners.z - corners.x + corners.w - corners.y);
  float zz = dot(corners, corners);
  for (int k = 0; k < 4; ++k) {
    const bvec2 after = bvec2((k & 1) != 0, (k & 2) != 0);
    const ivec2 s = cell + mix(-panel.footprint.xy, 1 + panel.footprint.xy, after);
    const uint raw = shadeHeight(s);
    const bool counts = inField(s) && !(kHoles && isHole(raw));
    // A selection and no product: a hole is no number.
    const float h = counts ? clamp(heightOf(raw), panel.limits.x, panel.limits.y) - middle : 0.0;
    const vec2 at = counts ? vec2(s - cell) - 0.5 : vec2(0.0);
    n += counts ? 1.0 : 0.0;
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
  // About the middle of the samples.
  const float per = 1.0 / n;
  const float a = xx - x * x * per, b = xy - x * y * per, c = yy - y * y * per;
  const float u = xz - x * z * per, v = yz - y * z * per;
  Plane plane;
  plane.slope = vec2(c * u - b * v, a * v - b * u) / (a * c - b * b);
  plane.residual = sqrt(max(0.0, (zz - z * z * per - plane.slope.x * u - plane.slope.y * v) * per));
  return plane;
}
