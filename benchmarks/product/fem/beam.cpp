#include "product/fem/beam.h"

#include <cmath>

#include "mesh/spatial_order.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"

namespace palpate::bench {
namespace {

constexpr double kDensity = 1000.0, kSpin = 3.0, kStart = 0.1, kFallsBelow = 3e5;

/// Returns angle and derivatives: a constant angular acceleration over kStart, then constant speed.
dynamics::PathPoint rotating_end(double t) {
  const double rate = kSpin / kStart, s = std::min(t, kStart);
  dynamics::PathPoint p;
  p.pose = {Quat(Eigen::AngleAxisd(0.5 * rate * s * s + kSpin * (t - s), Vec3::UnitY())), Vec3(-0.5, 0, 0)};
  p.twist.angular = Vec3(0, rate * s, 0);
  p.acceleration.angular = Vec3(0, t < kStart ? rate : 0.0, 0);
  return p;
}

}  // namespace

TetMesh beam_mesh(int along, int across) {
  TetMesh beam = mesh::box(Vec3(1.0, 0.25, 0.25), {along, across, across});
  mesh::renumber_nodes(beam, mesh::spatial_order(beam.nodes));  // As for a body of a scene.
  return beam;
}

Beam::Beam(int along, int across, double youngs_modulus_pa) {
  const TetMesh mesh = beam_mesh(along, across);
  tetrahedra = static_cast<int>(mesh.tets.cols());
  rest = mesh.nodes.reshaped();
  masses = fem::lumped_masses(mesh, kDensity);
  const int id = state.insert(
      {.name = "beam", .q_size = static_cast<int>(rest.size()), .u_size = static_cast<int>(rest.size())},
      rest, VecX::Zero(rest.size()));
  const fem::Material material{
      .youngs_modulus = youngs_modulus_pa, .poissons_ratio = 0.4, .density = kDensity};
  body_ = std::make_shared<fem::SoftBody>("beam", mesh, material,
                                          fem::SoftBodyOptions{.tangent = fem::Tangent::kWarped}, id);
  system.add(std::static_pointer_cast<dynamics::ForceTerm>(body_));
  system.add(fem::make_gravity(masses, Vec3(0, 0, -9.81), id));
  system.add(fem::make_lumped_mass(mesh, kDensity, id));
  const std::vector<int> held = fem::dofs_of_nodes(
      fem::nodes_in_box(mesh.nodes, Vec3(-0.5 - 1e-9, -1, -1), Vec3(-0.5 + 1e-9, 1, 1)), 0, "xyz");
  const auto count = static_cast<Eigen::Index>(held.size());
  VecX x0(count);
  Points local(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int dof = held[static_cast<std::size_t>(i)];
    x0[i] = rest[dof];
    local.col(i) = mesh.nodes.col(dof / 3) - Vec3(-0.5, 0, 0);
  }
  if (youngs_modulus_pa < kFallsBelow)
    system.add(fem::make_fixed(held, x0));
  else
    system.add(fem::make_driven(held, local, rotating_end));
  system.prepare(state.view());
}

double Beam::body_bytes() const {
  const fem::MemoryUse use = body_->memory();
  return static_cast<double>(use.elements + use.maps + use.scratch);
}

double Beam::end_rotation() const {
  Vec3 then = Vec3::Zero(), now = Vec3::Zero();
  const auto q = state.q();
  double x1 = -1.0, x2 = -1.0;  // The last two cross-sections.
  for (Eigen::Index i = 0; i < rest.size(); i += 3) x1 = std::max(x1, rest[i]);
  for (Eigen::Index i = 0; i < rest.size(); i += 3)
    if (rest[i] < x1 - 1e-9) x2 = std::max(x2, rest[i]);
  for (Eigen::Index i = 0; i < rest.size(); i += 3) {
    const double sign = rest[i] > x1 - 1e-9 ? 1.0 : rest[i] > x2 - 1e-9 ? -1.0 : 0.0;
    then += sign * Vec3(rest.segment<3>(i));
    now += sign * Vec3(q.segment<3>(i));
  }
  return std::atan2(then.cross(now).norm(), then.dot(now));
}

}  // namespace palpate::bench
