#pragma once
#include <cmath>
#include <vector>

#include "linear_problem.h"
#include "modal_steps.h"

namespace palpate::stability {

/// Course of a linear problem under a method at fixed steps H, mode by mode, from its formula
/// (modal_steps.h).
class PredictedCourse {
 public:
  PredictedCourse(const Column& column, const LinearProblem& problem, double H);
  void advance();  ///< Performs one step.
  const LinearProblem::Points2& modes() const { return modes_; }
  /// Returns the highest energy so far over the initial energy; infinite once it overflows.
  double highest() const { return highest_; }
  /// Returns the largest |x_n| so far, all modes together, over the initial one: the size to which rounding
  /// is relative.
  double size() const { return std::sqrt(highest_); }
  double spectral_radius() const;  ///< Largest over the modes' steps.

 private:
  const LinearProblem& problem_;
  std::vector<ModalSteps> steps_;
  std::vector<VecX> x_;
  LinearProblem::Points2 modes_;
  bool begun_ = false;
  double highest_ = 1.0;
};

}  // namespace palpate::stability
