#include "scene/keys.h"

namespace palpate::scene {
namespace {

const KeyTable<AttachmentSpec>& attachment_keys() {
  static const KeyTable<AttachmentSpec> keys = {
      vec3("box_min_m", &AttachmentSpec::box_min_m, any(), "nodes in a box: its lower corner, at the start"),
      vec3("box_max_m", &AttachmentSpec::box_max_m, any(), "nodes in a box: its upper corner, at the start"),
      vec3("centre_m", &AttachmentSpec::centre_m, any(), "nodes in a sphere: its centre, at the start"),
      unless("none",
             number("radius_m", &AttachmentSpec::radius_m, positive(), "nodes in a sphere: its radius")),
      unless("the world", text("to", &AttachmentSpec::to, {},
                               "what carries the nodes: a bone, or a hand's tool (\"tool\" the first)")),
      text("axes", &AttachmentSpec::axes, {"x", "y", "z", "xy", "xz", "yz", "xyz"},
           "directions that are held"),
      tables("keyframe", &AttachmentSpec::keyframes, keyframe_keys(),
             "the nodes move rigidly along them, rotating about the middle of their region"),
  };
  return keys;
}

const KeyTable<LoadSpec>& load_keys() {
  static const KeyTable<LoadSpec> keys = {
      required(
          vec3("box_min_m", &LoadSpec::box_min_m, any(), "nodes that are loaded: lower corner of a box")),
      required(
          vec3("box_max_m", &LoadSpec::box_max_m, any(), "nodes that are loaded: upper corner of a box")),
      required(vec3("force_n", &LoadSpec::force_n, any(),
                    "total force, spread by the nodes' share of the boundary's area")),
  };
  return keys;
}

const KeyTable<RegionSpec>& region_keys() {
  static const KeyTable<RegionSpec> keys = {
      required(
          text("name", &RegionSpec::name, {}, "a region of the mesh file, or a name for the box or sphere")),
      vec3("box_min_m", &RegionSpec::box_min_m, any(), "elements in a box: its lower corner, at the start"),
      vec3("box_max_m", &RegionSpec::box_max_m, any(), "elements in a box: its upper corner, at the start"),
      vec3("centre_m", &RegionSpec::centre_m, any(), "elements in a sphere: its centre, at the start"),
      unless("none",
             number("radius_m", &RegionSpec::radius_m, positive(), "elements in a sphere: its radius")),
      unless("the body's", number("youngs_modulus_pa", &RegionSpec::youngs_modulus_pa,
                                  MaterialRanges::youngs_modulus_pa, "Young's modulus of these elements")),
      unless("the body's", number("poissons_ratio", &RegionSpec::poissons_ratio,
                                  MaterialRanges::poissons_ratio, "Poisson's ratio of these elements")),
      unless("the body's", number("density_kg_m3", &RegionSpec::density_kg_m3, MaterialRanges::density_kg_m3,
                                  "density of these elements")),
      unless("the body's",
             number("mass_damping_per_s", &RegionSpec::mass_damping_per_s, MaterialRanges::mass_damping_per_s,
                    "Rayleigh damping in proportion to the mass")),
      unless("the body's",
             number("stiffness_damping_s", &RegionSpec::stiffness_damping_s,
                    MaterialRanges::stiffness_damping_s, "Rayleigh damping in proportion to the stiffness")),
  };
  return keys;
}

const KeyTable<MaterialChangeSpec>& change_keys() {
  static const KeyTable<MaterialChangeSpec> keys = {
      required(number("time_s", &MaterialChangeSpec::time_s, positive(),
                      "when it changes: from the step on that begins then")),
      required(number("youngs_modulus_pa", &MaterialChangeSpec::youngs_modulus_pa,
                      MaterialRanges::youngs_modulus_pa, "Young's modulus from then on; damping goes along")),
      unless("the body", text("region", &MaterialChangeSpec::region, {}, "the region that changes")),
  };
  return keys;
}

const KeyTable<JointSpec>& joint_keys() {
  static const KeyTable<JointSpec> keys = {
      required(text("bone", &JointSpec::bone, {}, "the bone that hangs on its parent by this joint")),
      unless("the skeleton's", text("type", &JointSpec::type, {"weld", "hinge", "ball", "free"},
                                    "how it may move against its parent")),
      unless("none", vec3("axis", &JointSpec::axis, any(), "of a hinge, in the body's own axes")),
      unless("the skeleton's", number("stiffness_n_m_rad", &JointSpec::stiffness_n_m_rad, at_least(0.0),
                                      "torsion spring of the joint, towards the start")),
      unless("the skeleton's", number("damping_n_m_s_rad", &JointSpec::damping_n_m_s_rad, at_least(0.0),
                                      "torsion damper of the joint")),
      tables("keyframe", &JointSpec::keyframes, keyframe_keys(),
             "rotations about the joint and shifts, against the parent, in the body's own axes"),
  };
  return keys;
}

const KeyTable<SkeletonSpec>& skeleton_keys() {
  static const KeyTable<SkeletonSpec> keys = {
      text("root", &SkeletonSpec::root, {"weld", "ball", "free"},
           "how bones without a parent hang on the world"),
      text("joints", &SkeletonSpec::others, {"weld", "ball"}, "how the other bones hang on their parents"),
      unless("none", number("density_kg_m3", &SkeletonSpec::density_kg_m3,
                            positive("bone has about 1800, 800 more than the tissue that its nodes weigh"),
                            "of bones that move freely, on top of the tissue that their nodes weigh")),
      number("stiffness_n_m_rad", &SkeletonSpec::stiffness_n_m_rad, at_least(0.0),
             "torsion spring of hinges and balls, towards the start"),
      number("damping_n_m_s_rad", &SkeletonSpec::damping_n_m_s_rad, at_least(0.0),
             "torsion damper of hinges and balls"),
      tables("joint", &SkeletonSpec::joints, joint_keys(),
             "a joint that differs from the rest, or moves by a script"),
  };
  return keys;
}

}  // namespace

const KeyTable<MeshSpec>& mesh_keys() {
  static const KeyTable<MeshSpec> keys = {
      unless("none",
             text("file", &MeshSpec::file, {},
                  "a mesh file; its path starts at the scene's folder; \"model:NAME\" is what `palpate "
                  "model NAME` makes")),
      unless("none",
             text("generator", &MeshSpec::generator, {}, "a shape that palpate meshes, around the origin")),
      vec3("size_m", &MeshSpec::size_m, MeshRanges::length, "edges of a box, legs of a tetrahedron"),
      number("radius_m", &MeshSpec::radius_m, MeshRanges::length, "radius of a ball or a cylinder"),
      number("length_m", &MeshSpec::length_m, MeshRanges::length, "length of a cylinder, along z"),
      number("element_size_m", &MeshSpec::element_size_m, MeshRanges::length,
             "wanted edge length of elements"),
      number("grading", &MeshSpec::grading, MeshRanges::grading,
             "size of elements in the middle over that at the surface; 1 is uniform"),
      unless("1", number("scale", &MeshSpec::scale, MeshRanges::scale,
                         "multiplies a file's coordinates; to be given where it is larger than 10 m or "
                         "smaller than 1 mm")),
  };
  return keys;
}

const KeyTable<KeyframeSpec>& keyframe_keys() {
  static const KeyTable<KeyframeSpec> keys = {
      required(number("time_s", &KeyframeSpec::time_s, at_least(0.0), "when it is reached")),
      vec3("position_m", &KeyframeSpec::position_m, any(), "position then"),
      vec3("rotation_vector_rad", &KeyframeSpec::rotation_vector_rad, any(),
           "orientation then: along the axis, as long as the angle"),
      text("interpolation", &KeyframeSpec::interpolation, {"minimum_jerk", "linear", "step"},
           "how it is reached from the keyframe before"),
  };
  return keys;
}

const KeyTable<SoftBodySpec>& body_keys() {
  static const KeyTable<SoftBodySpec> keys = {
      required(text("name", &SoftBodySpec::name, {}, "what [[contact]] and results call it")),
      required(table("mesh", &SoftBodySpec::mesh, mesh_keys(), "its tetrahedra: a file or a generator")),
      boolean("skin", &SoftBodySpec::skin,
              "contact and pictures on the skin of a model file, not on the tetrahedra"),
      boolean("proxies", &SoftBodySpec::proxies,
              "contact in image space only where the skin's convex proxies come near"),
      vec3("position_m", &SoftBodySpec::position_m, any(),
           "where the origin of the mesh is placed at the start"),
      vec3("rotation_vector_rad", &SoftBodySpec::rotation_vector_rad, any(),
           "how the mesh is rotated at the start: along the axis, as long as the angle"),
      vec3("velocity_m_s", &SoftBodySpec::velocity_m_s, any(), "velocity at the start"),
      vec3("angular_velocity_rad_s", &SoftBodySpec::angular_velocity_rad_s, any(),
           "angular velocity at the start, about the centre of mass"),
      required(number("youngs_modulus_pa", &SoftBodySpec::youngs_modulus_pa,
                      MaterialRanges::youngs_modulus_pa, "Young's modulus")),
      number("poissons_ratio", &SoftBodySpec::poissons_ratio, MaterialRanges::poissons_ratio,
             "Poisson's ratio"),
      number("density_kg_m3", &SoftBodySpec::density_kg_m3, MaterialRanges::density_kg_m3, "mass per volume"),
      number("mass_damping_per_s", &SoftBodySpec::mass_damping_per_s, MaterialRanges::mass_damping_per_s,
             "Rayleigh damping in proportion to the mass"),
      number("stiffness_damping_s", &SoftBodySpec::stiffness_damping_s, MaterialRanges::stiffness_damping_s,
             "Rayleigh damping in proportion to the stiffness"),
      text("mass", &SoftBodySpec::mass, {"lumped", "consistent"},
           "mass at the nodes, or the consistent mass matrix"),
      text("material", &SoftBodySpec::material, {}, "the constitutive law"),
      text("tangent", &SoftBodySpec::tangent, {"exact", "projected", "warped"},
           "stiffness matrix: the derivative of the force, made definite, or rotated alone"),
      text("volumetric", &SoftBodySpec::volumetric, {"element", "nodal"},
           "change of volume by elements, or averaged at nodes (no locking near 0.5)"),
      boolean("full_damping_tangent", &SoftBodySpec::full_damping_tangent,
              "keep the unsymmetric part of the damping's derivative by position"),
      tables("region", &SoftBodySpec::regions, region_keys(), "elements with a material of their own"),
      table("skeleton", &SoftBodySpec::skeleton, skeleton_keys(),
            "the bones of the model file carry its nodes"),
      tables("attachment", &SoftBodySpec::attachments, attachment_keys(),
             "nodes that are held, driven or carried"),
      tables("load", &SoftBodySpec::loads, load_keys(), "a force spread over nodes"),
      tables("change", &SoftBodySpec::changes, change_keys(), "the body becomes stiffer or softer at a time"),
  };
  return keys;
}

}  // namespace palpate::scene
