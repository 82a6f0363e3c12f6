// How shaders look into a field.
#include "layout.h"

layout(constant_id = kSpecPaged) const bool kPaged = false;
layout(constant_id = kSpecHoles) const bool kHoles = true;

layout(set = 0, binding = kBindPanel, std140) uniform PanelBlock { PanelUniforms panel; };
layout(set = 0, binding = kBindHeights) uniform utexture2DArray heights_image;
layout(set = 0, binding = kBindShade) uniform utexture2DArray shade_image;

// Where sample `s` of the virtual field lies in an image array. Pages are powers of two so that this is shifts.
ivec3 texelOf(ivec2 s) {
  s = clamp(s, ivec2(0), panel.size.zw - 1);
  if (!kPaged) return ivec3(s, 0);
  const ivec2 page = s >> panel.paging.xy;
  return ivec3(s - (page << panel.paging.xy), page.y * panel.paging.z + page.x);
}

uint rawHeight(ivec2 s) { return texelFetch(heights_image, texelOf(s), 0).x; }

// Colours may come from every 2^shade.x-th sample: a far view would else fetch a cache line for every pixel.
ivec3 shadeTexelOf(ivec2 s) {
  s = clamp(s, ivec2(0), (panel.size.zw - 1) >> panel.shade.x);
  if (!kPaged) return ivec3(s, 0);
  const ivec2 log2_page = panel.paging.xy - panel.shade.x;
  const ivec2 page = s >> log2_page;
  return ivec3(s - (page << log2_page), page.y * panel.paging.z + page.x);
}

uint shadeHeight(ivec2 s) { return texelFetch(shade_image, shadeTexelOf(s), 0).x; }

// Place among those samples of the point `local` samples from sample `base`: cell, and where in it.
ivec2 shadeCell(ivec2 base, vec2 local, out vec2 f) {
  const int step = 1 << panel.shade.x;
  const ivec2 first = base >> panel.shade.x;
  const vec2 p = (vec2(base - (first << panel.shade.x)) + local) / float(step);
  const ivec2 cell = clamp(first + ivec2(floor(p)), ivec2(0), panel.shade.zw - 2);
  f = clamp(p - vec2(cell - first), 0.0, 1.0);
  return cell;
}

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
  if (kHoles && isHole(raw)) {
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
