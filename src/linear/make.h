#pragma once
#include <memory>

#include "palpate/dynamics/linear_solver.h"

/// Factory functions of the solvers that registry.cpp lists.
namespace palpate::linear {

std::unique_ptr<dynamics::LinearSolver> make_cholmod(const IntegratorSpec&);
std::unique_ptr<dynamics::LinearSolver> make_umfpack(const IntegratorSpec&);
std::unique_ptr<dynamics::LinearSolver> make_gmres(const IntegratorSpec&);
std::unique_ptr<dynamics::LinearSolver> make_pcg(const IntegratorSpec&);
std::unique_ptr<dynamics::LinearSolver> make_pcg_single(const IntegratorSpec&);
std::unique_ptr<dynamics::LinearSolver> make_pcg_two_level(const IntegratorSpec&);

}  // namespace palpate::linear
