#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "layout.h"

layout(set = 0, binding = kBindGlyphs) uniform texture2D glyphs_image;
layout(set = 0, binding = kBindQuads, std430) readonly buffer Quads { Quad quads[]; };
layout(set = 0, binding = kBindMap, std140) uniform PanelBlock { PanelUniforms panel; };

layout(location = 0) flat in int index;
layout(location = 1) in vec2 uv;
layout(location = 0) out vec4 colour;  // premultiplied

vec3 mapped(float t) {
  t = clamp(t, 0.0, 1.0) * float(kColours - 1);
  const int i = min(int(t), kColours - 2);
  return mix(panel.colours[i].rgb, panel.colours[i + 1].rgb, t - float(i));
}

void main() {
  const Quad q = quads[index];
  vec3 rgb = q.colour.rgb;
  float opacity = q.colour.a;
  if (q.fill.x == kFillGlyph) opacity *= texelFetch(glyphs_image, ivec2(uv), 0).x;
  if (q.fill.x == kFillColours) rgb = mapped(uv.y);
  if (q.fill.x == kFillUp || q.fill.x == kFillDown) {
    rgb = mapped(q.fill.x == kFillUp ? 1.0 : 0.0);
    // uv goes from -1 to 1 across and from 0 (tip) to 1 (base); the edge is softened over one pixel.
    const float inside = uv.y - abs(uv.x);
    opacity *= clamp(inside / fwidth(uv.y) + 0.5, 0.0, 1.0);
  }
  colour = vec4(rgb, 1.0) * opacity;
}
