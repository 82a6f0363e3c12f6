#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
// Combines the pictures of the two eyes.
#include "layout.h"

layout(constant_id = kSpecAnaglyph) const bool kAnaglyph = false;

layout(set = 0, binding = kBindLeftEye) uniform texture2D left_image;
layout(set = 0, binding = kBindRightEye) uniform texture2D right_image;
layout(location = 0) out vec4 colour;

// For red - cyan glasses: the colours that, through the two filters, are nearest to the eye's own picture, by least
// squares over the spectra of display and filters (Dubois 2001, "A projection method to generate anaglyph stereo
// images", ICASSP; matrices of the author's page for red - cyan). Linear light; the columns are the contributions of
// red, green and blue of the eye's picture.
const mat3 kFromLeft = mat3(0.4561, -0.0400822, -0.0152161, 0.500484, -0.0378246, -0.0205971, 0.176381, -0.0157589,
                            -0.00546856);
const mat3 kFromRight = mat3(-0.0434706, 0.378476, -0.0721527, -0.0879388, 0.73364, -0.112961, -0.00155529, -0.0184503,
                             1.2264);

void main() {
  const ivec2 at = ivec2(gl_FragCoord.xy);
  if (kAnaglyph) {
    const vec3 left = texelFetch(left_image, at, 0).rgb, right = texelFetch(right_image, at, 0).rgb;
    colour = vec4(clamp(kFromLeft * left + kFromRight * right, 0.0, 1.0), 1.0);
    return;
  }
  const int width = textureSize(left_image, 0).x;
  // A picture of odd width shows the right eye's last column twice.
  colour = at.x < width ? texelFetch(left_image, at, 0)
                        : texelFetch(right_image, ivec2(min(at.x - width, width - 1), at.y), 0);
}
