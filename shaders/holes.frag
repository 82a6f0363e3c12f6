#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// Only the depth of the surface, without the holes.
#include "field.glsl"

layout(location = 0) flat in ivec2 base;
layout(location = 1) in vec2 place;

void main() {
  vec2 f;
  if (cellIsHole(shadeCell(base, place, f))) discard;
}
