// What the shaders of generalised variation share. Sums and products are `precise`: as written, never fused, so that
// every device rounds them as the processor does (engine/filter/tgv_rows-inl.h).
#include "tgv_layout.h"

layout(push_constant) uniform Push { TgvPush push; };

ivec2 sizeOf(int square) {
  const ivec4 two = push.sizes[square / 2];
  return square % 2 == 0 ? two.xy : two.zw;
}

int placeOf(int array, int square, ivec2 at) {
  return ((array * kTgvSquares + square) * kTgvSlot + at.y) * kTgvSlot + at.x;
}
