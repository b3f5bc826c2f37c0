#include "statics.h"

#include <Eigen/LU>

#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/boundary.h"

namespace palpate::validation {

StaticBody::StaticBody(const TetMesh& rest, const fem::Materials& materials,
                       const fem::SoftBodyOptions& options)
    : rest_(rest),
      materials_(materials),
      state_(static_cast<int>(rest.nodes.size()), static_cast<int>(rest.nodes.size())) {
  external_ = Points::Zero(3, rest.nodes.cols());
  held_.assign(static_cast<std::size_t>(rest.nodes.size()), 0);
  dynamics::BlockSpec spec;
  spec.name = "body";
  spec.q_size = spec.u_size = static_cast<int>(rest.nodes.size());
  block_ = state_.insert(spec, rest.nodes.reshaped(), VecX::Zero(rest.nodes.size()));
  body_ = std::make_shared<fem::SoftBody>("body", rest, materials, options, block_);
  terms_ = {body_};
  if (options.volumetric_share < 1.0)
    terms_.push_back(std::make_shared<fem::NodalDilatation>("body", rest, materials, options, block_));
}

void StaticBody::add(const std::function<std::shared_ptr<dynamics::ForceTerm>(int)>& make) {
  terms_.push_back(make(block_));
}

void StaticBody::replace(const std::function<Force(const Force&)>& make) {
  for (Force& term : terms_) term = make(term);
}

void StaticBody::hold(int node, int axis, double position) {
  held_[static_cast<std::size_t>(3 * node + axis)] = 1;
  state_.q()[3 * node + axis] = position;
}

void StaticBody::hold(int node, const Vec3& position) {
  for (int axis = 0; axis < 3; ++axis) hold(node, axis, position[axis]);
}

bool StaticBody::solve() {
  dynamics::System system;
  for (const auto& term : terms_) system.add(term);
  if (!external_.isZero(0.0)) system.add(fem::make_dead_load("loads", external_, block_));
  system.add(fem::make_lumped_mass(rest_, materials_, block_));
  std::vector<int> dofs;
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (held_[i]) dofs.push_back(static_cast<int>(i));
  if (!dofs.empty()) system.add(fem::make_fixed(dofs, VecX(state_.q()(dofs))));
  system.prepare(state_.view());
  IntegratorSpec spec;
  spec.name = "kinsol-static";
  spec.newton_rtol = 1e-12;
  return integrate::make_stepper(system, state_, spec)->advance_to(state_.time() + 1.0).ok();
}

VecX StaticBody::internal_force() {
  VecX f = VecX::Zero(state_.layout().u_size);
  for (const auto& term : terms_) term->add_force(state_.view(), f);
  return f;
}

double StaticBody::elastic_energy() {
  double sum = 0.0;
  for (const auto& term : terms_) sum += term->energy(state_.view());
  return sum;
}

Points StaticBody::internal_forces() { return internal_force().reshaped(3, rest_.nodes.cols()); }

// Balance div P = -b, so the integral of P is that of traction X^T and body force X^T: nodal forces times
// rest positions. In equilibrium they are minus the internal forces.
Mat3 StaticBody::mean_stress() { return -internal_forces() * rest_.nodes.transpose() / volume(rest_); }

double volume(const TetMesh& mesh) {
  double sum = 0.0;
  for (const auto& tet : mesh.tets.colwise()) {
    Mat3 edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = mesh.nodes.col(tet[a + 1]) - mesh.nodes.col(tet[0]);
    sum += edges.determinant() / 6.0;
  }
  return sum;
}

VecX end_loads(const TetMesh& mesh, double length, const std::function<double(double y)>& traction) {
  VecX loads = VecX::Zero(mesh.nodes.cols());
  for (const auto& tet : mesh.tets.colwise())
    for (int skip = 0; skip < 4; ++skip) {
      int face[3], k = 0;
      for (int a = 0; a < 4; ++a)
        if (a != skip) face[k++] = tet[a];
      bool end = true;
      for (int node : face) end = end && mesh.nodes(0, node) > length - 1e-9;
      if (!end) continue;
      const Vec3 a = mesh.nodes.col(face[0]), b = mesh.nodes.col(face[1]), c = mesh.nodes.col(face[2]);
      const double third = (b - a).cross(c - a).norm() / 6.0;
      for (int e = 0; e < 3; ++e) {
        const int i = face[e], j = face[(e + 1) % 3];
        const double half = 0.5 * third * traction(0.5 * (mesh.nodes(1, i) + mesh.nodes(1, j)));
        loads[i] += half;
        loads[j] += half;
      }
    }
  return loads;
}

std::vector<char> boundary_nodes(const TetMesh& mesh) {
  std::vector<char> on(static_cast<std::size_t>(mesh.nodes.cols()), 0);
  for (int node : mesh::boundary(mesh).node_of_vertex) on[static_cast<std::size_t>(node)] = 1;
  return on;
}

}  // namespace palpate::validation
