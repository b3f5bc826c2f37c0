#pragma once
#include <vector>

#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Motion given to some u-directions of node blocks: fixed nodes, scripted nodes, nodes carried by a bone.
/// Their rows leave the unknowns; what holds them there comes back as System::reactions.
class DrivenMotion {
 public:
  virtual ~DrivenMotion() = default;
  /// Indices into u (3 node + axis), ascending, each driven once in a System.
  virtual const std::vector<int>& dofs() const = 0;
  /// Position [m], velocity [m/s] and acceleration [m/s^2] of those directions at state.time.  A motion of
  /// time alone reads only the time. With a master block, a = G u'_master + gamma and `a` receives gamma
  /// alone.
  virtual void evaluate(const StateView& state, VecX& x, VecX& v, VecX& a) const = 0;
  /// Id of the rigid or articulated block that carries these nodes, -1 for a function of time.
  virtual int master_block() const { return -1; }
  /// G = dv_driven / du_master, dofs().size() x u_size of the master.
  virtual void jacobian(const StateView&, MatX& /*G*/) const {}
  /// K += -d(G^T f)/d(master) along the master's u-directions, with `f` held [N], one entry a direction of
  /// dofs(): G rotates with its master.
  virtual void add_geometric_stiffness(const StateView&, const VecX& /*f*/, MatX& /*K*/) const {}
};

}  // namespace palpate::dynamics
