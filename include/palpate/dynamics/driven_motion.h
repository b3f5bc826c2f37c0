#pragma once
#include <vector>

#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Prescribed motion of some u-directions of node blocks: fixed nodes, scripted nodes, nodes carried by a
/// bone.
/// These directions are eliminated from the unknowns; System::reactions returns the forces that enforce them.
class DrivenMotion {
 public:
  virtual ~DrivenMotion() = default;
  /// Returns the driven indices into u (3 node + axis), ascending. A direction is driven at most once in a
  /// System.
  virtual const std::vector<int>& dofs() const = 0;
  /// Computes position [m], velocity [m/s] and acceleration [m/s^2] of these directions at state.time, in the
  /// order of dofs(). A motion that depends on time alone reads state.time only. With a master block the
  /// acceleration is G u'_master + gamma, and `a` receives gamma only.
  virtual void evaluate(const StateView& state, VecX& x, VecX& v, VecX& a) const = 0;
  /// Returns the id of the rigid or articulated block that carries these nodes; -1 for a function of time.
  virtual int master_block() const { return -1; }
  /// Computes G = dv_driven / du_master, dofs().size() x u_size of the master.
  virtual void jacobian(const StateView&, MatX& /*G*/) const {}
  /// Adds the geometric stiffness of the constraint, K += -d(G^T f)/d(master), along the master's
  /// u-directions. G rotates with its master while `f`, the force per direction of dofs() [N], is held
  /// constant.
  virtual void add_geometric_stiffness(const StateView&, const VecX& /*f*/, MatX& /*K*/) const {}
};

}  // namespace palpate::dynamics
