#pragma once
#include "palpate/dynamics/linear_solver.h"

namespace palpate::integrate {

/// Adds what another solver did to the sum of one that hands matrices on to it.  The ordering stays the sum's
/// own.
inline void add_counters(const dynamics::SolverCounters& other, dynamics::SolverCounters& sum) {
  sum.symbolic += other.symbolic;
  sum.orderings += other.orderings;
  sum.factorisations += other.factorisations;
  sum.solves += other.solves;
  sum.iterations += other.iterations;
  sum.near += other.near;
  sum.residuals += other.residuals;
  sum.refreshes += other.refreshes;
  sum.symbolic_s += other.symbolic_s;
  sum.factor_s += other.factor_s;
  sum.solve_s += other.solve_s;
}

}  // namespace palpate::integrate
