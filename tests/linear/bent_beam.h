#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "dynamics/mixed_precision_step.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"

namespace palpate {

struct BentBeamOptions {
  double stiffness_damping = 0.0, mass_damping = 0.0;
  double shake_m = 0.0;  ///< amplitude of the held end's vertical motion
};

/// Step matrices M + h^2 K of a beam held at one end and bent by angles that require large rotations.
struct BentBeam {
  dynamics::State state;
  dynamics::System system;
  dynamics::StepAssembly assembly{system};
  VecX rest, masses;
  explicit BentBeam(int cells_along, double youngs_modulus, int cells_across = 0,
                    const BentBeamOptions& options = {}) {
    const int across = cells_across > 0 ? cells_across : cells_along / 4;
    const double width = static_cast<double>(across) / cells_along;
    const TetMesh mesh = mesh::box(Vec3(1.0, width, width), {cells_along, across, across});
    const auto n = static_cast<int>(mesh.nodes.cols());
    rest = mesh.nodes.reshaped();
    const int id = state.insert(dynamics::BlockSpec{.name = "beam", .q_size = 3 * n, .u_size = 3 * n}, rest,
                                VecX::Zero(3 * n));
    fem::Material material{.youngs_modulus = youngs_modulus, .poissons_ratio = 0.4, .density = 1000.0};
    material.stiffness_damping = options.stiffness_damping;
    material.mass_damping = options.mass_damping;
    system.add(std::static_pointer_cast<dynamics::ForceTerm>(std::make_shared<fem::SoftBody>(
        "beam", mesh, material, fem::SoftBodyOptions{.tangent = fem::Tangent::kWarped}, id)));
    masses = fem::lumped_masses(mesh, material.density);
    system.add(fem::make_gravity(masses, Vec3(0, 0, -9.81), id));
    system.add(fem::make_lumped_mass(mesh, material.density, id));
    const std::vector<int> held = fem::dofs_of_nodes(
        fem::nodes_in_box(mesh.nodes, Vec3(-0.5 - 1e-9, -1, -1), Vec3(-0.5 + 1e-9, 1, 1)), 0, "xyz");
    VecX x0(static_cast<Eigen::Index>(held.size()));
    Points points(3, x0.size());
    for (std::size_t i = 0; i < held.size(); ++i) {
      x0[static_cast<Eigen::Index>(i)] = rest[held[i]];
      points.col(static_cast<Eigen::Index>(i)) = mesh.nodes.col(held[i] / 3);
    }
    if (options.shake_m > 0.0)
      system.add(fem::make_driven(held, points, [a = options.shake_m](double t) {
        constexpr double kRate = 25.0;
        dynamics::PathPoint p{};
        p.pose.translation = Vec3(0, 0, a * std::sin(kRate * t));
        p.twist.linear = Vec3(0, 0, a * kRate * std::cos(kRate * t));
        p.acceleration.linear = Vec3(0, 0, -a * kRate * kRate * std::sin(kRate * t));
        return p;
      }));
    else
      system.add(fem::make_fixed(held, x0));
    system.prepare(state.view());
  }
  /// Bends the centre line to a circle whose angle at the end is `angle`, and writes the step matrix there,
  /// and a right-hand side of weight and a wave.
  void at(double angle, double h, dynamics::BorderedMatrix& A, VecX& b) {
    bend(angle);
    system.step_matrix(state.view(), 1.0, h, h * h, A);
    system.force(state.view(), b);
    load(angle, h, b);
  }
  /// Writes the step matrix as a zero-row-sum matrix, with the same right-hand side.
  void at(double angle, double h, dynamics::ZeroRowSumMatrix& A, VecX& b) {
    bend(angle);
    ASSERT_TRUE(assembly.applies(state.view()));
    assembly.assemble(state.view(), VecX::Zero(rest.size()), 1.0, h, h * h, b, A);
    load(angle, h, b);
  }
  const dynamics::BlockSparse& pattern() {
    EXPECT_TRUE(assembly.applies(state.view()));
    return assembly.pattern();
  }

 private:
  void bend(double angle) {
    VecX q = rest;
    for (Eigen::Index i = 0; i < q.size(); i += 3) {
      const double s = rest[i] + 0.5, z = rest[i + 2], turn = angle * s,
                   radius = angle != 0.0 ? 1.0 / angle : 0.0;
      if (angle == 0.0) continue;
      q[i] = (radius + z) * std::sin(turn) - 0.5;
      q[i + 2] = (radius + z) * std::cos(turn) - radius;
    }
    state.q() = q;
  }
  void load(double angle, double h, VecX& b) {
    for (Eigen::Index i = 0; i < b.size(); ++i)
      b[i] = h * b[i] + masses[i / 3] * std::sin(7.0 * rest[i - i % 3] + angle);
    system.reduce(state.view(), b);
  }
};

/// Residuals of a system with a given matrix; `evaluated` counts the evaluations.
class Known final : public dynamics::ResidualFunction {
 public:
  Known(const dynamics::BorderedMatrix& A, const VecX& b) : A_(A), b_(b) {}
  void at(const VecX& x, VecX& r) override {
    ++evaluated;
    A_.multiply(x, r);
    r = b_ - r;
  }
  int evaluated = 0;

 private:
  const dynamics::BorderedMatrix& A_;
  const VecX& b_;
};

/// Returns the solver's mixed-precision capability, which it is expected to have.
inline dynamics::MixedPrecisionSolver& mixed(dynamics::LinearSolver& solver) {
  return dynamic_cast<dynamics::MixedPrecisionSolver&>(solver);
}

inline double energy_norm(const dynamics::BorderedMatrix& A, const VecX& x) {
  VecX Ax;
  A.multiply(x, Ax);
  return std::sqrt(x.dot(Ax));
}

}  // namespace palpate
