#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.h"

layout(constant_id = kSpecFaint) const bool kFaint = false;

layout(location = 0) in vec3 normal;
layout(location = 1) in vec3 to_viewer;
layout(location = 2) flat in vec3 base;
layout(location = 3) flat in vec3 light;
layout(location = 0) out vec4 colour;  // premultiplied

void main() {
  const vec3 n = normalize(normal), v = normalize(to_viewer);
  const float facing = dot(n, v);
  // The far side, and a soft edge where the near one ends.
  const float covered = clamp(facing / max(fwidth(facing), 1e-4), 0.0, 1.0);
  if (covered <= 0.0) discard;
  const float lit = 0.30 + 0.70 * max(dot(n, light), 0.0);
  const float shine = pow(max(dot(n, normalize(light + v)), 0.0), 40.0);
  // A dark rim sets it off from a surface of its own colour.
  const float rim = mix(0.25, 1.0, smoothstep(0.0, 0.5, facing));
  const float opacity = covered * (kFaint ? 0.22 : 1.0);
  colour = vec4(min(base * lit * rim + 0.35 * shine, vec3(1.0)), 1.0) * opacity;
}
