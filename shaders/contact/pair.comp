#version 430 core
// Pixels of all tiles of the atlas where both surfaces are visible, as one compact list (tile and pixel, face
// of a, face of b).  A work group is a block of one tile.  The order is that of the atomic counter: the
// reader sorts.
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0) uniform usampler2D faces_a;
layout(binding = 1) uniform usampler2D faces_b;
layout(binding = 2) uniform sampler2D depth_a;
layout(binding = 3) uniform sampler2D depth_b;

struct Tile {
  uint x, y, width, height;  // in the atlas [pixels]
  float largest_gap;         // pixels farther apart than this are excluded [depth units]
};
layout(std430, binding = 1) readonly buffer Tiles { Tile tiles[]; };
layout(std430, binding = 2) readonly buffer Blocks { uint blocks[]; };  // tile, row and column: 16, 8, 8 bits
layout(std430, binding = 3) buffer Count { uint count; };
layout(std430, binding = 4) writeonly buffer Pairs { uint pairs[]; };

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;  // no dimension may be long
  if (group >= blocks.length()) return;
  uint block = blocks[group];
  uint number = block >> 16;
  Tile tile = tiles[number];
  uvec2 pixel = 16u * uvec2(block & 0xffu, (block >> 8) & 0xffu) + gl_LocalInvocationID.xy;
  if (pixel.x >= tile.width || pixel.y >= tile.height) return;
  ivec2 at = ivec2(tile.x + pixel.x, tile.y + pixel.y);
  uint a = texelFetch(faces_a, at, 0).x;
  uint b = texelFetch(faces_b, at, 0).x;
  if (a == 0u || b == 0u) return;
  if (texelFetch(depth_a, at, 0).x - texelFetch(depth_b, at, 0).x > tile.largest_gap) return;
  uint k = 3u * atomicAdd(count, 1u);
  pairs[k] = (number << 24) | (pixel.y * tile.width + pixel.x);
  pairs[k + 1u] = a - 1u;
  pairs[k + 2u] = b - 1u;
}
