// Adds a custom force: springs that pull each node to its place at rest, with a stiffness proportional to its
// mass. A body that is shifted and released then oscillates as a whole, x(t) = d cos(w t), and does not
// deform.
#include <cmath>
#include <cstdio>
#include <utility>

#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

using namespace palpate;

/// f_i = -w^2 m_i (x_i - X_i);  K = -df/dx = w^2 diag(m);  energy w^2/2 sum m_i |x_i - X_i|^2.
class Springs : public dynamics::ForceTerm {
 public:
  Springs(VecX masses, VecX places, double w) : stiffness_(w * w * masses), places_(std::move(places)) {}
  std::string_view name() const override { return "springs"; }
  dynamics::TermTraits traits() const override { return {.stiff = false, .conservative = true}; }
  /// Adds the force, f += force.
  void add_force(const dynamics::StateView& state, VecX& f) override {
    for (int i = 0; i < stiffness_.size(); ++i) f.segment<3>(3 * i) -= stiffness_[i] * extension(state, i);
  }
  /// Adds the tangent, A += k_scale K, for implicit methods. Diagonal blocks are always in the pattern of the
  /// matrix; a term that couples nodes also overrides add_pattern (custom_material.cpp).
  void add_tangent(const dynamics::StateView&, double k_scale, double, dynamics::BorderedMatrix& A) override {
    for (int i = 0; i < stiffness_.size(); ++i)
      A.body.add(A.body.diagonal(i), k_scale * stiffness_[i] * Mat3::Identity());
  }
  /// Adds the product y += k_scale K x, for methods that assemble no matrix.
  void apply_tangent(const dynamics::StateView&, double k_scale, double, const VecX& x, VecX& y) override {
    for (int i = 0; i < stiffness_.size(); ++i)
      y.segment<3>(3 * i) += k_scale * stiffness_[i] * x.segment<3>(3 * i);
  }
  double energy(const dynamics::StateView& state) override {
    double sum = 0.0;
    for (int i = 0; i < stiffness_.size(); ++i)
      sum += 0.5 * stiffness_[i] * extension(state, i).squaredNorm();
    return sum;
  }

 private:
  Vec3 extension(const dynamics::StateView& state, int i) const {
    return state.position(i) - places_.segment<3>(3 * i);
  }
  VecX stiffness_, places_;  ///< [N/m], [m]
};

int main() {
  const double w = 10.0, shift = 0.02, t = 0.5;  // [1/s], [m], [s]
  const TetMesh mesh = mesh::ball(0.03, 0.01);
  const fem::Material tissue{.youngs_modulus = 1e4};
  const VecX rest = mesh.nodes.reshaped(), masses = fem::lumped_masses(mesh, tissue.density);
  const int n = static_cast<int>(rest.size());

  dynamics::State state;
  const VecX start = rest + Vec3(shift, 0, 0).replicate(n / 3, 1);
  const int ball = state.insert({.name = "ball", .q_size = n, .u_size = n}, start, VecX::Zero(n));
  dynamics::System system;
  system.add(std::make_shared<fem::SoftBody>("ball", mesh, tissue, fem::SoftBodyOptions{}, ball));
  system.add(fem::make_lumped_mass(mesh, tissue.density, ball));
  system.add(std::make_shared<Springs>(masses, rest, w));
  system.prepare(state.view());

  const double before = system.kinetic_energy(state.view()) + system.potential_energy(state.view());
  const auto stepper = integrate::make_stepper(system, state, {.name = "implicit-midpoint", .step_s = 1e-3});
  const dynamics::StepResult result = stepper->advance_to(t);
  const double after = system.kinetic_energy(state.view()) + system.potential_energy(state.view());
  const Points moved = Points(state.q().reshaped(3, n / 3)) - mesh.nodes;
  const double mean = moved.row(0).dot(masses) / masses.sum();
  std::printf("%s: shifted by %.6g m, by theory d cos(w t) = %.6g m; energy %.6g J, at the start %.6g J\n",
              to_string(result.status), mean, shift * std::cos(w * t), after, before);
}
