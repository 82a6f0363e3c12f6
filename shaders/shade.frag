#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// Shades the surface once per pixel from the depth that is visible there: geometry costs only its depth, regardless of
// the number of triangles per pixel.
#include "shading.glsl"

layout(constant_id = kSpecPerspective) const bool kPerspective = false;

#ifdef FETTLE_EYES
layout(set = 0, binding = kBindDepth) uniform texture2DArray depth_image;
#define FETTLE_DEPTH_AT(pixel) ivec3(pixel, gl_ViewIndex)
#else
layout(set = 0, binding = kBindDepth) uniform texture2D depth_image;
#define FETTLE_DEPTH_AT(pixel) (pixel)
#endif
layout(location = 0) noperspective in vec4 at_no_depth;
layout(location = 0) out vec4 colour;

void main() {
  const float depth = texelFetch(depth_image, FETTLE_DEPTH_AT(ivec2(gl_FragCoord.xy)), 0).x;
  vec4 at = at_no_depth + viewUniforms().field_from_pixel[2] * depth;
  if (kPerspective) at.xyz /= at.w;
  const SurfacePoint p = surfacePoint(viewUniforms().origin.xy, at.xy, at.z);
  // Differences between neighbouring pixels: at the silhouette of something in front they are wrong, but only for that
  // pixel.
  const vec3 scene = vec3(at.xy * panel.placing.zw, at.z);
  const vec3 facet = cross(dFdx(scene), dFdy(scene));
  const float contour = kContours ? contourOf(p) : 0.0;
  const float contour_width = kContours ? fwidth(contour) : 1.0;
  const mat2 steps = kContours ? mat2(dFdx(at.xy), dFdy(at.xy)) : mat2(0.0);
  vec3 c = surfaceColour(p, facet, contour, contour_width, steps);
  // The geometry excludes holes except for rounding.
  if (kHoles && p.hole) c = panel.no_data.rgb;
  colour = vec4(c, 1.0);
}
