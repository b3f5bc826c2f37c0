// The skin in its tetrahedra: which nodes carry a vertex, and where it is, computed by the processor.

/// Positions at rest of the skin's vertices.
export function skinAtRest({ rest, tets, tet, weights }) {
  const out = new Float32Array(3 * tet.length);
  for (let v = 0; v < tet.length; ++v)
    for (let corner = 0; corner < 4; ++corner) {
      const node = 3 * tets[4 * tet[v] + corner], weight = weights[4 * v + corner];
      for (let k = 0; k < 3; ++k) out[3 * v + k] += weight * rest[node + k];
    }
  return out;
}

/// Writes position and normal (of any length) of each vertex: what embed() of skin_shader.js computes.
/// Scalars and no inner loops, which take three times as long.
/// @param rows  rows [F x] of the nodes, 12 numbers each
export function embedSkin(rows, { corner, weight, normal }, position, turned) {
  for (let v = 0, p = 0; p < position.length; v += 4, p += 3) {
    let a0 = 0, a1 = 0, a2 = 0, a3 = 0, b0 = 0, b1 = 0, b2 = 0, b3 = 0, c0 = 0, c1 = 0, c2 = 0, c3 = 0;
    for (let k = v; k < v + 4; ++k) {
      const w = weight[k], at = 12 * corner[k];
      a0 += w * rows[at], a1 += w * rows[at + 1], a2 += w * rows[at + 2], a3 += w * rows[at + 3];
      b0 += w * rows[at + 4], b1 += w * rows[at + 5], b2 += w * rows[at + 6], b3 += w * rows[at + 7];
      c0 += w * rows[at + 8], c1 += w * rows[at + 9], c2 += w * rows[at + 10], c3 += w * rows[at + 11];
    }
    const x = normal[p], y = normal[p + 1], z = normal[p + 2];
    position[p] = a3, position[p + 1] = b3, position[p + 2] = c3;
    turned[p] = (b1 * c2 - b2 * c1) * x + (b2 * c0 - b0 * c2) * y + (b0 * c1 - b1 * c0) * z;
    turned[p + 1] = (c1 * a2 - c2 * a1) * x + (c2 * a0 - c0 * a2) * y + (c0 * a1 - c1 * a0) * z;
    turned[p + 2] = (a1 * b2 - a2 * b1) * x + (a2 * b0 - a0 * b2) * y + (a0 * b1 - a1 * b0) * z;
  }
}
