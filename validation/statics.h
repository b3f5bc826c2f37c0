#pragma once
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/SparseCholesky>

#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"
#include "palpate/fem/nodal_dilatation.h"

namespace palpate::validation {

/// Equilibrium of one soft body by Newton's method with the exact tangent and a plain LDL^T of Eigen: nothing
/// of the integrators is in it.
class StaticBody {
 public:
  /// A volumetric share below 1 brings the rest of lambda by fem::NodalDilatation.
  StaticBody(const TetMesh& rest, const fem::Materials& materials, const fem::SoftBodyOptions& options = {});

  const TetMesh& rest() const { return rest_; }
  fem::SoftBody& body() { return *body_; }
  /// A further force on the same nodes; `make` receives the id of the node block.
  void add(const std::function<std::shared_ptr<dynamics::ForceTerm>(int block_id)>& make);
  /// Holds one direction of a node at a position [m] (and puts it there).
  void hold(int node, int axis, double position);
  void hold(int node, const Vec3& position);
  /// A dead force [N] on a node, added to what it carries.
  void load(int node, const Vec3& force) { external_.col(node) += force; }
  void remove_loads() { external_.setZero(); }
  void place(int node, const Vec3& position) { x_.segment<3>(3 * node) = position; }

  /// Newton from the present positions, until the residual is at rounding.  False when it does not get there.
  /// @param good_enough  residual, over the forces that act, that counts as rounding; iterations go on
  ///   while they still help
  bool solve(double good_enough = 1e-11);
  /// One linear step from the present positions: the small-displacement solution.
  bool solve_linear();

  Vec3 position(int node) const { return x_.segment<3>(3 * node); }
  Vec3 displacement(int node) const { return position(node) - rest_.nodes.col(node); }
  double elastic_energy();
  /// Forces [N] of the body on its nodes.
  Points internal_forces();
  /// Mean first Piola-Kirchhoff stress, from the forces that hold and load the body: V P = sum over nodes of
  /// f X^T.
  Mat3 mean_stress();

 private:
  void internal_force(VecX& f);
  dynamics::StateView view() { return state_.view(0.0, x_.data(), v_.data()); }
  bool newton_step(const VecX& residual);

  TetMesh rest_;
  dynamics::State state_;
  int block_ = -1;
  std::shared_ptr<fem::SoftBody> body_;
  std::vector<std::shared_ptr<dynamics::ForceTerm>> terms_;
  dynamics::BorderedMatrix K_;
  std::size_t terms_in_pattern_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  std::vector<char> held_in_factor_;  ///< what the symbolic analysis was made for
  VecX x_, v_;
  Points external_;
  std::vector<char> held_;
};

double volume(const TetMesh& mesh);

/// Consistent nodal loads [N] of a traction(y) [Pa] on the face x = `length`, in the direction of y (or any
/// one); the midpoint rule of edges, exact for a quadratic traction's resultant.
VecX end_loads(const TetMesh& mesh, double length, const std::function<double(double y)>& traction);

/// True where the node lies on the boundary of the mesh.
std::vector<char> boundary_nodes(const TetMesh& mesh);

}  // namespace palpate::validation
