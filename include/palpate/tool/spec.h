#pragma once
#include <string>

#include "palpate/core/types.h"
#include "palpate/mesh/spec.h"

namespace palpate {

/// The virtual coupling between handle and tool, a spring and a damper in six directions: the
/// `[tool.coupling]` table of a scene.
struct VirtualCouplingSpec {
  double stiffness_n_m = 300.0;                ///< of the spring between the origins
  double damping_n_s_m = 2.0;                  ///< of the damper beside it
  double rotational_stiffness_n_m_rad = 0.3;   ///< of the spring between the orientations
  double rotational_damping_n_m_s_rad = 1e-3;  ///< of the damper beside it
};

/// The `[tool]` table of a scene: a rigid body pulled after the handle by a 6-DoF spring-damper.
struct ToolSpec {
  std::string shape = "sphere";             ///< "sphere" (analytic), or "mesh" (any closed surface)
  double radius_m = 0.01;                   ///< sphere
  MeshSpec mesh;                            ///< skin, where shape = "mesh", and for gpu contact
  double mass_kg = 0.1;                     ///< positive
  Vec3 inertia_kg_m2 = Vec3::Zero();        ///< principal, about the centre of mass; zero: a solid sphere's
  Vec3 position_m = Vec3::Zero();           ///< of its origin at the start
  Vec3 rotation_vector_rad = Vec3::Zero();  ///< its orientation at the start
  bool gravity = false;                     ///< off: a device holds its own weight
  VirtualCouplingSpec coupling = {};        ///< spring and damper to the handle
  double tick_s = 1e-3;                     ///< length of a haptic tick
  /// integrator of the tool's own ticks: see `palpate list tool-integrators`
  std::string integrator = "linearly-implicit-euler";
  /// of the handle: while it is pressed the tool holds what pressed on it when it closed; -1: none
  int grasp_switch = -1;
};

/// What they may be: checked by the loader of scenes and by the tool.
struct ToolRanges {
  static constexpr Range radius_m = Range::positive();     ///< [m]
  static constexpr Range coupling = Range::at_least(0.0);  ///< each of its four numbers
  static constexpr Range grasp_switch = Range::closed(-1, 31, "-1 grasps nothing");  ///< a switch's number
  /// [s]
  static constexpr Range tick_s = Range::open(0.0, 0.1, "a haptic device asks for 0.001");
};

}  // namespace palpate
