#pragma once
#include "palpate/bones/spec.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/skeleton.h"

/// Properties of a bone's shape: mass and inertia, interior, surface.  In bone axes, with the origin at the
/// centre of mass.
namespace palpate::bones {

/// Mass and principal moments of a bone.
struct BoneInertia {
  double mass = 0.0;              ///< [kg]
  Vec3 principal = Vec3::Zero();  ///< about the centre of mass [kg m^2]
};

/// Returns mass and inertia of a free bone: the values of the spec, and the others from its shape, filled
/// evenly.
/// @throws Error if the shape has no volume, or the mass and moments are not those of a rigid body
BoneInertia bone_inertia(const BoneSpec& spec);

/// Bone of a model file: the convex hull of a ball at each end, filled evenly.  Its frame has the origin at
/// the centre of mass and z from head to tail.
struct TaperedBone {
  double volume = 0.0;               ///< [m^3]
  Vec3 unit_moments = Vec3::Zero();  ///< principal moments about the centre of mass, for mass 1 [m^2]
  Pose frame;                        ///< pose in the axes of the model
};
/// Computes the mass properties of a bone of a model file.
/// @throws Error for a radius that is not positive
TaperedBone tapered_bone(const Bone& bone);
/// Returns the bone's surface in that frame.
TriMesh tapered_bone_surface(const Bone& bone);

/// Returns the volume of the shape [m^3]; zero without one.
double bone_volume(const BoneSpec& spec);

/// Whether a point is inside the shape, its surface included (to a relative 1e-9); false without a shape.
bool inside_bone(const BoneSpec& spec, const Vec3& p);

/// Returns the shape's surface, for pictures and records; empty without one.
TriMesh bone_surface(const BoneSpec& spec);

}  // namespace palpate::bones
