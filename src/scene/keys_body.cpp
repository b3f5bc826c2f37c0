#include "scene/keys.h"

namespace palpate::scene {
namespace {

const KeyTable<AttachmentSpec>& attachment_keys() {
  static const KeyTable<AttachmentSpec> keys = {
      vec3("box_min_m", &AttachmentSpec::box_min_m),
      vec3("box_max_m", &AttachmentSpec::box_max_m),
      vec3("centre_m", &AttachmentSpec::centre_m),
      number("radius_m", &AttachmentSpec::radius_m, positive()),
      text("to", &AttachmentSpec::to),
      text("axes", &AttachmentSpec::axes, {"x", "y", "z", "xy", "xz", "yz", "xyz"}),
      tables("keyframe", &AttachmentSpec::keyframes, keyframe_keys()),
  };
  return keys;
}

const KeyTable<LoadSpec>& load_keys() {
  static const KeyTable<LoadSpec> keys = {
      required(vec3("box_min_m", &LoadSpec::box_min_m)),
      required(vec3("box_max_m", &LoadSpec::box_max_m)),
      required(vec3("force_n", &LoadSpec::force_n)),
  };
  return keys;
}

const char* const kYoungs = "soft tissue has 1e3 to 1e5";
const char* const kPoisson = "use 0.49 for nearly incompressible tissue";
const char* const kDensity = "water and soft tissue have about 1000";
const char* const kDamping = "1e-3 damps lightly, 1e-2 strongly";

const KeyTable<RegionSpec>& region_keys() {
  static const KeyTable<RegionSpec> keys = {
      required(text("name", &RegionSpec::name)),
      vec3("box_min_m", &RegionSpec::box_min_m),
      vec3("box_max_m", &RegionSpec::box_max_m),
      vec3("centre_m", &RegionSpec::centre_m),
      number("radius_m", &RegionSpec::radius_m, positive()),
      number("youngs_modulus_pa", &RegionSpec::youngs_modulus_pa, positive(kYoungs)),
      number("poissons_ratio", &RegionSpec::poissons_ratio, open(-1.0, 0.5, kPoisson)),
      number("density_kg_m3", &RegionSpec::density_kg_m3, positive(kDensity)),
      number("mass_damping_per_s", &RegionSpec::mass_damping_per_s, at_least(0.0)),
      number("stiffness_damping_s", &RegionSpec::stiffness_damping_s, at_least(0.0, kDamping)),
  };
  return keys;
}

const KeyTable<MaterialChangeSpec>& change_keys() {
  static const KeyTable<MaterialChangeSpec> keys = {
      required(number("time_s", &MaterialChangeSpec::time_s, positive())),
      required(number("youngs_modulus_pa", &MaterialChangeSpec::youngs_modulus_pa, positive())),
      text("region", &MaterialChangeSpec::region),
  };
  return keys;
}

const KeyTable<JointSpec>& joint_keys() {
  static const KeyTable<JointSpec> keys = {
      required(text("bone", &JointSpec::bone)),
      text("type", &JointSpec::type, {"weld", "hinge", "ball", "free"}),
      vec3("axis", &JointSpec::axis),
      number("stiffness_n_m_rad", &JointSpec::stiffness_n_m_rad, at_least(0.0)),
      number("damping_n_m_s_rad", &JointSpec::damping_n_m_s_rad, at_least(0.0)),
      tables("keyframe", &JointSpec::keyframes, keyframe_keys()),
  };
  return keys;
}

const KeyTable<SkeletonSpec>& skeleton_keys() {
  static const KeyTable<SkeletonSpec> keys = {
      text("root", &SkeletonSpec::root, {"weld", "ball", "free"}),
      text("joints", &SkeletonSpec::others, {"weld", "ball"}),
      number("density_kg_m3", &SkeletonSpec::density_kg_m3,
             positive("bone has about 1800, 800 more than the flesh that its nodes weigh")),
      number("stiffness_n_m_rad", &SkeletonSpec::stiffness_n_m_rad, at_least(0.0)),
      number("damping_n_m_s_rad", &SkeletonSpec::damping_n_m_s_rad, at_least(0.0)),
      tables("joint", &SkeletonSpec::joints, joint_keys()),
  };
  return keys;
}

}  // namespace

const KeyTable<MeshSpec>& mesh_keys() {
  static const KeyTable<MeshSpec> keys = {
      text("file", &MeshSpec::file),
      text("generator", &MeshSpec::generator, {"box", "ball", "cylinder", "tet"}),
      vec3("size_m", &MeshSpec::size_m, positive()),
      number("radius_m", &MeshSpec::radius_m, positive()),
      number("length_m", &MeshSpec::length_m, positive()),
      number("element_size_m", &MeshSpec::element_size_m, positive()),
      number(
          "grading", &MeshSpec::grading,
          closed(0.5, 32.0, "1 is uniform, 2 makes elements in the middle twice as large as at the surface")),
      number("scale", &MeshSpec::scale, positive("0.001 turns a file in millimetres into metres")),
  };
  return keys;
}

const KeyTable<KeyframeSpec>& keyframe_keys() {
  static const KeyTable<KeyframeSpec> keys = {
      required(number("time_s", &KeyframeSpec::time_s, at_least(0.0))),
      vec3("position_m", &KeyframeSpec::position_m),
      vec3("rotation_vector_rad", &KeyframeSpec::rotation_vector_rad),
      text("interpolation", &KeyframeSpec::interpolation, {"minimum_jerk", "linear", "step"}),
  };
  return keys;
}

const KeyTable<SoftBodySpec>& body_keys() {
  static const KeyTable<SoftBodySpec> keys = {
      required(text("name", &SoftBodySpec::name)),
      required(table("mesh", &SoftBodySpec::mesh, mesh_keys())),
      boolean("skin", &SoftBodySpec::skin),
      boolean("proxies", &SoftBodySpec::proxies),
      vec3("position_m", &SoftBodySpec::position_m),
      vec3("rotation_vector_rad", &SoftBodySpec::rotation_vector_rad),
      vec3("velocity_m_s", &SoftBodySpec::velocity_m_s),
      vec3("angular_velocity_rad_s", &SoftBodySpec::angular_velocity_rad_s),
      required(number("youngs_modulus_pa", &SoftBodySpec::youngs_modulus_pa, positive(kYoungs))),
      number("poissons_ratio", &SoftBodySpec::poissons_ratio, open(-1.0, 0.5, kPoisson)),
      number("density_kg_m3", &SoftBodySpec::density_kg_m3, positive(kDensity)),
      number("mass_damping_per_s", &SoftBodySpec::mass_damping_per_s, at_least(0.0)),
      number("stiffness_damping_s", &SoftBodySpec::stiffness_damping_s, at_least(0.0, kDamping)),
      text("mass", &SoftBodySpec::mass, {"lumped", "consistent"}),
      text("material", &SoftBodySpec::material),
      text("tangent", &SoftBodySpec::tangent, {"exact", "projected", "warped"}),
      text("volumetric", &SoftBodySpec::volumetric, {"element", "nodal"}),
      boolean("full_damping_tangent", &SoftBodySpec::full_damping_tangent),
      tables("region", &SoftBodySpec::regions, region_keys()),
      table("skeleton", &SoftBodySpec::skeleton, skeleton_keys()),
      tables("attachment", &SoftBodySpec::attachments, attachment_keys()),
      tables("load", &SoftBodySpec::loads, load_keys()),
      tables("change", &SoftBodySpec::changes, change_keys()),
  };
  return keys;
}

}  // namespace palpate::scene
