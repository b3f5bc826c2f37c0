#pragma once
#include "palpate/core/types.h"

namespace palpate {

/// Signed singular value decomposition, F = U diag(sigma) V^T with U, V proper rotations; sigma[0] >=
/// sigma[1] >= |sigma[2]|, sigma[2] < 0 exactly when det F < 0.
struct SignedSvd {
  Mat3 U;
  Vec3 sigma;
  Mat3 V;
};

/// Computes the signed singular value decomposition (sign convention of Irving, Teran, Fedkiw 2004), defined
/// for every finite F, flat and inverted included.  NaN in all factors where F is not finite.
SignedSvd signed_svd(const Mat3& F);

/// Polar decomposition, F = R S with R a proper rotation and S symmetric (indefinite when det F < 0).
struct Polar {
  Mat3 R;
  Mat3 S;
};

/// Computes the polar decomposition, by Newton iteration where F is well conditioned (det F > 0.05, |F|_F^2 <
/// 30), else by signed_svd.  |R^T R - I| <= 1e-14.
Polar polar_decomposition(const Mat3& F);

}  // namespace palpate
