// Triangles in an order in which neighbours follow each other, so that a vertex is computed about once.

/// Spreads the lowest ten bits of n to every third bit.
function spread(n) {
  let out = n & 0x3ff;
  out = (out | (out << 16)) & 0x30000ff;
  out = (out | (out << 8)) & 0x300f00f;
  out = (out | (out << 4)) & 0x30c30c3;
  return (out | (out << 2)) & 0x9249249;
}

/// Returns the triangles along a space-filling curve (Morton 1966) through their centres.
export function alongCurve(vertices, triangles) {
  const low = [0, 1, 2].map(() => Infinity), high = low.map(() => -Infinity);
  for (let i = 0; i < vertices.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], vertices[i]);
    high[i % 3] = Math.max(high[i % 3], vertices[i]);
  }
  const size = Math.max(...high.map((one, k) => one - low[k])) || 1, count = triangles.length / 3;
  const place = new Uint32Array(count), order = new Uint32Array(count);
  for (let t = 0; t < count; ++t) {
    order[t] = t;
    for (let k = 0; k < 3; ++k) {
      const sum = vertices[3 * triangles[3 * t] + k] + vertices[3 * triangles[3 * t + 1] + k] +
        vertices[3 * triangles[3 * t + 2] + k];
      place[t] |= spread(Math.min(1023, Math.floor((1024 * (sum / 3 - low[k])) / size))) << k;
    }
  }
  order.sort((a, b) => place[a] - place[b]);
  const out = new Uint32Array(triangles.length);
  order.forEach((t, i) => out.set(triangles.subarray(3 * t, 3 * t + 3), 3 * i));
  return out;
}
