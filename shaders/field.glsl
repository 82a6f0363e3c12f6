// Access to the samples of a field.
#ifdef FETTLE_EYES
#extension GL_EXT_multiview : require
#endif
#include "layout.h"

layout(constant_id = kSpecPaged) const bool kPaged = false;
layout(constant_id = kSpecHoles) const bool kHoles = true;
layout(constant_id = kSpecOnDemand) const bool kByNeed = false;
layout(constant_id = kSpecGather) const bool kGather = false;

layout(set = 0, binding = kBindPanel, std140) uniform PanelBlock { PanelUniforms panel; };
layout(set = 0, binding = kBindHeights) uniform utexture2DArray heights_image;
layout(set = 0, binding = kBindShade) uniform utexture2DArray shade_image;
// A texture and not a storage buffer: differences between fragments also read entries outside the surface, and not
// every driver allows that in buffers.
layout(set = 0, binding = kBindPages) uniform utextureBuffer page_table;

uint pageEntry(int number) { return texelFetch(page_table, number).x; }

// Position of sample `s` of a page in the pool.
ivec3 pooledTexel(uint entry, ivec2 s) {
  const ivec2 page = ivec2(entry & kEntrySideMask, entry >> kEntryUpShift & kEntrySideMask);
  return ivec3((page << panel.pages.pool.x) + (s & ((1 << panel.pages.pool.x) - 1)),
               entry >> kEntryLayerShift & kEntryLayerMask);
}

uint entryOf(int level, ivec2 s) {
  const ivec2 page = s >> panel.pages.pool.x;
  return pageEntry(panel.pages.level[level].x + page.y * panel.pages.level[level].y + page.x);
}

// Sample `s` of the field, from the level of every 2^log2_step-th sample: `s` is a multiple of that, or on the last
// column or row.
uint rawOnDemand(ivec2 s, int log2_step) {
  const ivec2 last = panel.size.zw - 1;
  s = clamp(s, ivec2(0), last);
  const int level = min(log2_step >> 1, kDataLevels - 1);
  ivec3 texel;
  if (level > 0 && any(equal(s, last))) {
    const int number = s.x == last.x ? s.y : panel.pages.pool.z + s.x;
    texel = pooledTexel(pageEntry(panel.pages.pool.y + (number >> 2 * panel.pages.pool.x)),
                        ivec2(number, number >> panel.pages.pool.x));
  } else {
    const ivec2 at = s >> 2 * level;
    texel = pooledTexel(entryOf(level, at), at);
  }
  return texelFetch(heights_image, texel, 0).x;
}
layout(set = 0, binding = kBindNearest) uniform sampler nearest;

// The eye that is drawn. FETTLE_EYES: a pass draws both at once.
#ifdef FETTLE_EYES
ViewUniforms viewUniforms() { return panel.views[gl_ViewIndex]; }
#else
ViewUniforms viewUniforms() { return panel.views[0]; }
#endif

// Position of sample `s` of the virtual field in an image array. Pages are powers of two, so that this needs only
// shifts.
ivec3 texelOf(ivec2 s) {
  s = clamp(s, ivec2(0), panel.size.zw - 1);
  if (!kPaged) return ivec3(s, 0);
  const ivec2 page = s >> panel.paging.xy;
  return ivec3(s - (page << panel.paging.xy), page.y * panel.paging.z + page.x);
}

uint rawHeight(ivec2 s, int log2_step) {
  return kByNeed ? rawOnDemand(s, log2_step) : texelFetch(heights_image, texelOf(s), 0).x;
}

// Colours may come from every 2^shade.x-th sample: otherwise a far view would fetch a cache line for every pixel. Where
// those are not on the device yet, colours come from a coarser level: shadeCell() sets these three variables, which the
// reads after it use.
int shade_log2 = panel.shade.x;       // of the step between samples
ivec2 shade_size = panel.shade.zw;    // columns, rows
int shade_difference = panel.paging.w;  // step of differences

// The pages of the samples of a cell's colour, from panel.footprint.z before it to one more after it: 2 x 2 at most.
// Looked up once for all samples of a fragment.
ivec2 window_page;     // of the lowest of them
uvec4 window_entries;  // low, to the right, above, above to the right

// Sets the window; returns whether it is on the device.
bool readable(int level, ivec2 cell) {
  const ivec2 last = panel.pages.level[level].zw - 1;
  const int reach = panel.footprint.z;
  const ivec2 low = clamp(cell - reach, ivec2(0), last), high = clamp(cell + reach + 1, ivec2(0), last);
  window_page = low >> panel.pages.pool.x;
  window_entries = uvec4(entryOf(level, low), entryOf(level, ivec2(high.x, low.y)),
                         entryOf(level, ivec2(low.x, high.y)), entryOf(level, high));
  return (window_entries.x | window_entries.y | window_entries.z | window_entries.w) >> kEntryAwayShift == 0u;
}

ivec3 shadeTexelOf(ivec2 s) {
  s = clamp(s, ivec2(0), (panel.size.zw - 1) >> shade_log2);
  if (kByNeed) {
    const bvec2 beyond = greaterThan(s >> panel.pages.pool.x, window_page);
    const uvec2 e = beyond.y ? window_entries.zw : window_entries.xy;
    return pooledTexel(beyond.x ? e.y : e.x, s);
  }
  if (!kPaged) return ivec3(s, 0);
  const ivec2 log2_page = panel.paging.xy - panel.shade.x;
  const ivec2 page = s >> log2_page;
  return ivec3(s - (page << log2_page), page.y * panel.paging.z + page.x);
}

// The same in the original.
ivec3 originalTexelOf(ivec2 s) {
  if (!kByNeed) return shadeTexelOf(s);
  s = clamp(s, ivec2(0), (panel.size.zw - 1) >> shade_log2);
  const int level = shade_log2 >> 1;
  const ivec2 page = s >> panel.pages.pool.x;
  return pooledTexel(pageEntry(panel.pages.pool.w + panel.pages.level[level].x +
                                   page.y * panel.pages.level[level].y + page.x),
                     s);
}

uint shadeHeight(ivec2 s) { return texelFetch(shade_image, shadeTexelOf(s), 0).x; }

// Position of the point `local` samples from sample `base` among those samples: cell, and position in the cell.
ivec2 shadeCell(ivec2 base, vec2 local, out vec2 f) {
  if (kByNeed) {
    const ivec2 s = base + ivec2(floor(local));
    int level = panel.shade.x >> 1;
    while (!readable(level, s >> 2 * level) && level < kDataLevels - 1) ++level;
    shade_log2 = 2 * level;
    if (shade_log2 > panel.shade.x) shade_size = max(((panel.size.zw - 1) >> shade_log2) + 1, ivec2(2));
    shade_difference = max(panel.paging.w >> (shade_log2 - panel.shade.x), 1);
  }
  const int step = 1 << shade_log2;
  const ivec2 first = base >> shade_log2;
  const vec2 p = (vec2(base - (first << shade_log2)) + local) / float(step);
  const ivec2 cell = clamp(first + ivec2(floor(p)), ivec2(0), shade_size - 2);
  f = clamp(p - vec2(cell - first), 0.0, 1.0);
  return cell;
}

// Bits of the heights at a cell's corners: (0, 0), (1, 0), (0, 1), (1, 1).
uvec4 cellHeights(ivec2 cell) {
  if (kGather) {
    // Halfway between the four: rounding cannot select others.
    const vec2 at = vec2(cell + 1) / vec2(textureSize(shade_image, 0).xy);
    return textureGather(usampler2DArray(shade_image, nearest), vec3(at, 0.0)).wzxy;
  }
  return uvec4(shadeHeight(cell), shadeHeight(cell + ivec2(1, 0)), shadeHeight(cell + ivec2(0, 1)),
               shadeHeight(cell + ivec2(1, 1)));
}

// On the bits, because a driver may evaluate "x != x" as false.
bool isHole(uint raw) { return (raw & 0x7fffffffu) > 0x7f800000u; }

bool cellIsHole(ivec2 cell) {
  const uvec4 raw = cellHeights(cell);
  return isHole(raw.x) || isHole(raw.y) || isHole(raw.z) || isHole(raw.w);
}

float heightOf(uint raw) { return panel.relief.x * uintBitsToFloat(raw); }

// Scene z of a height; spikes are clipped so that a single outlier does not fill the picture.
float sceneZ(float height) {
  return (clamp(height, panel.limits.x, panel.limits.y) - panel.relief.y) * panel.relief.z;
}

vec3 scenePoint(ivec2 s, float z) { return vec3(panel.placing.xy + vec2(s) * panel.placing.zw, z); }

// The height that geometry uses at a sample. A hole takes the nearest height in the square of cells around it, so that
// the valid part of a cell larger than one sample is drawn at its position; the fragments over the hole itself are
// dropped.
float drawnZ(ivec2 s, ivec2 stride) {
  uint raw = rawHeight(s, findMSB(stride.x));
  if (kHoles && isHole(raw)) {
    // At most 8 rings, so that a stride of 2^k costs no more than a stride of 8.
    const ivec2 step = max(stride >> 3, ivec2(1));
    const int log2_step = findMSB(step.x);
    // On the last column and row as well, only samples of that step are read.
    s &= ~(step - 1);
    const int rings = max(stride.x / step.x, stride.y / step.y);
    for (int ring = 1; ring <= rings && isHole(raw); ++ring)
      for (int i = -ring; i < ring && isHole(raw); ++i) {
        raw = rawHeight(s + step * ivec2(i, -ring), log2_step);
        if (isHole(raw)) raw = rawHeight(s + step * ivec2(ring, i), log2_step);
        if (isHole(raw)) raw = rawHeight(s + step * ivec2(-i, ring), log2_step);
        if (isHole(raw)) raw = rawHeight(s + step * ivec2(-ring, -i), log2_step);
      }
    if (isHole(raw)) return panel.relief.w;
  }
  return sceneZ(heightOf(raw));
}
