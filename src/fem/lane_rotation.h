#pragma once
// Rotation R of F = R S in SIMD lanes, for every F away from the singular set: regular, flat and inverted
// alike.
//
// R is the proper rotation with the greatest R : F. With the signed singular values s of F (Irving et al.
// 2004) that greatest value is l = s0 + s1 + s2. The four numbers l, s0 - s1 - s2, s1 - s0 - s2, s2 - s0 - s1
// are the eigenvalues of the symmetric traceless 4 x 4 matrix whose quadratic form on unit quaternions is R :
// F (Davenport), and so the roots of
//
//   p(l) = (l^2 - |F|^2)^2 - 8 l det F - 4 |cof F|^2,       p'(l) = 8 z,
//   z = (s0 + s1)(s1 + s2)(s2 + s0) = k l - det F,   k = (l^2 - |F|^2)/2.
//
// All roots are real and l is the greatest, so Newton's method converges to it monotonically from any upper
// bound, without a branch. Such a bound is l^2 <= 3 |F|^2 (Cauchy and Schwarz), hence l <= (3 + |F|^2)/2,
// which is exact at S = I. A step of length d leaves an error of d^2 p''/(2 p') with p'' = 12 l^2 - 4 |F|^2,
// so the error is known without a further step. With l known (Markley 1993, "Attitude determination using
// vector observations: a fast optimal matrix algorithm", eq. 17):
//
//   R = ( (k + |F|^2) F + l cof F - F F^T F ) / z.
//
// The right side is a polynomial of F: whatever the error of l, the singular vectors are those of F and only
// the stretches r_i of this R differ from 1. One Newton-Schulz step R (3 I - R^T R)/2 brings them from 1 + e
// to 1 - 3/2 e^2: full accuracy for an e of 1e-8.
//
// The rounding error of R is of order |F|^3 / z times the unit roundoff, about s0/(s1 + s2), which is
// inherent: lanes where z < |F|^3 / 100 (flat to a line, or s1 + s2 near 0 where R is discontinuous) and
// lanes that are not finite are left to the scalar path.

/// Half of the relative error that Newton's method may leave in l; in the stretches it is larger by a
/// factor of up to |F|^3 / z, that is, a hundred.
constexpr double kLeft = 2e-10;

/// Computes rotations R and det F of kTogether deformation gradients.
/// @param F  Deformation gradients.
/// @param states  Out: R and det.
/// @param right  Out: lanes where R is accurate.
template <class State>
PALPATE_INLINE void find_rotations(const Matrix* F, State* states, Mask* right) {
  Pack f[kTogether], q[kTogether], d[kTogether], l[kTogether];
  for (int n = 0; n < kTogether; ++n) {
    const Matrix cof = cofactors(F[n]);
    states[n].det = dot(F[n].row[0], cof.row[0]);
    f[n] = double_dot(F[n], F[n]);
    q[n] = 4.0 * double_dot(cof, cof);
    d[n] = 8.0 * states[n].det;
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
    const Pack k = 0.5 * (l[n] * l[n] - f[n]), z = k * l[n] - states[n].det;
    right[n] = (z > 0.0) & (z * z > 1e-4 * (f[n] * f[n] * f[n])) & ~open[n];
    const Pack inverse = 1.0 / z;
    const Matrix FFtF = F[n] * full(gram_of_columns(F[n]));
    const Matrix X = ((k + f[n]) * inverse) * F[n] + (l[n] * inverse) * cofactors(F[n]) + (-inverse) * FFtF;
    const Symmetric Q = gram_of_columns(X);
    const Symmetric correction{1.5 - 0.5 * Q.xx, 1.5 - 0.5 * Q.yy, 1.5 - 0.5 * Q.zz,
                               -0.5 * Q.yz,      -0.5 * Q.xz,      -0.5 * Q.xy};
    states[n].R = X * full(correction);
  }
}

/// Computes the inaccurate lanes one by one. Arguments are copies, so that the matrices of the common path
/// can stay in registers.
[[gnu::noinline, gnu::cold]] static void rotate_by_scalar(const Matrix* F, Matrix* R, const Mask* right,
                                                          const ScalarPath& scalar, LaneCounts& counts) {
  for (int l = 0; l < kWidth; ++l) {
    if ((*right)[l] != 0) continue;
    double one_F[9], one_R[9];
    take_lane(*F, l, one_F);
    scalar.state(one_F, one_R);
    put_lane(one_R, l, *R);
    ++counts.by_scalar;
  }
}

/// Computes the rotations of the first `count` of kTogether deformation gradients.
template <class State>
PALPATE_INLINE void rotations(const Matrix* F, int count, const ScalarPath& scalar, State* states,
                              LaneCounts& counts) {
  Mask right[kTogether];
  find_rotations(F, states, right);
  for (int n = 0; n < kTogether; ++n) {
    if (n >= count || !any(~right[n])) [[likely]]
      continue;
    Matrix copy_F = F[n], copy_R = states[n].R;
    Mask copy_right = right[n];
    rotate_by_scalar(&copy_F, &copy_R, &copy_right, scalar, counts);
    states[n].R = copy_R;
  }
}
