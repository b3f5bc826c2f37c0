#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/bones/spec.h"
#include "palpate/core/keys.h"
#include "palpate/core/types.h"
#include "palpate/device/spec.h"
#include "palpate/mesh/spec.h"

namespace palpate {

/// Nodes inside a box or a sphere (where they stand at the start, world frame, borders included), or inside
/// the bone that they are tied to: held, driven or carried.
struct AttachmentSpec {
  /// which keys say where: "box", "sphere", or "shape" of what `to` names, where neither is given
  std::string region = "box";
  Vec3 box_min_m = Vec3::Zero();  ///< of a box: its least corner
  Vec3 box_max_m = Vec3::Zero();  ///< of a box: its largest corner
  Vec3 centre_m = Vec3::Zero();   ///< of a sphere
  double radius_m = 0.0;          ///< of a sphere
  /// a bone, or "tool": its nodes go with it; empty: with the world, or along the keyframes
  std::string to;
  std::string axes = "xyz";  ///< which directions are held
  /// empty: fixed; else the region moves rigidly along them (position and rotation about its own centre)
  std::vector<KeyframeSpec> keyframes;
};

/// Elements of a body with a material of their own: those of a region of the mesh file, by its name, or those
/// whose middle lies in a box or a sphere (where they stand at the start, world frame, borders included).
/// What is not given is the body's.
struct RegionSpec {
  std::string name;  ///< of the region, unique in the body
  /// which keys say where: "box", "sphere", or "file" where neither is given
  std::string region = "file";
  Vec3 box_min_m = Vec3::Zero();              ///< of a box: its least corner
  Vec3 box_max_m = Vec3::Zero();              ///< of a box: its largest corner
  Vec3 centre_m = Vec3::Zero();               ///< of a sphere
  double radius_m = 0.0;                      ///< of a sphere
  std::optional<double> youngs_modulus_pa;    ///< Young's modulus; empty: the body's
  std::optional<double> poissons_ratio;       ///< empty: the body's
  std::optional<double> density_kg_m3;        ///< empty: the body's
  std::optional<double> mass_damping_per_s;   ///< alpha; empty: the body's
  std::optional<double> stiffness_damping_s;  ///< beta; empty: the body's
};

/// A body, or one of its regions, becomes stiffer or softer at a time.
struct MaterialChangeSpec {
  double time_s = 0.0;             ///< when it takes effect
  double youngs_modulus_pa = 0.0;  ///< Young's modulus from then on
  /// empty: the body, with those of its regions that have no Young's modulus of their own
  std::string region;
};

/// A load spread over nodes in a box by their share of the boundary area: total force [N].
struct LoadSpec {
  Vec3 box_min_m = Vec3::Zero();  ///< least corner of the box
  Vec3 box_max_m = Vec3::Zero();  ///< largest corner of the box
  Vec3 force_n = Vec3::Zero();    ///< resultant over the triangles in the box
};

/// The `[[body]]` tables of a scene.
struct SoftBodySpec {
  std::string name;  ///< unique in the scene
  MeshSpec mesh;     ///< its tetrahedra
  /// contact and pictures on the skin of mesh.file, a model file; else on the tetrahedra's own boundary
  bool skin = false;
  /// contact in image space looks only where the skin's convex proxies come near, in regions of their own
  /// plane
  bool proxies = false;
  Vec3 position_m = Vec3::Zero();              ///< placed here at the start
  Vec3 rotation_vector_rad = Vec3::Zero();     ///< about the origin of its own axes, before it is placed
  Vec3 velocity_m_s = Vec3::Zero();            ///< of every node, at the start
  Vec3 angular_velocity_rad_s = Vec3::Zero();  ///< about the centre of mass
  double youngs_modulus_pa = 1e4;              ///< Young's modulus
  double poissons_ratio = 0.3;                 ///< in (-1, 0.5)
  double density_kg_m3 = 1000.0;               ///< mass per volume
  double mass_damping_per_s = 0.0;             ///< alpha
  double stiffness_damping_s = 0.0;            ///< beta: (mu_d, lambda_d) = beta (mu, lambda)
  std::string mass = "lumped";                 ///< or "consistent"
  std::string material = "corotational";       ///< constitutive law, a name of fem::law_registry()
  std::string tangent = "exact";               ///< "exact", "projected", of some laws "warped"
  /// resistance to change of volume: "element", or of some laws "nodal" averages (no locking for nu -> 0.5)
  std::string volumetric = "element";
  /// keep the unsymmetric part of the damping's derivative by position
  bool full_damping_tangent = false;
  std::vector<RegionSpec> regions;          ///< an element in several is of the last
  std::optional<SkeletonSpec> skeleton;     ///< its bones stand in mesh.file, a model file
  std::vector<AttachmentSpec> attachments;  ///< nodes that are held or moved
  std::vector<LoadSpec> loads;              ///< forces on parts of its surface
  /// times ascend, or stay for another region; each acts from the step that begins then
  std::vector<MaterialChangeSpec> changes;
};

/// What a material's numbers may be, a body's and a region's: checked by the loader of scenes and by fem.
struct MaterialRanges {
  /// [Pa]
  static constexpr Range youngs_modulus_pa = Range::positive("soft tissue has 1e3 to 1e5");
  /// [1]
  static constexpr Range poissons_ratio = Range::open(-1.0, 0.5, "use 0.49 for nearly incompressible tissue");
  /// [kg/m^3]
  static constexpr Range density_kg_m3 = Range::positive("water and soft tissue have about 1000");
  static constexpr Range mass_damping_per_s = Range::at_least(0.0, "0 is none");  ///< alpha [1/s]
  /// beta [s]
  static constexpr Range stiffness_damping_s = Range::at_least(0.0, "1e-3 damps lightly, 1e-2 strongly");
};

}  // namespace palpate
