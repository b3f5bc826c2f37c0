#pragma once
#include <functional>
#include <limits>

#include "integrate/registry_test_name.h"
#include "palpate/dynamics/system.h"
#include "palpate/integrate/integrators.h"

/// Small systems with known motion, for tests of integrators without elements and contact.
namespace palpate::fakes {

using namespace dynamics;

/// f = -K (q - q0) - D u over the node blocks, all nodes coupled; optionally unsymmetric, or NaN from a given
/// time on.
struct LinearTerm final : ForceTerm {
  MatX K, D;
  VecX q0;
  bool symmetric = true;
  double nan_from = std::numeric_limits<double>::infinity();
  long forces = 0, tangents = 0;

  LinearTerm(MatX k, MatX d, VecX rest) : K(std::move(k)), D(std::move(d)), q0(std::move(rest)) {}
  std::string_view name() const override { return "linear"; }
  TermTraits traits() const override { return {.symmetric_tangent = symmetric, .conservative = true}; }
  void add_pattern(PatternBuilder& pattern) const override {
    std::vector<int> all(static_cast<std::size_t>(K.rows() / 3));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    pattern.add_clique(all.data(), static_cast<int>(all.size()));
  }
  void add_force(const StateView& s, VecX& f) override {
    ++forces;
    f.head(K.rows()) -= K * (s.q.head(K.rows()) - q0) + D * s.u.head(K.rows());
    if (s.time >= nan_from) f[0] = std::numeric_limits<double>::quiet_NaN();
  }
  void add_tangent(const StateView&, double k, double d, BorderedMatrix& A) override {
    ++tangents;
    for (int i = 0; i < K.rows() / 3; ++i)
      for (int j = 0; j < K.rows() / 3; ++j)
        A.body.add(A.body.slot(i, j), k * K.block<3, 3>(3 * i, 3 * j) + d * D.block<3, 3>(3 * i, 3 * j));
  }
  void apply_tangent(const StateView&, double k, double d, const VecX& x, VecX& y) override {
    y.head(K.rows()) += k * (K * x.head(K.rows())) + d * (D * x.head(K.rows()));
  }
  double energy(const StateView& s) override {
    const VecX e = s.q.head(K.rows()) - q0;
    return 0.5 * e.dot(K * e);
  }
};

/// Any mass matrix over the nodes.
struct NodalMass final : InertiaTerm {
  int block;
  MatX M;
  NodalMass(int b, MatX m) : block(b), M(std::move(m)) {}
  int block_id() const override { return block; }
  bool diagonal() const override { return M.isDiagonal(); }
  void add_pattern(PatternBuilder& pattern) const override {
    for (int i = 0; i < M.rows() / 3; ++i)
      for (int j = 0; j < i; ++j)
        if (!M.block<3, 3>(3 * i, 3 * j).isZero()) pattern.add_pair(i, j);
  }
  void add_mass(const StateView&, double scale, BorderedMatrix& A) const override {
    for (int i = 0; i < M.rows() / 3; ++i)
      for (int j = 0; j < M.rows() / 3; ++j)
        if (const int s = A.body.slot(i, j); s >= 0) A.body.add(s, scale * M.block<3, 3>(3 * i, 3 * j));
  }
  void apply(const StateView&, const VecX& x, VecX& y) const override {
    y.head(M.rows()) += M * x.head(M.rows());
  }
};

/// Directions prescribed as functions of time.
struct Scripted final : DrivenMotion {
  std::vector<int> indices;
  std::function<void(double t, VecX& x, VecX& v, VecX& a)> motion;
  Scripted(std::vector<int> i, std::function<void(double, VecX&, VecX&, VecX&)> m)
      : indices(std::move(i)), motion(std::move(m)) {}
  const std::vector<int>& dofs() const override { return indices; }
  void evaluate(const StateView& s, VecX& x, VecX& v, VecX& a) const override { motion(s.time, x, v, a); }
};

/// Stiffness of a chain of `nodes` equal masses along x, with springs k between neighbours and from the first
/// to a wall, in x; each node is held by k in y and z.
inline MatX chain_stiffness(int nodes, double k) {
  MatX K = MatX::Zero(3 * nodes, 3 * nodes);
  for (int i = 0; i < nodes; ++i) {
    K(3 * i, 3 * i) += k;
    if (i + 1 < nodes) {
      K(3 * i, 3 * i) += k;
      K(3 * i, 3 * i + 3) -= k;
      K(3 * i + 3, 3 * i) -= k;
    }
    K(3 * i + 1, 3 * i + 1) = K(3 * i + 2, 3 * i + 2) = k;
  }
  return K;
}

/// Undamped chain with unit masses; omega_j = 2 sqrt(k) sin((2j - 1) pi / (4n + 2)), phi_i = sin(i (2j - 1)
/// pi / (2n + 1)) (fixed at one end, free at the other).
struct Chain {
  int nodes = 4;
  double k = 100.0;
  State state;
  System system;
  std::shared_ptr<LinearTerm> term;
  int block = -1;

  explicit Chain(double damping = 0.0, double stiffness = 100.0) : k(stiffness) {
    BlockSpec spec;
    spec.name = "chain";
    spec.q_size = spec.u_size = 3 * nodes;
    const VecX rest = VecX::LinSpaced(3 * nodes, 0.0, 1.0);
    block = state.insert(spec, rest, VecX::Zero(3 * nodes));
    const MatX K = chain_stiffness(nodes, k);
    term = std::make_shared<LinearTerm>(K, damping * K, rest);
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(block, MatX::Identity(3 * nodes, 3 * nodes)));
    system.prepare(state.view());
  }
  double omega() const { return 2.0 * std::sqrt(k) * std::sin(M_PI / (4 * nodes + 2)); }
  VecX mode() const {
    VecX phi = VecX::Zero(3 * nodes);
    for (int i = 0; i < nodes; ++i) phi[3 * i] = std::sin((i + 1) * M_PI / (2 * nodes + 1));
    return phi;
  }
  void start_in_mode(double amplitude) {
    state.q() = term->q0 + amplitude * mode();
    state.u().setZero();
  }
};

/// Runs an integrator to t_end and returns its State's q.
inline VecX run(System& system, State& state, const IntegratorSpec& spec, double t_end) {
  const auto stepper = integrate::make_stepper(system, state, spec);
  const StepResult result = stepper->advance_to(t_end);
  if (!result.ok()) fail("{}", result.message);
  return state.q();
}

/// Modes of a conformance suite: every integrator of the registry, and those that support both again with a
/// fixed step ("ark-erk-3, fixed step").
inline constexpr const char* kFixedStep = ", fixed step";
inline std::vector<std::string> stepper_modes(bool dynamic_only = true) {
  std::vector<std::string> out;
  for (const auto& entry : integrate::stepper_registry()) {
    if (dynamic_only && entry.traits.stability == Stability::kStatic) continue;
    out.push_back(entry.name);
    if (entry.traits.control == StepControl::kEither) out.push_back(entry.name + kFixedStep);
  }
  return out;
}
inline IntegratorSpec mode_spec(const std::string& mode) {
  IntegratorSpec spec;
  spec.fixed_step = mode.ends_with(kFixedStep);
  spec.name = spec.fixed_step ? mode.substr(0, mode.size() - std::string(kFixedStep).size()) : mode;
  spec.newton_rtol = 1e-11;                                // below the error of the finest step of order 5
  if (spec.name.starts_with("ark-mri")) spec.rtol = 1e-8;  // tolerance of the fast side
  return spec;
}
inline const StepperTraits& mode_traits(const std::string& mode) {
  return find(integrate::stepper_registry(), mode_spec(mode).name, "integrator").traits;
}
inline bool is_explicit(const std::string& mode) { return !mode_traits(mode).implicit; }
/// Returns whether a step, rather than a tolerance, determines the accuracy.
inline bool steps_are_fixed(const std::string& mode) {
  return mode_traits(mode).control == StepControl::kFixed || mode_spec(mode).fixed_step;
}
/// Order observed over a sequence of steps; 0 for a method controlled by tolerances.
inline int ladder_order(const std::string& mode) {
  return steps_are_fixed(mode) ? mode_traits(mode).order : 0;
}

/// Sets the parameter refined by a sequence: the step of a method with known order, else the tolerance.
inline void set_accuracy(IntegratorSpec& spec, int order, double value) {
  (order > 0 ? spec.step_s : spec.rtol) = value;
}

inline double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::ArrayXd lx = Eigen::Map<const Eigen::ArrayXd>(x.data(), n).log(),
                       ly = Eigen::Map<const Eigen::ArrayXd>(y.data(), n).log();
  return ((lx - lx.mean()) * (ly - ly.mean())).sum() / (lx - lx.mean()).square().sum();
}

/// Settings of a refinement sequence over which the error must decrease with the theoretical slope, and the
/// band of that slope. Fixed steps: the order; w h is small enough for the next error term to stay below a
/// tenth, and large enough for the error of a high-order method to stay above rounding. Tolerances: for
/// variable order k/(k+1) to 1, with k from 2 to 5 along the sequence; for a single order 1. Low orders skip
/// the tightest levels.
struct Ladder {
  std::vector<double> values;
  double low, high;
};
/// @param T  time between two outputs: a whole number of steps, because a shortened last step would distort
/// the slope
inline Ladder ladder(const std::string& mode, double omega, double T) {
  const int order = mode_traits(mode).order;
  if (steps_are_fixed(mode)) {
    const double coarsest = (order == 1   ? 1e-3
                             : order == 2 ? 0.02
                             : order == 3 ? 0.008
                             : order == 4 ? 0.06
                                          : 0.045) /
                            omega;
    const double ratio = order <= 2 ? 2.0 : order == 3 ? 1.4 : order == 4 ? 1.5 : 1.25;
    Ladder l{{}, order - 0.1, order + 0.1};
    for (double h = coarsest; l.values.size() < 4; h /= ratio) l.values.push_back(T / std::ceil(T / h));
    return l;
  }
  if (order <= 2) return {{1e-3, 1e-4, 1e-5, 1e-6}, 0.8, 1.2};
  return {{1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}, 0.6, 1.2};
}

}  // namespace palpate::fakes
