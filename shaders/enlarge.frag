#version 460
// A picture of half the size, enlarged. Only a look-up at two components of an input of four: llvmpipe has a fast path
// for exactly that, a third of the time (Mesa, lp_state_fs_analysis.c).
layout(set = 0, binding = 0) uniform sampler2D half_image;
layout(location = 0) in vec4 place;
layout(location = 0) out vec4 colour;

void main() { colour = texture(half_image, place.xy); }
