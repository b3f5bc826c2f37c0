#pragma once
#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// 1 + h^2 tr K / tr M of a step matrix M + h^2 K, read from its rows; held nodes apart.
double squared_courant_number(const dynamics::BlockSparse& A);
/// Returns whether "pcg-two-level" solves with such a matrix sooner than "pcg-single" does.
/// @param courant_squared  as squared_courant_number()
bool prefers_two_level(double courant_squared);
std::unique_ptr<dynamics::LinearSolver> make_auto(const IntegratorSpec& spec);

}  // namespace palpate::linear
