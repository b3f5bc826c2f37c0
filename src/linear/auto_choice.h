#pragma once
#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// 1 + h^2 tr K / tr M of a step matrix M + h^2 K, read from its rows; held nodes apart.
double squared_courant_number(const dynamics::BlockSparse& A);
/// What auto_table.inc holds nearest.
const char* measured_choice(double nodes, double stiffness, double rtol);
std::unique_ptr<dynamics::LinearSolver> make_auto(const IntegratorSpec& spec);

}  // namespace palpate::linear
