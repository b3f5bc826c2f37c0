#include "vibrating_bar.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

namespace palpate::validation {
namespace {

/// f = -s K (q - q0 + beta u) with a constant assembled K: the body at infinitesimal amplitude.
class LinearBody final : public dynamics::ForceTerm {
 public:
  LinearBody(dynamics::BorderedMatrix K, VecX q0, double beta, double scale)
      : K_(std::move(K)), q0_(std::move(q0)), beta_(beta), scale_(scale) {}
  std::string_view name() const override { return "linear body"; }
  dynamics::TermTraits traits() const override { return {.conservative = true}; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    for (int i = 0; i < K_.body.block_rows(); ++i)
      for (int s = K_.body.row_start()[static_cast<std::size_t>(i)];
           s < K_.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
        pattern.add_pair(i, K_.body.columns()[static_cast<std::size_t>(s)]);
  }
  void add_force(const dynamics::StateView& state, VecX& f) override {
    shift_ = state.q - q0_ + beta_ * state.u;
    apply_tangent(state, -1.0, 0.0, shift_, f);
  }
  void add_tangent(const dynamics::StateView&, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override {
    auto& to = A.body.values();  // The only term: the patterns are equal.
    for (std::size_t i = 0; i < to.size(); ++i)
      to[i] += (k_scale + beta_ * d_scale) * scale_ * K_.body.values()[i];
  }
  void apply_tangent(const dynamics::StateView&, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override {
    K_.multiply(x, product_);
    y += (k_scale + beta_ * d_scale) * scale_ * product_;
  }

 private:
  dynamics::BorderedMatrix K_;
  VecX q0_;
  double beta_, scale_;
  VecX shift_, product_;
};

}  // namespace

VibratingBar::VibratingBar(bool all_modes) : rest(mesh::box(Vec3(1.0, 0.3, 0.2), {4, 2, 2})) {
  q0 = rest.nodes.reshaped();
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
  find_modes(all_modes);
}

int VibratingBar::insert(dynamics::State& state, double amplitude) const {
  dynamics::BlockSpec spec;
  spec.name = "bar";
  spec.q_size = spec.u_size = static_cast<int>(q0.size());
  spec.q_scale = amplitude;
  spec.u_scale = omega.size() ? amplitude * omega[0] : 1.0;
  return state.insert(spec, q0, VecX::Zero(q0.size()));
}

void VibratingBar::find_modes(bool all) {
  std::vector<int> free;
  for (int i = 0; i < q0.size(); ++i)
    if (!std::binary_search(clamped.begin(), clamped.end(), i)) free.push_back(i);
  const MatX dense = K.to_dense();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> modes(dense(free, free),
                                                             MatX(mass(free).asDiagonal()));
  PALPATE_CHECK(modes.info() == Eigen::Success, "no modes");
  const Eigen::Index count = all ? static_cast<Eigen::Index>(free.size()) : kModes;
  omega = modes.eigenvalues().head(count).cwiseSqrt();
  highest_omega = std::sqrt(modes.eigenvalues()[static_cast<Eigen::Index>(free.size()) - 1]);
  phi = MatX::Zero(q0.size(), count);
  for (Eigen::Index j = 0; j < count; ++j)
    phi(free, j) = modes.eigenvectors().col(j) / modes.eigenvectors().col(j).lpNorm<Eigen::Infinity>();
}

VecX VibratingBar::displacement(double t, double beta) const {
  const Eigen::ArrayXd g = 0.5 * beta * omega.array().square(),
                       v = (omega.array().square() - g.square()).sqrt();
  return phi * ((-g * t).exp() * ((v * t).cos() + g / v * (v * t).sin())).matrix();
}

double VibratingBar::norm(const VecX& d) const { return std::sqrt(d.dot(mass.cwiseProduct(d))); }

double vibration_error(const VibratingBar& bar, const IntegratorSpec& spec, const VibrationTrial& trial,
                       const std::string& fault) {
  dynamics::State state;
  const double a = trial.amplitude > 0.0 ? trial.amplitude : 1.0;
  const int id = bar.insert(state, a);
  state.q() += a * bar.displacement(0.0, trial.beta);
  dynamics::System system;
  if (trial.amplitude > 0.0)
    system.add(std::make_shared<fem::SoftBody>("bar", bar.rest, bar.material, fem::SoftBodyOptions{}, id));
  else
    system.add(std::make_shared<LinearBody>(bar.K, bar.q0, trial.beta,
                                            fault == "force-off-by-one-percent" ? 1.01 : 1.0));
  system.add(fem::make_lumped_mass(bar.rest, bar.material.density, id));
  system.add(fem::make_fixed(bar.clamped, bar.q0(bar.clamped)));
  system.prepare(state.view());
  IntegratorSpec given = spec;
  if (fault == "first-order-rule") given.name = "backward-euler";
  if (fault == "tolerance-ignored") given.rtol = 1e-3;
  const auto stepper = integrate::make_stepper(system, state, given);
  double sum = 0.0;
  for (int i = 1; i <= trial.samples; ++i) {
    const double t = trial.T * i / trial.samples;
    if (!stepper->advance_to(t).ok()) return std::nan("");
    sum += std::pow(bar.norm((state.q() - bar.q0) / a - bar.displacement(t, trial.beta)) /
                        bar.norm(bar.displacement(0.0, 0.0)),
                    2);
  }
  return std::sqrt(sum / trial.samples);
}

}  // namespace palpate::validation
