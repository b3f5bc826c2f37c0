// Normals of a surface at rest: smooth over round parts, apart where faces meet at an edge.

/// Faces at a vertex share a normal where theirs differ by less than 50 degrees.
const COSINE_OF_CREASE = 0.64;

function faceNormals(vertices, triangles) {
  const count = triangles.length / 3;
  const areas = new Float32Array(3 * count), units = new Float32Array(3 * count);
  for (let t = 0; t < count; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[3 * t + k]);
    const u = [0, 1, 2].map((k) => vertices[b + k] - vertices[a + k]);
    const v = [0, 1, 2].map((k) => vertices[c + k] - vertices[a + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; ++k) areas[3 * t + k] = n[k], units[3 * t + k] = n[k] / size;
  }
  return { areas, units };
}

/// Triangles at each vertex: those of v are faces[first[v]] to faces[first[v + 1] - 1].
function facesOfVertices(count, triangles) {
  const first = new Uint32Array(count + 1), faces = new Uint32Array(triangles.length);
  for (const v of triangles) ++first[v + 1];
  for (let v = 0; v < count; ++v) first[v + 1] += first[v];
  const next = first.slice();
  triangles.forEach((v, corner) => { faces[next[v]++] = Math.trunc(corner / 3); });
  return { first, faces };
}

/// Returns {source, normals, triangles}: the vertices to draw, each with the vertex that it is a copy of and
/// its unit normal (weighted by area), and the triangles between them.
export function withCreases(vertices, triangles) {
  const { areas, units } = faceNormals(vertices, triangles);
  const { first, faces } = facesOfVertices(vertices.length / 3, triangles);
  const source = [], normals = [], drawn = new Uint32Array(triangles.length);
  const copies = new Map();  // vertex: [number of the copy, ...]
  for (let corner = 0; corner < triangles.length; ++corner) {
    const v = triangles[corner], own = 3 * Math.trunc(corner / 3), n = [0, 0, 0];
    for (let at = first[v]; at < first[v + 1]; ++at) {
      const other = 3 * faces[at];
      const cosine = units[own] * units[other] + units[own + 1] * units[other + 1] +
        units[own + 2] * units[other + 2];
      if (cosine > COSINE_OF_CREASE || other === own)
        for (let k = 0; k < 3; ++k) n[k] += areas[other + k];
    }
    const size = Math.hypot(...n) || 1, known = copies.get(v) || [];
    const same = known.find((copy) => [0, 1, 2].every((k) =>
      Math.abs(normals[3 * copy + k] - n[k] / size) < 1e-3));
    drawn[corner] = same ?? source.length;
    if (same !== undefined) continue;
    copies.set(v, [...known, source.length]);
    source.push(v);
    normals.push(...n.map((x) => x / size));
  }
  return { source: Uint32Array.from(source), normals: Float32Array.from(normals), triangles: drawn };
}
