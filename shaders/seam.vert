#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// Closes the gap between a patch's edge and the coarser edge of the patch beyond it: two strips from one to the other
// that overlap both by a fraction of a pixel, one to the left and right, one up and down, because a vertex in the
// middle of the coarser edge is rounded to one of its sides. (A single strip that overlaps across the edge turns over
// where the edge does, on walls and spikes, and leaves a hole there.) place: first sample of the edge; level | the
// other's level << 8; side as in wall.vert.
#include "field.glsl"

layout(set = 0, binding = kBindPatches, std430) readonly buffer Patches { Patch patches[]; };
layout(push_constant) uniform Push { vec4 plot_px; } push;

layout(location = 0) flat out ivec2 base;
layout(location = 1) out vec2 place;  // as in surface.vert

vec4 clipOf(ivec2 s, float z) { return viewUniforms().clip_from_scene * vec4(scenePoint(s, z), 1.0); }

void main() {
  const Patch p = patches[gl_InstanceIndex >> 1];
  const int side = p.place.w;
  const ivec2 stride = ivec2(1 << (p.place.z & 255)), wide = ivec2(1 << (p.place.z >> 8));
  const ivec2 along = (side & 1) == 0 ? ivec2(1, 0) : ivec2(0, 1);
  const ivec2 last = panel.size.xy - 1;
  const ivec2 s = min(p.place.xy + along * stride * (gl_VertexIndex >> 1), last);
  base = p.place.xy;
  place = vec2(s - p.place.xy);
  // The vertices of the coarser edge before and after this position.
  const ivec2 a = (ivec2(1) - along) * s + along * (s & ~(wide - 1));
  const ivec2 b = min(a + along * wide, last);
  const int run = (b.x - a.x) + (b.y - a.y);
  const float t = run == 0 ? 0.0 : float((s.x - a.x) + (s.y - a.y)) / float(run);
  const float fine = drawnZ(s, stride), coarse = mix(drawnZ(a, wide), drawnZ(b, wide), t);
  const vec4 at_fine = clipOf(s, fine), at_coarse = clipOf(s, coarse);
  gl_Position = at_fine;
  // Points behind the viewer have no position in the picture.
  if (min(at_fine.w, at_coarse.w) <= 0.0) return;
  const vec2 half_px = 0.5 * push.plot_px.xy;
  const vec2 across = (gl_InstanceIndex & 1) == 0 ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
  const bool upper = (gl_VertexIndex & 1) != 0;
  const bool fine_is_upper = dot((at_fine.xy / at_fine.w - at_coarse.xy / at_coarse.w) * half_px, across) > 0.0;
  const bool takes_fine = upper == fine_is_upper;
  gl_Position = takes_fine ? at_fine : at_coarse;
  gl_Position.xy += (upper ? 1.0 : -1.0) * panel.seam.x * across / half_px * gl_Position.w;
}
