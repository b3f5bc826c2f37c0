// A coarser skin, for emulated cards: their time is that of the triangles, about a microsecond each.
// Vertices that are near each other become one of them (Rossignac and Borrel 1993), with its normal.

/// Normals of the vertices, of any length, and the area of the surface.
function normalsOf(x, triangles) {
  const normals = new Float32Array(x.length);
  let area = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
    const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    area += 0.5 * Math.hypot(nx, ny, nz);
    for (const v of [a, b, c]) normals[v] += nx, normals[v + 1] += ny, normals[v + 2] += nz;
  }
  return { normals, area };
}

/// Returns the number of the cluster of each vertex, and the clusters, with counts and sums of positions.
/// A cluster has the vertices in a cell of a grid whose normals are within 90 degrees of that of the first
/// one, so that a thin part keeps both sides.
function clustersOf(x, normals, size) {
  const CELLS = 2 ** 17, cells = new Map(), of = new Uint32Array(x.length / 3), clusters = [];
  for (let v = 0, p = 0; p < x.length; ++v, p += 3) {
    const key = (Math.floor(x[p] / size) * CELLS + Math.floor(x[p + 1] / size)) * CELLS +
      Math.floor(x[p + 2] / size);
    let known = cells.get(key);
    if (!known) cells.set(key, known = []);
    let found = known.find(({ first: q }) =>
      normals[p] * normals[q] + normals[p + 1] * normals[q + 1] + normals[p + 2] * normals[q + 2] > 0);
    if (!found) {
      found = { number: clusters.length, first: p, count: 0, x: 0, y: 0, z: 0 };
      known.push(found);
      clusters.push(found);
    }
    of[v] = found.number;
    ++found.count;
    found.x += x[p], found.y += x[p + 1], found.z += x[p + 2];
  }
  return { of, clusters };
}

/// Returns for each vertex the one that replaces it: of its cluster, the nearest to the centre.
function replacements(x, normals, size) {
  const { of, clusters } = clustersOf(x, normals, size);
  const least = new Float64Array(clusters.length).fill(Infinity), nearest = new Uint32Array(clusters.length);
  of.forEach((number, v) => {
    const { count, ...sum } = clusters[number], square = (x[3 * v] - sum.x / count) ** 2 +
      (x[3 * v + 1] - sum.y / count) ** 2 + (x[3 * v + 2] - sum.z / count) ** 2;
    if (square < least[number]) least[number] = square, nearest[number] = v;
  });
  return of.map((number) => nearest[number]);
}

/// Copies of each vertex in a surface of withCreases().
function copiesOf(source) {
  const copies = [];
  source.forEach((v, copy) => (copies[v] ||= []).push(copy));
  return copies;
}

/// The vertices that triangles use, numbered anew.
function compact({ source, normals }, triangles) {
  const number = new Int32Array(source.length).fill(-1), used = [];
  const numbered = Uint32Array.from(triangles, (copy) => {
    if (number[copy] < 0) number[copy] = used.push(copy) - 1;
    return number[copy];
  });
  const out = new Float32Array(3 * used.length);
  used.forEach((copy, i) => out.set(normals.subarray(3 * copy, 3 * copy + 3), 3 * i));
  return { source: Uint32Array.from(used, (copy) => source[copy]), normals: out, triangles: numbered };
}

/// Returns a surface of at most `most` triangles.
/// @param x  positions of the vertices  @param triangles  between them
/// @param drawn  of withCreases() for both; so is what is returned
export function coarser(x, triangles, drawn, most) {
  const { source, normals } = drawn, copies = copiesOf(source), smooth = normalsOf(x, triangles);
  const along = (a, b) => normals[3 * a] * normals[3 * b] + normals[3 * a + 1] * normals[3 * b + 1] +
    normals[3 * a + 2] * normals[3 * b + 2];
  // of a vertex at an edge, the copy on the same side of it
  const copyFor = (corner, vertex) =>
    copies[vertex].reduce((best, copy) => (along(copy, corner) > along(best, corner) ? copy : best));
  for (let size = Math.sqrt((2.5 * smooth.area) / most); ; size *= 1.1) {
    const by = replacements(x, smooth.normals, size), left = [];
    for (let t = 0; t < drawn.triangles.length; t += 3) {
      const [i, j, k] = drawn.triangles.subarray(t, t + 3);
      const a = by[source[i]], b = by[source[j]], c = by[source[k]];
      if (a !== b && b !== c && c !== a) left.push(copyFor(i, a), copyFor(j, b), copyFor(k, c));
    }
    if (left.length <= 3 * most) return compact(drawn, left);
  }
}
