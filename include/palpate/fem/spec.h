#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/bones/spec.h"
#include "palpate/core/keys.h"
#include "palpate/core/types.h"
#include "palpate/device/spec.h"
#include "palpate/fem/options.h"
#include "palpate/mesh/spec.h"

namespace palpate {

/// Keys that select nodes or elements of a body: those of a box or a sphere, or, where neither is given, the
/// shape of a bone or a tool, or a region of the mesh file.
enum class Selection { kBox, kSphere, kShape, kFile };
/// Returns the names of the values.
constexpr std::array<std::string_view, 4> option_names(Selection) {
  return {"box", "sphere", "shape", "file"};
}

/// Mass matrix of a body: lumped at the nodes, or consistent with the shape functions.
enum class MassMatrix { kLumped, kConsistent };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(MassMatrix) { return {"lumped", "consistent"}; }

/// Volumetric stiffness: by element, or by averages at the nodes (no locking for nu -> 0.5), which only some
/// laws support.
enum class Volumetric { kElement, kNodal };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(Volumetric) { return {"element", "nodal"}; }

/// Nodes inside a box or a sphere (at their initial world positions, border included), or inside the bone
/// that they are attached to: fixed, driven or carried.
struct AttachmentSpec {
  Selection region =
      Selection::kBox;            ///< keys that define the region; kShape: that of the bone or tool in `to`
  Vec3 box_min_m = Vec3::Zero();  ///< box: lower corner
  Vec3 box_max_m = Vec3::Zero();  ///< box: upper corner
  Vec3 centre_m = Vec3::Zero();   ///< sphere: centre
  double radius_m = 0.0;          ///< sphere: radius
  /// A bone, or "tool": the nodes move with it. Empty: fixed in the world, or moved along the keyframes.
  std::string to;
  std::string axes = "xyz";  ///< directions that are held
  /// Empty: fixed; else the region moves rigidly along them (position and rotation about its centre).
  std::vector<KeyframeSpec> keyframes;
};

/// Elements of a body with a different material: those of a region of the mesh file, by its name, or those
/// whose centroid lies in a box or a sphere (at initial world positions, border included). Values that are
/// not given are the body's.
struct RegionSpec {
  std::string name;                           ///< name of the region, unique in the body
  std::string material;                       ///< preset, a name in fem::material_presets(); empty: none
  Selection region = Selection::kFile;        ///< keys that define the region
  Vec3 box_min_m = Vec3::Zero();              ///< box: lower corner
  Vec3 box_max_m = Vec3::Zero();              ///< box: upper corner
  Vec3 centre_m = Vec3::Zero();               ///< sphere: centre
  double radius_m = 0.0;                      ///< sphere: radius
  std::optional<double> youngs_modulus_pa;    ///< Young's modulus; empty: the body's
  std::optional<double> poissons_ratio;       ///< Poisson's ratio; empty: the body's
  std::optional<double> density_kg_m3;        ///< density; empty: the body's
  std::optional<double> mass_damping_per_s;   ///< alpha; empty: the body's
  std::optional<double> stiffness_damping_s;  ///< beta; empty: the body's
};

/// Change of the stiffness of a body, or of one of its regions, at a given time.
struct MaterialChangeSpec {
  double time_s = 0.0;             ///< time at which it takes effect
  double youngs_modulus_pa = 0.0;  ///< new Young's modulus
  /// Empty: the body, including those of its regions that have no separate Young's modulus.
  std::string region;
};

/// Load distributed over the nodes in a box by their share of the boundary area; total force in [N].
struct LoadSpec {
  Vec3 box_min_m = Vec3::Zero();  ///< lower corner of the box
  Vec3 box_max_m = Vec3::Zero();  ///< upper corner of the box
  Vec3 force_n = Vec3::Zero();    ///< resultant over the triangles in the box
};

/// A `[[body]]` table of a scene.
struct SoftBodySpec {
  std::string name;  ///< unique in the scene
  MeshSpec mesh;     ///< tetrahedral mesh
  /// Whether contact and pictures use the skin of mesh.file, a model file; else the boundary of the
  /// tetrahedra.
  bool skin = false;
  /// Whether contact in image space is limited to the neighbourhoods of the skin's convex proxies, each
  /// rendered in a region with a separate projection plane.
  bool proxies = false;
  Vec3 position_m = Vec3::Zero();              ///< initial position
  Vec3 rotation_vector_rad = Vec3::Zero();     ///< initial rotation about the mesh origin, before placement
  Vec3 velocity_m_s = Vec3::Zero();            ///< initial velocity of every node
  Vec3 angular_velocity_rad_s = Vec3::Zero();  ///< initial angular velocity about the centre of mass
  double youngs_modulus_pa = 1e4;              ///< Young's modulus
  double poissons_ratio = 0.3;                 ///< in (-1, 0.5)
  double density_kg_m3 = 1000.0;               ///< density
  double mass_damping_per_s = 0.0;             ///< mass-proportional damping, alpha
  double stiffness_damping_s = 0.0;  ///< stiffness-proportional, beta: (mu_d, lambda_d) = beta (mu, lambda)
  MassMatrix mass = MassMatrix::kLumped;  ///< mass matrix
  std::string material;  ///< preset that set the values, a name in fem::material_presets(); empty: none
  std::string law = "corotational";              ///< constitutive law, a name in fem::law_registry()
  fem::Tangent tangent = fem::Tangent::kExact;   ///< stiffness matrix; some laws support kWarped
  Volumetric volumetric = Volumetric::kElement;  ///< volumetric stiffness
  /// Whether to include the unsymmetric derivative of the damping force by position.
  bool full_damping_tangent = false;
  std::vector<RegionSpec> regions;          ///< an element in several regions belongs to the last
  std::optional<SkeletonSpec> skeleton;     ///< its bones are in mesh.file, a model file
  std::vector<AttachmentSpec> attachments;  ///< held, driven or carried nodes
  std::vector<LoadSpec> loads;              ///< forces on parts of the surface
  /// Times must ascend, or repeat for another region; each change acts from the step that begins at its time.
  std::vector<MaterialChangeSpec> changes;
};

/// Ranges of the material values of bodies and regions, checked by the scene loader and by fem.
struct MaterialRanges {
  /// Young's modulus [Pa]
  static constexpr Range youngs_modulus_pa = Range::positive("soft tissue has 1e3 to 1e5");
  /// Poisson's ratio [1]
  static constexpr Range poissons_ratio = Range::open(-1.0, 0.5, "use 0.49 for nearly incompressible tissue");
  /// Density [kg/m^3]
  static constexpr Range density_kg_m3 = Range::positive("water and soft tissue have about 1000");
  static constexpr Range mass_damping_per_s = Range::at_least(0.0, "0 disables it");  ///< alpha [1/s]
  /// Stiffness damping beta [s]
  static constexpr Range stiffness_damping_s =
      Range::at_least(0.0, "1e-3 gives light damping, 1e-2 strong damping");
};

}  // namespace palpate
