#pragma once
#include "element_blocks.h"
#include "palpate/core/types.h"
#include "palpate/fem/material.h"

namespace palpate::fem {

// Objective damping for any constitutive law: Kelvin-Voigt with the rate of Green's strain, so that rigid
// motions are not damped. With F' = sum_a v_a g_a^T:
//
//   P_d = F Sigma,   Sigma = 2 mu_d E' + lambda_d tr(E') I,   E' = sym(F^T F').
//
// F Sigma F^T is symmetric: no moment. F' = [w]x F gives E' = 0: a spin is not damped. The power is
// F' : P_d = E' : Sigma >= 0. The derivative by velocity (dF' = dv_b g_b^T, k = F g, B2 = F F^T) is
// symmetric:
//   D_ab = V ( mu_d ((g_a . g_b) B2 + k_b k_a^T) + lambda_d k_a k_b^T ).
// The derivative by position (dF = dx_b g_b^T, l = F' g) is unsymmetric:
//   K_ab = V ( (g_a . Sigma g_b) I + mu_d ((g_a . g_b) F F'^T + k_b l_a^T) + lambda_d k_a l_b^T ).

/// Returns the strain rate E' [1/s].
Mat3 strain_rate(const Mat3& F, const Mat3& F_dot);
Mat3 damping_stress(const Mat3& rate, const Lame& damping);
void add_damping_blocks(const Mat3& gradients, const Mat3& F, const Lame& damping, double scale,
                        ElementBlocks& D);
void add_damping_position_blocks(const Mat3& gradients, const Mat3& F, const Mat3& F_dot, const Lame& damping,
                                 double scale, ElementBlocks& K);

}  // namespace palpate::fem
