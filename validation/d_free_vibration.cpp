#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "cases.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

// M q'' + D q' + K (q - q0) = 0 with K phi_j = w_j^2 M phi_j and D = beta K: every mode is an oscillator of its own,
//     q(t) = q0 + sum_j phi_j e^{-g_j t} (cos v_j t + (g_j/v_j) sin v_j t),   g_j = beta w_j^2/2,  v_j^2 = w_j^2 - g_j^2,
// exact in time, no reference run needed.  K and M are those of a clamped bar of corotational tetrahedra at rest; the eigenvectors come
// from a dense solver of Eigen.  An order is seen only where the method is in its asymptotic range for the modes that it carries
// (VALIDATION, D); the motion starts in the three lowest:
//     order 1: w^2 H T/2 <= 0.2 (the amplitude's damping e^{-w^2 H T/2});   order 2: w H <= 0.3 and w^3 H^2 T/12 <= 0.1 (the phase).
// A tolerance is met by the order 5 in the end, error ~ rtol^{5/6} to rtol.  Undamped, the ladder ends at 1e-6: backward differences of order > 2
// are unstable on the undamped upper modes for all but small steps, there are then as many steps at 1e-8 as at 1e-4, and the error has
// reached what these steps leave.  With damping ratio 0.03 of the lowest mode, beta K damps them and the ladder goes on to 1e-8.

namespace palpate::validation {
namespace {

constexpr int kModes = 3;
constexpr double kDampingRatio = 0.03;  // of the lowest mode, where there is damping

/// f = -s K (q - q0 + beta u) with a constant assembled K: the body at infinitesimal amplitude, so that no rounding hides a small error.
class LinearBody final : public dynamics::ForceTerm {
 public:
  LinearBody(dynamics::BorderedMatrix K, VecX q0, double beta, double scale) : K_(std::move(K)), q0_(std::move(q0)), beta_(beta), scale_(scale) {}
  std::string_view name() const override { return "linear body"; }
  dynamics::TermTraits traits() const override { return {.conservative = true}; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    for (int i = 0; i < K_.body.block_rows(); ++i)
      for (int s = K_.body.row_start()[static_cast<std::size_t>(i)]; s < K_.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
        pattern.add_pair(i, K_.body.columns()[static_cast<std::size_t>(s)]);
  }
  void add_force(const dynamics::StateView& state, VecX& f) override {
    shift_ = state.q - q0_ + beta_ * state.u;
    apply_tangent(state, -1.0, 0.0, shift_, f);
  }
  void add_tangent(const dynamics::StateView&, double k_scale, double d_scale, dynamics::BorderedMatrix& A) override {
    auto& to = A.body.values();  // the only term: the patterns are the same
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += (k_scale + beta_ * d_scale) * scale_ * K_.body.values()[i];
  }
  void apply_tangent(const dynamics::StateView&, double k_scale, double d_scale, const VecX& x, VecX& y) override {
    K_.multiply(x, product_);
    y += (k_scale + beta_ * d_scale) * scale_ * product_;
  }

 private:
  dynamics::BorderedMatrix K_;
  VecX q0_;
  double beta_, scale_;
  VecX shift_, product_;
};

/// The bar, its modes, and its motion.
struct Bar {
  TetMesh rest = mesh::box(Vec3(1.0, 0.3, 0.2), {4, 2, 2});
  fem::Material material;
  VecX q0 = rest.nodes.reshaped(), mass, omega;  ///< nodal masses, one a direction; kModes frequencies [rad/s]
  MatX phi;                                      ///< modes, zero where clamped, largest entry 1
  dynamics::BorderedMatrix K;
  std::vector<int> clamped;

  Bar() {
    material.youngs_modulus = 1e5;
    for (int node : fem::nodes_in_box(rest.nodes, Vec3(-0.5, -1, -1), Vec3(-0.5 + 1e-9, 1, 1)))
      for (int axis = 0; axis < 3; ++axis) clamped.push_back(3 * node + axis);
    mass = fem::lumped_masses(rest, material.density).transpose().replicate(3, 1).reshaped();
    dynamics::State state;
    fem::SoftBody body("bar", rest, material, {}, insert(state, 1.0));
    dynamics::PatternBuilder pattern(state.layout());
    body.add_pattern(pattern);
    K.body = pattern.build();
    body.add_tangent(state.view(), 1.0, 0.0, K);
    K.touch();
    find_modes();
  }

  int insert(dynamics::State& state, double amplitude) const {
    dynamics::BlockSpec spec;
    spec.name = "bar";
    spec.q_size = spec.u_size = static_cast<int>(q0.size());
    spec.q_scale = amplitude;
    spec.u_scale = omega.size() ? amplitude * omega[0] : 1.0;
    return state.insert(spec, q0, VecX::Zero(q0.size()));
  }

  void find_modes() {
    std::vector<int> free;
    for (int i = 0; i < q0.size(); ++i)
      if (!std::binary_search(clamped.begin(), clamped.end(), i)) free.push_back(i);
    const MatX dense = K.to_dense();
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> modes(dense(free, free), MatX(mass(free).asDiagonal()));
    PALPATE_CHECK(modes.info() == Eigen::Success, "no modes");
    omega = modes.eigenvalues().head(kModes).cwiseSqrt();
    phi = MatX::Zero(q0.size(), kModes);
    for (int j = 0; j < kModes; ++j) phi(free, j) = modes.eigenvectors().col(j) / modes.eigenvectors().col(j).lpNorm<Eigen::Infinity>();
  }

  VecX displacement(double t, double beta) const {
    const Eigen::ArrayXd g = 0.5 * beta * omega.array().square(), v = (omega.array().square() - g.square()).sqrt();
    return phi * ((-g * t).exp() * ((v * t).cos() + g / v * (v * t).sin())).matrix();
  }
  double norm(const VecX& d) const { return std::sqrt(d.dot(mass.cwiseProduct(d))); }
};

struct Trial {
  double T;                ///< [s]
  int looks = 1;           ///< times at which the error is taken, the last at T
  double beta = 0.0;       ///< stiffness damping [s]
  double amplitude = 0.0;  ///< 0: the linear body at amplitude 1; else the corotational one
};

/// Mass-weighted relative error of q, RMS over the looks.
double error(const Bar& bar, const IntegratorSpec& spec, const Trial& trial, const std::string& sabotage) {
  dynamics::State state;
  const double a = trial.amplitude > 0.0 ? trial.amplitude : 1.0;
  const int id = bar.insert(state, a);
  state.q() += a * bar.displacement(0.0, trial.beta);
  dynamics::System system;
  if (trial.amplitude > 0.0)
    system.add(std::make_shared<fem::SoftBody>("bar", bar.rest, bar.material, fem::SoftBodyOptions{}, id));
  else
    system.add(std::make_shared<LinearBody>(bar.K, bar.q0, trial.beta, sabotage == "half-stiffness" ? 0.5 : sabotage == "one-percent" ? 1.01 : 1.0));
  system.add(fem::make_lumped_mass(bar.rest, bar.material.density, id));
  system.add(fem::make_fixed(bar.clamped, bar.q0(bar.clamped)));
  system.prepare(state.view());
  const auto stepper = integrate::make_stepper(system, state, spec);
  double sum = 0.0;
  for (int i = 1; i <= trial.looks; ++i) {
    const double t = trial.T * i / trial.looks;
    if (!stepper->advance_to(t).ok()) return std::nan("");
    sum += std::pow(bar.norm((state.q() - bar.q0) / a - bar.displacement(t, trial.beta)) / bar.norm(bar.displacement(0.0, 0.0)), 2);
  }
  return std::sqrt(sum / trial.looks);
}

/// Largest step for which the highest mode that moves is in the asymptotic range.
double coarsest_step(int order, double w, double T) {
  return order == 1 ? 0.4 / (w * w * T) : std::min(0.3 / w, std::sqrt(1.2 / (w * w * w * T)));
}

Measurement order_of_steps(const Bar& bar, IntegratorSpec spec, int order, const std::string& sabotage) {
  const double T = M_PI / bar.omega[0];
  std::vector<double> steps, errors;
  for (int k = 0; k < 4; ++k) {
    spec.step_s = coarsest_step(order, bar.omega[kModes - 1], T) / std::pow(2.0, k);
    steps.push_back(spec.step_s);
    errors.push_back(error(bar, spec, {.T = T}, sabotage));
  }
  return {.quantity = spec.name + ": error at the finest step", .computed = errors.back(), .error = errors.back(), .bar = 0.05,
          .order = study::fitted_order(steps, errors), .order_low = order - 0.1, .order_high = order + 0.1, .note = "order in the step, 4 halvings"};
}

Measurement slope_of_tolerances(const Bar& bar, IntegratorSpec spec, bool damped, const std::string& sabotage) {
  const Trial trial{.T = 4.0 * M_PI / bar.omega[0], .looks = 8, .beta = damped ? 2.0 * kDampingRatio / bar.omega[0] : 0.0};
  const int loosest = 2, tightest = damped ? 8 : 6;
  std::vector<double> tolerances, errors;
  for (int k = loosest; k <= tightest; ++k) {
    spec.rtol = std::pow(10.0, -k);
    tolerances.push_back(spec.rtol);
    if (sabotage == "tolerance-ignored") spec.rtol = std::pow(10.0, -loosest);
    errors.push_back(error(bar, spec, trial, sabotage));
  }
  return {.quantity = fmt::format("{}, {}: error at rtol 1e-{}", spec.name, damped ? "damped" : "undamped", tightest), .computed = errors.back(),
          .error = errors.back(), .bar = damped ? 1e-6 : 1e-5, .order = study::fitted_order(tolerances, errors), .order_low = 0.8, .order_high = 1.2,
          .note = fmt::format("slope of the error against rtol, 1e-{} to 1e-{}", loosest, tightest)};
}

std::vector<Measurement> run(const std::string& sabotage) {
  const Bar bar;
  std::vector<Measurement> out;
  for (const auto& entry : integrate::stepper_registry()) {
    IntegratorSpec spec;
    spec.name = entry.name;
    if (entry.traits.control != dynamics::StepControl::kAdaptive) {
      out.push_back(order_of_steps(bar, spec, entry.traits.order, sabotage));
      continue;
    }
    for (const bool damped : {false, true}) out.push_back(slope_of_tolerances(bar, spec, damped, sabotage));
  }
  IntegratorSpec spec;
  spec.rtol = 1e-4;
  const double e = error(bar, spec, {.T = M_PI / bar.omega[0], .amplitude = 1e-5}, sabotage);
  out.push_back({.quantity = "corotational body at amplitude 1e-5 m, cvode-bdf: error", .computed = e, .error = e, .bar = 1e-3, .note = "rtol 1e-4; the nonlinearity is 1e-5"});
  return out;
}

}  // namespace

ValidationCase free_vibration() {
  return {.name = "free-vibration",
          .section = "D",
          .summary = "free vibration of a clamped bar against the modes of its own K and M: order of every integrator, slope of error against rtol",
          .why = "exact in time, so each integrator's error is its own; eigenvectors by a dense solver that no integrator uses",
          .run = run,
          .sabotages = {"half-stiffness", "one-percent", "tolerance-ignored"}};
}

}  // namespace palpate::validation
