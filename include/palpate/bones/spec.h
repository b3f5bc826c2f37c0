#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/device/spec.h"

namespace palpate {

/// Shape of a bone, centred at its origin; cylinder and capsule lie along z.
enum class BoneShape { kSphere, kBox, kCylinder, kCapsule };
/// Returns the names of the values.
constexpr std::array<std::string_view, 4> option_names(BoneShape) {
  return {"sphere", "box", "cylinder", "capsule"};
}

/// Joint of a bone to its parent, or to the world.
enum class JointType {
  kWeld,   ///< no motion
  kHinge,  ///< rotation about an axis
  kBall,   ///< any rotation
  kFree,   ///< rotation and translation, for a bone without a parent
};
/// Returns the names of the values.
constexpr std::array<std::string_view, 4> option_names(JointType) {
  return {"weld", "hinge", "ball", "free"};
}

/// A `[[bone]]` table of a scene: a rigid body inside soft ones, which carries some of their nodes.  It moves
/// freely unless it is fixed or has keyframes.
struct BoneSpec {
  std::string name;                ///< unique in the scene
  std::optional<BoneShape> shape;  ///< empty: mass and inertia are given
  double radius_m = 0.0;           ///< radius of a sphere, a cylinder, a capsule
  /// Length of a cylinder, or of a capsule between the centres of its caps.
  double length_m = 0.0;
  Vec3 size_m = Vec3::Zero();  ///< edge lengths of a box
  double mass_kg = 0.0;        ///< mass; alternative: density_kg_m3 with a shape
  double density_kg_m3 = 0.0;  ///< density of the shape; mass_kg is then omitted
  /// Principal moments about the centre of mass; zero: moments of the shape, filled evenly.
  Vec3 inertia_kg_m2 = Vec3::Zero();
  Vec3 position_m = Vec3::Zero();              ///< initial position of the centre of mass
  Vec3 rotation_vector_rad = Vec3::Zero();     ///< initial orientation
  Vec3 velocity_m_s = Vec3::Zero();            ///< initial velocity of its origin, world axes
  Vec3 angular_velocity_rad_s = Vec3::Zero();  ///< initial angular velocity, world axes
  bool gravity = true;                         ///< false: the bone has no weight
  bool fixed = false;                          ///< stays at its initial pose
  /// Prescribed motion from the initial pose: these translations, and these rotations about the bone's
  /// origin.
  std::vector<KeyframeSpec> keyframes;
};

/// Joint of a skeleton that differs from the skeleton's default, or moves by keyframes.
struct JointSpec {
  std::string bone;                 ///< bone that this joint attaches to its parent
  std::optional<JointType> type;    ///< kFree is for a root; empty: the skeleton's default
  Vec3 axis = Vec3::Zero();         ///< axis of a hinge, in body axes
  double stiffness_n_m_rad = -1.0;  ///< negative: the skeleton's default
  double damping_n_m_s_rad = -1.0;  ///< negative: the skeleton's default
  /// Rotations about the joint, and translations, relative to the parent, in body axes; the joint then has no
  /// type.
  std::vector<KeyframeSpec> keyframes;
};

/// The `[body.skeleton]` table: the bones of a model file, connected by joints, carry the nodes that the file
/// binds to them.
struct SkeletonSpec {
  JointType root = JointType::kWeld;    ///< joint of bones without a parent to the world: no hinge
  JointType others = JointType::kWeld;  ///< joint of all other bones to their parents: weld or ball
  /// Density of bones that move freely, in addition to the tissue mass of their nodes.
  double density_kg_m3 = 0.0;
  double stiffness_n_m_rad = 0.0;  ///< stiffness of hinges and balls, towards the initial pose
  double damping_n_m_s_rad = 0.0;  ///< damping of hinges and balls
  std::vector<JointSpec> joints;   ///< joints that differ from the defaults
};

}  // namespace palpate
