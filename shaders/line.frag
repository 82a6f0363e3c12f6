#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.h"

layout(set = 0, binding = kBindLines, std430) readonly buffer Lines { Line lines[]; };

layout(location = 0) flat in int index;
layout(location = 1) noperspective in vec2 place;
layout(location = 2) flat in float run;
layout(location = 0) out vec4 colour;  // premultiplied

void main() {
  const Line l = lines[index];
  const float off = length(vec2(place.x - clamp(place.x, 0.0, run), place.y));
  // The edge is softened over one pixel.
  const float opacity = l.colour.a * clamp(0.5 * l.from.w - off + 0.5, 0.0, 1.0);
  colour = vec4(l.colour.rgb, 1.0) * opacity;
}
