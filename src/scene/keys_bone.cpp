#include "scene/keys.h"

namespace palpate::scene {

const KeyTable<BoneSpec>& bone_keys() {
  static const KeyTable<BoneSpec> keys = {
      required(text("name", &BoneSpec::name)),
      text("shape", &BoneSpec::shape, {"sphere", "box", "cylinder", "capsule"}),
      number("radius_m", &BoneSpec::radius_m, positive()),
      number("length_m", &BoneSpec::length_m, positive()),
      vec3("size_m", &BoneSpec::size_m, positive()),
      number("mass_kg", &BoneSpec::mass_kg, positive()),
      number("density_kg_m3", &BoneSpec::density_kg_m3, positive("bone has about 1800")),
      vec3("inertia_kg_m2", &BoneSpec::inertia_kg_m2,
           positive("it is the principal inertia about the centre of mass")),
      vec3("position_m", &BoneSpec::position_m),
      vec3("rotation_vector_rad", &BoneSpec::rotation_vector_rad),
      vec3("velocity_m_s", &BoneSpec::velocity_m_s),
      vec3("angular_velocity_rad_s", &BoneSpec::angular_velocity_rad_s),
      boolean("gravity", &BoneSpec::gravity),
      boolean("fixed", &BoneSpec::fixed),
      tables("keyframe", &BoneSpec::keyframes, keyframe_keys()),
  };
  return keys;
}

}  // namespace palpate::scene
