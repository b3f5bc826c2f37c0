#pragma once
#include <array>
#include <string>
#include <string_view>

#include "palpate/core/types.h"
#include "palpate/mesh/spec.h"

namespace palpate {

/// Shape of a tool: a sphere, with analytic gaps, or any closed surface.
enum class ToolShape { kSphere, kMesh };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(ToolShape) { return {"sphere", "mesh"}; }

/// Where a tool starts: at its position_m, or at the first touch of an object on its way from there.
enum class ToolStart { kPlaced, kTouching };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(ToolStart) { return {"placed", "touching"}; }

/// Parameters of the virtual coupling between handle and tool, a spring and a damper in each of six
/// directions: the `[tool.coupling]` table of a scene.
struct VirtualCouplingSpec {
  double stiffness_n_m = 300.0;                ///< Spring between the two origins.
  double damping_n_s_m = 2.0;                  ///< Damper between the two origins.
  double rotational_stiffness_n_m_rad = 0.3;   ///< Spring between the two orientations.
  double rotational_damping_n_m_s_rad = 1e-3;  ///< Damper between the two orientations.
};

/// Parameters of a tool, the `[tool]` table of a scene: a rigid body that a 6-DoF spring-damper pulls after
/// the handle.
struct ToolSpec {
  ToolShape shape = ToolShape::kSphere;     ///< Sphere or closed surface.
  double radius_m = 0.01;                   ///< Radius of the sphere.
  MeshSpec mesh;                            ///< Surface, for ToolShape::kMesh and for gpu contact.
  double mass_kg = 0.1;                     ///< Positive.
  Vec3 inertia_kg_m2 = Vec3::Zero();        ///< Principal, about the centre of mass; zero: a solid sphere's.
  Vec3 position_m = Vec3::Zero();           ///< Origin at the start.
  Vec3 rotation_vector_rad = Vec3::Zero();  ///< Orientation at the start.
  /// kTouching: assembly moves the tool from position_m along start_direction until it touches an object of
  /// its contacts, and the device's keyframes with it (src/loop/placing.h).
  ToolStart start = ToolStart::kPlaced;
  Vec3 start_direction = -Vec3::UnitZ();  ///< World axes, any length; for ToolStart::kTouching.
  bool gravity = false;                   ///< Whether the tool has weight; off, as a device carries it.
  VirtualCouplingSpec coupling = {};      ///< Spring and damper to the handle.
  double tick_s = 1e-3;                   ///< Length of a haptic tick.
  /// Integrator of the tool's ticks: see `palpate list tool-integrators`.
  std::string integrator = "linearly-implicit-euler";
  /// Switch of the handle that grasps: while pressed, the tool holds the contact points that pressed on it
  /// when the switch closed. -1: none.
  int grasp_switch = -1;
};

/// Valid ranges of the parameters, checked by the scene loader and by the tool.
struct ToolRanges {
  static constexpr Range radius_m = Range::positive();     ///< [m]
  static constexpr Range coupling = Range::at_least(0.0);  ///< Each of the four coupling parameters.
  static constexpr Range grasp_switch =
      Range::closed(-1, 31, "-1 disables grasping");  ///< Index of a switch.
  /// Tick length [s].
  static constexpr Range tick_s = Range::open(0.0, 0.1, "a haptic device needs 0.001");
};

}  // namespace palpate
