#include "multirate_theory.h"

#include <Eigen/LU>

#include "integrate/multirate.h"

// Multi-rate methods are A-stable for each side alone. No theorem is known for two sides that are mutually
// stiff, so the matrix of a step is assembled from the coupling tables (integrate::multirate_amplification).
// With y = [q; u] and K, D of the terms of each side (contact and terms declared fast on the fast one),
//     S = [0 1; -M^-1 K_S  -M^-1 D_S],    F = [0 0; -M^-1 K_F  -M^-1 D_F].

namespace palpate::stability {
namespace {

MatX over_mass(loop::World& world, double d_scale, double k_scale, const dynamics::System::TermFilter& side) {
  dynamics::BorderedMatrix A, M;
  world.system.step_matrix(world.state.view(), 0.0, d_scale, k_scale, A, side);
  const MatX dense = A.to_dense();
  world.system.step_matrix(world.state.view(), 1.0, 0.0, 0.0, M, side);
  return M.to_dense().lu().solve(dense);
}

MatX linearised(loop::World& world, bool fast) {
  const auto side = [fast](const dynamics::TermTraits& t) { return (t.fast || t.contact) == fast; };
  const MatX K = over_mass(world, 0.0, 1.0, side), D = over_mass(world, 1.0, 0.0, side);
  const Eigen::Index n = K.rows();
  MatX A = MatX::Zero(2 * n, 2 * n);
  if (!fast) A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -K;
  A.bottomRightCorner(n, n) = -D;
  return A;
}

}  // namespace

double multirate_amplification_at(const Column& column, loop::World& world, const VecX& q, const VecX& u,
                                  double step_s) {
  world.state.q() = q;
  world.state.u() = u;
  if (world.contact) world.contact->refresh(world.state.view());
  return integrate::multirate_amplification(column.name, linearised(world, false), linearised(world, true),
                                            step_s);
}

}  // namespace palpate::stability
