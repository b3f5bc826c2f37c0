#pragma once
#include "simbody/headers.h"

#include "bones/tree.h"

namespace palpate::bones {

/// Simbody system of a tree, with the results of the last state.
struct BoneTree::Impl {
  Impl(std::vector<TreeBone> bones, const Vec3& gravity);
  void go_to(const VecX& q, const VecX& u);  ///< realises positions and velocities, unless the state is
                                             ///< current
  /// Computes J unless it is current.
  void need_jacobian();
  /// Computes the bias accelerations unless they are current.
  void need_bias();
  /// Returns the rotation vector of a ball joint since the start.
  Vec3 ball_rotation(const VecX& q, std::size_t bone) const;

  std::vector<TreeBone> bones;
  Vec3 gravity;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  std::vector<SimTK::MobilizedBody> bodies;
  SimTK::State state;
  int q_size = 0, u_size = 0;
  std::vector<int> first_q, first_u;  ///< per bone
  std::vector<int> bone_of_u;

  VecX at_q, at_u;  ///< q and u of `state`
  std::vector<Pose> poses;
  std::vector<Twist> twists;
  bool has_jacobian = false, has_bias = false, has_mass = false;
  MatX J;  ///< six rows per bone
  MatX M;
  SimTK::Matrix_<SimTK::SpatialVec> columns;
  SimTK::Vector_<SimTK::SpatialVec> biases;
  SimTK::Matrix simbody_mass;
  SimTK::Vector zero, residual;
};

}  // namespace palpate::bones
