#pragma once
#include <cstdint>

#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// y' = f(t, y) with its Newton matrix, as an adapter of SUNDIALS sees it: the one thing between a System and
/// the library. The adapters know no mechanics and the mechanics no SUNDIALS; a dense test equation fits as
/// well as a soft body.
class OdeProblem {
 public:
  /// What of f is asked for.  f = implicit + explicit = slow + fast.
  enum class Side { kAll, kImplicit, kExplicit, kSlow, kFast };

  virtual ~OdeProblem() = default;
  virtual int size() const = 0;
  /// Grows when y changes its size or meaning: what was allocated for another version is stale.
  virtual std::uint64_t version() const = 0;

  virtual double time() const = 0;
  virtual void set_time(double t) = 0;  ///< where nothing is to be integrated
  /// y now.
  virtual void load(double* y) const = 0;
  /// y becomes the present, at time t.
  virtual void store(double t, const double* y) = 0;
  /// A trial y as q and u of the outside.
  virtual void finish(double t, const double* y, VecX& q, VecX& u) const = 0;
  virtual bool has_manifold() const { return false; }
  virtual void project(double* /*y*/) const {}
  /// Weights of the norm sqrt(mean (w_i e_i)^2): 1 is the tolerance.
  virtual void weights(const double* y, double* w) const = 0;

  /// False when an entry is not finite.
  virtual bool derivative(double t, const double* y, double* y_dot, Side side) = 0;
  /// Evaluates J = df/dy of one side at (t, y); no factor yet.
  virtual void evaluate_tangent(double t, const double* y, Side side) = 0;
  /// Factor of I - gamma J; nothing is done where there is one already.
  virtual dynamics::SolveStatus factor(double gamma) = 0;
  virtual double gamma() const = 0;  ///< of the factor; 0 without one
  /// Asks for a positive semi-definite tangent from now on, where there is one (true), or for the true one
  /// (false).
  virtual void project_to_psd(bool) {}
  /// Solutions d of what follows may err by `error` in the norm of the weights w, where the linear solver has
  /// a use for that (takes_error_limit).
  virtual void limit_error(const double* /*w*/, double /*error*/) {}
  virtual bool takes_error_limit() const { return false; }
  /// (I - gamma J) d = r.  d may not be r.
  virtual dynamics::SolveStatus solve(const double* y, const double* r, double* d) = 0;

  /// Residual form F(t, y, y') = 0, for which no mass has to be inverted: 0 where y' = f(t, y).
  virtual bool residual(double t, const double* y, const double* y_dot, double* r) = 0;
  /// (dF/dy + c dF/dy') d = r with c = 1 / gamma().
  virtual dynamics::SolveStatus solve_residual(const double* y, const double* r, double* d) = 0;

  /// Functions that change sign where f has a kink.
  virtual int event_count() const { return 0; }
  /// grows when they are other functions than before
  virtual std::uint64_t events_version() const { return 0; }
  virtual void events(double /*t*/, const double* /*y*/, double* /*g*/) {}

  /// For traces: the entry of u that entry i of y belongs to (-1: none), and what is inside out at y.
  virtual int dof_of(int /*i*/) const { return -1; }
  virtual std::pair<dynamics::Diagnostic, std::string> inspect(double /*t*/, const double* /*y*/) {
    return {};
  }

  virtual dynamics::StepperCounters& counters() = 0;
  /// Brings the linear solver's counts into counters().
  virtual void collect_solver_counters() {}
};

/// An adapter of SUNDIALS over any problem; spec.name as in the registry.  @throws Error for a method that is
/// none of SUNDIALS'
std::unique_ptr<dynamics::Stepper> make_ode_stepper(std::unique_ptr<OdeProblem> problem,
                                                    const IntegratorSpec& spec);

}  // namespace palpate::integrate
