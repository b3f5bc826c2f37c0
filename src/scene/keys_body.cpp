#include "scene/keys.h"

namespace palpate::scene {
namespace {

const KeyTable<AttachmentSpec>& attachment_keys() {
  static const KeyTable<AttachmentSpec> keys = {
      vec3("box_min_m", &AttachmentSpec::box_min_m, any(),
           "lower corner of a box that selects nodes by their initial position"),
      vec3("box_max_m", &AttachmentSpec::box_max_m, any(),
           "upper corner of a box that selects nodes by their initial position"),
      vec3("centre_m", &AttachmentSpec::centre_m, any(),
           "centre of a sphere that selects nodes by their initial position"),
      unless("none", number("radius_m", &AttachmentSpec::radius_m, positive(),
                            "radius of a sphere that selects nodes")),
      unless("the world", text("to", &AttachmentSpec::to, {},
                               "bone or tool that carries the nodes (\"tool\" is that of [tool])")),
      text("axes", &AttachmentSpec::axes, {"x", "y", "z", "xy", "xz", "yz", "xyz"}, "constrained directions"),
      tables("keyframe", &AttachmentSpec::keyframes, keyframe_keys(),
             "prescribed rigid motion of the nodes, with rotation about the middle of their region"),
  };
  return keys;
}

const KeyTable<LoadSpec>& load_keys() {
  static const KeyTable<LoadSpec> keys = {
      required(vec3("box_min_m", &LoadSpec::box_min_m, any(),
                    "lower corner of a box that selects the loaded nodes")),
      required(vec3("box_max_m", &LoadSpec::box_max_m, any(),
                    "upper corner of a box that selects the loaded nodes")),
      required(vec3("force_n", &LoadSpec::force_n, any(),
                    "total force, distributed over the nodes by boundary area")),
  };
  return keys;
}

const KeyTable<RegionSpec>& region_keys() {
  static const KeyTable<RegionSpec> keys = {
      required(text("name", &RegionSpec::name, {},
                    "name of a region of the mesh file, or a name for the box or sphere")),
      vec3("box_min_m", &RegionSpec::box_min_m, any(),
           "lower corner of a box that selects elements by their initial position"),
      vec3("box_max_m", &RegionSpec::box_max_m, any(),
           "upper corner of a box that selects elements by their initial position"),
      vec3("centre_m", &RegionSpec::centre_m, any(),
           "centre of a sphere that selects elements by their initial position"),
      unless("none", number("radius_m", &RegionSpec::radius_m, positive(),
                            "radius of a sphere that selects elements")),
      unless("none",
             text("material", &RegionSpec::material, {},
                  "material with published values: palpate list materials; keys beside it take precedence")),
      unless("the body's", number("youngs_modulus_pa", &RegionSpec::youngs_modulus_pa,
                                  MaterialRanges::youngs_modulus_pa, "Young's modulus of these elements")),
      unless("the body's", number("poissons_ratio", &RegionSpec::poissons_ratio,
                                  MaterialRanges::poissons_ratio, "Poisson's ratio of these elements")),
      unless("the body's", number("density_kg_m3", &RegionSpec::density_kg_m3, MaterialRanges::density_kg_m3,
                                  "density of these elements")),
      unless("the body's", number("mass_damping_per_s", &RegionSpec::mass_damping_per_s,
                                  MaterialRanges::mass_damping_per_s, "mass-proportional Rayleigh damping")),
      unless("the body's",
             number("stiffness_damping_s", &RegionSpec::stiffness_damping_s,
                    MaterialRanges::stiffness_damping_s, "stiffness-proportional Rayleigh damping")),
  };
  return keys;
}

const KeyTable<MaterialChangeSpec>& change_keys() {
  static const KeyTable<MaterialChangeSpec> keys = {
      required(number("time_s", &MaterialChangeSpec::time_s, positive(),
                      "time of the change; it applies from the step that begins then")),
      required(number("youngs_modulus_pa", &MaterialChangeSpec::youngs_modulus_pa,
                      MaterialRanges::youngs_modulus_pa,
                      "Young's modulus after the change; damping scales with it")),
      unless("the whole body", text("region", &MaterialChangeSpec::region, {}, "the region that changes")),
  };
  return keys;
}

const KeyTable<JointSpec>& joint_keys() {
  static const KeyTable<JointSpec> keys = {
      required(text("bone", &JointSpec::bone, {}, "bone that this joint connects to its parent")),
      unless("the skeleton's",
             option("type", &JointSpec::type, "motion relative to the parent that the joint allows")),
      unless("none", vec3("axis", &JointSpec::axis, any(), "axis of a hinge, in the body frame")),
      unless("the skeleton's", number("stiffness_n_m_rad", &JointSpec::stiffness_n_m_rad, at_least(0.0),
                                      "torsion spring of the joint, at rest in the initial pose")),
      unless("the skeleton's", number("damping_n_m_s_rad", &JointSpec::damping_n_m_s_rad, at_least(0.0),
                                      "torsion damper of the joint")),
      tables(
          "keyframe", &JointSpec::keyframes, keyframe_keys(),
          "prescribed rotation about the joint and translation, relative to the parent, in the body frame"),
  };
  return keys;
}

const KeyTable<SkeletonSpec>& skeleton_keys() {
  static const KeyTable<SkeletonSpec> keys = {
      option("root", &SkeletonSpec::root, "joint between the world and bones without a parent",
             {JointType::kWeld, JointType::kBall, JointType::kFree}),
      option("joints", &SkeletonSpec::others, "joint between the other bones and their parents",
             {JointType::kWeld, JointType::kBall}),
      unless("none",
             number("density_kg_m3", &SkeletonSpec::density_kg_m3,
                    positive("bone has about 1800, 800 more than the tissue whose mass its nodes have"),
                    "density of freely moving bones, in excess of the tissue whose mass their nodes have")),
      number("stiffness_n_m_rad", &SkeletonSpec::stiffness_n_m_rad, at_least(0.0),
             "torsion spring of hinges and balls, at rest in the initial pose"),
      number("damping_n_m_s_rad", &SkeletonSpec::damping_n_m_s_rad, at_least(0.0),
             "torsion damper of hinges and balls"),
      tables("joint", &SkeletonSpec::joints, joint_keys(),
             "a joint that differs from the others, or has a prescribed motion"),
  };
  return keys;
}

}  // namespace

const KeyTable<MeshSpec>& mesh_keys() {
  static const KeyTable<MeshSpec> keys = {
      unless("none", text("file", &MeshSpec::file, {},
                          "mesh file, relative to the scene's folder; \"model:NAME\" is the output of "
                          "`palpate model NAME`")),
      unless("none",
             text("generator", &MeshSpec::generator, {}, "shape that palpate meshes, around the origin")),
      vec3("size_m", &MeshSpec::size_m, MeshRanges::length, "edges of a box, legs of a tetrahedron"),
      number("radius_m", &MeshSpec::radius_m, MeshRanges::length, "radius of a ball or a cylinder"),
      number("length_m", &MeshSpec::length_m, MeshRanges::length, "length of a cylinder, along z"),
      number("element_size_m", &MeshSpec::element_size_m, MeshRanges::length,
             "target edge length of elements"),
      number("grading", &MeshSpec::grading, MeshRanges::grading,
             "ratio of element size in the middle to that at the surface; 1 is uniform"),
      unless("1", number("scale", &MeshSpec::scale, MeshRanges::scale,
                         "factor on the coordinates of a file; required if the mesh is larger than 10 m or "
                         "smaller than 1 mm")),
  };
  return keys;
}

const KeyTable<KeyframeSpec>& keyframe_keys() {
  static const KeyTable<KeyframeSpec> keys = {
      required(number("time_s", &KeyframeSpec::time_s, at_least(0.0), "time at which the pose is reached")),
      vec3("position_m", &KeyframeSpec::position_m, any(), "position at that time"),
      vec3("rotation_vector_rad", &KeyframeSpec::rotation_vector_rad, any(),
           "orientation at that time, as rotation axis times angle"),
      option("interpolation", &KeyframeSpec::interpolation, "interpolation from the previous keyframe"),
  };
  return keys;
}

const KeyTable<SoftBodySpec>& body_keys() {
  static const KeyTable<SoftBodySpec> keys = {
      required(text("name", &SoftBodySpec::name, {}, "name used in [[contact]] and in results")),
      required(table("mesh", &SoftBodySpec::mesh, mesh_keys(), "tetrahedral mesh: a file or a generator")),
      boolean("skin", &SoftBodySpec::skin,
              "contact and pictures use the skin of a model file instead of the tetrahedra's surface"),
      boolean("proxies", &SoftBodySpec::proxies,
              "restrict contact in image space to places where the skin's convex proxies come close"),
      vec3("position_m", &SoftBodySpec::position_m, any(), "initial position of the mesh's origin"),
      vec3("rotation_vector_rad", &SoftBodySpec::rotation_vector_rad, any(),
           "initial rotation of the mesh, as rotation axis times angle"),
      vec3("velocity_m_s", &SoftBodySpec::velocity_m_s, any(), "initial velocity"),
      vec3("angular_velocity_rad_s", &SoftBodySpec::angular_velocity_rad_s, any(),
           "initial angular velocity, about the centre of mass"),
      unless("none",
             text("material", &SoftBodySpec::material, {},
                  "material with published values: palpate list materials; keys beside it take precedence")),
      required(number("youngs_modulus_pa", &SoftBodySpec::youngs_modulus_pa,
                      MaterialRanges::youngs_modulus_pa, "Young's modulus; not required beside material")),
      number("poissons_ratio", &SoftBodySpec::poissons_ratio, MaterialRanges::poissons_ratio,
             "Poisson's ratio"),
      number("density_kg_m3", &SoftBodySpec::density_kg_m3, MaterialRanges::density_kg_m3, "mass per volume"),
      number("mass_damping_per_s", &SoftBodySpec::mass_damping_per_s, MaterialRanges::mass_damping_per_s,
             "mass-proportional Rayleigh damping"),
      number("stiffness_damping_s", &SoftBodySpec::stiffness_damping_s, MaterialRanges::stiffness_damping_s,
             "stiffness-proportional Rayleigh damping"),
      option("mass", &SoftBodySpec::mass, "lumped mass at the nodes, or the consistent mass matrix"),
      text("law", &SoftBodySpec::law, {}, "the constitutive law: palpate list laws"),
      option(
          "tangent", &SoftBodySpec::tangent,
          "stiffness matrix: exact derivative of the force, projected to positive definite, or only rotated"),
      option("volumetric", &SoftBodySpec::volumetric,
             "volume change per element, or averaged at nodes (no locking for poissons_ratio near 0.5)"),
      boolean("full_damping_tangent", &SoftBodySpec::full_damping_tangent,
              "keep the unsymmetric part of the derivative of the damping force by position"),
      tables("region", &SoftBodySpec::regions, region_keys(), "elements with a different material"),
      table("skeleton", &SoftBodySpec::skeleton, skeleton_keys(),
            "bones of the model file that carry nodes of the body"),
      tables("attachment", &SoftBodySpec::attachments, attachment_keys(),
             "nodes that are held, driven or carried"),
      tables("load", &SoftBodySpec::loads, load_keys(), "a force distributed over nodes"),
      tables("change", &SoftBodySpec::changes, change_keys(), "a change of stiffness at a given time"),
  };
  return keys;
}

}  // namespace palpate::scene
