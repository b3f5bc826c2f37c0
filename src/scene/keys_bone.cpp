#include "scene/keys.h"

namespace palpate::scene {

const KeyTable<BoneSpec>& bone_keys() {
  static const KeyTable<BoneSpec> keys = {
      required(text("name", &BoneSpec::name, {}, "name used by attachments")),
      unless("none", option("shape", &BoneSpec::shape,
                            "shape around the bone's origin; cylinder and capsule along z")),
      unless("none",
             number("radius_m", &BoneSpec::radius_m, positive(), "radius of a sphere, cylinder or capsule")),
      unless("none", number("length_m", &BoneSpec::length_m, positive(),
                            "length of a cylinder, or of a capsule between the centres of its caps")),
      unless("none", vec3("size_m", &BoneSpec::size_m, positive(), "edges of a box")),
      unless("none", number("mass_kg", &BoneSpec::mass_kg, positive(),
                            "mass; alternatively, give a density and a shape")),
      unless("none", number("density_kg_m3", &BoneSpec::density_kg_m3, positive("bone has about 1800"),
                            "density from which the mass of the shape is computed")),
      unless("the shape's", vec3("inertia_kg_m2", &BoneSpec::inertia_kg_m2,
                                 positive("it is the principal inertia about the centre of mass"),
                                 "principal inertia about the centre of mass")),
      vec3("position_m", &BoneSpec::position_m, any(), "initial position of the centre of mass"),
      vec3("rotation_vector_rad", &BoneSpec::rotation_vector_rad, any(),
           "initial orientation, as rotation axis times angle"),
      vec3("velocity_m_s", &BoneSpec::velocity_m_s, any(), "initial velocity"),
      vec3("angular_velocity_rad_s", &BoneSpec::angular_velocity_rad_s, any(), "initial angular velocity"),
      boolean("gravity", &BoneSpec::gravity, "whether gravity acts on the bone itself"),
      boolean("fixed", &BoneSpec::fixed, "whether the bone is fixed at its position"),
      tables("keyframe", &BoneSpec::keyframes, keyframe_keys(),
             "prescribed motion relative to its position, with rotation about its origin"),
  };
  return keys;
}

}  // namespace palpate::scene
