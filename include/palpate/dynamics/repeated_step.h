#pragma once
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: part of its force bends too sharply for one linear solve a step
/// (friction between sticking and sliding).  Between begin_step() and end_step() forces and tangents of that
/// part are affine about a guess of the step's end, first its start, which each solve improves.  A class
/// derives from it beside ForceTerm.
class RepeatedStepTerm {
 public:
  virtual ~RepeatedStepTerm() = default;
  /// Whether that part acts at a state, and an acceleration there says nothing of the step that begins: at
  /// rest friction is zero by the law, and a whole mu N as soon as something moves.
  virtual bool bends_at(const StateView& state) = 0;
  /// From a state that stays the same for all solves of the step.  False: one solve serves, and there is
  /// nothing to end.
  virtual bool begin_step(const StateView& state) = 0;
  /// Takes the end that a solve found for the next guess.
  /// @param state  where the step begins
  /// @param moved   displacement over the step, along u-directions  @param change  that of the velocity
  /// @return  whether the part that was taken as affine is within its tolerance of what it is at that end, or
  ///          no further solve is worth its cost
  virtual bool improve_step(const StateView& state, const VecX& moved, const VecX& change) = 0;
  /// Forces and tangents are the law's again.
  virtual void end_step() = 0;
};

}  // namespace palpate::dynamics
