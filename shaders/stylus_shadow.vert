#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// The part of the plot in which the shadow of the stylus may be: around the pen and what lies behind it in the light.
#include "field.glsl"

layout(set = 0, binding = kBindStylus, std430) readonly buffer StylusBlock { Stylus stylus; };
layout(push_constant) uniform Push { vec4 plot_px; } push;

layout(location = 0) noperspective out vec4 at_no_depth;  // as in shade.vert
layout(location = 1) flat out vec3 across;  // the plane of the pen's axis and the light: a unit vector

void main() {
  // Down to the plate at most, from both ends as far as from the higher one where that is farther than a shadow falls.
  const float most = stylus.shadow.y, down = clamp(stylus.ball.z - stylus.point.w, 0.0, most);
  // Chosen, not branched: drivers of processors compile a shader again for each value that such a condition reads.
  const float rise = panel.light.z;
  vec2 reach = max(vec2(stylus.ball.z, stylus.tail.z) - stylus.point.w, vec2(0.0)) / max(rise, 1e-3);
  reach = mix(reach, vec2(most), bvec2(rise <= 1e-3 || max(reach.x, reach.y) >= most));
  const float wide =
      max(stylus.tail.w, stylus.shadow.w) + 0.2 * max(down, max(reach.x, reach.y)) + 2.0 * stylus.shadow.z;
  const vec3 ends[5] = vec3[](stylus.ball.xyz, stylus.tail.xyz, stylus.ball.xyz - reach.x * panel.light.xyz,
                              stylus.tail.xyz - reach.y * panel.light.xyz, stylus.ball.xyz - vec3(0.0, 0.0, down));
  vec2 low = vec2(1.0), high = vec2(-1.0);
  for (int i = 0; i < 5; ++i) {
    const float margin = i < 2 ? 2.0 * max(stylus.tail.w, stylus.shadow.w) : wide;
    for (int k = 0; k < 8; ++k) {
      const vec3 corner = ends[i] + margin * (2.0 * vec3(k & 1, k >> 1 & 1, k >> 2) - 1.0);
      const vec4 clip = viewUniforms().clip_from_scene * vec4(corner, 1.0);
      // Beside or behind the viewer: anywhere.
      const bool before = clip.w > 0.0;
      low = min(low, before ? clip.xy / clip.w : vec2(-1.0));
      high = max(high, before ? clip.xy / clip.w : vec2(1.0));
    }
  }
  low = clamp(low, -1.0, 1.0);
  high = clamp(high, -1.0, 1.0);
  const vec2 t = 0.5 * mix(low, high, vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1)) + 0.5;
  gl_Position = vec4(2.0 * t - 1.0, 0.0, 1.0);
  const vec3 normal = cross(stylus.tail.xyz - stylus.point.xyz, panel.light.xyz);
  const float length_of_normal = length(normal);
  // A pen that points at the light has no such plane: no point is far from it.
  across = length_of_normal > 1e-3 * stylus.shadow.y ? normal / length_of_normal : vec3(0.0);
  at_no_depth = viewUniforms().field_from_pixel * vec4(push.plot_px.zw + t * push.plot_px.xy, 0.0, 1.0);
}
