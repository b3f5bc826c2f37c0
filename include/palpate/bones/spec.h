#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/device/spec.h"

namespace palpate {

/// The `[[bone]]` tables of a scene: a rigid body inside soft ones, which carries nodes of theirs.  Free
/// unless it is fixed or has keyframes.
struct BoneSpec {
  std::string name;  ///< unique in the scene
  /// "sphere", "box", "cylinder" or "capsule" (both along z), around its origin; empty: mass and inertia are
  /// given
  std::string shape;
  double radius_m = 0.0;  ///< of a sphere, a cylinder, a capsule
  /// of a cylinder, and of a capsule between the middles of its caps
  double length_m = 0.0;
  Vec3 size_m = Vec3::Zero();  ///< of a box
  double mass_kg = 0.0;        ///< or density_kg_m3 of the shape
  double density_kg_m3 = 0.0;  ///< of the shape; then mass_kg is left out
  /// principal, about the centre of mass; zero: the shape's, filled evenly
  Vec3 inertia_kg_m2 = Vec3::Zero();
  Vec3 position_m = Vec3::Zero();              ///< of its centre of mass, at the start
  Vec3 rotation_vector_rad = Vec3::Zero();     ///< its orientation at the start
  Vec3 velocity_m_s = Vec3::Zero();            ///< of its origin at the start, world axes
  Vec3 angular_velocity_rad_s = Vec3::Zero();  ///< at the start, world axes
  bool gravity = true;                         ///< false: the bone itself has no weight
  bool fixed = false;                          ///< stays where it is placed
  /// moves from where it is placed: by these positions, and by these rotations about its own origin
  std::vector<KeyframeSpec> keyframes;
};

/// One joint of a skeleton that differs from the rest, or moves by a script.
struct JointSpec {
  std::string bone;  ///< which hangs on its parent by it
  /// "weld", "hinge", "ball", of a root also "free"; empty: the skeleton's
  std::string type;
  Vec3 axis = Vec3::Zero();         ///< of a hinge, in the body's own axes
  double stiffness_n_m_rad = -1.0;  ///< negative: the skeleton's
  double damping_n_m_s_rad = -1.0;  ///< negative: the skeleton's
  /// rotations about the joint, and shifts, against its parent, in the body's own axes; then it has no type
  std::vector<KeyframeSpec> keyframes;
};

/// The `[body.skeleton]` table: the bones of a model file, on joints, carry the nodes that the file binds to
/// them.
struct SkeletonSpec {
  /// how bones without a parent hang on the world: "weld", "ball" or "free"
  std::string root = "weld";
  std::string others = "weld";  ///< how the others hang on their parents: "weld" or "ball"
  /// of bones that move freely, on top of the tissue that their nodes weigh
  double density_kg_m3 = 0.0;
  double stiffness_n_m_rad = 0.0;  ///< of hinges and balls, towards the start
  double damping_n_m_s_rad = 0.0;  ///< of hinges and balls
  std::vector<JointSpec> joints;   ///< those that differ from the rest
};

}  // namespace palpate
