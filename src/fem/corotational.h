#pragma once
#include "element_blocks.h"
#include "palpate/core/types.h"
#include "palpate/fem/material.h"
#include "palpate/fem/options.h"

namespace palpate::fem {

// Corotated energy of one element, F = R S with R a proper rotation (Mueller and Gross 2004; with this R also
// for flat and inverted elements, Irving, Teran and Fedkiw 2004):
//
//   psi = mu |F - R|^2 + lambda/2 (tr S - 3)^2,      P = dpsi/dF = 2 mu (F - R) + lambda (tr S - 3) R,
//
// since R : dR = 0 and S : R^T dR = 0 (a symmetric against a skew matrix), so that dR drops out of both
// derivatives. Nodal forces: f_a = -V P g_a.

/// Returns the energy density [J/m^3].
double elastic_energy_density(const Mat3& F, const Mat3& R, const Lame& lame);
/// Returns the first Piola-Kirchhoff stress P [Pa].
Mat3 elastic_stress(const Mat3& F, const Mat3& R, const Lame& lame);

// Tangent. With c = 2 mu - lambda (tr S - 3):
//
//   dP = 2 mu dF + lambda (R : dF) R - c dR.
//
// Let dR = [w]x R and dF = dR S + R dS. With B = F R^T = R S R^T the skew part of dF R^T is
//   dF R^T - R dF^T = [w]x B + B [w]x = [(tr(B) I - B) w]x,
// hence
//   w = G axl(dF R^T - R dF^T),   axl [a]x = a,
// with G = (tr(B) I - B)^-1, whose eigenvalues are 1/(s_i + s_j) for the signed singular values s. For
// dF = dx_b g_b^T and h = R g: axl(dx_b h_b^T - h_b dx_b^T) = h_b x dx_b, and
// dR g_a = w x h_a = -[h_a]x w. So
//
//   K_ab = V ( 2 mu (g_a . g_b) I + lambda h_a h_b^T + [h_a]x C [h_b]x ),   C = c G.
//
// In the basis U (.) V^T of the singular vectors dP/dF has the eigenvalues 2 mu + 3 lambda (along R), 2 mu
// five times (the other stretches and the flips, where dR = 0), and for the three twists U [e_k]x V^T
//
//   2 mu - 2 c/(s_i + s_j)   =   2 (mu - eigenvalue of C)
//
// (Smith, de Goes, Kim 2019, with a lambda that does not mix into the twists, because
// tr(R^T U [e_k]x V^T) = 0).
//
// As 2 mu + 3 lambda = E/(1 - 2 nu) > 0, the nearest positive semi-definite matrix has min(C, mu I) in C's
// eigenbasis. As [h_a]x [h_b]x = h_b h_a^T - (h_a . h_b) I, C = mu I gives R K_linear R^T, the warped
// tangent of Mueller and Gross (2004). The three tangents are one formula with three matrices C:
//
//   exact: C = c G        projected: C = min(c G, mu I)        warped: C = mu I       (all equal at S = I).

/// Lower limit of the sum of two signed singular values in the exact tangent: R is discontinuous where the
/// sum is zero.
inline constexpr double kSmallestSum = 1e-4;

/// Returns the matrix C [Pa] of a tangent. `clamped` is set where kSmallestSum was used.
Mat3 rotation_coupling(Tangent tangent, const Mat3& F, const Mat3& R, const Lame& lame, bool& clamped);

/// K += scale V dP/dF in blocks. `gradients` has rows g_a; C is from rotation_coupling().
void add_elastic_blocks(const Mat3& gradients, const Mat3& R, const Mat3& C, const Lame& lame, double scale,
                        ElementBlocks& K);

/// Returns dP for a direction dF, with the tangent given by C.
Mat3 elastic_stress_change(const Mat3& dF, const Mat3& R, const Mat3& C, const Lame& lame);

}  // namespace palpate::fem
