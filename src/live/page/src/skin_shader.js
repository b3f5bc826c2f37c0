// Shaders of a body. The skin is embedded in the tetrahedra on the graphics card, so that only nodes travel.
//
// On an emulated card, where fetches of textures cost more than the rest of a vertex, and colours more than
// the rest of a pixel, the processor embeds the skin (embedding.js) and vertices are coloured, not pixels:
// EMBEDDED is then undefined.

/// Nodes in a row of the texture; each has three texels, the rows [F x] of its affine map.
export const NODES_PER_ROW = 256;

/// Colour of a point: that of its displacement, a share of the range, under two lights that follow the eye,
/// one from the upper left, and a faint one from above: light of a dull surface, and gloss.  Colours are
/// computed as squares of their screen values, close enough to linear light.
const paint = `
uniform sampler2D ramp;
uniform float stops;
uniform vec3 plain;
uniform bool coloured;
vec3 paint(float share, vec3 n) {
  const vec3 key = vec3(-0.46, 0.62, 0.64), fill = vec3(0.75, -0.1, 0.65);
  const vec3 half_way = vec3(-0.254, 0.342, 0.905);
  vec3 own = plain;
  if (coloured)
    own = textureLod(ramp, vec2((0.5 + clamp(share, 0.0, 1.0) * (stops - 1.0)) / stops, 0.5), 0.0).rgb;
  float light = 0.26 + 0.72 * max(dot(n, key), 0.0) + 0.2 * max(dot(n, fill), 0.0) + 0.06 * n.y;
  float gloss = max(dot(n, half_way), 0.0);
  gloss *= gloss, gloss *= gloss, gloss *= gloss;
  return sqrt(own * own * light + 0.06 * gloss * gloss * gloss);
}`;

export const vertexShader = `
uniform mat3 fitRotation;
uniform vec3 fitTranslation;
uniform float inverseRange;
#ifdef EMBEDDED
out float share;
out vec3 viewNormal;
uniform sampler2D nodes;
in uvec4 corner;
in vec4 weight;
void embed(out vec3 x, out vec3 n) {
  vec4 r0 = vec4(0.0), r1 = vec4(0.0), r2 = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    int node = int(corner[k]);
    ivec2 at = ivec2(3 * (node % ${NODES_PER_ROW}), node / ${NODES_PER_ROW});
    r0 += weight[k] * texelFetch(nodes, at, 0);
    r1 += weight[k] * texelFetch(nodes, at + ivec2(1, 0), 0);
    r2 += weight[k] * texelFetch(nodes, at + ivec2(2, 0), 0);
  }
  x = vec3(r0.w, r1.w, r2.w);
  // normals map by the cofactors of F, also where an element is flat or inverted
  n = vec3(dot(cross(r1.xyz, r2.xyz), normal), dot(cross(r2.xyz, r0.xyz), normal),
           dot(cross(r0.xyz, r1.xyz), normal));
}
#else
out vec3 painted;
in vec3 moved;
in vec3 turned;
${paint}
#endif

void main() {
#ifdef EMBEDDED
  vec3 x, n;
  embed(x, n);
#else
  vec3 x = moved, n = turned;
#endif
  n = normalMatrix * n;
  float s = length(x - (fitRotation * position + fitTranslation)) * inverseRange;
#ifdef EMBEDDED
  share = s;
  viewNormal = n;
#else
  painted = paint(s, normalize(n));
#endif
  gl_Position = projectionMatrix * (modelViewMatrix * vec4(x, 1.0));
}`;

export const fragmentShader = `
uniform float opacity;
out vec4 colour;
#ifdef EMBEDDED
in float share;
in vec3 viewNormal;
${paint}
#else
in vec3 painted;
#endif

void main() {
#ifdef EMBEDDED
  colour = vec4(paint(share, normalize(viewNormal)), opacity);
#else
  colour = vec4(painted, opacity);
#endif
}`;
