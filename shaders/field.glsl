// How shaders look into a field.
#include "layout.h"

layout(constant_id = kSpecPaged) const bool kPaged = false;

layout(set = 0, binding = kBindPanel, std140) uniform PanelBlock { PanelUniforms panel; };
layout(set = 0, binding = kBindHeights) uniform utexture2DArray heights_image;

// Where sample `s` of the virtual field lies in an image array. Pages are powers of two so that this is shifts.
ivec3 texelOf(ivec2 s) {
  s = clamp(s, ivec2(0), panel.size.zw - 1);
  if (!kPaged) return ivec3(s, 0);
  const ivec2 page = s >> panel.paging.xy;
  return ivec3(s - (page << panel.paging.xy), page.y * panel.paging.z + page.x);
}

uint rawHeight(ivec2 s) { return texelFetch(heights_image, texelOf(s), 0).x; }

// On the bits, because a driver may take "x != x" for false.
bool isHole(uint raw) { return (raw & 0x7fffffffu) > 0x7f800000u; }

float heightOf(uint raw) { return panel.relief.x * uintBitsToFloat(raw); }

// Scene z of a height; spikes are cut so that one wild sample does not fill the picture.
float sceneZ(float height) {
  return (clamp(height, panel.limits.x, panel.limits.y) - panel.relief.y) * panel.relief.z;
}

vec3 scenePoint(ivec2 s, float z) { return vec3(panel.placing.xy + vec2(s) * panel.placing.zw, z); }

// The height that geometry takes at a sample. A hole takes the nearest height in the square of cells around it, so
// that the valid part of a cell larger than one sample is drawn where it belongs; the fragments over the hole
// itself are dropped.
float drawnZ(ivec2 s, ivec2 stride) {
  uint raw = rawHeight(s);
  if (isHole(raw)) {
    // At most 8 rings, so that a stride of 2^k costs no more than a stride of 8.
    const ivec2 step = max(stride >> 3, ivec2(1));
    const int rings = max(stride.x / step.x, stride.y / step.y);
    for (int ring = 1; ring <= rings && isHole(raw); ++ring)
      for (int i = -ring; i < ring && isHole(raw); ++i) {
        raw = rawHeight(s + step * ivec2(i, -ring));
        if (isHole(raw)) raw = rawHeight(s + step * ivec2(ring, i));
        if (isHole(raw)) raw = rawHeight(s + step * ivec2(-i, ring));
        if (isHole(raw)) raw = rawHeight(s + step * ivec2(-ring, -i));
      }
    if (isHole(raw)) return panel.relief.w;
  }
  return sceneZ(heightOf(raw));
}
