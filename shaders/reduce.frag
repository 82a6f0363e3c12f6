#version 460
// The mean of four rays, in linear light: the image decodes sRGB when it is read.
layout(set = 0, binding = 0) uniform sampler2D fine_image;
layout(location = 0) in vec4 place;
layout(location = 0) out vec4 colour;

void main() {
  const ivec2 first = 2 * ivec2(gl_FragCoord.xy);
  colour = 0.25 * (texelFetch(fine_image, first, 0) + texelFetch(fine_image, first + ivec2(1, 0), 0) +
                   texelFetch(fine_image, first + ivec2(0, 1), 0) + texelFetch(fine_image, first + ivec2(1, 1), 0));
}
