// Colour of a point of the surface, from the exact samples (or every 2^shade.x-th), regardless of the geometry's
// stride.
#include "field.glsl"

layout(constant_id = kSpecMarks) const bool kMarks = false;
layout(constant_id = kSpecDeviation) const bool kDeviation = false;
layout(constant_id = kSpecContours) const bool kContours = false;
layout(constant_id = kSpecSmooth) const bool kSmooth = false;
layout(constant_id = kSpecCell) const bool kCell = false;
layout(constant_id = kSpecFootprint) const bool kFootprint = false;
layout(constant_id = kSpecOcclusion) const bool kOcclusion = false;
layout(constant_id = kSpecCavity) const bool kCavity = false;
layout(constant_id = kSpecMaterial) const bool kMaterial = false;

layout(set = 0, binding = kBindMarks) uniform utexture2DArray marks_image;
layout(set = 0, binding = kBindOriginal) uniform utexture2DArray original_image;

// Whether `s` is one of the samples that colours come from.
bool inField(ivec2 s) { return all(greaterThanEqual(s, ivec2(0))) && all(lessThan(s, shade_size)); }

#include "footprint.glsl"
#include "surroundings.glsl"
#include "material.glsl"
#include "contours.glsl"

// Half the difference between the neighbours of `s` along `d`, or the difference to one neighbour where the other is a
// hole; height units per step. `h` is the height at s.
float slope(ivec2 s, ivec2 d, float h) {
  const uint after = shadeHeight(s + d);
  const uint before = shadeHeight(s - d);
  const ivec2 last = shade_size - 1;
  const bool has_after = !(kHoles && isHole(after)) && all(lessThanEqual(s + d, last));
  const bool has_before = !(kHoles && isHole(before)) && all(greaterThanEqual(s - d, ivec2(0)));
  const float a = has_after ? heightOf(after) : h;
  const float b = has_before ? heightOf(before) : h;
  return (a - b) / (has_after && has_before ? 2.0 : 1.0);
}

// Slope at a corner of the cell, of which `inward` is the slope along the cell's own edge: the mean of that and of the
// slope to the sample outside, when there is one. `sign` is +1 when the outer sample comes after the corner.
float cornerSlope(ivec2 outer, float at, float inward, float sign) {
  const uint raw = shadeHeight(outer);
  const bool inside = all(greaterThanEqual(outer, ivec2(0))) && all(lessThan(outer, shade_size));
  return (kHoles && isHole(raw)) || !inside ? inward : 0.5 * (inward + sign * (heightOf(raw) - at));
}

// Slopes interpolated between the cell's corners from the samples around it: smooth shading.
vec2 smoothSlopes(ivec2 c, vec2 f, vec4 h) {
  const vec2 low = vec2(h.y - h.x, h.z - h.x), high = vec2(h.w - h.z, h.w - h.y);  // edges: (x at y0, y at x0), ...
  const float x0 = mix(cornerSlope(c + ivec2(-1, 0), h.x, low.x, -1.0), cornerSlope(c + ivec2(2, 0), h.y, low.x, 1.0), f.x);
  const float x1 = mix(cornerSlope(c + ivec2(-1, 1), h.z, high.x, -1.0), cornerSlope(c + ivec2(2, 1), h.w, high.x, 1.0), f.x);
  const float y0 = mix(cornerSlope(c + ivec2(0, -1), h.x, low.y, -1.0), cornerSlope(c + ivec2(0, 2), h.z, low.y, 1.0), f.y);
  const float y1 = mix(cornerSlope(c + ivec2(1, -1), h.y, high.y, -1.0), cornerSlope(c + ivec2(1, 2), h.w, high.y, 1.0), f.y);
  return vec2(mix(x0, x1, f.y), mix(y0, y1, f.x));
}

vec3 mapped(float value) {
  const float t = clamp((value - panel.colouring.x) * panel.colouring.y, 0.0, 1.0) * float(kColours - 1);
  if (kCell) return panel.colours[int(t + 0.5)].rgb;
  const int i = min(int(t), kColours - 2);
  return mix(panel.colours[i].rgb, panel.colours[i + 1].rgb, t - float(i));
}

// A point of the surface as it is drawn, with its values from the samples.
struct SurfacePoint {
  ivec2 cell;     // among the samples that colours come from
  vec2 f;         // position in it, 0 .. 1
  vec4 h;         // heights of its corners
  vec4 shown;     // what the colours show there
  bool hole;      // one of them is a hole
  bool displaced;    // drawn away from its exact position: see below
  bool compared;  // the original has a height here
  float value;    // what the colours show
  float drawn;    // height at which it is drawn
};

// The point `local` samples from sample `base`, drawn at scene z `drawn_z`.
SurfacePoint surfacePoint(ivec2 base, vec2 local, float drawn_z) {
  SurfacePoint p;
  p.cell = shadeCell(base, local, p.f);
  const uvec4 raw = cellHeights(p.cell);
  p.hole = kHoles && (isHole(raw.x) || isHole(raw.y) || isHole(raw.z) || isHole(raw.w));
  p.h = panel.relief.x * uintBitsToFloat(raw);
  const float height = mix(mix(p.h.x, p.h.y, p.f.x), mix(p.h.z, p.h.w, p.f.x), p.f.y);
  p.value = height;
  p.shown = p.h;
  p.compared = true;
  if (kDeviation) {
    uvec4 before;
    before.x = texelFetch(original_image, originalTexelOf(p.cell), 0).x;
    before.y = texelFetch(original_image, originalTexelOf(p.cell + ivec2(1, 0)), 0).x;
    before.z = texelFetch(original_image, originalTexelOf(p.cell + ivec2(0, 1)), 0).x;
    before.w = texelFetch(original_image, originalTexelOf(p.cell + ivec2(1, 1)), 0).x;
    p.compared = !(isHole(before.x) || isHole(before.y) || isHole(before.z) || isHole(before.w));
    // Corner by corner, so that equal samples give exactly zero.
    const vec4 d = p.h - panel.limits.z * uintBitsToFloat(before);
    p.value = mix(mix(d.x, d.y, p.f.x), mix(d.z, d.w, p.f.x), p.f.y);
    p.shown = d;
  }
  // Where a coarse cell is drawn in place of a steep wall, the drawn point is not above the sample's position but
  // displaced: it shows the wall at its own height, so it takes colour and light from there. Otherwise walls would be
  // striped.
  p.displaced = abs(drawn_z - sceneZ(height)) > panel.seam.y;
  p.drawn = panel.relief.y + drawn_z / panel.relief.z;
  if (!kDeviation && p.displaced) p.value = p.drawn;
  return p;
}

float contourOf(SurfacePoint p) { return p.value / panel.colouring.z; }

// How much of a contour line covers the point, 0 .. 1: lines of one width on the screen. `contour`: contourOf, and its
// change over one ray; `steps`: samples that the position changes by from this ray to the next, along and up the
// picture.
float contourInk(SurfacePoint p, float contour, float contour_width, mat2 steps) {
  float shown = 1.0;
  if (!p.displaced) {
    const bvec2 after = greaterThanEqual(p.f, vec2(0.5));
    const vec2 pair = after.y ? p.shown.zw : p.shown.xy;
    const Trend trend = trendAround(p.cell + ivec2(after), after.x ? pair.y : pair.x);
    shown = smoothstep(0.9, 1.6, trend.rise / max(trend.residual, 1e-30));
    // Steps are no noise: their width is that of the cell itself.
    const vec2 own = 0.5 * vec2(p.shown.y - p.shown.x + p.shown.w - p.shown.z,
                                p.shown.z - p.shown.x + p.shown.w - p.shown.y);
    const float noisy = 1.0 - smoothstep(3.0, 5.0, length(own) / max(trend.residual, 1e-30));
    const vec2 change = trend.slope * steps / (float(1 << shade_log2) * panel.colouring.z);
    contour_width = mix(contour_width, abs(change.x) + abs(change.y), noisy);
  }
  const float off = abs(fract(contour - 0.5) - 0.5) / max(contour_width, 1e-12);
  // Lines closer than four rays would fill the surface: they are faded out.
  return shown * (1.0 - smoothstep(0.6, 1.4, off)) * (1.0 - smoothstep(0.15, 0.3, contour_width));
}

// The share of a mark's colour at sample `s`, which has the mark `mark`: of an outline all or none of it.
float markShare(ivec2 s, uint mark, float opacity) {
  if (opacity >= 0.0) return opacity;
  const ivec2 steps[4] = ivec2[](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
  for (int i = 0; i < 4; ++i)
    if (inField(s + steps[i]) && texelFetch(marks_image, shadeTexelOf(s + steps[i]), 0).x != mark) return 1.0;
  return 0.0;
}

// Grey of a point that the original has no height for: its own height is all there is to show. Hatched, since holes have the
// same grey: stripes are told from it whatever colours a person sees. They lie on the surface, so that they stay where they are
// in a picture that moves, that is drawn in parts, or less sharply.
vec3 greyByHeight(SurfacePoint p) {
  const float height = mix(mix(p.h.x, p.h.y, p.f.x), mix(p.h.z, p.h.w, p.f.x), p.f.y);
  const float share = (height - panel.limits.x) / max(panel.limits.y - panel.limits.x, 1e-30);
  const vec2 at = (vec2(p.cell) + p.f) * float(1 << shade_log2) * panel.placing.zw;
  const bool stripe = fract((at.x + at.y) / panel.no_data.w) * float(kHatchStripes) < 1.0;
  return panel.no_data.rgb * mix(0.5, 1.5, clamp(share, 0.0, 1.0)) / (stripe ? float(kHatchShade) : 1.0);
}

// `facet`: normal of the geometry, used where the point is displaced. The others as contourInk().
vec3 surfaceColour(SurfacePoint p, vec3 facet, float contour, float contour_width, mat2 steps) {
  const ivec2 nearest = p.cell + ivec2(round(p.f));
  vec2 g;
  if (kSmooth) {
    g = smoothSlopes(p.cell, p.f, p.h);
  } else if (kFootprint) {
    g = footprintPlane(p.cell, p.h).slope;
  } else if (kCell) {
    g = 0.5 * vec2(p.h.y - p.h.x + p.h.w - p.h.z, p.h.z - p.h.x + p.h.w - p.h.y);
  } else {
    const float at = p.f.y < 0.5 ? (p.f.x < 0.5 ? p.h.x : p.h.y) : (p.f.x < 0.5 ? p.h.z : p.h.w);
    const int step = shade_difference;
    g = vec2(slope(nearest, ivec2(step, 0), at), slope(nearest, ivec2(0, step), at)) / float(step);
  }
  vec3 normal = normalize(vec3(-g * panel.relief.z / (panel.placing.zw * float(1 << shade_log2)), 1.0));
  if (p.displaced && facet.z != 0.0) normal = normalize(facet * sign(facet.z));

  vec3 c = p.compared ? mapped(p.value) : greyByHeight(p);
  if (kMaterial && p.compared) c = mix(panel.material.body.rgb, c, panel.to_right.w);
  if (kMarks) {
    const uint mark = texelFetch(marks_image, shadeTexelOf(nearest), 0).x;
    const vec4 tint = mark == uint(kSuggested) ? panel.suggested_tint : panel.marks_tint;
    if (mark != 0u) c = mix(c, tint.rgb, markShare(nearest, mark, tint.a));
  }
  // A level surface has exactly its colour on the bar; slopes are lighter towards the light, darker away from it.
  if (kMaterial)
    c = asMaterial(c, normal);
  else
    c *= panel.light.w + (1.0 - panel.light.w) * max(dot(normal, panel.light.xyz), 0.0) / panel.light.z;
  if (kOcclusion || kCavity) {
    const Surroundings s = surroundings(p.cell, p.f, p.displaced ? p.drawn : clippedBetween(p.h, p.f));
    // Of the sky above: a steep wall sees half of it at best, and what stands around its foot says nothing of how it is
    // lit. There, which samples are before it and which behind changes from one to the next.
    if (kOcclusion) c *= 1.0 - panel.form.x * normal.z * s.hidden;
    if (kCavity) c *= 1.0 - panel.form.y * normal.z * s.hollow;
  }
  if (kContours && p.compared) c = mix(c, vec3(0.01), 0.7 * contourInk(p, contour, contour_width, steps));
  return min(c, vec3(1.0));
}
