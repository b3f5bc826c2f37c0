#pragma once
#include "integrate/condensed_newton.h"
#include "integrate/ode_problem.h"

namespace palpate::integrate {

/// Formulates a System as y' = f(t, y), y = [q; u], f = [N(q) u; M^-1 (sum of forces)].
/// Driven directions keep their places in y with y' = 0 and are never read: before every evaluation the
/// System writes their exact values into a copy. So a drive costs neither accuracy nor steps, and its jumps
/// do not enter the history of a multistep method.
///
/// Splits, by the TermTraits of the force terms:
///     implicit   stiff terms and q' = N u
///     explicit   all other terms; with explicit_side = "contact" contact as well
///     slow       all other terms and q' = u of node blocks
///     fast       contact, terms declared as fast (a virtual coupling), and q' = N u of rigid blocks
/// Accelerations of driven directions belong to the implicit and to the slow side.
class MechanicalProblem final : public OdeProblem {
 public:
  /// @param solver  null for an explicit method: nothing is factored
  MechanicalProblem(dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec,
                    std::unique_ptr<dynamics::LinearSolver> solver);

  int size() const override { return layout().q_size + layout().u_size; }
  std::uint64_t version() const override { return layout().version; }
  double time() const override { return state_.time(); }
  void set_time(double t) override { state_.set_time(t); }
  void load(double* y) const override;
  void store(double t, const double* y) override;
  void finish(double t, const double* y, VecX& q, VecX& u) const override;
  bool has_manifold() const override;
  void project(double* y) const override { dynamics::project(layout(), y); }
  void weights(const double* y, double* w) const override;
  bool derivative(double t, const double* y, double* y_dot, Side side) override;
  void evaluate_tangent(double t, const double* y, Side side) override;
  dynamics::SolveStatus factor(double gamma) override { return newton_->factor(gamma); }
  double gamma() const override { return newton_->gamma(); }
  bool takes_error_limit() const override { return newton_ && newton_->takes_error_limit(); }
  void limit_error(const double* w, double error) override { newton_->limit_error(layout(), w, error); }
  void project_to_psd(bool on) override { system_.project_to_psd(on); }
  dynamics::SolveStatus solve(const double* y, const double* r, double* d) override;
  bool residual(double t, const double* y, const double* y_dot, double* r) override;
  dynamics::SolveStatus solve_residual(const double* y, const double* r, double* d) override;
  int event_count() const override { return system_.event_count(); }
  std::uint64_t events_version() const override { return system_.events_version(); }
  void events(double t, const double* y, double* g) override;
  int dof_of(int i) const override;
  std::pair<dynamics::Diagnostic, std::string> inspect(double t, const double* y) override;
  dynamics::StepperCounters& counters() override { return counters_; }
  void collect_solver_counters() override;

 private:
  const dynamics::Layout& layout() const { return state_.layout(); }
  dynamics::StateView view(double t, const double* y);
  dynamics::System::TermFilter filter(Side side) const;
  void rates(Side side, const dynamics::StateView& at, double* q_dot) const;

  dynamics::System& system_;
  dynamics::State& state_;
  IntegratorSpec spec_;
  long clamped_before_;
  std::unique_ptr<CondensedNewton> newton_;
  Side tangent_side_ = Side::kAll;
  dynamics::StepperCounters counters_;
  VecX imposed_, force_, acceleration_, driven_part_;
};

}  // namespace palpate::integrate
