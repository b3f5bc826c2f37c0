#pragma once
#include "palpate/core/pose.h"
#include "palpate/core/types.h"

namespace palpate {

/// Fits a rigid motion to two point sets: returns the pose x -> R x + t that minimises sum_i w_i |R a_i + t -
/// b_i|^2.  With c, d the weighted means, R = V U^T from the singular value decomposition sum w_i (a_i -
/// c)(b_i - d)^T = U S V^T (Kabsch 1976), with the last direction negated where that would be a reflection.
/// @param before, after  a_i and b_i, 3 x n [m]
/// @param weights  n, non-negative; empty for equal weights
Pose rigid_fit(const Points& before, const Points& after, const VecX& weights = {});

/// Returns the displacements without rigid motion, b_i - (R a_i + t) with that fit, 3 x n [m].  With masses
/// as weights their sum has no momentum and no angular momentum about the centre of mass.
Points without_rigid_motion(const Points& before, const Points& after, const VecX& weights = {});

}  // namespace palpate
