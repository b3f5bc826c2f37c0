#pragma once
#include "integrate/fakes.h"

namespace palpate::fakes {

/// One node of unit mass, q'' + 2 z w q' + w^2 q = 0 in each direction: the test equation of structural
/// dynamics.
struct Oscillator {
  double w, z;
  State state;
  System system;
  std::shared_ptr<LinearTerm> term;

  Oscillator(double frequency, double damping_ratio, double q = 0.3, double u = 0.0)
      : w(frequency), z(damping_ratio) {
    const int id = state.insert(BlockSpec{.name = "one", .q_size = 3, .u_size = 3}, VecX::Constant(3, q),
                                VecX::Constant(3, u));
    term = std::make_shared<LinearTerm>(w * w * MatX::Identity(3, 3), 2.0 * z * w * MatX::Identity(3, 3),
                                        VecX::Zero(3));
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
    system.prepare(state.view());
  }
  /// State (q, u/w) of the first direction.
  Eigen::Vector2d scaled() const { return {state.q()[0], state.u()[0] / w}; }
  double energy() { return system.kinetic_energy(state.view()) + system.potential_energy(state.view()); }
};

}  // namespace palpate::fakes
