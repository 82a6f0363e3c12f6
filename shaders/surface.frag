#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// Colour of the surface, from the exact samples (or every 2^shade.x-th) whatever the geometry's stride.
#include "field.glsl"

layout(constant_id = kSpecMarks) const bool kMarks = false;
layout(constant_id = kSpecDeviation) const bool kDeviation = false;
layout(constant_id = kSpecContours) const bool kContours = false;
layout(constant_id = kSpecSmooth) const bool kSmooth = false;
layout(constant_id = kSpecCell) const bool kCell = false;

layout(set = 0, binding = kBindMarks) uniform utexture2DArray marks_image;
layout(set = 0, binding = kBindOriginal) uniform utexture2DArray original_image;

layout(location = 0) flat in ivec2 base;
layout(location = 1) in vec2 local;
layout(location = 2) in float drawn_z;
layout(location = 0) out vec4 colour;

// Half the difference between the neighbours of `s` along `d`, or what one neighbour and the sample itself can
// say; height units a step. `h` is the height at s.
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
// slope to the sample outside, when there is one. `sign` is +1 when the outer sample lies after the corner.
float cornerSlope(ivec2 outer, float at, float inward, float sign) {
  const uint raw = shadeHeight(outer);
  const bool inside = all(greaterThanEqual(outer, ivec2(0))) && all(lessThan(outer, shade_size));
  return (kHoles && isHole(raw)) || !inside ? inward : 0.5 * (inward + sign * (heightOf(raw) - at));
}

// Slopes interpolated between the cell's corners from the samples around it: shading without facets.
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

void main() {
  vec2 f;
  const ivec2 cell = shadeCell(base, local, f);
  const uvec4 raw = uvec4(shadeHeight(cell), shadeHeight(cell + ivec2(1, 0)), shadeHeight(cell + ivec2(0, 1)),
                          shadeHeight(cell + ivec2(1, 1)));
  const bool hole = kHoles && (isHole(raw.x) || isHole(raw.y) || isHole(raw.z) || isHole(raw.w));
  const vec4 h = panel.relief.x * uintBitsToFloat(raw);
  const float height = mix(mix(h.x, h.y, f.x), mix(h.z, h.w, f.x), f.y);
  float value = height;
  bool compared = true;
  if (kDeviation) {
    uvec4 before;
    before.x = texelFetch(original_image, originalTexelOf(cell), 0).x;
    before.y = texelFetch(original_image, originalTexelOf(cell + ivec2(1, 0)), 0).x;
    before.z = texelFetch(original_image, originalTexelOf(cell + ivec2(0, 1)), 0).x;
    before.w = texelFetch(original_image, originalTexelOf(cell + ivec2(1, 1)), 0).x;
    compared = !(isHole(before.x) || isHole(before.y) || isHole(before.z) || isHole(before.w));
    // Corner by corner, so that equal samples give exactly zero.
    const vec4 d = h - panel.limits.z * uintBitsToFloat(before);
    value = mix(mix(d.x, d.y, f.x), mix(d.z, d.w, f.x), f.y);
  }
  // Where a coarse cell stands in for a wall, the drawn point is not over the sample's place but beside it: it shows the
  // wall at its own height, so it takes colour and light from there. Else walls would be striped.
  const bool beside = abs(drawn_z - sceneZ(height)) > panel.seam.y;
  if (!kDeviation && beside) value = panel.relief.y + drawn_z / panel.relief.z;
  const vec3 along_x = vec3(dFdx(local) * panel.placing.zw, dFdx(drawn_z));
  const vec3 along_y = vec3(dFdy(local) * panel.placing.zw, dFdy(drawn_z));
  // Before the discard: differences between fragments are defined only while all of a quad take part.
  const float contour = kContours ? value / panel.colouring.z : 0.0;
  const float contour_width = kContours ? fwidth(contour) : 1.0;
  if (kHoles && hole) discard;

  const ivec2 nearest = cell + ivec2(round(f));
  vec2 g;
  if (kSmooth) {
    g = smoothSlopes(cell, f, h);
  } else if (kCell) {
    g = 0.5 * vec2(h.y - h.x + h.w - h.z, h.z - h.x + h.w - h.y);
  } else {
    const float at = f.y < 0.5 ? (f.x < 0.5 ? h.x : h.y) : (f.x < 0.5 ? h.z : h.w);
    const int step = shade_difference;
    g = vec2(slope(nearest, ivec2(step, 0), at), slope(nearest, ivec2(0, step), at)) / float(step);
  }
  vec3 normal = normalize(vec3(-g * panel.relief.z / (panel.placing.zw * float(1 << shade_log2)), 1.0));

  if (beside) {
    const vec3 facet = cross(along_x, along_y);
    if (facet.z != 0.0) normal = normalize(facet * sign(facet.z));
  }

  vec3 c = compared ? mapped(value) : panel.no_data.rgb;
  if (kMarks && texelFetch(marks_image, shadeTexelOf(nearest), 0).x != 0u)
    c = mix(c, panel.marks_tint.rgb, panel.marks_tint.a);
  // A level surface shows exactly its colour on the bar; slopes are lighter towards the light, darker away from it.
  c *= panel.light.w + (1.0 - panel.light.w) * max(dot(normal, panel.light.xyz), 0.0) / panel.light.z;
  if (kContours && compared) {
    const float off = abs(fract(contour - 0.5) - 0.5) / max(contour_width, 1e-12);
    // Lines closer than four rays would fill the surface: they fade out.
    const float ink = (1.0 - smoothstep(0.6, 1.4, off)) * (1.0 - smoothstep(0.15, 0.3, contour_width));
    c = mix(c, vec3(0.01), 0.7 * ink);
  }
  colour = vec4(min(c, vec3(1.0)), 1.0);
}
