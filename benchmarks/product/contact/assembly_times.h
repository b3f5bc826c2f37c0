#pragma once
#include <memory>

#include "dynamics/mixed_precision_step.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/loop/world.h"

namespace palpate::bench {

/// Times the assembly of a linearly implicit step: forces and tangent of all contact samples, and of all
/// elements of the first body, both in one pass and in the form used by the mixed-precision step.
class AssemblyTimes {
 public:
  explicit AssemblyTimes(loop::World& world);

  double elements_ms();  ///< At the World's present state.
  double contact_ms();   ///< 0 if the contact's tangent cannot be stored outside the pattern.

 private:
  loop::World& world_;
  std::unique_ptr<dynamics::LinearSolver> solver_;
  dynamics::BlockSparse pattern_;
  dynamics::ZeroRowSumMatrix* elements_ = nullptr;
  dynamics::PointStiffness points_;
  dynamics::SparseBorder border_;
  VecX shift_, force_;
};

}  // namespace palpate::bench
