#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// The sides of the block below the surface. The top vertices of the walls are the rim vertices of the surface, so the
// two meet without a gap at any stride. place.xy: first sample, place.zw: as for a patch, and the side in the low two
// bits of the sign-free fourth component: see Side below.
#include "field.glsl"

layout(set = 0, binding = kBindPatches, std430) readonly buffer Patches { Patch patches[]; };

layout(location = 0) flat out ivec2 base;
layout(location = 1) out vec2 local;
layout(location = 2) flat out vec3 normal;

void main() {
  const Patch p = patches[gl_InstanceIndex];
  const int side = p.place.w >> 8;  // 0 low y, 1 high x, 2 high y, 3 low x
  const ivec2 stride = ivec2(1) << ivec2(p.place.z, p.place.w & 255);
  const ivec2 along = (side & 1) == 0 ? ivec2(1, 0) : ivec2(0, 1);
  const ivec2 s = min(p.place.xy + along * stride * (gl_VertexIndex >> 1), panel.size.xy - 1);
  base = p.place.xy;
  local = vec2(s - p.place.xy);
  normal = side == 0 ? vec3(0, -1, 0) : side == 1 ? vec3(1, 0, 0) : side == 2 ? vec3(0, 1, 0) : vec3(-1, 0, 0);
  const float z = (gl_VertexIndex & 1) == 0 ? drawnZ(s, stride) : panel.relief.w;
  gl_Position = viewUniforms().clip_from_scene * vec4(scenePoint(s, z), 1.0);
}
