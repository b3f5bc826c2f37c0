#version 430 core
// A lit surface: positions relative to the scene's middle, in world axes.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;

uniform mat4 view_projection;
uniform mat4 light_projection;

out vec3 world_position;
out vec3 world_normal;
out vec3 light_position;
out float scaled_value;

void main() {
  world_position = position;
  world_normal = normal;
  scaled_value = value;
  light_position = (light_projection * vec4(position, 1.0)).xyz * 0.5 + 0.5;
  gl_Position = view_projection * vec4(position, 1.0);
}
