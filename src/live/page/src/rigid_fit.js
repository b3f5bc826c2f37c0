// The rigid motion that fits a body's nodes best, so that a free body is coloured by its deformation alone.

/// Cofactors of a 3 x 3 matrix by rows.
function cofactors(m) {
  const [a, b, c, d, e, f, g, h, i] = m;
  return [e * i - f * h, f * g - d * i, d * h - e * g, c * h - b * i, a * i - c * g, b * g - a * h,
    b * f - c * e, c * d - a * f, a * e - b * d];
}

/// The rotation nearest to m (polar decomposition by Newton's iteration, Higham 1986), or null where m is
/// singular or turns the body inside out.
function rotationOf(m) {
  const size = Math.hypot(...m) || 1;
  let r = m.map((one) => (one * Math.sqrt(3)) / size);
  for (let round = 0; round < 30; ++round) {
    const cofactor = cofactors(r), determinant = r[0] * cofactor[0] + r[1] * cofactor[1] + r[2] * cofactor[2];
    if (!(determinant > 1e-9)) return null;
    const next = r.map((one, k) => 0.5 * (one + cofactor[k] / determinant));
    const change = Math.hypot(...next.map((one, k) => one - r[k]));
    r = next;
    if (change < 1e-7) break;
  }
  return r;
}

function centreOf(x) {
  const sum = [0, 0, 0], count = x.length / 3;
  for (let i = 0; i < x.length; i += 3) sum[0] += x[i], sum[1] += x[i + 1], sum[2] += x[i + 2];
  return sum.map((one) => one / count);
}

/// Rotation by rows and translation of the least-squares fit x = R X + t over all nodes.
export function rigidFit(rest, x) {
  const from = centreOf(rest), to = centreOf(x), m = new Array(9).fill(0);
  for (let i = 0; i < x.length; i += 3)
    for (let row = 0; row < 3; ++row) {
      const moved = x[i + row] - to[row];
      for (let k = 0; k < 3; ++k) m[3 * row + k] += moved * (rest[i + k] - from[k]);
    }
  const rotation = rotationOf(m) || [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const translation = to.map((one, row) =>
    one - [0, 1, 2].reduce((sum, k) => sum + rotation[3 * row + k] * from[k], 0));
  return { rotation, translation };
}

export const noMotion = { rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], translation: [0, 0, 0] };

/// The largest distance of a node from where the rigid motion takes it [m].
export function largestDisplacement(rest, x, { rotation: r, translation: t }) {
  let most = 0;
  for (let i = 0; i < x.length; i += 3) {
    let square = 0;
    for (let k = 0; k < 3; ++k) {
      const carried = r[3 * k] * rest[i] + r[3 * k + 1] * rest[i + 1] + r[3 * k + 2] * rest[i + 2] + t[k];
      square += (x[i + k] - carried) ** 2;
    }
    if (square > most) most = square;
  }
  return Math.sqrt(most);
}
