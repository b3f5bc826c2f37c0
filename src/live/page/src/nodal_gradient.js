// Deformation gradients at nodes, smooth enough to shade by.
//
// Inside a tetrahedron x = F X + c with F = Ds Dm^-1, the columns of Ds and Dm its edges now and at rest.  F
// jumps between tetrahedra, and normals cof(F) n with it, which would show every one of them under a skin
// that is finer.  The mean of F over the tetrahedra around each node, weighted by their volumes and then
// interpolated, is continuous.

/// Inverse of the matrix whose columns are three edges, by rows, and its determinant.
function inverseOfEdges(x, [a, b, c, d]) {
  const [u, v, w] = [b, c, d].map((n) => [0, 1, 2].map((k) => x[3 * n + k] - x[3 * a + k]));
  const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
  const rows = [cross(v, w), cross(w, u), cross(u, v)];
  const determinant = u.reduce((sum, one, k) => sum + one * rows[0][k], 0);
  return { inverse: rows.flat().map((one) => one / determinant), determinant };
}

export class NodalGradient {
  constructor(rest, tets) {
    const nodes = rest.length / 3, count = tets.length / 4, total = new Float64Array(nodes);
    this.tets = tets;
    this.inverses = new Float32Array(9 * count);
    this.shares = new Float32Array(4 * count);  // of the four nodes
    const volumes = new Float64Array(count);
    for (let e = 0; e < count; ++e) {
      const { inverse, determinant } = inverseOfEdges(rest, tets.subarray(4 * e, 4 * e + 4));
      if (!inverse.every(Number.isFinite)) continue;  // flat at rest: no part of the mean
      this.inverses.set(inverse, 9 * e);
      volumes[e] = Math.abs(determinant);
      for (let k = 0; k < 4; ++k) total[tets[4 * e + k]] += volumes[e];
    }
    for (let e = 0; e < count; ++e)
      for (let k = 0; k < 4; ++k) this.shares[4 * e + k] = volumes[e] / (total[tets[4 * e + k]] || 1);
    this.alone = [...total.keys()].filter((n) => total[n] === 0);  // nodes of no tetrahedron with a volume
  }

  /// Writes the rows [F x] of each node, 12 numbers, into `out`.
  write(x, out) {
    const { tets, inverses, shares } = this, nodes = x.length / 3;
    out.fill(0);
    for (let e = 0; 4 * e < tets.length; ++e) {
      const a = 3 * tets[4 * e], b = 3 * tets[4 * e + 1], c = 3 * tets[4 * e + 2], d = 3 * tets[4 * e + 3];
      const m = 9 * e;
      for (let row = 0; row < 3; ++row) {
        const from = x[a + row], u = x[b + row] - from, v = x[c + row] - from, w = x[d + row] - from;
        const f0 = u * inverses[m] + v * inverses[m + 3] + w * inverses[m + 6];
        const f1 = u * inverses[m + 1] + v * inverses[m + 4] + w * inverses[m + 7];
        const f2 = u * inverses[m + 2] + v * inverses[m + 5] + w * inverses[m + 8];
        for (let k = 0; k < 4; ++k) {
          const at = 12 * tets[4 * e + k] + 4 * row, share = shares[4 * e + k];
          out[at] += share * f0;
          out[at + 1] += share * f1;
          out[at + 2] += share * f2;
        }
      }
    }
    for (const n of this.alone) out[12 * n] = out[12 * n + 5] = out[12 * n + 10] = 1;
    for (let n = 0; n < nodes; ++n)
      for (let row = 0; row < 3; ++row) out[12 * n + 4 * row + 3] = x[3 * n + row];
  }
}
