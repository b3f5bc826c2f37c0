#version 430 core
// Colours are screen colours (sRGB-encoded) throughout: shading in that space keeps the colour map's steps
// even to the eye.
in vec3 world_position;
in vec3 world_normal;
in vec3 light_position;
in float scaled_value;

uniform vec3 plain_colour;
uniform float opacity;
uniform int lit;
uniform vec3 eye;        // a point, or a direction when `parallel`
uniform int parallel;
uniform vec3 key_light;  // directions towards the lights, unit
uniform vec3 fill_light;
uniform sampler2D colour_map;
uniform sampler2D shadow_map;
uniform float shadow_radius;

layout(location = 0) out vec4 colour;

// Sixteen taps on a golden-angle spiral, rotated by a fixed dither of the pixel (Jimenez 2014) so that no
// rings show; 1: in the light.
float light_reached(vec3 p, float bias) {
  if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0)))) return 1.0;
  float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float sum = 0.0, start = 6.28319 * dither;
  for (int i = 0; i < 16; ++i) {
    float r = sqrt((float(i) + 0.5) / 16.0), a = start + 2.39996 * float(i);
    vec2 at = p.xy + shadow_radius * r * vec2(cos(a), sin(a));
    sum += texture(shadow_map, at).r + bias < p.z ? 0.0 : 1.0;
  }
  return sum / 16.0;
}

void main() {
  float texel = (clamp(scaled_value, 0.0, 1.0) * 255.0 + 0.5) / 256.0;
  vec3 base = scaled_value < -1.0 ? plain_colour : texture(colour_map, vec2(texel, 0.5)).rgb;
  if (lit == 0) {
    colour = vec4(base, opacity);
    return;
  }
  vec3 to_eye = normalize(parallel == 1 ? eye : eye - world_position);
  vec3 n = normalize(world_normal);
  if (dot(n, to_eye) < 0.0) n = -n;
  float facing = dot(n, key_light);
  // A shadow on a body keeps half of the key light: colours under the tool are what the picture is about.
  float bias = 0.004 + 0.012 * (1.0 - max(facing, 0.0));
  float key = max(facing, 0.0) * mix(0.5, 1.0, light_reached(light_position, bias));
  float fill = max(dot(n, fill_light), 0.0);
  float sky = 0.5 + 0.5 * n.z;
  float gloss = pow(max(dot(n, normalize(key_light + to_eye)), 0.0), 60.0) * min(key * 3.0, 1.0);
  float rim = 1.0 - max(dot(n, to_eye), 0.0);
  vec3 shade = base * (0.53 + 0.14 * sky + 0.40 * key + 0.16 * fill) * (1.0 - 0.14 * rim * rim);
  // A translucent surface is more opaque towards its outline, as glass is: it shows its shape, and what lies
  // behind its middle.
  float cover = opacity < 1.0 ? mix(opacity, 1.0, 0.75 * pow(rim, 4.0)) : 1.0;
  colour = vec4(shade + vec3(0.12 * gloss), cover);
}
