#pragma once
#include <array>

#include "palpate/core/types.h"
#include "palpate/fem/soft_body.h"

namespace palpate::fem {

/// Lame's constants [Pa].
struct Lame {
  double mu = 0.0, lambda = 0.0;
};

/// The nine 3x3 blocks of an element matrix that belong to nodes 1, 2, 3 (index 3 (a-1) + (b-1)).  Those of
/// node 0 follow:
/// a translation of the whole element changes nothing, so that the blocks of each row and of each column sum
/// to zero.
using ElementBlocks = std::array<Mat3, 9>;

// The corotated energy of one element, F = R S with R a proper rotation (DESIGN 3.1):
//
//   psi = mu |F - R|^2 + lambda/2 (tr S - 3)^2,      P = dpsi/dF = 2 mu (F - R) + lambda (tr S - 3) R,
//
// since R : dR = 0 and S : R^T dR = 0 (a symmetric against a skew matrix), so that dR drops out of both
// derivatives. Nodal forces: f_a = -V P g_a.

/// Energy density [J/m^3].
double elastic_energy_density(const Mat3& F, const Mat3& R, const Lame& lame);
/// First Piola-Kirchhoff stress P [Pa].
Mat3 elastic_stress(const Mat3& F, const Mat3& R, const Lame& lame);

// Tangent.  With c = 2 mu - lambda (tr S - 3):
//
//   dP = 2 mu dF + lambda (R : dF) R - c dR.
//
// Put dR = [w]x R and dF = dR S + R dS; with B = F R^T = R S R^T the skew part of dF R^T is
//   dF R^T - R dF^T = [w]x B + B [w]x = [(tr(B) I - B) w]x,   so   w = G axl(dF R^T - R dF^T),   axl [a]x =
//   a,
// G = (tr(B) I - B)^-1, whose eigenvalues are 1/(s_i + s_j) of the signed singular values s.
// For dF = dx_b g_b^T and h = R g: axl(dx_b h_b^T - h_b dx_b^T) = h_b x dx_b, and dR g_a = w x h_a = -[h_a]x
// w.  So
//
//   K_ab = V ( 2 mu (g_a . g_b) I + lambda h_a h_b^T + [h_a]x C [h_b]x ),   C = c G.
//
// In the basis U (.) V^T of the singular vectors dP/dF has the eigenvalues 2 mu + 3 lambda (along R), 2 mu
// five times (the rest of the stretches and the flips, where dR = 0), and for the three twists U [e_k]x V^T
//
//   2 mu - 2 c/(s_i + s_j)   =   2 (mu - eigenvalue of C)        (Smith, de Goes, Kim 2019, with a lambda
//   that does not mix
//                                                                 into the twists, because tr(R^T U [e_k]x
//                                                                 V^T) = 0).
//
// As 2 mu + 3 lambda = E/(1 - 2 nu) > 0, the nearest positive semi-definite matrix has min(C, mu I) in C's
// eigenbasis. And as [h_a]x [h_b]x = h_b h_a^T - (h_a . h_b) I, C = mu I gives R K_linear R^T, the warped
// tangent of Mueller and Gross (2004). The three tangents are one formula with three matrices C:
//
//   exact: C = c G        projected: C = min(c G, mu I)        warped: C = mu I       (all equal at S = I).

/// Below this sum of two signed singular values the exact tangent takes this value instead: R jumps where the
/// sum is zero.
inline constexpr double kSmallestSum = 1e-4;

/// The matrix C [Pa] of a tangent.  `clamped` is set where kSmallestSum was used.
Mat3 rotation_coupling(Tangent tangent, const Mat3& F, const Mat3& R, const Lame& lame, bool& clamped);

/// K += scale V dP/dF in blocks.  `gradients` has rows g_a, C from rotation_coupling.
void add_elastic_blocks(const Mat3& gradients, const Mat3& R, const Mat3& C, const Lame& lame, double scale,
                        ElementBlocks& K);

/// dP of a direction dF, with the tangent that C stands for.
Mat3 elastic_stress_change(const Mat3& dF, const Mat3& R, const Mat3& C, const Lame& lame);

// Objective damping (DESIGN 3.1), with F' = sum_a v_a g_a^T:
//
//   P_d = F Sigma,   Sigma = 2 mu_d E' + lambda_d tr(E') I,   E' = sym(F^T F').
//
// F Sigma F^T is symmetric: no moment.  F' = [w]x F gives E' = 0: a spin is not braked.  Power F' : P_d = E'
// : Sigma >= 0. By velocity (dF' = dv_b g_b^T, k = F g, B2 = F F^T), symmetric:
//   D_ab = V ( mu_d ((g_a . g_b) B2 + k_b k_a^T) + lambda_d k_a k_b^T ).
// By position (dF = dx_b g_b^T, l = F' g), unsymmetric:
//   K_ab = V ( (g_a . Sigma g_b) I + mu_d ((g_a . g_b) F F'^T + k_b l_a^T) + lambda_d k_a l_b^T ).

/// Strain rate E' [1/s] and the damping stress Sigma [Pa].
Mat3 strain_rate(const Mat3& F, const Mat3& F_dot);
Mat3 damping_stress(const Mat3& rate, const Lame& damping);
void add_damping_blocks(const Mat3& gradients, const Mat3& F, const Lame& damping, double scale,
                        ElementBlocks& D);
void add_damping_position_blocks(const Mat3& gradients, const Mat3& F, const Mat3& F_dot, const Lame& damping,
                                 double scale, ElementBlocks& K);

}  // namespace palpate::fem
