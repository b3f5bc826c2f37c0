#version 430 core
// The ground: a faint grid that fades into the background, and the shadow on it.
in vec3 world_position;
in vec3 light_position;

uniform vec3 background;
uniform vec2 grid_origin;  // of the world, relative to the scene's middle
uniform float spacing;
uniform float fade_radius;
uniform sampler2D shadow_map;
uniform float shadow_radius;
uniform int lit;

layout(location = 0) out vec4 colour;

float light_reached(vec3 p) {
  if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0)))) return 1.0;
  float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float sum = 0.0, start = 6.28319 * dither;
  for (int i = 0; i < 32; ++i) {
    float r = sqrt((float(i) + 0.5) / 32.0), a = start + 2.39996 * float(i);
    sum += texture(shadow_map, p.xy + shadow_radius * r * vec2(cos(a), sin(a))).r + 0.002 < p.z ? 0.0 : 1.0;
  }
  return sum / 32.0;
}

// Coverage of lines at whole numbers, one pixel and a half wide; lines closer than a few pixels fade out.
float lines(vec2 u) {
  vec2 width = fwidth(u);
  vec2 distance = abs(fract(u - 0.5) - 0.5) / max(width, vec2(1e-9));
  vec2 cover = (1.0 - smoothstep(0.6, 1.6, distance)) * (1.0 - smoothstep(0.15, 0.4, width));
  return max(cover.x, cover.y);
}

void main() {
  vec2 p = world_position.xy;
  float fade = 1.0 - smoothstep(0.25, 1.0, length(p) / fade_radius);
  vec2 u = (p - grid_origin) / spacing;
  float ink = fade * (0.075 * lines(u) + 0.075 * lines(u / 5.0));
  float shadow = lit == 0 ? 0.0 : fade * 0.24 * (1.0 - light_reached(light_position));
  vec3 base = mix(background, background * vec3(0.965, 0.97, 0.978), fade);
  colour = vec4(base * (1.0 - ink) * (1.0 - shadow * vec3(1.0, 0.97, 0.92)), 1.0);
}
