#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// The shadow of the stylus on what is visible: how much of a soft light the pen and its ball hide from each point. The
// position of the point follows from its depth, as in shade.frag.
#include "field.glsl"

#ifdef FETTLE_EYES
layout(set = 0, binding = kBindDepth) uniform texture2DArray depth_image;
#define FETTLE_DEPTH_AT(pixel) ivec3(pixel, gl_ViewIndex)
#else
layout(set = 0, binding = kBindDepth) uniform texture2D depth_image;
#define FETTLE_DEPTH_AT(pixel) (pixel)
#endif
layout(set = 0, binding = kBindStylus, std430) readonly buffer StylusBlock { Stylus stylus; };
layout(location = 0) noperspective in vec4 at_no_depth;
layout(location = 1) flat in vec3 across;
layout(location = 0) out vec4 colour;  // premultiplied

const float kLightWidth = 0.12;  // of the light, as seen from the surface: how fast the shadow's edge grows soft
const float kDarkest = 0.7;
const float kUnderTip = 0.9, kSpread = 0.2;  // of the spot under the tip: its radius, of the pen's; and how it grows
const float kCone = 0.28;  // share of the pen that is its cone (stylus.vert)

// Half of the shadow's edge where the occluder is so far along the light.
float softness(float far) {
  return 0.5 * kLightWidth * far + 0.75 * stylus.shadow.z;
}
// Of the light, how much a disc of radius r hides whose middle is `off` from the ray and `far` along it.
float hidden(float off, float r, float far) {
  const float soft = softness(far);
  // An occluder smaller than the light hides its share of it.
  return smoothstep(r + soft, r - soft, off) * min(1.0, r / soft);
}

void main() {
  const float depth = texelFetch(depth_image, FETTLE_DEPTH_AT(ivec2(gl_FragCoord.xy)), 0).x;
  if (depth >= 1.0) discard;
  vec4 at = at_no_depth + viewUniforms().field_from_pixel[2] * depth;
  at.xyz /= at.w;
  const vec3 scene = vec3(panel.placing.xy + (vec2(viewUniforms().origin.xy) + at.xy) * panel.placing.zw, at.z);
  const vec3 light = panel.light.xyz;
  const vec3 from = stylus.point.xyz - scene;
  // Under the tip the sky is hidden, too: the spot tells where the tip would come down.
  const float above = stylus.ball.z - scene.z;
  const float wide = max(stylus.shadow.w, kUnderTip * stylus.tail.w) + kSpread * max(above, 0.0);
  const float off = length(scene.xy - stylus.ball.xy);
  // Most of the part that is drawn has neither of both. The ray to the light stays as far from the pen's axis as this
  // point is from the plane of both.
  const float reach = max(stylus.tail.w, stylus.shadow.w) + softness(stylus.shadow.y);
  if (abs(dot(from, across)) > reach && off > wide) discard;

  // Where the ray to the light is nearest to the pen's axis: along the ray, and as a share of the pen.
  const vec3 run = stylus.tail.xyz - stylus.point.xyz;
  const float ab = dot(run, light), aa = dot(run, run);
  const float determinant = aa - ab * ab;
  const float t = determinant > 1e-6 * aa ? clamp((ab * dot(from, light) - dot(from, run)) / determinant, 0.0, 1.0) : 0.0;
  const vec3 nearest = from + t * run;
  const float far = dot(nearest, light);
  const float radius = stylus.tail.w * clamp(t / kCone, 0.08, 1.0);
  float dark = far > -radius ? hidden(length(nearest - far * light), radius, max(far, 0.0)) : 0.0;
  float distance_mm = max(far, 0.0);
  if (stylus.shadow.w > 0.0) {
    const vec3 ball = stylus.ball.xyz - scene;
    const float ball_far = dot(ball, light);
    const float of_ball = ball_far > 0.0 ? hidden(length(ball - ball_far * light), stylus.shadow.w, ball_far) : 0.0;
    if (of_ball > dark) {
      dark = of_ball;
      distance_mm = ball_far;
    }
  }
  const float spot = above > -wide ? (1.0 - smoothstep(0.15 * wide, wide, off)) / (1.0 + 12.0 * max(above, 0.0) / stylus.shadow.y) : 0.0;
  // It fades with the distance that it falls, and ends before the part that is drawn does.
  const float share = distance_mm / stylus.shadow.y;
  dark *= kDarkest / (1.0 + 3.0 * share) * (1.0 - smoothstep(0.7, 1.0, share));
  const float under = kDarkest * spot * (1.0 - smoothstep(0.7, 1.0, above / stylus.shadow.y));
  colour = vec4(0.0, 0.0, 0.0, stylus.shadow.x * max(dark, under));
}
