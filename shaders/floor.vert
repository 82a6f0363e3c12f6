#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// The plate under the surface, visible through holes.
#include "field.glsl"

void main() {
  const ivec2 s = ivec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * (panel.size.xy - 1);
  gl_Position = viewUniforms().clip_from_scene * vec4(scenePoint(s, panel.relief.w), 1.0);
}
