#pragma once
#include <memory>
#include <string>

#include "palpate/core/registry.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/spec.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

class System;

enum class StepStatus { kOk, kNewtonFailed, kErrorTestFailed, kSolverFailed, kNotFinite, kTooManySteps, kBadSettings };
const char* to_string(StepStatus status);

/// Numerical outcomes are data: the loop decides what to do with them.
struct StepResult {
  StepStatus status = StepStatus::kOk;
  double t = 0.0;         ///< time reached [s]
  double h = 0.0;         ///< last step [s]
  int order = 0;          ///< order used in it
  int iterations = 0;     ///< Newton iterations in it
  double residual = 0.0;  ///< of the nonlinear solve, in the method's norm
  std::string message;    ///< on failure: the library's flag name, time and step
  bool ok() const { return status == StepStatus::kOk; }
};

enum class ReinitReason { kContactRefreshed, kStateChanged, kLayoutChanged, kParametersChanged };

struct StepperCounters {
  long steps = 0, rejected = 0;
  long error_test_failures = 0, newton_failures = 0, newton_iterations = 0;
  long force_evaluations = 0, tangent_evaluations = 0;
  long reinits = 0;
  long indefinite = 0;  ///< factorisations that met an indefinite matrix and fell back
  double force_s = 0.0, tangent_s = 0.0;  ///< wall time [s]
  SolverCounters solver;
};

/// Advances a System's State in time.
class Stepper {
 public:
  virtual ~Stepper() = default;
  virtual std::string name() const = 0;
  /// Steps until exactly t_end (> state time); on success the State's time is t_end.  On failure the State holds the last good step.
  virtual StepResult advance_to(double t_end) = 0;
  /// q and u at a time within the last step (or between the last two outputs), by the method's own interpolant.  False where t is outside.
  virtual bool dense_output(double t, VecX& q, VecX& u) const = 0;
  /// The right-hand side or the State was changed from outside: forget history.
  virtual void reinit(ReinitReason reason) = 0;
  virtual const StepperCounters& counters() const = 0;
};

using MakeStepper = std::unique_ptr<Stepper> (*)(System&, State&, const IntegratorSpec&, std::unique_ptr<LinearSolver>);
using StepperRegistry = Registry<MakeStepper>;

}  // namespace palpate::dynamics
