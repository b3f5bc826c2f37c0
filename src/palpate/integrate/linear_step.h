#pragma once
#include <string_view>

#include "palpate/core/types.h"

namespace palpate::integrate {

/// One fixed step of a method of SUNDIALS on  y' = A y  as a matrix, R(Z) of Z = H A, from the method's table
/// alone.  Of a Runge-Kutta method (A, b) with stages Y:
///     Y = 1 y0 + (A x Z) Y,    y1 = y0 + (b^T x Z) Y;
/// of an additive pair the implicit half, and of a multi-rate method the slow side, with nothing on the
/// other.
/// @throws Error for a method that is not one of these, or a Z that is not square
MatX linear_step(std::string_view method, const MatX& Z);

/// The same with both sides: Z of the implicit or slow one, `other` of the explicit or fast one, the fast
/// side integrated exactly between the slow stages.
/// @throws Error for a method that is neither additive nor multi-rate, or matrices that do not fit
MatX split_step(std::string_view method, const MatX& Z, const MatX& other);

}  // namespace palpate::integrate
