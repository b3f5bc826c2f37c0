#pragma once
// The rotation R of F = R S in lanes, for every F away from the singular set: regular, flat and inverted
// alike.
//
// R is the proper rotation with the greatest R : F, and with the signed singular values s of F (Irving et al.
// 2004) that greatest value is l = s0 + s1 + s2.  The four numbers l, s0 - s1 - s2, s1 - s0 - s2, s2 - s0 -
// s1 are the eigenvalues of the symmetric traceless 4 x 4 matrix
// whose quadratic form on unit quaternions is R : F (Davenport), and so the roots of
//
//   p(l) = (l^2 - |F|^2)^2 - 8 l det F - 4 |cof F|^2,       p'(l) = 8 z,   z = (s0 + s1)(s1 + s2)(s2 + s0) =
//   k l - det F,   k = (l^2 - |F|^2)/2.
//
// All roots are real and l is the greatest, so Newton's method descends to it from any bound above, without a
// branch; such a bound is l^2 <= 3 |F|^2 (Cauchy and Schwarz), hence l <= (3 + |F|^2)/2, which is exact at S
// = I.  A step of length d leaves an error of d^2 p''/(2 p') with p'' = 12 l^2 - 4 |F|^2, so that it need not
// be seen to be small itself.  With l at hand (Markley 1993, "Attitude determination
// using vector observations: a fast optimal matrix algorithm", eq. 17):
//
//   R = ( (k + |F|^2) F + l cof F - F F^T F ) / z.
//
// The right side is a polynomial of F: whatever error l has, the singular vectors are those of F and only the
// stretches r_i of this R are off 1.  One step R (3 I - R^T R)/2 of Newton and Schulz brings them from 1 + e
// to 1 - 3/2 e^2: full accuracy from an e of 1e-8.
//
// What rounding does to R is of order |F|^3 / z times the unit roundoff, about s0/(s1 + s2), as it must be:
// lanes where z < |F|^3 / 100 (flat to a line, or s1 + s2 near 0 where R jumps) and lanes that are not finite
// are left to the scalar path.

PALPATE_INLINE Matrix cofactors(const Matrix& F) {
  return {{cross(F.row[1], F.row[2]), cross(F.row[2], F.row[0]), cross(F.row[0], F.row[1])}};
}

/// Half of the relative error that Newton may leave in l; in the stretches it is up to |F|^3 / z, a hundred,
/// times as large.
constexpr double kLeft = 2e-10;

/// Elements go together, kTogether in each lane: while one waits for its divisions, the other goes on.
constexpr int kTogether = 2;

/// @param right  lanes where R is right
PALPATE_INLINE void find_rotations(const Matrix* F, Matrix* R, Pack* det, Mask* right) {
  Pack f[kTogether], q[kTogether], d[kTogether], l[kTogether];
  for (int n = 0; n < kTogether; ++n) {
    const Matrix cof = cofactors(F[n]);
    det[n] = dot(F[n].row[0], cof.row[0]);
    f[n] = double_dot(F[n], F[n]);
    q[n] = 4.0 * double_dot(cof, cof);
    d[n] = 8.0 * det[n];
    l[n] = 1.5 + 0.5 * f[n];
  }
  Mask open[kTogether];
  for (int i = 0; i < 24; ++i) {
    Mask in_any{};
    for (int n = 0; n < kTogether; ++n) {
      const Pack w = l[n] * l[n] - f[n];
      const Pack slope = 4.0 * (l[n] * w) - d[n];  // p' = 8 z
      const Pack step = (w * w - l[n] * d[n] - q[n]) / slope;
      l[n] -= step;
      open[n] = step * step * (3.0 * (l[n] * l[n]) - f[n]) > kLeft * (l[n] * slope);
      in_any |= open[n];
    }
    if (!any(in_any)) break;
  }
  for (int n = 0; n < kTogether; ++n) {
    const Pack k = 0.5 * (l[n] * l[n] - f[n]), z = k * l[n] - det[n];
    right[n] = (z > 0.0) & (z * z > 1e-4 * (f[n] * f[n] * f[n])) & ~open[n];
    const Pack inverse = 1.0 / z;
    const Matrix FFtF = F[n] * full(gram_of_columns(F[n]));
    const Matrix X = ((k + f[n]) * inverse) * F[n] + (l[n] * inverse) * cofactors(F[n]) + (-inverse) * FFtF;
    const Symmetric Q = gram_of_columns(X);
    const Symmetric correction{1.5 - 0.5 * Q.xx, 1.5 - 0.5 * Q.yy, 1.5 - 0.5 * Q.zz,
                               -0.5 * Q.yz,      -0.5 * Q.xz,      -0.5 * Q.xy};
    R[n] = X * full(correction);
  }
}

PALPATE_INLINE void take_lane(const Matrix& A, int l, double* a) {
  for (int r = 0; r < 3; ++r) {
    a[3 * r] = A.row[r].x[l];
    a[3 * r + 1] = A.row[r].y[l];
    a[3 * r + 2] = A.row[r].z[l];
  }
}
PALPATE_INLINE void put_lane(const double* a, int l, Matrix& A) {
  for (int r = 0; r < 3; ++r) {
    A.row[r].x[l] = a[3 * r];
    A.row[r].y[l] = a[3 * r + 1];
    A.row[r].z[l] = a[3 * r + 2];
  }
}

/// The lanes that are not right, one by one.  By value: the matrices of the common path then stay in
/// registers.
[[gnu::noinline, gnu::cold]] static void rotate_by_scalar(const Matrix* F, Matrix* R, const Mask* right,
                                                          const ScalarPath& scalar, LaneCounts& counts) {
  for (int l = 0; l < kWidth; ++l) {
    if ((*right)[l] != 0) continue;
    double one_F[9], one_R[9];
    take_lane(*F, l, one_F);
    scalar.rotation(one_F, one_R);
    put_lane(one_R, l, *R);
    ++counts.by_scalar;
  }
}

/// The rotations of the first `count` of kTogether deformation gradients.
PALPATE_INLINE void rotations(const Matrix* F, int count, const ScalarPath& scalar, Matrix* R, Pack* det,
                              LaneCounts& counts) {
  Mask right[kTogether];
  find_rotations(F, R, det, right);
  for (int n = 0; n < kTogether; ++n) {
    if (n >= count || !any(~right[n])) [[likely]]
      continue;
    Matrix copy_F = F[n], copy_R = R[n];
    Mask copy_right = right[n];
    rotate_by_scalar(&copy_F, &copy_R, &copy_right, scalar, counts);
    R[n] = copy_R;
  }
}
