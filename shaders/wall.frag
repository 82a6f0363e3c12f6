#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "field.glsl"

layout(location = 0) flat in ivec2 base;
layout(location = 1) in vec2 local;
layout(location = 2) flat in vec3 normal;
layout(location = 0) out vec4 colour;

void main() {
  // There is a wall under a rim cell only where there is surface: no corner of that cell is a hole.
  vec2 f;
  if (kHoles && cellIsHole(shadeCell(base, local, f))) discard;
  colour = vec4(panel.wall.rgb * (0.55 + 0.45 * max(dot(normal, panel.light.xyz), 0.0)), 1.0);
}
