#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// The surface without a vertex buffer: an instance is a patch, gl_VertexIndex counts along its strips.
#include "field.glsl"

layout(set = 0, binding = kBindPatches, std430) readonly buffer Patches { Patch patches[]; };

layout(location = 0) flat out ivec2 base;  // first sample of the patch
layout(location = 1) out vec2 place;  // samples from it, kept small so that no fraction is lost far out

void main() {
  const Patch p = patches[gl_InstanceIndex];
  const int strip = gl_VertexIndex / kStripVertices;
  // Doubling the first and the last vertex joins the strips by triangles without area.
  const int k = clamp(gl_VertexIndex % kStripVertices - 1, 0, 2 * kPatchCells + 1);
  const ivec2 stride = ivec2(1) << p.place.zw;
  const ivec2 s = min(p.place.xy + ivec2(k >> 1, strip + (k & 1)) * stride, panel.size.xy - 1);
  base = p.place.xy;
  place = vec2(s - p.place.xy);
  gl_Position = viewUniforms().clip_from_scene * vec4(scenePoint(s, drawnZ(s, stride)), 1.0);
}
