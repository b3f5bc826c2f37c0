#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/contact/obstacle.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/nodal_dilatation.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/embedding.h"
#include "palpate/mesh/skeleton.h"
#include "palpate/mesh/source.h"
#include "palpate/scene/description.h"

namespace palpate::device {
class Device;
}  // namespace palpate::device

namespace palpate::bones {
class BoneTree;
}  // namespace palpate::bones

namespace palpate::proxy {
class ProxySet;
}  // namespace palpate::proxy

namespace palpate::loop {

struct ToolInstance;

/// Detailed surface that is embedded in a body's tetrahedra.
struct Skin {
  TriMesh rest;                              ///< In the body's axes.
  mesh::Embedding embedding;                 ///< Embedding of the vertices in the body's tetrahedra.
  std::shared_ptr<proxy::ProxySet> proxies;  ///< null if the scene does not enable them
};

/// Named set of elements of a body, from the mesh file or the scene.
struct Region {
  std::string name;       ///< Unique in the body.
  std::vector<int> tets;  ///< Ascending; regions do not overlap.
  /// Index in the material list of the body's term; 0: the body's material, as the scene does not set the
  /// region.
  int material = 0;
  double volume = 0.0;            ///< Volume [m^3].
  double stiffness_factor = 1.0;  ///< Ratio of its Young's modulus to the body's, unless own_stiffness.
  bool own_stiffness = false;     ///< Whether the scene sets its Young's modulus.
};

/// Node that is the midpoint of an edge between two others (compare --mesh divides meshes).
struct Midpoint {
  int node = -1;       ///< The midpoint.
  int a = -1, b = -1;  ///< Ends of the edge.
};

/// Assembled soft body.
struct Body {
  std::string name;   ///< Name in the scene.
  int block_id = -1;  ///< Block of its nodes in `state`
  /// Rest positions in the body's axes; nodes are numbered in spatial order (mesh/spatial_order.h), not as in
  /// the mesh file.
  TetMesh rest;
  std::vector<int> file_node;  ///< Index of each node in that file, from zero.
  Points placed;               ///< Rest positions in the world, at the start of the simulation.
  /// Midpoints of a divided mesh, each after its ends; empty: the mesh is not divided. An attachment holds a
  /// midpoint where it holds both ends, so that the part that is held does not change with the division.
  std::vector<Midpoint> midpoints = {};
  mesh::Boundary boundary;   ///< Surface of the tetrahedra; always present.
  std::optional<Skin> skin;  ///< Only if the scene enables it.
  /// Bones of the model file in the world, at the start, if the scene enables them; else empty.
  Skeleton skeleton;
  std::vector<int> bone_of_node;  ///< Bone of `skeleton` that carries each node, -1: none.
  mesh::MeshReport report;        ///< Findings of the mesh reader or generator.
  std::vector<Region> regions;    ///< First the file's, then the scene's.
  /// Material index per element, in the list of `term`; empty: the body's material throughout.
  std::vector<int> material_of_element;
  VecX masses;                                       ///< Lumped mass per node [kg].
  std::shared_ptr<fem::SoftBody> term;               ///< Force of the elements, in `system`
  std::shared_ptr<fem::NodalDilatation> dilatation;  ///< null for element-wise volumetric terms

  /// Returns the surface used for contact and pictures: the skin's, else the boundary's.
  const Faces& surface_faces() const { return skin ? skin->rest.faces : boundary.surface.faces; }
  /// Interpolates positions [m] or values of the nodes to the vertices of that surface.
  Points surface_points(const Points& nodes) const;
  /// Interpolates scalar values to the vertices of that surface.
  /// @param at_nodes  one value per node  @return one value per vertex
  VecX surface_values(const VecX& at_nodes) const;
  /// Returns the tetrahedra in the file's node numbering, in which all output is written; nodal values go
  /// into out(Eigen::all, file_node).
  Tets file_tets() const;
  /// Returns the von Mises stress [Pa], one value per node.
  VecX nodal_stress(const dynamics::StateView& state) const {
    return dilatation ? dilatation->nodal_stress(state) : term->nodal_stress(state);
  }
};

/// Assembled bone: a rigid block of the State, a part of a tree of joints, or a function of time.
struct Bone {
  std::string name;                             ///< Name in the scene or the model.
  int block_id = -1;                            ///< Block of a free bone, or of the tree; else -1.
  std::shared_ptr<const bones::BoneTree> tree;  ///< Tree of a jointed bone; else null.
  int tree_bone = -1;                           ///< Index in the tree.
  int body = -1;          ///< Body whose model file contains it; -1: a [[bone]] of the scene.
  dynamics::Path path;    ///< Motion of a fixed or keyframed bone; else empty.
  double mass = 0.0;      ///< Mass of a free bone [kg].
  std::vector<int> dofs;  ///< u-directions of the nodes that it carries, ascending
  TriMesh surface;        ///< In the bone's axes; empty without a shape.
};

/// Motion of a tool with start = "touching" before the simulation starts (src/loop/placing.h).
struct ToolPlacement {
  std::string tool;                ///< Name in [[contact]].
  double moved_m = 0.0;            ///< Distance from the position_m of the scene [m].
  Vec3 position_m = Vec3::Zero();  ///< Position of the tool at the start [m].
  std::string touched;             ///< Object that it touches.
  Vec3 touch_m = Vec3::Zero();     ///< Point of the touch [m].
};

/// All parts of one assembled scene; absent parts are null or empty. `description` and `folder` are the
/// input; everything else is changed by run(), or by a caller that steps the World itself. The stepper refers
/// to `state` and `system`, so a World cannot be copied or moved.
struct World {
  World();
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  scene::Description description;                  ///< The scene.
  std::string folder;                              ///< Folder of the scene file.
  dynamics::State state;                           ///< Coordinates and velocities of all moving parts.
  dynamics::System system;                         ///< Equations of motion.
  std::vector<Body> bodies;                        ///< In the scene's order.
  std::vector<Bone> bones;                         ///< Free, jointed and scripted bones.
  std::shared_ptr<contact::ContactForce> contact;  ///< null without contact pairs
  std::unique_ptr<dynamics::Stepper> stepper;      ///< null without bodies
  std::vector<ToolPlacement> placements;           ///< One per tool with start = "touching".
  /// One per hand, in the numbering of scene::hands_of(). The type is internal (src/loop/tool_instance.h):
  /// users of the library read tools through the functions below.
  std::vector<ToolInstance> tools;

  /// Returns the body with that name; null if there is none.
  const Body* find_body(const std::string& name) const;
  /// Returns the tool with that name in [[contact]]; null if there is none.
  ToolInstance* find_tool(const std::string& name);
  /// Sets the Young's modulus of a body from the next step on. Its damping changes in proportion (mu_d = beta
  /// mu), and so do regions without a specified Young's modulus.
  /// @param body  one of `bodies`  @param youngs_modulus_pa  > 0
  /// @param region  change only this region, which must have a material in the scene
  /// @throws Error for a modulus that is not positive, or an unknown region
  void set_youngs_modulus(Body& body, double youngs_modulus_pa, const std::string& region = {});
  Points positions(const Body& body) const;  ///< Current positions, world [m].
  /// Returns the current pose of the bone's axes in the world.
  Pose bone_pose(const Bone& bone) const;
  /// Returns the current twist of the bone's origin, world axes.
  Twist bone_twist(const Bone& bone) const;
  /// Returns the wrench of the tissue on each bone, moment about the bone's origin: minus the constraint
  /// forces on the nodes that it carries.
  std::vector<Wrench> wrenches_on_bones();
  bool monolithic() const;         ///< Tools are blocks of the State.
  bool has_tool_of_ticks() const;  ///< A tool with separate ticks exists.
  /// Index of the first tool's frame in `contact`; -1 if no contact refers to the tool.
  int tool_frame_index() const;
  /// Returns the current pose of a tool, in the numbering of scene::hands_of(). @pre the hand exists
  Pose tool_pose(std::size_t hand = 0) const;
  /// Returns the current twist of the tool's origin, world axes.
  Twist tool_twist(std::size_t hand = 0) const;
  /// Queries contact at the current state, with the tools at their current poses. @pre `contact` is not null
  void refresh_contact();
  /// Returns the kinetic and potential energy of bodies, contact, tool and coupling [J].
  double mechanical_energy();
};

/// Assembles a World from a scene: the only function that depends on concrete parts. It also sets the
/// number of threads of the process (core/workers.h): the World assembled last determines it for callers that
/// step Worlds themselves; run() uses each World's number.
/// @throws Error for unknown names, parts not compiled in, invalid meshes
std::unique_ptr<World> assemble(const scene::Description& description);
/// Assembles a World whose first hand is replaced by another device (a recording, or a user-defined device);
/// the limits remain those of [device].
std::unique_ptr<World> assemble(const scene::Description& description, std::unique_ptr<device::Device> hand);
/// Assembles a World with a device per hand, in the numbering of scene::hands_of(); null or missing: the
/// scene's.
std::unique_ptr<World> assemble(const scene::Description& description,
                                std::vector<std::unique_ptr<device::Device>> hands);

/// Returns the surface of the scene's tool in the tool's axes, for pictures and records: its mesh, or a
/// sphere.
TriMesh tool_surface(const ToolSpec& spec, const std::string& folder);
/// Returns the picture of an obstacle.
contact::ObstaclePicture obstacle_picture(const ObstacleSpec& spec, const contact::View& view);

}  // namespace palpate::loop
