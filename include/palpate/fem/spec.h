#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/device/spec.h"
#include "palpate/mesh/spec.h"

namespace palpate {

/// Nodes inside a box (rest positions, world frame, borders included) that are held or driven.
struct AttachmentSpec {
  Vec3 box_min_m = Vec3::Zero();
  Vec3 box_max_m = Vec3::Zero();
  std::string axes = "xyz";                ///< which directions are held
  std::vector<KeyframeSpec> keyframes;     ///< empty: fixed; else the box moves rigidly along them (position and rotation about its own centre)
};

/// A load spread over nodes in a box by their share of the boundary area: total force [N].
struct LoadSpec {
  Vec3 box_min_m = Vec3::Zero();
  Vec3 box_max_m = Vec3::Zero();
  Vec3 force_n = Vec3::Zero();
};

/// The `[[body]]` tables of a scene.
struct SoftBodySpec {
  std::string name;
  MeshSpec mesh;
  Vec3 position_m = Vec3::Zero();          ///< placed here at the start
  Vec3 rotation_vector_rad = Vec3::Zero();
  Vec3 velocity_m_s = Vec3::Zero();
  Vec3 angular_velocity_rad_s = Vec3::Zero();  ///< about the centre of mass
  double youngs_modulus_pa = 1e4;
  double poissons_ratio = 0.3;
  double density_kg_m3 = 1000.0;
  double mass_damping_per_s = 0.0;         ///< alpha
  double stiffness_damping_s = 0.0;        ///< beta: (mu_d, lambda_d) = beta (mu, lambda)
  std::string mass = "lumped";             ///< or "consistent"
  std::string tangent = "exact";           ///< "exact", "projected", "warped"
  std::string volumetric = "element";      ///< resistance to change of volume: "element", or "nodal" averages (no locking for nu -> 0.5)
  bool full_damping_tangent = false;       ///< keep the unsymmetric part of the damping's derivative by position
  std::vector<AttachmentSpec> attachments;
  std::vector<LoadSpec> loads;
};

}  // namespace palpate
