#pragma once
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: part of its force is too nonlinear for one linear solve per step
/// (friction between sticking and sliding). Between begin_step() and end_step() forces and tangents of that
/// part are affine about a guess of the step's end. The first guess is the start of the step; each solve
/// improves it. A class inherits it in addition to ForceTerm.
class RepeatedStepTerm {
 public:
  virtual ~RepeatedStepTerm() = default;
  /// Returns whether that part acts at a state and the acceleration there does not predict the step that
  /// begins: at rest friction is zero by its law, and the full mu N as soon as there is motion.
  virtual bool has_onset_at(const StateView& state) = 0;
  /// Starts the solves of one step from a state that is the same for all of them. Returns false where one
  /// solve is sufficient; end_step() is then not called.
  virtual bool begin_step(const StateView& state) = 0;
  /// Takes the end of the step found by a solve as the next guess.
  /// @param state  start of the step
  /// @param moved  displacement over the step, along u-directions
  /// @param change  change of the velocity over the step
  /// @return  whether the affine part is within its tolerance of the true one at that end, or no further
  ///   solve is worth its cost
  virtual bool improve_step(const StateView& state, const VecX& moved, const VecX& change) = 0;
  /// Restores the forces and tangents of the law.
  virtual void end_step() = 0;
};

}  // namespace palpate::dynamics
