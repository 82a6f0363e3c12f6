#version 460
#extension GL_GOOGLE_include_directive : require
// Rectangles of the finished picture: panels, colour bar, scale bar, letters.
#include "layout.h"

layout(set = 0, binding = kBindQuads, std430) readonly buffer Quads { Quad quads[]; };
layout(push_constant) uniform Push { vec4 picture_px; } push;

layout(location = 0) flat out int index;
layout(location = 1) out vec2 uv;

void main() {
  const Quad q = quads[gl_InstanceIndex];
  const vec2 t = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);
  index = gl_InstanceIndex;
  uv = mix(q.uv.xy, q.uv.zw, t);
  gl_Position = vec4(mix(q.pixels.xy, q.pixels.zw, t) / push.picture_px.xy * 2.0 - 1.0, 0.0, 1.0);
}
