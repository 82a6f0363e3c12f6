#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef FETTLE_EYES
#extension GL_EXT_multiview : require
#endif
// Lines of a width in pixels: a rectangle around each, coloured by the distance to the line.
#include "layout.h"

layout(set = 0, binding = kBindPanel, std140) uniform PanelBlock { PanelUniforms panel; };
layout(set = 0, binding = kBindLines, std430) readonly buffer Lines { Line lines[]; };
layout(push_constant) uniform Push { vec4 plot_px; } push;

layout(location = 0) flat out int index;
layout(location = 1) noperspective out vec2 place;  // along the line from its start, across it [px]
layout(location = 2) flat out float run;            // length of the line [px]

void main() {
  const Line l = lines[gl_InstanceIndex];
#ifdef FETTLE_EYES
  const mat4 clip_from_scene = panel.views[gl_ViewIndex].clip_from_scene;
#else
  const mat4 clip_from_scene = panel.views[0].clip_from_scene;
#endif
  vec4 a = clip_from_scene * vec4(l.from.xyz, 1.0), b = clip_from_scene * vec4(l.to.xyz, 1.0);
  index = gl_InstanceIndex;
  // The part in front of the near plane is clipped, otherwise its projection would be mirrored.
  if (a.z < 0.0 && b.z < 0.0) {
    place = vec2(0.0);
    run = 0.0;
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (a.z < 0.0) a = mix(b, a, b.z / (b.z - a.z));
  if (b.z < 0.0) b = mix(a, b, a.z / (a.z - b.z));
  const vec2 half_px = 0.5 * push.plot_px.xy;
  const vec2 pa = a.xy / a.w * half_px, pb = b.xy / b.w * half_px;
  run = distance(pa, pb);
  const vec2 along = run > 1e-6 ? (pb - pa) / run : vec2(1.0, 0.0);
  const vec2 across = vec2(-along.y, along.x);
  const float reach = 0.5 * l.from.w + 1.0;
  const bool at_end = (gl_VertexIndex & 1) != 0;
  place = vec2(at_end ? run + reach : -reach, (gl_VertexIndex & 2) != 0 ? reach : -reach);
  const vec2 p = pa + along * place.x + across * place.y;
  gl_Position = vec4(p / half_px, at_end ? b.z / b.w : a.z / a.w, 1.0);
}
