#pragma once
#include <cstdint>

#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// Ordinary differential equation y' = f(t, y) with its Newton matrix, in the form used by the SUNDIALS
/// adapters. It is the only interface between a System and the library: adapters contain no mechanics,
/// mechanics no SUNDIALS. A dense test equation can be used in place of a soft body.
class OdeProblem {
 public:
  /// Part of f to be evaluated. f = implicit + explicit = slow + fast.
  enum class Side { kAll, kImplicit, kExplicit, kSlow, kFast };

  virtual ~OdeProblem() = default;
  /// Returns the number of entries of y.
  virtual int size() const = 0;
  /// Increases when y changes its size or meaning: memory allocated for another version is stale.
  virtual std::uint64_t version() const = 0;

  /// Returns the current time [s].
  virtual double time() const = 0;
  virtual void set_time(double t) = 0;  ///< Sets the time where there is nothing to integrate.
  /// Copies the current state to y.
  virtual void load(double* y) const = 0;
  /// Makes y the current state, at time t.
  virtual void store(double t, const double* y) = 0;
  /// Converts a trial y to q and u, on the manifold and with exact driven values.
  virtual void finish(double t, const double* y, VecX& q, VecX& u) const = 0;
  /// Returns whether project() changes y (unit quaternions).
  virtual bool has_manifold() const { return false; }
  /// Projects y onto its manifold.
  virtual void project(double* /*y*/) const {}
  /// Computes the weights of the norm sqrt(mean (w_i e_i)^2), in which 1 is the tolerance.
  virtual void weights(const double* y, double* w) const = 0;

  /// Computes y' of one side; returns false when an entry is not finite.
  virtual bool derivative(double t, const double* y, double* y_dot, Side side) = 0;
  /// Evaluates J = df/dy of one side at (t, y), without a factorisation.
  virtual void evaluate_tangent(double t, const double* y, Side side) = 0;
  /// Factors I - gamma J; does nothing where that factor exists already.
  virtual dynamics::SolveStatus factor(double gamma) = 0;
  virtual double gamma() const = 0;  ///< Returns gamma of the factor; 0 without one.
  /// Switches to positive semi-definite tangents, where they are supported (true), or back to the true ones
  /// (false).
  virtual void project_to_psd(bool) {}
  /// Allows solutions d of later solves an error of `error` in the norm of the weights w, where the linear
  /// solver supports it (takes_error_limit).
  virtual void limit_error(const double* /*w*/, double /*error*/) {}
  /// Returns whether limit_error() has an effect.
  virtual bool takes_error_limit() const { return false; }
  /// Solves (I - gamma J) d = r. d must not alias r.
  virtual dynamics::SolveStatus solve(const double* y, const double* r, double* d) = 0;

  /// Evaluates the residual form F(t, y, y') = 0, which needs no inverse of the mass: 0 where y' = f(t, y).
  /// Returns false when an entry is not finite.
  virtual bool residual(double t, const double* y, const double* y_dot, double* r) = 0;
  /// Solves (dF/dy + c dF/dy') d = r with c = 1 / gamma().
  virtual dynamics::SolveStatus solve_residual(const double* y, const double* r, double* d) = 0;

  /// Returns the number of functions that change sign where f has a kink.
  virtual int event_count() const { return 0; }
  /// Increases when the functions change.
  virtual std::uint64_t events_version() const { return 0; }
  /// Evaluates these functions; g receives event_count() values.
  virtual void events(double /*t*/, const double* /*y*/, double* /*g*/) {}

  /// Returns the entry of u that entry i of y belongs to (-1: none); for traces.
  virtual int dof_of(int /*i*/) const { return -1; }
  /// Returns the most inverted element at y and its term; for traces.
  virtual std::pair<dynamics::Diagnostic, std::string> inspect(double /*t*/, const double* /*y*/) {
    return {};
  }

  virtual dynamics::StepperCounters& counters() = 0;
  /// Adds the linear solver's counts to counters().
  virtual void collect_solver_counters() {}
};

/// Makes a SUNDIALS adapter for any problem; spec.name as in the registry. @throws Error for a method that is
/// not one of SUNDIALS
std::unique_ptr<dynamics::Stepper> make_ode_stepper(std::unique_ptr<OdeProblem> problem,
                                                    const IntegratorSpec& spec);

}  // namespace palpate::integrate
