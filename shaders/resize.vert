#version 460
// A rectangle that covers the picture.
layout(location = 0) out vec4 place;  // x, y: 0 .. 1

void main() {
  place = vec4(gl_VertexIndex & 1, gl_VertexIndex >> 1, 0.0, 1.0);
  gl_Position = vec4(place.xy * 2.0 - 1.0, 0.0, 1.0);
}
