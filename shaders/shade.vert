#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// All of the plot at the largest depth: the depth test passes where this is farther than the surface, so that no
// fragment is spent on the background.
#include "field.glsl"

layout(push_constant) uniform Push { vec4 plot_px; } push;

// The part of the field position that follows from the position in the picture; the rest comes from the depth.
layout(location = 0) noperspective out vec4 at_no_depth;

void main() {
  const vec2 t = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);
  gl_Position = vec4(t * 2.0 - 1.0, 1.0, 1.0);
  const vec2 pixel = push.plot_px.zw + t * push.plot_px.xy;
  at_no_depth = viewUniforms().field_from_pixel * vec4(pixel, 0.0, 1.0);
}
