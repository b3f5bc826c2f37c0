#version 430 core
// Which face of the region the depth test kept; 0 is "none".
flat in uint first_face;
layout(location = 0) out uint face;

void main() {
  face = first_face + uint(gl_PrimitiveID) + 1u;
}
