#pragma once
#include "integrate/top.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"

/// Small scenes for comparing tolerances with achieved errors.
namespace palpate::fakes {

/// A floor under every node: springs k with depth d that set in over a width w, f = k w ln(1 + e^(d/w)), as
/// smooth as the rest of a scene; or one-sided, w = 0, with a kink at d = 0.
struct SpringFloor final : ForceTerm {
  double k, w;
  SpringFloor(double stiffness, double width) : k(stiffness), w(width) {}
  std::string_view name() const override { return "floor"; }
  TermTraits traits() const override { return {.conservative = true, .contact = true}; }
  double force(double d) const {
    if (w == 0.0) return k * std::max(0.0, d);
    return k * (std::max(0.0, d) + w * std::log1p(std::exp(-std::abs(d) / w)));
  }
  double stiffness(double d) const {
    if (w == 0.0) return d > 0.0 ? k : 0.0;
    return k / (1.0 + std::exp(-d / w));
  }
  void add_force(const StateView& s, VecX& f) override {
    for (int i = 2; i < s.layout->nodal_size; i += 3) f[i] += force(-s.q[i]);
  }
  void add_tangent(const StateView& s, double ks, double, BorderedMatrix& A) override {
    for (int i = 0; i < s.layout->nodal_size / 3; ++i)
      A.body.add(A.body.slot(i, i),
                 ks * stiffness(-s.q[3 * i + 2]) * Vec3::UnitZ() * Vec3::UnitZ().transpose());
  }
  void apply_tangent(const StateView& s, double ks, double, const VecX& x, VecX& y) override {
    for (int i = 2; i < s.layout->nodal_size; i += 3) y[i] += ks * stiffness(-s.q[i]) * x[i];
  }
};

struct Small {
  State state;
  System system;
  double duration = 0.0;  ///< [s]
};

/// A damped soft bar with one end held, that falls under gravity and swings.
/// @param length, across  numbers of elements
inline std::unique_ptr<Small> swinging_bar(int length, int across) {
  auto s = std::make_unique<Small>();
  const TetMesh mesh = mesh::box(Vec3(0.12, 0.04, 0.04), {length, across, across});
  const auto n = static_cast<int>(mesh.nodes.cols());
  const VecX rest = mesh.nodes.reshaped();
  const int id = s->state.insert(
      BlockSpec{.name = "bar", .q_size = 3 * n, .u_size = 3 * n, .q_scale = 0.12, .u_scale = 1.0}, rest,
      VecX::Zero(3 * n));
  const fem::Material material{
      .youngs_modulus = 2e4, .poissons_ratio = 0.4, .density = 1000.0, .stiffness_damping = 2e-3};
  s->system.add(std::static_pointer_cast<ForceTerm>(
      std::make_shared<fem::SoftBody>("bar", mesh, material, fem::SoftBodyOptions{}, id)));
  s->system.add(fem::make_gravity(fem::lumped_masses(mesh, material.density), Vec3(0, 0, -9.81), id));
  s->system.add(fem::make_lumped_mass(mesh, material.density, id));
  const std::vector<int> held = fem::dofs_of_nodes(
      fem::nodes_in_box(mesh.nodes, Vec3(-0.06 - 1e-9, -1, -1), Vec3(-0.06 + 1e-9, 1, 1)), 0, "xyz");
  VecX x0(static_cast<Eigen::Index>(held.size()));
  for (std::size_t i = 0; i < held.size(); ++i) x0[static_cast<Eigen::Index>(i)] = rest[held[i]];
  s->system.add(fem::make_fixed(held, x0));
  s->system.prepare(s->state.view());
  s->duration = 0.3;
  return s;
}

/// A damped soft block, slightly tilted, that comes to rest on a floor: each node of its lower face touches
/// once.
/// @param onset  onset width of the floor [m]
inline std::unique_ptr<Small> landing_block(double onset) {
  auto s = std::make_unique<Small>();
  const TetMesh mesh = mesh::box(Vec3(0.06, 0.04, 0.04), {2, 1, 1});
  const auto n = static_cast<int>(mesh.nodes.cols());
  VecX rest = mesh.nodes.reshaped();
  const Mat3 tilt = quaternion_of(Vec3(0.03, 0.05, 0.0)).toRotationMatrix();
  for (int i = 0; i < n; ++i) rest.segment<3>(3 * i) = tilt * mesh.nodes.col(i) + Vec3(0, 0, 0.0225);
  const int id = s->state.insert(
      BlockSpec{.name = "block", .q_size = 3 * n, .u_size = 3 * n, .q_scale = 0.06, .u_scale = 1.0}, rest,
      VecX::Zero(3 * n));
  const fem::Material material{
      .youngs_modulus = 2e4, .poissons_ratio = 0.4, .density = 1000.0, .stiffness_damping = 2e-3};
  s->system.add(std::static_pointer_cast<ForceTerm>(
      std::make_shared<fem::SoftBody>("block", mesh, material, fem::SoftBodyOptions{}, id)));
  s->system.add(fem::make_gravity(fem::lumped_masses(mesh, material.density), Vec3(0, 0, -9.81), id));
  s->system.add(fem::make_lumped_mass(mesh, material.density, id));
  s->system.add(std::make_shared<SpringFloor>(50.0, onset));
  s->system.prepare(s->state.view());
  s->duration = 0.2;
  return s;
}

inline std::unique_ptr<Small> swinging_bar() { return swinging_bar(3, 1); }
inline std::unique_ptr<Small> smoothly_landing_block() { return landing_block(1e-3); }
inline std::unique_ptr<Small> sharply_landing_block() { return landing_block(0.0); }

/// A spinning rigid top, with a quaternion, whose centre swings on a spring against a node.
inline std::unique_ptr<Small> spinning_top() {
  auto s = std::make_unique<Small>();
  s->state.insert(BlockSpec{.name = "node", .q_size = 3, .u_size = 3, .q_scale = 0.2, .u_scale = 1.0},
                  Vec3(0.2, 0.0, -0.1), VecX::Zero(3));
  VecX q = VecX::Unit(7, 0), u = VecX::Zero(6);
  u.head<3>() = Vec3(1.0, -0.5, 3.0);
  const int id = s->state.insert(rigid_block("top", 0.2, 1.0), q, u);
  s->system.add(std::make_shared<TopForces>(id));
  s->system.add(std::make_shared<TopInertia>(id));
  s->system.add(std::make_shared<NodalMass>(0, kNodeMass * MatX::Identity(3, 3)));
  s->system.prepare(s->state.view());
  s->duration = 0.6;  // one period of the swing
  return s;
}

}  // namespace palpate::fakes
