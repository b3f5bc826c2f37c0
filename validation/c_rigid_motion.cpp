#include <random>

#include "cases.h"
#include "faults.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: rigid motion of a soft body, at rest and spinning with damping.
//
// Exact answer: x = Q X + t gives F = Q = R, hence P = 0 and psi = 0. With v = w x x + v0 the strain rate
// sym(F^T F') vanishes, and with it the damping force. Measured: forces and energy, limit 1e-10 of E h^2 and
// E h^3 (rounding).

namespace palpate::validation {
namespace {

std::vector<Measurement> run(const std::string& fault) {
  constexpr double kSize = 0.1;
  constexpr int kCells = 4;
  const TetMesh rest = mesh::perturbed(mesh::box(Vec3::Constant(kSize), {kCells, kCells, kCells}), 0.2, 11);
  const auto n = rest.nodes.cols();
  fem::Material material;
  material.youngs_modulus = 3e4;
  material.poissons_ratio = 0.4;
  material.stiffness_damping = 0.02;
  dynamics::State state(static_cast<int>(3 * n), static_cast<int>(3 * n));
  dynamics::BlockSpec spec;
  spec.q_size = spec.u_size = static_cast<int>(3 * n);
  const VecX X = rest.nodes.reshaped();
  const int id = state.insert(spec, X, VecX::Zero(3 * n));
  std::shared_ptr<dynamics::ForceTerm> body =
      std::make_shared<fem::SoftBody>("body", rest, material, fem::SoftBodyOptions{}, id);
  if (fault == "small-strain") body = small_strain(body, X);
  if (fault == "rayleigh-damping") body = with_rayleigh_damping(body, X, material.stiffness_damping);

  const double h = kSize / kCells;
  const double unit = material.youngs_modulus * h * h;
  std::mt19937 engine(12);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&] { return Vec3(uniform(engine), uniform(engine), uniform(engine)); };
  double force = 0.0, spinning = 0.0, energy = 0.0;
  for (int k = 0; k < 50; ++k) {
    const Mat3 Q = quaternion_of(EIGEN_PI * random()).toRotationMatrix();
    const Vec3 t = 10.0 * kSize * random(), w = 20.0 * random(), v0 = random();
    const VecX x = ((Q * rest.nodes).colwise() + t).reshaped();
    const VecX v = ((cross_matrix(w) * Q * rest.nodes).colwise() + v0).reshaped();
    VecX f = VecX::Zero(3 * n), fv = f;
    const VecX zero = VecX::Zero(3 * n);
    body->add_force(state.view(0.0, x.data(), zero.data()), f);
    body->add_force(state.view(0.0, x.data(), v.data()), fv);
    force = std::max(force, f.lpNorm<Eigen::Infinity>() / unit);
    spinning = std::max(spinning, fv.lpNorm<Eigen::Infinity>() / unit);
    energy = std::max(energy, body->energy(state.view(0.0, x.data(), zero.data())) / (unit * h));
  }
  return {{.quantity = "largest nodal force / (E h^2), 50 poses",
           .computed = force,
           .error = force,
           .bar = 1e-10},
          {.quantity = "largest nodal force while spinning, with damping / (E h^2)",
           .computed = spinning,
           .error = spinning,
           .bar = 1e-10},
          {.quantity = "energy / (E h^3)", .computed = energy, .error = energy, .bar = 1e-10}};
}

}  // namespace

ValidationCase rigid_motion() {
  return {
      .name = "rigid-motion",
      .section = "C",
      .summary = "any rotation and translation: no force, no energy, no damping",
      .why =
          "small-strain elasticity fails it by design: a rotated body swells; the corotated energy must not",
      .quick = true,
      .run = run,
      .faults = {{"small-strain", " / (E h^"}, {"rayleigh-damping", "while spinning"}}};
}

}  // namespace palpate::validation
