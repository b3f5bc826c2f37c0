#version 430 core
// Pixels where both surfaces are visible, as a compact list (pixel, triangle of a, triangle of b); the
// highest bit of a's tells that one of them has layers there.  The order is that of the atomic counter: the
// reader sorts.
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0) uniform usampler2D triangles_a;
layout(binding = 1) uniform usampler2D triangles_b;
layout(binding = 2) uniform sampler2D depth_a;
layout(binding = 3) uniform sampler2D depth_b;
layout(binding = 4) uniform usampler2D layers_a;
layout(binding = 5) uniform usampler2D layers_b;
uniform int width, height;   // the part of the images that is in use
uniform float largest_gap;  // pixels farther apart than this are excluded [depth units]

layout(std430, binding = 0) buffer Count { uint count; };
layout(std430, binding = 1) writeonly buffer Pairs { uint pairs[]; };

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= width || at.y >= height) return;
  uint a = texelFetch(triangles_a, at, 0).x;
  uint b = texelFetch(triangles_b, at, 0).x;
  if (a == 0u || b == 0u) return;
  if (texelFetch(depth_a, at, 0).x - texelFetch(depth_b, at, 0).x > largest_gap) return;
  bool layered = texelFetch(layers_a, at, 0).x > 1u || texelFetch(layers_b, at, 0).x > 1u;
  uint k = 3u * atomicAdd(count, 1u);
  pairs[k] = uint(at.y * width + at.x);
  pairs[k + 1u] = (a - 1u) | (layered ? 0x80000000u : 0u);
  pairs[k + 2u] = b - 1u;
}
