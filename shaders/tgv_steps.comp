#version 460
#extension GL_GOOGLE_include_directive : require
// kTgvTogether steps of generalised variation: the kernels `duals` and `surface` of engine/filter/tgv_rows-inl.h.
#include "tgv.glsl"

layout(local_size_x = kTgvRegion, local_size_y = kTgvThreadRows) in;

layout(set = 0, binding = kTgvBindKept, std430) readonly buffer Kept { float kept[]; };
layout(set = 0, binding = kTgvBindFrom, std430) readonly buffer From { float from[]; };
layout(set = 0, binding = kTgvBindTo, std430) writeonly buffer To { float to[]; };

const int kRegionSamples = kTgvRegion * kTgvRegion;
// What threads beside this one read: of all samples the columns on both sides, of the lowest and the uppermost of a
// thread's rows the threads below and above. 26 KiB.
shared float shared_u2[kRegionSamples], shared_x2[kRegionSamples], shared_y2[kRegionSamples];
shared float shared_p[kRegionSamples], shared_xx[kRegionSamples], shared_xy[kRegionSamples];
shared float top_q[kTgvThreadRows * kTgvRegion], top_yy[kTgvThreadRows * kTgvRegion];

// A thread has kTgvRowsPerThread of them, each a variable of its own: an array that a loop goes through does not stay in
// registers on every device (on lavapipe it takes twenty times as long).
struct Sample {
  bool known;
  float f, wp, wq, wv, u, x, y, u2, x2, y2, p, q, xx, yy, xy;
};

Sample load(int square, ivec2 size, ivec2 at) {
  // Beyond the border everything is 0, and stays so: no weight of a link to there is above 0.
  Sample s = Sample(false, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  if (at.x < 0 || at.y < 0 || at.x >= size.x || at.y >= size.y) return s;
  s.f = kept[placeOf(kTgvF, square, at)];
  // Not by a comparison, which a device need not carry out as one of NaN.
  s.known = (floatBitsToUint(s.f) & 0x7fffffffu) <= 0x7f800000u;
  s.wp = kept[placeOf(kTgvWp, square, at)];
  s.wq = kept[placeOf(kTgvWq, square, at)];
  s.wv = kept[placeOf(kTgvWv, square, at)];
  s.u = from[placeOf(kTgvU, square, at)];
  s.x = from[placeOf(kTgvX, square, at)];
  s.y = from[placeOf(kTgvY, square, at)];
  s.u2 = from[placeOf(kTgvU2, square, at)];
  s.x2 = from[placeOf(kTgvX2, square, at)];
  s.y2 = from[placeOf(kTgvY2, square, at)];
  s.p = from[placeOf(kTgvP, square, at)];
  s.q = from[placeOf(kTgvQ, square, at)];
  s.xx = from[placeOf(kTgvXx, square, at)];
  s.yy = from[placeOf(kTgvYy, square, at)];
  s.xy = from[placeOf(kTgvXy, square, at)];
  return s;
}

void store(Sample s, int square, ivec2 size, ivec2 at, ivec2 in_region) {
  const int past = kTgvTogether + kTgvInner;
  if (in_region.x < kTgvTogether || in_region.y < kTgvTogether || in_region.x >= past || in_region.y >= past ||
      at.x >= size.x || at.y >= size.y)
    return;
  to[placeOf(kTgvU, square, at)] = s.u;
  to[placeOf(kTgvX, square, at)] = s.x;
  to[placeOf(kTgvY, square, at)] = s.y;
  to[placeOf(kTgvU2, square, at)] = s.u2;
  to[placeOf(kTgvX2, square, at)] = s.x2;
  to[placeOf(kTgvY2, square, at)] = s.y2;
  to[placeOf(kTgvP, square, at)] = s.p;
  to[placeOf(kTgvQ, square, at)] = s.q;
  to[placeOf(kTgvXx, square, at)] = s.xx;
  to[placeOf(kTgvYy, square, at)] = s.yy;
  to[placeOf(kTgvXy, square, at)] = s.xy;
}

void shareSurface(Sample s, int at) {
  shared_u2[at] = s.u2;
  shared_x2[at] = s.x2;
  shared_y2[at] = s.y2;
}

// above: u2, x2 and y2 of the next row.
void stepDuals(inout Sample s, vec3 above, int at, int next) {
  const float step = push.lengths.y;
  precise float a = s.p + step * ((shared_u2[next] - s.u2) - s.x2);
  precise float b = s.q + step * ((above.x - s.u2) - s.y2);
  a = a > s.wp ? s.wp : a;
  s.p = a < -s.wp ? -s.wp : a;
  b = b > s.wq ? s.wq : b;
  s.q = b < -s.wq ? -s.wq : b;
  const float right = s.wp > 0.0 ? step : 0.0;
  const float up = s.wq > 0.0 ? step : 0.0;
  precise float xx = s.xx + right * (shared_x2[next] - s.x2);
  precise float yy = s.yy + up * (above.z - s.y2);
  precise float xy = s.xy + 0.5 * (right * (shared_y2[next] - s.y2) + up * (above.y - s.x2));
  precise float bound = s.wv * s.wv;
  precise float squared = (xx * xx + yy * yy) + 2.0 * (xy * xy);
  precise float shorter = s.wv / sqrt(squared > bound ? squared : bound);
  xx = xx * shorter;
  yy = yy * shorter;
  xy = xy * shorter;
  s.xx = xx;
  s.yy = yy;
  s.xy = xy;
  shared_p[at] = s.p;
  shared_xx[at] = xx;
  shared_xy[at] = xy;
}

// below: q, yy and xy of the row before.
void stepSurface(inout Sample s, vec3 below, int before) {
  const float step = push.lengths.x;
  precise float moved = s.u + step * ((s.p - shared_p[before]) + (s.q - below.x));
  precise float nearer = moved + push.lengths.z * (s.f - moved);
  const float u = s.known ? nearer : moved;
  precise float x = s.x + step * (s.p + ((s.xx - shared_xx[before]) + (s.xy - below.z)));
  precise float y = s.y + step * (s.q + ((s.xy - shared_xy[before]) + (s.yy - below.y)));
  precise float u2 = 2.0 * u - s.u;
  precise float x2 = 2.0 * x - s.x;
  precise float y2 = 2.0 * y - s.y;
  s.u = u;
  s.x = x;
  s.y = y;
  s.u2 = u2;
  s.x2 = x2;
  s.y2 = y2;
}

void main() {
  const int square = int(gl_WorkGroupID.z);
  const ivec2 size = sizeOf(square);
  const ivec2 first = ivec2(gl_WorkGroupID.xy) * kTgvInner;  // that is written
  if (first.x >= size.x || first.y >= size.y) return;
  const ivec2 at = ivec2(gl_LocalInvocationID.x, gl_LocalInvocationID.y * kTgvRowsPerThread);
  const ivec2 up = ivec2(0, 1);
  const ivec2 corner = first - kTgvTogether;

  Sample s0 = load(square, size, corner + at);
  Sample s1 = load(square, size, corner + at + up);
  Sample s2 = load(square, size, corner + at + 2 * up);
  Sample s3 = load(square, size, corner + at + 3 * up);
  // Places in the region. At its rim any sample will do for a neighbour: what comes of it is not written.
  const int p0 = at.y * kTgvRegion + at.x, p1 = p0 + kTgvRegion, p2 = p1 + kTgvRegion, p3 = p2 + kTgvRegion;
  const int next = at.x + 1 < kTgvRegion ? 1 : 0, before = at.x > 0 ? -1 : 0;
  const int above = at.y + kTgvRowsPerThread < kTgvRegion ? p3 + kTgvRegion : p3;
  const int below = at.y > 0 ? p0 - kTgvRegion : p0;
  const int top = int(gl_LocalInvocationID.y) * kTgvRegion + at.x;
  const int top_below = at.y > 0 ? top - kTgvRegion : top;
  for (int taken = 0; taken < kTgvTogether; ++taken) {
    shareSurface(s0, p0);
    shareSurface(s1, p1);
    shareSurface(s2, p2);
    shareSurface(s3, p3);
    barrier();
    stepDuals(s0, vec3(s1.u2, s1.x2, s1.y2), p0, p0 + next);
    stepDuals(s1, vec3(s2.u2, s2.x2, s2.y2), p1, p1 + next);
    stepDuals(s2, vec3(s3.u2, s3.x2, s3.y2), p2, p2 + next);
    stepDuals(s3, vec3(shared_u2[above], shared_x2[above], shared_y2[above]), p3, p3 + next);
    top_q[top] = s3.q;
    top_yy[top] = s3.yy;
    barrier();
    stepSurface(s0, vec3(top_q[top_below], top_yy[top_below], shared_xy[below]), p0 + before);
    stepSurface(s1, vec3(s0.q, s0.yy, s0.xy), p1 + before);
    stepSurface(s2, vec3(s1.q, s1.yy, s1.xy), p2 + before);
    stepSurface(s3, vec3(s2.q, s2.yy, s2.xy), p3 + before);
  }
  store(s0, square, size, corner + at, at);
  store(s1, square, size, corner + at + up, at + up);
  store(s2, square, size, corner + at + 2 * up, at + 2 * up);
  store(s3, square, size, corner + at + 3 * up, at + 3 * up);
}
