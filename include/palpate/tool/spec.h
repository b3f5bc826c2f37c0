#pragma once
#include <string>

#include "palpate/core/types.h"
#include "palpate/mesh/spec.h"

namespace palpate {

/// The `[tool]` table of a scene: a rigid body pulled after the handle by a 6-DoF spring-damper.
struct ToolSpec {
  std::string shape = "sphere";  ///< "sphere" (analytic), or "mesh" (any closed surface)
  double radius_m = 0.01;        ///< sphere
  MeshSpec mesh;                 ///< skin, where shape = "mesh", and for gpu contact
  double mass_kg = 0.1;
  Vec3 inertia_kg_m2 = Vec3::Zero();  ///< principal, about the centre of mass; zero: a solid sphere's
  Vec3 position_m = Vec3::Zero();
  Vec3 rotation_vector_rad = Vec3::Zero();
  bool gravity = false;  ///< off: a device holds its own weight
  double coupling_stiffness_n_m = 300.0;
  double coupling_damping_n_s_m = 2.0;
  double coupling_rotational_stiffness_n_m_rad = 0.3;
  double coupling_rotational_damping_n_m_s_rad = 1e-3;
  double tick_s = 1e-3;
  /// of the tool's own ticks: see `palpate list tool-integrators`
  std::string integrator = "linearly-implicit-euler";
};

}  // namespace palpate
