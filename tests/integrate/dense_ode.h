#pragma once
#include <Eigen/LU>
#include <functional>

#include "integrate/ode_problem.h"

/// A small equation in the place of a System, with a dense solver: tests the adapters in isolation.
namespace palpate::fakes {

using dynamics::SolveStatus;
using integrate::OdeProblem;

/// y' = f(y), or y' = f(y) + g(y) with g on the explicit side of an additive method; the Jacobian is f's.
struct Equation {
  std::function<void(const VecX& y, VecX& f)> f;
  std::function<void(const VecX& y, MatX& J)> jacobian;
  VecX y0;
  VecX scale;  ///< magnitudes of the components for error control
  std::function<void(const VecX& y, VecX& g)> g{};
};

class DenseOde final : public OdeProblem {
 public:
  DenseOde(const Equation& e, double rtol, VecX& y, double& t) : e_(e), rtol_(rtol), y_(y), t_(t) {
    y_ = e.y0;
    t_ = 0.0;
  }
  int size() const override { return static_cast<int>(e_.y0.size()); }
  std::uint64_t version() const override { return 1; }
  double time() const override { return t_; }
  void set_time(double t) override { t_ = t; }
  void load(double* y) const override { Eigen::Map<VecX>(y, size()) = y_; }
  void store(double t, const double* y) override {
    y_ = Eigen::Map<const VecX>(y, size());
    t_ = t;
  }
  void finish(double, const double* y, VecX& q, VecX&) const override {
    q = Eigen::Map<const VecX>(y, size());
  }
  void weights(const double* y, double* w) const override {
    for (int i = 0; i < size(); ++i) w[i] = 1.0 / (rtol_ * (std::abs(y[i]) + 1e-3 * e_.scale[i]));
  }
  bool derivative(double, const double* y, double* y_dot, Side side) override {
    const VecX at = Eigen::Map<const VecX>(y, size());
    VecX f = VecX::Zero(size()), g = f;
    if (side != Side::kExplicit) e_.f(at, f);
    if (e_.g && side != Side::kImplicit) e_.g(at, g);
    f += g;
    Eigen::Map<VecX>(y_dot, size()) = f;
    ++counters_.force_evaluations;
    return f.allFinite();
  }
  void evaluate_tangent(double, const double* y, Side) override {
    J_.setZero(size(), size());
    e_.jacobian(Eigen::Map<const VecX>(y, size()), J_);
    gamma_ = 0.0;
  }
  SolveStatus factor(double gamma) override {
    if (gamma != gamma_) lu_.compute(MatX::Identity(size(), size()) - gamma * J_);
    gamma_ = gamma;
    return SolveStatus::kOk;
  }
  double gamma() const override { return gamma_; }
  SolveStatus solve(const double*, const double* r, double* d) override {
    Eigen::Map<VecX>(d, size()) = lu_.solve(Eigen::Map<const VecX>(r, size()));
    return SolveStatus::kOk;
  }
  bool residual(double t, const double* y, const double* y_dot, double* r) override {
    VecX f(size());
    const bool finite = derivative(t, y, f.data(), Side::kAll);
    Eigen::Map<VecX>(r, size()) = Eigen::Map<const VecX>(y_dot, size()) - f;
    return finite;
  }
  /// (c I - J) d = r with c = 1 / gamma: d = gamma (I - gamma J)^-1 r.
  SolveStatus solve_residual(const double*, const double* r, double* d) override {
    Eigen::Map<VecX>(d, size()) = gamma_ * lu_.solve(Eigen::Map<const VecX>(r, size()));
    return SolveStatus::kOk;
  }
  dynamics::StepperCounters& counters() override { return counters_; }

 private:
  const Equation& e_;
  double rtol_;
  VecX& y_;
  double& t_;
  MatX J_;
  Eigen::PartialPivLU<MatX> lu_;
  double gamma_ = 0.0;
  dynamics::StepperCounters counters_;
};

}  // namespace palpate::fakes
