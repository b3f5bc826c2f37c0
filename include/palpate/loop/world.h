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

struct ToolSide;

/// A detailed surface that hangs on a body's tetrahedra.
struct Skin {
  TriMesh rest;                              ///< in the body's own axes
  mesh::Embedding embedding;                 ///< of the vertices in the body's tetrahedra
  std::shared_ptr<proxy::ProxySet> proxies;  ///< null where the scene does not ask for them
};

/// Elements of a body that the mesh file or the scene gives a name.
struct Region {
  std::string name;       ///< unique in the body
  std::vector<int> tets;  ///< ascending; no element in two regions
  /// number in the list of the body's term; 0: the body's own, as the scene does not set the region
  int material = 0;
  double volume = 0.0;            ///< [m^3]
  double stiffness_factor = 1.0;  ///< of its Young's modulus over the body's, where it has none of its own
  bool own_stiffness = false;     ///< whether the scene gives it a Young's modulus
};

/// One soft body as assembled.
struct Body {
  std::string name;   ///< of the scene
  int block_id = -1;  ///< of its nodes in `state`
  /// rest positions in the body's own axes; its nodes are numbered in spatial order (mesh/spatial_order.h),
  /// not as in the mesh's file
  TetMesh rest;
  std::vector<int> file_node;  ///< the number of each node in that file, from zero
  Points placed;               ///< rest positions placed in the world: the start of the simulation
  mesh::Boundary boundary;     ///< surface; made for every body
  std::optional<Skin> skin;    ///< where the scene asks for it
  /// bones of the model file, placed in the world as at the start, where the scene asks for them; else empty
  Skeleton skeleton;
  std::vector<int> bone_of_node;         ///< bone of `skeleton` that carries the node, -1: none
  mesh::MeshReport report;               ///< what the reader or generator found
  std::vector<Region> regions;           ///< in the order of the file, then of the scene
  std::vector<int> material_of_element;  ///< in the list of `term`; empty: all are of the body's own material
  VecX masses;                           ///< lumped, one a node [kg]
  std::shared_ptr<fem::SoftBody> term;   ///< its elements' force, in `system`
  std::shared_ptr<fem::NodalDilatation> dilatation;  ///< null where the body's volume is the elements' alone

  /// The surface that is touched and drawn: the skin's, else the boundary's.
  const Faces& surface_faces() const { return skin ? skin->rest.faces : boundary.surface.faces; }
  /// Positions [m] or values at the vertices of that surface, from those of the nodes.
  Points surface_points(const Points& nodes) const;
  /// @param at_nodes  one value a node  @return one a vertex
  VecX surface_values(const VecX& at_nodes) const;
  /// The tetrahedra as numbered in the file.  Everything that leaves the program is numbered so; values of
  /// the nodes go into out(Eigen::all, file_node).
  Tets file_tets() const;
  /// Von Mises stress [Pa], one value a node.
  VecX nodal_stress(const dynamics::StateView& state) const {
    return dilatation ? dilatation->nodal_stress(state) : term->nodal_stress(state);
  }
};

/// One bone as assembled: a rigid block of the State, a part of a tree on joints, or a function of time.
struct Bone {
  std::string name;                             ///< of the scene or the model
  int block_id = -1;                            ///< of a free one, or of the tree; else -1
  std::shared_ptr<const bones::BoneTree> tree;  ///< of one on joints; else null
  int tree_bone = -1;                           ///< which of its bones
  int body = -1;                                ///< body whose model file has it; -1: a [[bone]] of the scene
  dynamics::Path path;                          ///< of one that is fixed or has keyframes; else empty
  double mass = 0.0;                            ///< of a free one [kg]
  std::vector<int> dofs;                        ///< u-directions of the nodes that it carries, ascending
  TriMesh surface;                              ///< in its own axes; empty without a shape
};

/// Everything that one scene names, and nothing else.  What is absent is null or empty.
/// `description` and `folder` are what it was made of; the rest is changed by run(), or by a caller that
/// steps it itself, and what comes out. The stepper refers to `state` and `system`: a World does not move.
struct World {
  World();
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  scene::Description description;                  ///< the scene
  std::string folder;                              ///< of the scene file
  dynamics::State state;                           ///< coordinates and velocities of everything that moves
  dynamics::System system;                         ///< what moves them
  std::vector<Body> bodies;                        ///< in the scene's order
  std::vector<Bone> bones;                         ///< free, jointed and scripted ones
  std::shared_ptr<contact::ContactForce> contact;  ///< null where nothing may touch
  std::unique_ptr<dynamics::Stepper> stepper;      ///< null without bodies

  /// Null where there is none of that name.
  const Body* find_body(const std::string& name) const;
  /// Makes a body stiffer or softer from the next step on; its damping goes along (mu_d = beta mu), and so do
  /// regions without a Young's modulus of their own.
  /// @param body  one of `bodies`  @param youngs_modulus_pa  > 0
  /// @param region  that region alone, which the scene gives a material  @throws Error for a modulus that
  ///   is not positive, for a region that is not there
  void set_youngs_modulus(Body& body, double youngs_modulus_pa, const std::string& region = {});
  Points positions(const Body& body) const;  ///< now, world [m]
  /// Of its own axes in the world, now.
  Pose bone_pose(const Bone& bone) const;
  /// World axes, of its origin, now.
  Twist bone_twist(const Bone& bone) const;
  /// Wrench of the tissue on each bone, moment about its origin: minus the forces that hold the nodes that it
  /// carries.
  std::vector<Wrench> wrenches_on_bones();
  bool monolithic() const;         ///< tools are blocks of the State
  bool has_tool_of_ticks() const;  ///< there is a tool, and it has ticks of its own
  /// number of the tool's frame in `contact`; -1 where no contact names it
  int tool_frame_index() const;
  /// Of the hands as scene::hands_of() counts them.  @pre that one is there
  Pose tool_pose(std::size_t hand = 0) const;
  /// Of its origin, world axes, now.
  Twist tool_twist(std::size_t hand = 0) const;
  /// Asks for the contact anew at the state as it is, tools where they stand.  @pre there is a contact
  void refresh_contact();
  /// kinetic and potential energy of bodies, contact, tool and coupling [J]
  double mechanical_energy();

 private:
  friend struct ToolSide;
  std::vector<std::unique_ptr<ToolSide>> tool_sides_;  ///< one at least
};

/// Builds a World: the only function that names concrete parts.  From here on the process works on its number
/// of threads (core/workers.h): the World assembled last decides for callers that step Worlds themselves;
/// run() keeps to each World's own.
/// @throws Error for names that no registry knows, parts not compiled in, meshes refused
std::unique_ptr<World> assemble(const scene::Description& description);
/// As the scene, but held by another hand (a recording, or a device of one's own); the limits are those of
/// [device].
std::unique_ptr<World> assemble(const scene::Description& description, std::unique_ptr<device::Device> hand);
/// Likewise, of each hand as scene::hands_of() counts them; null, or not there: the scene's own.
std::unique_ptr<World> assemble(const scene::Description& description,
                                std::vector<std::unique_ptr<device::Device>> hands);

/// The surface of the scene's tool in its own axes, for pictures and records: its mesh, or a sphere.
TriMesh tool_surface(const ToolSpec& spec, const std::string& folder);
/// An obstacle, for pictures.
contact::ObstaclePicture obstacle_picture(const ObstacleSpec& spec, const contact::View& view);

}  // namespace palpate::loop
