#include "scene/keys.h"

namespace palpate::scene {

const KeyTable<BoneSpec>& bone_keys() {
  static const KeyTable<BoneSpec> keys = {
      required(text("name", &BoneSpec::name, {}, "what attachments call it")),
      unless("none", text("shape", &BoneSpec::shape, {"sphere", "box", "cylinder", "capsule"},
                          "around its origin; round ones along z")),
      unless("none",
             number("radius_m", &BoneSpec::radius_m, positive(), "of a sphere, a cylinder or a capsule")),
      unless("none", number("length_m", &BoneSpec::length_m, positive(),
                            "of a cylinder; of a capsule between the middles of its caps")),
      unless("none", vec3("size_m", &BoneSpec::size_m, positive(), "edges of a box")),
      unless("none",
             number("mass_kg", &BoneSpec::mass_kg, positive(), "mass; or give a density and a shape")),
      unless("none", number("density_kg_m3", &BoneSpec::density_kg_m3, positive("bone has about 1800"),
                            "density that gives the shape its mass")),
      unless("the shape's", vec3("inertia_kg_m2", &BoneSpec::inertia_kg_m2,
                                 positive("it is the principal inertia about the centre of mass"),
                                 "principal inertia about the centre of mass")),
      vec3("position_m", &BoneSpec::position_m, any(), "centre of mass at the start"),
      vec3("rotation_vector_rad", &BoneSpec::rotation_vector_rad, any(),
           "orientation at the start: along the axis, as long as the angle"),
      vec3("velocity_m_s", &BoneSpec::velocity_m_s, any(), "velocity at the start"),
      vec3("angular_velocity_rad_s", &BoneSpec::angular_velocity_rad_s, any(),
           "angular velocity at the start"),
      boolean("gravity", &BoneSpec::gravity, "whether the bone itself has weight"),
      boolean("fixed", &BoneSpec::fixed, "stays at its position"),
      tables("keyframe", &BoneSpec::keyframes, keyframe_keys(),
             "moves from its position along them, rotating about its origin"),
  };
  return keys;
}

}  // namespace palpate::scene
