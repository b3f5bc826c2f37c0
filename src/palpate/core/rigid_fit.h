#pragma once
#include "palpate/core/pose.h"
#include "palpate/core/types.h"

namespace palpate {

/// The rigid motion that brings points nearest to others: the pose x -> R x + t with the least
/// sum_i w_i |R a_i + t - b_i|^2.  With c, d the weighted means, R = V U^T of the singular value
/// decomposition sum w_i (a_i - c)(b_i - d)^T = U S V^T (Kabsch 1976), the last direction turned where that
/// were a reflection.
/// @param before, after  3 x n [m]  @param weights  n, not negative; empty: all alike
Pose rigid_fit(const Points& before, const Points& after, const VecX& weights = {});

}  // namespace palpate
