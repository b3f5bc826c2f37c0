#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "palpate/dynamics/state.h"
#include "palpate/fem/nodal_dilatation.h"

namespace palpate::validation {

/// Equilibrium of one soft body by the integrator "kinsol-static", as in a scene.
class StaticBody {
 public:
  using Force = std::shared_ptr<dynamics::ForceTerm>;
  /// Builds the body. With a volumetric share below 1 fem::NodalDilatation adds the rest of lambda.
  StaticBody(const TetMesh& rest, const fem::Materials& materials, const fem::SoftBodyOptions& options = {});

  const TetMesh& rest() const { return rest_; }
  fem::SoftBody& body() { return *body_; }
  /// Adds a force on the same nodes; `make` receives the id of the node block.
  void add(const std::function<std::shared_ptr<dynamics::ForceTerm>(int block_id)>& make);
  /// Replaces each force added so far: the library with a defect.
  void replace(const std::function<Force(const Force&)>& make);
  /// Moves one direction of a node to a position [m] and holds it there.
  void hold(int node, int axis, double position);
  void hold(int node, const Vec3& position);
  /// Adds a dead force [N] to the load of a node.
  void load(int node, const Vec3& force) { external_.col(node) += force; }
  void remove_loads() { external_.setZero(); }
  void place(int node, const Vec3& position) { state_.q().segment<3>(3 * node) = position; }

  /// Solves for the equilibrium that Newton's method finds from the present positions, to rounding. Returns
  /// false if it finds none.
  bool solve();
  dynamics::StateView view() const { return state_.view(); }

  Vec3 position(int node) const { return state_.q().segment<3>(3 * node); }
  Vec3 displacement(int node) const { return position(node) - rest_.nodes.col(node); }
  double elastic_energy();
  /// Returns the forces [N] of the body on its nodes.
  Points internal_forces();
  /// Returns the mean first Piola-Kirchhoff stress [Pa], from the forces that hold and load the body: V
  /// P = sum over nodes of f X^T.
  Mat3 mean_stress();

 private:
  VecX internal_force();

  TetMesh rest_;
  fem::Materials materials_;
  dynamics::State state_;
  int block_ = -1;
  std::shared_ptr<fem::SoftBody> body_;
  std::vector<std::shared_ptr<dynamics::ForceTerm>> terms_;
  Points external_;
  std::vector<char> held_;
};

double volume(const TetMesh& mesh);

/// Returns the consistent nodal loads [N] of a traction(y) [Pa] on the face x = `length`, along y (or any one
/// direction). The midpoint rule of edges is exact for the resultant of a quadratic traction.
VecX end_loads(const TetMesh& mesh, double length, const std::function<double(double y)>& traction);

/// Returns for each node whether it is on the boundary of the mesh.
std::vector<char> boundary_nodes(const TetMesh& mesh);

}  // namespace palpate::validation
