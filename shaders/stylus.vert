#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef FETTLE_EYES
#extension GL_EXT_multiview : require
#endif
// The stylus' pen and ball: rings around an axis, joined by bands of triangles. Both are convex, and the farther one is
// drawn first, so that no depth is written.
#include "layout.h"

layout(set = 0, binding = kBindPanel, std140) uniform PanelBlock { PanelUniforms panel; };
layout(set = 0, binding = kBindStylus, std430) readonly buffer StylusBlock { Stylus stylus; };

layout(location = 0) out vec3 normal;
layout(location = 1) out vec3 to_viewer;
layout(location = 2) flat out vec3 base;    // colour of the band
layout(location = 3) flat out vec3 light;

// The rings of the pen: where along it, and how wide, both as shares. A rounded point, a cone, a barrel, a rounded end.
const vec2 kRings[kStylusBands + 1] =
    vec2[](vec2(0.0, 0.0), vec2(0.004, 0.10), vec2(0.015, 0.17), vec2(0.06, 0.32), vec2(0.12, 0.52), vec2(0.18, 0.71),
           vec2(0.25, 0.92), vec2(0.28, 1.0), vec2(0.32, 1.0), vec2(0.36, 1.0), vec2(0.60, 1.0), vec2(0.88, 1.0),
           vec2(0.94, 1.0), vec2(0.97, 0.92), vec2(0.985, 0.78), vec2(0.996, 0.50), vec2(1.0, 0.0));
const int kColouredBands = 7;  // of the pen: its point, in the colour of the ball
const int kGripBands = 9;      // up to here a dark ring
const vec3 kBarrel = vec3(0.62), kGrip = vec3(0.06);
const float kTurn = 6.2831853;

void main() {
  const int band = gl_VertexIndex / 6 / kStylusSides, side = gl_VertexIndex / 6 % kStylusSides;
  // Two triangles: corners 0 1 2, 2 1 3.
  const int corner = int[](0, 1, 2, 2, 1, 3)[gl_VertexIndex % 6];
  const int ring = band + (corner & 1);
  const float turn = kTurn * float((side + (corner >> 1)) % kStylusSides) / float(kStylusSides);
  const bool is_ball = (gl_InstanceIndex == 1) == (stylus.colour.w > 0.5) && stylus.shadow.w > 0.0;

  vec3 at;
  if (is_ball) {
    const float down = 0.5 * kTurn * float(ring) / float(kStylusBands);
    const vec3 unit = vec3(sin(down) * cos(turn), sin(down) * sin(turn), cos(down));
    const vec3 radii = vec3(stylus.shadow.ww, stylus.ball.w);
    at = stylus.ball.xyz + radii * unit;
    normal = normalize(unit / radii);
    base = stylus.colour.rgb;
  } else {
    const vec3 run = stylus.tail.xyz - stylus.point.xyz;
    const float length_mm = length(run);
    const vec3 along = run / length_mm;
    const vec3 other = abs(along.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    const vec3 across = normalize(cross(along, other)), third = cross(along, across);
    const vec3 out_ = cos(turn) * across + sin(turn) * third;
    at = stylus.point.xyz + kRings[ring].x * run + kRings[ring].y * stylus.tail.w * out_;
    // Across the slope of the band: its edges stay sharp.
    const vec2 slope = (kRings[band + 1] - kRings[band]) * vec2(length_mm, stylus.tail.w);
    normal = normalize(slope.x * out_ - slope.y * along);
    base = band < kColouredBands ? stylus.colour.rgb : band < kGripBands ? kGrip : kBarrel;
  }
#ifdef FETTLE_EYES
  const mat4 clip_from_scene = panel.views[gl_ViewIndex].clip_from_scene;
#else
  const mat4 clip_from_scene = panel.views[0].clip_from_scene;
#endif
  // The viewer, at infinity in a parallel view: no point of the picture is nearer.
  const vec4 viewer = inverse(clip_from_scene) * vec4(0.0, 0.0, -1.0, 0.0);
  to_viewer = normalize(viewer.xyz - at * viewer.w);
  light = panel.light.xyz;
  gl_Position = clip_from_scene * vec4(at, 1.0);
}
