#pragma once
#include "fem/fem_fixture.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"

namespace palpate::fem::testing {

struct BoneOptions {
  int cells = 3;             ///< number of cells along the cube's edge of 0.1 m
  double mass_ratio = 1e-3;  ///< bone mass over tissue mass
  /// bone's origin relative to the cube's centre, off the centroid of the carried nodes [m]
  Vec3 centre{0.005, -0.01, 0.015};
  double radius = 0.03;         ///< nodes closer to the centre than this are carried [m]
  double youngs_modulus = 5e4;  ///< [Pa]
  double damping = 0.0;         ///< stiffness-proportional [s]
  /// the bone spreads its nodes by this factor relative to rest
  double spread = 1.0;
  bool consistent = false;
  bool geometric_stiffness = true;  ///< false: without the geometric stiffness of carried nodes
};

/// A carried motion without its geometric stiffness in any matrix: comparison that shows the effect of the
/// geometric stiffness.
struct WithoutTurning final : dynamics::DrivenMotion {
  std::shared_ptr<dynamics::DrivenMotion> whole;
  explicit WithoutTurning(std::shared_ptr<dynamics::DrivenMotion> motion) : whole(std::move(motion)) {}
  const std::vector<int>& dofs() const override { return whole->dofs(); }
  int master_block() const override { return whole->master_block(); }
  void evaluate(const dynamics::StateView& s, VecX& x, VecX& v, VecX& a) const override {
    whole->evaluate(s, x, v, a);
  }
  void jacobian(const dynamics::StateView& s, MatX& G) const override { whole->jacobian(s, G); }
};

/// A cube of tissue, 0.1 m and 1 kg, around a free rigid bone that carries its inner nodes.
struct BoneInTissue {
  dynamics::State state;
  dynamics::System system;
  std::shared_ptr<SoftBody> term;
  TetMesh rest;
  VecX masses;  ///< nodal masses [kg]
  double bone_mass = 0.0;
  Vec3 inertia = Vec3::Zero();
  int tissue = -1, bone = -1;
  std::vector<int> carried;  ///< carried nodes
  Points local;              ///< positions of the carried nodes in the bone's axes

  explicit BoneInTissue(const BoneOptions& o = {}) {
    rest = jittered_cube(o.cells, 0.05, 7);
    rest.nodes = 0.1 * (rest.nodes.array() - 0.5).matrix();
    Material m;
    m.youngs_modulus = o.youngs_modulus;
    m.poissons_ratio = 0.3;
    m.density = 1000.0;
    m.stiffness_damping = o.damping;
    masses = lumped_masses(rest, m.density);
    carried = nodes_in_sphere(rest.nodes, Vec3::Zero(), o.radius);
    const int n = static_cast<int>(rest.nodes.cols());
    tissue = state.insert({.name = "tissue",
                           .q_size = 3 * n,
                           .u_size = 3 * n,
                           .q_scale = 0.1,
                           .u_scale = std::sqrt(o.youngs_modulus / m.density)},
                          flat(rest.nodes), VecX::Zero(3 * n));
    const Quat r = quaternion_of(Vec3(0.3, -0.5, 0.8));
    VecX q(7);
    q << r.w(), r.vec(), o.centre;
    bone = state.insert(dynamics::rigid_block("bone", 0.1, std::sqrt(o.youngs_modulus / m.density)), q,
                        VecX::Zero(6));
    term = std::make_shared<SoftBody>("tissue", rest, m, SoftBodyOptions{}, tissue);
    system.add(std::static_pointer_cast<dynamics::ForceTerm>(term));
    system.add(o.consistent ? make_consistent_mass(rest, m.density, tissue)
                            : make_lumped_mass(rest, m.density, tissue));
    bone_mass = o.mass_ratio * masses.sum();
    inertia = bone_mass * Vec3(1e-4, 1.5e-4, 2e-4);
    system.add(dynamics::make_rigid_inertia(bone, bone_mass, inertia));
    system.add(dynamics::make_gyroscopic(bone, inertia));
    const std::vector<int> dofs = dofs_of_nodes(carried, 0, "xyz");
    local.resize(3, static_cast<Eigen::Index>(carried.size()));
    Points per_dof(3, static_cast<Eigen::Index>(dofs.size()));
    for (std::size_t i = 0; i < carried.size(); ++i) {
      local.col(static_cast<Eigen::Index>(i)) =
          r.conjugate() * (o.spread * Vec3(rest.nodes.col(carried[i])) - o.centre);
      for (int k = 0; k < 3; ++k)
        per_dof.col(static_cast<Eigen::Index>(3 * i) + k) = local.col(static_cast<Eigen::Index>(i));
    }
    const auto motion = make_carried(dofs, per_dof, bone);
    if (o.geometric_stiffness)
      system.add(motion);
    else
      system.add(std::make_shared<WithoutTurning>(motion));
  }
  void prepare() {
    system.prepare(state.view());
    impose();
  }
  void impose() { system.impose(state.layout(), state.time(), state.q().data(), state.u().data()); }

  /// Moves nodes and bone at random, with random velocities; carried nodes follow the bone.
  void disturb(double size, double speed, unsigned seed) {
    Random random(seed);
    state.q().head(state.layout().nodal_size) += size * random.vector(state.layout().nodal_size);
    state.u() += speed * random.vector(state.layout().u_size);
    dynamics::project(state.layout(), state.q().data());
    impose();
  }
  /// Moves the whole as one rigid body, with velocity v of the cube's centre and angular velocity w.
  void throw_rigidly(const Vec3& v, const Vec3& w) {
    for (Eigen::Index i = 0; i < masses.size(); ++i)
      state.u().segment<3>(3 * i) = v + w.cross(Vec3(state.q().segment<3>(3 * i)));
    const auto& b = *state.layout().find(bone);
    state.u().segment<3>(b.u_offset) = w;
    state.u().segment<3>(b.u_offset + 3) = v + w.cross(Vec3(state.q().segment<3>(b.q_offset + 4)));
    impose();
  }
  /// Momentum (angular about the world's origin, linear) for velocities u; for accelerations u, its rate
  /// without the bone's w x I w.
  Vec6 momentum_of(const VecX& u) const {
    const auto view = state.view();
    const auto& b = *state.layout().find(bone);
    const Pose pose = dynamics::motion_of(view, b).pose;
    const Vec3 wb = u.segment<3>(b.u_offset), vb = u.segment<3>(b.u_offset + 3);
    Vec6 out;
    out << dynamics::world_inertia(pose, inertia) * wb + bone_mass * pose.translation.cross(vb),
        bone_mass * vb;
    for (int i = 0; i < masses.size(); ++i) {
      const Vec3 p = masses[i] * u.segment<3>(3 * i);
      out.head<3>() += view.position(i).cross(p);
      out.tail<3>() += p;
    }
    return out;
  }
  Vec6 momentum() const { return momentum_of(state.u()); }
  double energy() { return system.kinetic_energy(state.view()) + system.potential_energy(state.view()); }
};

}  // namespace palpate::fem::testing
