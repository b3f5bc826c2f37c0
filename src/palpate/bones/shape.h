#pragma once
#include "palpate/bones/spec.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/skeleton.h"

/// What the shape of a bone says: its mass and inertia, what is inside, what it looks like.  In the bone's
/// own axes, origin at the centre of mass.
namespace palpate::bones {

struct BoneInertia {
  double mass = 0.0;              ///< [kg]
  Vec3 principal = Vec3::Zero();  ///< about the centre of mass [kg m^2]
};

/// Mass and inertia of a free bone: what the spec gives, the rest from its shape, filled evenly.
/// @throws Error where the shape has no volume or the moments are no body's
BoneInertia bone_inertia(const BoneSpec& spec);

/// A bone of a model file: the hull of a ball at each end, filled evenly.  Its own frame has the origin at
/// the centre of mass and z from head to tail.
struct TaperedBone {
  double volume = 0.0;               ///< [m^3]
  Vec3 unit_moments = Vec3::Zero();  ///< principal, about the centre of mass, of mass 1 [m^2]
  Pose frame;                        ///< in the axes of the model
};
TaperedBone tapered_bone(const Bone& bone);
/// Its surface in that frame.
TriMesh tapered_bone_surface(const Bone& bone);

/// Volume of the shape [m^3]; zero without one.
double bone_volume(const BoneSpec& spec);

/// Whether a point is inside the shape, its surface included (to 1e-9 of the distance); false without a
/// shape.
bool inside_bone(const BoneSpec& spec, const Vec3& p);

/// The shape's surface, for pictures and records; empty without one.
TriMesh bone_surface(const BoneSpec& spec);

}  // namespace palpate::bones
