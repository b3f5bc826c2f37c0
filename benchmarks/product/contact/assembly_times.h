#pragma once
#include <memory>

#include "dynamics/mixed_precision_step.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/loop/world.h"

namespace palpate::bench {

/// Times what a linearly implicit step assembles: forces and tangent of all contact samples, against those of
/// all elements of the first body, both in one pass and as the mixed-precision step takes them.
class AssemblyTimes {
 public:
  explicit AssemblyTimes(loop::World& world);

  double elements_ms();  ///< at the World's present state
  double contact_ms();   ///< 0 where the contact's tangent does not stand beside the pattern

 private:
  loop::World& world_;
  std::unique_ptr<dynamics::LinearSolver> solver_;
  dynamics::BlockSparse pattern_;
  dynamics::ZeroRowSumMatrix* elements_ = nullptr;
  dynamics::PointStiffness points_;
  VecX shift_, force_;
};

}  // namespace palpate::bench
