#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// The surface, shaded triangle by triangle: for pictures drawn once, at several rays a pixel.
#include "shading.glsl"

layout(location = 0) flat in ivec2 base;
layout(location = 1) in vec3 place;
layout(location = 0) out vec4 colour;

void main() {
  const SurfacePoint p = surfacePoint(base, place.xy, place.z);
  // Before the discard: differences between fragments are defined only while all of a quad take part.
  const vec3 scene = vec3(place.xy * panel.placing.zw, place.z);
  const vec3 facet = cross(dFdx(scene), dFdy(scene));
  const float contour = kContours ? contourOf(p) : 0.0;
  const float contour_width = kContours ? fwidth(contour) : 1.0;
  if (kHoles && p.hole) discard;
  colour = vec4(surfaceColour(p, facet, contour, contour_width), 1.0);
}
