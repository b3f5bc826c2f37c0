#version 430 core
// One surface of a contact region, seen along the contact normal.
layout(location = 0) in vec3 position;  // contact axes (u, v, w) about the region's origin [m]
uniform vec3 scale;                     // clip = scale * position + shift: an orthographic camera
uniform vec3 shift;

void main() {
  gl_Position = vec4(scale * position + shift, 1.0);
}
