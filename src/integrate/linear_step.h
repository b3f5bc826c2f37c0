#pragma once
#include <string_view>

#include "palpate/core/types.h"

namespace palpate::integrate {

/// Returns one fixed step of a SUNDIALS method on  y' = A y  as a matrix, R(Z) with Z = H A, computed from
/// the method's table alone. For a Runge-Kutta method (A, b) with stages Y:
///     Y = 1 y0 + (A x Z) Y,    y1 = y0 + (b^T x Z) Y;
/// for an additive pair this is the implicit half, and for a multi-rate method the slow side, with zero on
/// the other side.
/// @throws Error for a method without a table, or a Z that is not square
MatX linear_step(std::string_view method, const MatX& Z);

/// Returns the same with both sides: Z of the implicit or slow one, `other` of the explicit or fast one. The
/// fast side is integrated exactly between the slow stages.
/// @throws Error for a method that is neither additive nor multi-rate, or matrices of different sizes
MatX split_step(std::string_view method, const MatX& Z, const MatX& other);

}  // namespace palpate::integrate
