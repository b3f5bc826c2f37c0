#pragma once
// The rotation R of F = R S in lanes, for every F away from the singular set: regular, flat and inverted alike.
//
// R is the proper rotation with the greatest R : F, and with the signed singular values s of F (Irving et al. 2004) that greatest value is
// l = s0 + s1 + s2.  The four numbers l, s0 - s1 - s2, s1 - s0 - s2, s2 - s0 - s1 are the eigenvalues of the symmetric traceless 4 x 4 matrix
// whose quadratic form on unit quaternions is R : F (Davenport), and so the roots of
//
//   p(l) = (l^2 - |F|^2)^2 - 8 l det F - 4 |cof F|^2,       p'(l) = 8 z,   z = (s0 + s1)(s1 + s2)(s2 + s0) = k l - det F,   k = (l^2 - |F|^2)/2.
//
// All roots are real and l is the greatest, so Newton's method descends to it from any bound above, without a branch; such a bound is
// l^2 <= 3 |F|^2 (Cauchy and Schwarz), hence l <= (3 + |F|^2)/2, which is exact at S = I.  A step of length d leaves an error of
// d^2 p''/(2 p') with p'' = 12 l^2 - 4 |F|^2, so that it need not be seen to be small itself.  With l at hand (Markley 1993, "Attitude determination
// using vector observations: a fast optimal matrix algorithm", eq. 17):
//
//   R = ( (k + |F|^2) F + l cof F - F F^T F ) / z.
//
// The right side is a polynomial of F: whatever error l has, the singular vectors are those of F and only the stretches r_i of this R are
// off 1.  One step R (3 I - R^T R)/2 of Newton and Schulz brings them from 1 + e to 1 - 3/2 e^2: full accuracy from an e of 1e-8.
//
// What rounding does to R is of order |F|^3 / z times the unit roundoff, about s0/(s1 + s2), as it must be: lanes where z < |F|^3 / 100 (flat to
// a line, or s1 + s2 near 0 where R jumps) and lanes that are not finite are left to the scalar path.

/// Half of the relative error that Newton may leave in l; in the stretches it is up to |F|^3 / z, a hundred, times as large.
constexpr double kLeft = 2e-10;

/// @return lanes where R is right
PALPATE_INLINE Mask find_rotation(const Matrix& F, Matrix& R, Pack& det) {
  const Matrix cof{{cross(F.row[1], F.row[2]), cross(F.row[2], F.row[0]), cross(F.row[0], F.row[1])}};
  det = dot(F.row[0], cof.row[0]);
  const Pack f = double_dot(F, F), q = 4.0 * double_dot(cof, cof), d = 8.0 * det;
  Pack l = 1.5 + 0.5 * f;
  Mask open;
  for (int i = 0; i < 24; ++i) {
    const Pack w = l * l - f;
    const Pack slope = 4.0 * (l * w) - d;  // p' = 8 z
    const Pack step = (w * w - l * d - q) / slope;
    l -= step;
    open = step * step * (3.0 * (l * l) - f) > kLeft * (l * slope);
    if (!any(open)) break;
  }
  const Pack k = 0.5 * (l * l - f), z = k * l - det;
  const Mask right = (z > 0.0) & (z * z > 1e-4 * (f * f * f)) & ~open;

  const Pack inverse = 1.0 / z;
  const Matrix FFtF = F * full(gram_of_columns(F));
  const Matrix X = ((k + f) * inverse) * F + (l * inverse) * cof + (-inverse) * FFtF;
  const Symmetric Q = gram_of_columns(X);
  const Symmetric correction{1.5 - 0.5 * Q.xx, 1.5 - 0.5 * Q.yy, 1.5 - 0.5 * Q.zz, -0.5 * Q.yz, -0.5 * Q.xz, -0.5 * Q.xy};
  R = X * full(correction);
  return right;
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

/// The lanes that are not right, one by one.  By value: the matrices of the common path then stay in registers.
[[gnu::noinline, gnu::cold]] static void rotate_by_scalar(const Matrix* F, Matrix* R, const Mask* right, const ScalarPath& scalar, LaneCounts& counts) {
  for (int l = 0; l < kWidth; ++l) {
    if ((*right)[l] != 0) continue;
    double one_F[9], one_R[9];
    take_lane(*F, l, one_F);
    scalar.rotation(one_F, one_R);
    put_lane(one_R, l, *R);
    ++counts.by_scalar;
  }
}

PALPATE_INLINE void rotation(const Matrix& F, const ScalarPath& scalar, Matrix& R, Pack& det, LaneCounts& counts) {
  const Mask right = find_rotation(F, R, det);
  if (any(~right)) [[unlikely]] {
    Matrix copy_F = F, copy_R = R;
    Mask copy_right = right;
    rotate_by_scalar(&copy_F, &copy_R, &copy_right, scalar, counts);
    R = copy_R;
  }
}
