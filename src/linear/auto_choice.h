#pragma once
#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Returns 1 + h^2 tr K / tr M of a step matrix A = M + h^2 K: the square of a Courant-type number
/// (derivation at its definition). Rows of held nodes and of their neighbours are left out; large matrices
/// are sampled.
double squared_courant_number(const dynamics::BlockSparse& A);
/// Returns whether "pcg-two-level" solves systems with such a matrix faster than "pcg-single".
/// @param courant_squared  As returned by squared_courant_number().
bool prefers_two_level(double courant_squared);
/// Builds the solver "auto", which chooses by prefers_two_level(). @throws Error for settings out of range
std::unique_ptr<dynamics::LinearSolver> make_auto(const IntegratorSpec& spec);

}  // namespace palpate::linear
