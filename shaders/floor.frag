#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "field.glsl"

layout(location = 0) out vec4 colour;

void main() { colour = vec4(panel.no_data.rgb, 1.0); }
