#pragma once
#include <cmath>
#include <vector>

#include "linear_problem.h"
#include "modal_steps.h"

namespace palpate::stability {

/// What a method at fixed steps H makes of a linear problem, mode by mode, by its formula (modal_steps.h).
class PredictedCourse {
 public:
  PredictedCourse(const Column& column, const LinearProblem& problem, double H);
  void advance();  ///< one step
  const LinearProblem::Points2& modes() const { return modes_; }
  double highest() const { return highest_; }  ///< energy over that of the start; infinite once it overflows
  /// Largest |x_n| so far, all modes together, over that of the start: the size that rounding is relative to.
  double size() const { return std::sqrt(highest_); }
  double spectral_radius() const;  ///< the largest of a mode's step

 private:
  const LinearProblem& problem_;
  std::vector<ModalSteps> steps_;
  std::vector<VecX> x_;
  LinearProblem::Points2 modes_;
  bool begun_ = false;
  double highest_ = 1.0;
};

}  // namespace palpate::stability
