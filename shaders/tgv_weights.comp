#version 460
#extension GL_GOOGLE_include_directive : require
// Lowers the weights where the surface jumps or is creased: the kernel `lower` of engine/filter/tgv_rows-inl.h.
#include "tgv.glsl"

layout(local_size_x = kTgvWeightsGroup, local_size_y = kTgvWeightsGroup) in;

layout(set = 0, binding = kTgvBindKept, std430) buffer Kept { float kept[]; };
layout(set = 0, binding = kTgvBindFrom, std430) readonly buffer From { float from[]; };

void main() {
  const int square = int(gl_WorkGroupID.z);
  const ivec2 size = sizeOf(square);
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  // Beyond the border no weight is above 0, so that any sample will do.
  const ivec2 next = ivec2(min(at.x + 1, size.x - 1), at.y);
  const ivec2 above = ivec2(at.x, min(at.y + 1, size.y - 1));
  const float wp = kept[placeOf(kTgvWp, square, at)];
  const float wq = kept[placeOf(kTgvWq, square, at)];
  const float right = wp > 0.0 ? 1.0 : 0.0;
  const float up = wq > 0.0 ? 1.0 : 0.0;
  const float u = from[placeOf(kTgvU, square, at)];
  const float x = from[placeOf(kTgvX, square, at)];
  const float y = from[placeOf(kTgvY, square, at)];
  precise float a = abs((from[placeOf(kTgvU, square, next)] - u) - x);
  precise float b = abs((from[placeOf(kTgvU, square, above)] - u) - y);
  precise float s = right * (from[placeOf(kTgvX, square, next)] - x);
  precise float t = up * (from[placeOf(kTgvY, square, above)] - y);
  precise float d = 0.5 * (right * (from[placeOf(kTgvY, square, next)] - y) +
                           up * (from[placeOf(kTgvX, square, above)] - x));
  precise float bend = sqrt((s * s + t * t) + 2.0 * (d * d));
  precise float lower_p = push.weights.x / (a + push.weights.y);
  precise float lower_q = push.weights.x / (b + push.weights.y);
  precise float lower_v = push.weights.z / (bend + push.weights.w);
  if (wp > push.cut.x) kept[placeOf(kTgvWp, square, at)] = lower_p;
  if (wq > push.cut.x) kept[placeOf(kTgvWq, square, at)] = lower_q;
  kept[placeOf(kTgvWv, square, at)] = lower_v;
}
