#include <algorithm>
#include <cmath>
#include <filesystem>

#include "assemble_parts.h"
#include "core/counters.h"
#include "core/memory.h"
#include "loop/choose_scheme.h"
#include "loop/memory.h"
#include "loop/placing.h"
#include "mesh/spatial_order.h"
#include "mesh/tet_checks.h"
#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "palpate/fem/laws.h"
#include "palpate/fem/load.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/scene/hands.h"
#include "palpate/scene/load.h"
#include "proxy/proxy_set.h"
#include "scene/contact_sides.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

fem::SoftBodyOptions options_of(const SoftBodySpec& spec, const fem::Materials& materials) {
  fem::SoftBodyOptions options;
  options.law = spec.law;
  options.tangent = spec.tangent;
  fem::check_law(spec.law, options.tangent, spec.volumetric == Volumetric::kNodal,
                 fmt::format("body \"{}\"", spec.name));
  options.full_damping_tangent = spec.full_damping_tangent;
  if (spec.volumetric == Volumetric::kNodal) {
    for (const fem::Material& material : materials.list)
      options.volumetric_shares.push_back(fem::kept_volumetric_share(material));
    options.volumetric_share =
        *std::min_element(options.volumetric_shares.begin(), options.volumetric_shares.end());
  }
  return options;
}

/// Takes the tetrahedra of a body, renumbered in spatial order.
void take_tets(TetMesh tets, Body& body) {
  body.file_node = mesh::spatial_order(tets.nodes);
  body.rest = std::move(tets);
  mesh::renumber_nodes(body.rest, body.file_node);
}

/// Takes the tetrahedra of a native mesh file or a model, checked.
void take_file(TetMesh tets, const std::string& path, double scale, Body& body) {
  tets.nodes *= scale;
  mesh::Provenance from;
  from.source = path;
  body.report = mesh::check_tets(tets, from);
  take_tets(std::move(tets), body);
}

/// Takes the edges of divided tetrahedra. @param edges  ends of those whose midpoints are the file's last
/// nodes
void take_midpoints(const std::vector<std::array<int, 2>>& edges, Body& body) {
  if (edges.empty()) return;
  std::vector<int> node_of_file(body.file_node.size());
  for (std::size_t i = 0; i < body.file_node.size(); ++i)
    node_of_file[static_cast<std::size_t>(body.file_node[i])] = static_cast<int>(i);
  const std::size_t first = body.file_node.size() - edges.size();
  for (std::size_t i = 0; i < edges.size(); ++i)
    body.midpoints.push_back({node_of_file[first + i], node_of_file[static_cast<std::size_t>(edges[i][0])],
                              node_of_file[static_cast<std::size_t>(edges[i][1])]});
}

/// Takes the tetrahedra of a model and its nodal data.
void take_model(LayeredModel& model, const std::string& path, double scale, Body& body) {
  take_file(std::move(model.tets), path, scale, body);
  if (model.bone_of_node.empty()) return;
  std::vector<int> bone_of_node;
  for (const int node : body.file_node)
    bone_of_node.push_back(model.bone_of_node[static_cast<std::size_t>(node)]);
  model.bone_of_node = std::move(bone_of_node);
}

/// Takes the bones, still in the body's axes.
void take_skeleton(const SoftBodySpec& spec, const std::string& path, const LayeredModel& model, Body& body) {
  if (model.skeleton.bones.empty())
    fail("body \"{}\": [body.skeleton]: {} has no bones; `palpate model human` writes a file with bones",
         spec.name, path);
  counters::count("loop.skeleton");
  body.skeleton = model.skeleton;
  body.bone_of_node = model.bone_of_node;
  for (palpate::Bone& bone : body.skeleton.bones) {
    bone.head *= spec.mesh.factor(), bone.tail *= spec.mesh.factor();
    bone.head_radius *= spec.mesh.factor(), bone.tail_radius *= spec.mesh.factor();
  }
}

/// @param path  model file, for messages
std::shared_ptr<proxy::ProxySet> proxies_of(const LayeredModel& model, const std::string& path) {
  try {
    return std::make_shared<proxy::ProxySet>(model);
  } catch (const Error& e) { fail("{}: {}", path, e.what()); }
}

/// Loads the tetrahedra of a body, and the skin and proxies that the scene enables; returns the regions of
/// the file. Without skin and skeleton, only the tetrahedra of a model file are read; otherwise the whole
/// file is read and checked, and unused parts are dropped.
/// @param with_proxies  whether a contact requires the proxies that the scene enables
std::vector<MaterialRegion> load_mesh(const SoftBodySpec& spec, const std::string& folder, bool with_proxies,
                                      Body& body) {
  const std::string path = (std::filesystem::path(folder) / spec.mesh.file).string();
  if (spec.skin || spec.skeleton) {
    store::ModelFile file = store::read_model(path);
    LayeredModel& model = file.model;
    take_model(model, path, spec.mesh.factor(), body);
    take_midpoints(file.edges, body);
    if (spec.skeleton) take_skeleton(spec, path, model, body);
    if (!spec.skin) return std::move(model.regions);
    if (model.skin.faces.cols() == 0)
      fail("body \"{}\": skin = true, but {} has no skin; `palpate model` writes files with a skin",
           spec.name, path);
    counters::count("loop.skin");
    model.skin.vertices *= spec.mesh.factor();
    std::shared_ptr<proxy::ProxySet> proxies;
    if (spec.proxies && with_proxies) {
      if (model.proxies.empty())
        fail("body \"{}\": proxies = true, but {} has no proxies; `palpate model` writes files with proxies",
             spec.name, path);
      model.tets = body.rest;  // as checked, scaled and numbered
      for (ProxyHull& hull : model.proxies) hull.corners *= spec.mesh.factor();
      counters::count("loop.proxies");
      proxies = proxies_of(model, path);
    }
    body.skin = Skin{std::move(model.skin), std::move(model.embedding), std::move(proxies)};
    return std::move(model.regions);
  }
  std::vector<MaterialRegion> regions;
  if (spec.mesh.file.ends_with(".h5")) {
    take_file(store::read_mesh(path), path, spec.mesh.factor(), body);
    regions = store::read_regions(path, static_cast<int>(body.rest.tets.cols()));
    if (!spec.attachments.empty())
      take_midpoints(store::read_edges(path, static_cast<int>(body.rest.nodes.cols())), body);
  } else {
    take_tets(mesh::tet_mesh(spec.mesh, folder, &body.report, &regions), body);
  }
  return regions;
}

/// Returns the velocity of each node of a body with rigid initial motion: v + w x (x - centre of mass).
VecX initial_velocities(const SoftBodySpec& spec, const Points& placed, const VecX& masses) {
  const Vec3 centre = placed * masses / masses.sum();
  Points v(3, placed.cols());
  for (Eigen::Index i = 0; i < placed.cols(); ++i)
    v.col(i) = spec.velocity_m_s + spec.angular_velocity_rad_s.cross(placed.col(i) - centre);
  return Eigen::Map<const VecX>(v.data(), v.size());
}

Body place_body(World& world, const SoftBodySpec& spec, fem::Materials& materials) {
  Body body;
  body.name = spec.name;
  std::vector<MaterialRegion> regions =
      load_mesh(spec, world.folder, scene::is_in_images(world.description, spec.name), body);
  const Pose pose{quaternion_of(spec.rotation_vector_rad), spec.position_m};
  body.placed.resize(3, body.rest.nodes.cols());
  for (Eigen::Index i = 0; i < body.placed.cols(); ++i)
    body.placed.col(i) = pose * Vec3(body.rest.nodes.col(i));
  for (palpate::Bone& bone : body.skeleton.bones) bone.head = pose * bone.head, bone.tail = pose * bone.tail;
  materials = assemble_materials(spec, std::move(regions), body);
  body.masses = fem::lumped_masses(body.rest, materials);
  body.boundary = mesh::boundary(body.rest);
  return body;
}

/// Returns the block of a body. Error control measures strain: lengths are scaled by the body's size,
/// velocities by the bar wave speed sqrt(E/rho) of the body's material.
dynamics::BlockSpec block_of(const SoftBodySpec& spec, const Body& body) {
  dynamics::BlockSpec block;
  block.name = spec.name;
  block.q_size = block.u_size = static_cast<int>(3 * body.placed.cols());
  block.q_scale = (body.placed.rowwise().maxCoeff() - body.placed.rowwise().minCoeff()).norm();
  block.u_scale = std::sqrt(spec.youngs_modulus_pa / spec.density_kg_m3);
  if (!(block.u_scale > 0.0 && std::isfinite(block.u_scale)))
    fail(
        "youngs_modulus_pa = {:g} and density_kg_m3 = {:g} give a wave speed of {:g} m/s; it must be "
        "positive and finite",
        spec.youngs_modulus_pa, spec.density_kg_m3, block.u_scale);
  return block;
}

void add_forces(World& world, Body& body, const SoftBodySpec& spec, const fem::Materials& materials) {
  const fem::SoftBodyOptions options = options_of(spec, materials);
  body.term = std::make_shared<fem::SoftBody>(spec.name, body.rest, materials, options, body.block_id);
  world.system.add(body.term);
  if (options.volumetric_share < 1.0) {
    body.dilatation = std::make_shared<fem::NodalDilatation>("volume of " + spec.name, body.rest, materials,
                                                             options, body.block_id);
    world.system.add(body.dilatation);
  }
  const bool consistent = spec.mass == MassMatrix::kConsistent;
  world.system.add(consistent ? fem::make_consistent_mass(body.rest, materials, body.block_id)
                              : fem::make_lumped_mass(body.rest, materials, body.block_id));
  if (consistent) world.system.set_mass_solver(linear::make_linear_solver("cholmod"));
  if (!world.description.gravity_m_s2.isZero())
    world.system.add(fem::make_gravity(body.masses, world.description.gravity_m_s2, body.block_id));
  for (const LoadSpec& load : spec.loads)
    world.system.add(fem::make_dead_load("load on " + spec.name,
                                         fem::spread_over_boundary({body.placed, body.rest.tets}, load),
                                         body.block_id));
}

/// Returns whether a message begins with the location of its fault: the scene file, or a file that the scene
/// reads. Other words before a colon are none, whatever files the working folder contains.
bool begins_with_file(const std::string& message, const World& world) {
  const auto begins = [&](const std::string& path) {
    return !path.empty() && message.starts_with(path) && message.substr(path.size()).starts_with(':');
  };
  const auto reads = [&](const std::string& file) {
    return !file.empty() && begins((std::filesystem::path(world.folder) / file).string());
  };
  const scene::Description& d = world.description;
  const std::vector<scene::Hand> hands = scene::hands_of(d);
  return begins(d.path) ||
         std::any_of(d.bodies.begin(), d.bodies.end(),
                     [&](const SoftBodySpec& body) { return reads(body.mesh.file); }) ||
         std::any_of(hands.begin(), hands.end(), [&](const scene::Hand& hand) {
           return reads(hand.tool->mesh.file) || (hand.device && reads(hand.device->file));
         });
}

/// Checks the memory estimate, after meshing and before assembly: the meshes are small, the assembled system
/// is large.
void check_memory(const World& world) {
  std::vector<MeshCounts> counts;
  MeshCounts all;
  for (const Body& body : world.bodies) {
    counts.push_back(counts_of(body));
    all.nodes += counts.back().nodes, all.tetrahedra += counts.back().tetrahedra;
    all.skin_vertices += counts.back().skin_vertices;
  }
  const MemoryEstimate estimate = estimate_memory(world.description, counts);
  const bool direct = estimate.factor > estimate.elements;
  const std::string skins =
      all.skin_vertices > 0 ? fmt::format(", {} for skins", memory_text(estimate.skins)) : "";
  refuse_beyond_memory(
      fmt::format("scene \"{}\": {} nodes and {} tetrahedra", world.description.name, all.nodes,
                  all.tetrahedra),
      estimate.total(),
      fmt::format("{} for elements and matrix{}, {} for the factor of a direct solver",
                  memory_text(estimate.elements + estimate.touch), skins, memory_text(estimate.factor)),
      direct ? "a larger element_size_m or integrator.linear_solver = \"pcg-single\" needs less"
             : "a larger element_size_m needs less",
      estimate.addresses);
}

}  // namespace

void at_place(const World& world, const std::string& at, const std::string& who,
              const std::function<void()>& make) {
  try {
    make();
  } catch (const Error& e) {
    const std::string message = e.what();
    const bool names_who = who.empty() || message.starts_with(who);
    if (begins_with_file(message, world)) throw;
    fail("{}: {}{}", scene::place_of(world.description, at), names_who ? "" : who + ": ", message);
  }
}

void assemble_bodies(World& world) {
  std::vector<Body>& bodies = world.bodies;
  std::vector<fem::Materials> materials;
  const std::vector<SoftBodySpec>& specs = world.description.bodies;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    materials.emplace_back(fem::Material{});
    at_place(world, fmt::format("body[{}].mesh", i), fmt::format("body \"{}\"", specs[i].name),
             [&] { bodies.push_back(place_body(world, specs[i], materials.back())); });
  }
  check_memory(world);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const VecX q = Eigen::Map<const VecX>(bodies[i].placed.data(), bodies[i].placed.size());
    at_place(world, fmt::format("body[{}]", i), fmt::format("body \"{}\"", specs[i].name), [&] {
      bodies[i].block_id = world.state.insert(
          block_of(specs[i], bodies[i]), q, initial_velocities(specs[i], bodies[i].placed, bodies[i].masses));
    });
  }
  for (std::size_t i = 0; i < bodies.size(); ++i)
    at_place(world, fmt::format("body[{}]", i), fmt::format("body \"{}\"", specs[i].name),
             [&] { add_forces(world, bodies[i], specs[i], materials[i]); });
}

std::unique_ptr<World> assemble(const scene::Description& description) {
  return assemble(description, std::vector<std::unique_ptr<device::Device>>());
}

std::unique_ptr<World> assemble(const scene::Description& description, std::unique_ptr<device::Device> hand) {
  std::vector<std::unique_ptr<device::Device>> hands;
  hands.push_back(std::move(hand));
  return assemble(description, std::move(hands));
}

std::unique_ptr<World> assemble(const scene::Description& description,
                                std::vector<std::unique_ptr<device::Device>> hands) {
  if (description.tool && description.exchange.scheme == scene::ExchangeScheme::kAuto)
    return assemble(with_scheme(description, choose_scheme(description).scheme), std::move(hands));
  auto world = std::make_unique<World>();
  world->description = description;
  workers::set_count(description.integrator.threads);
  world->folder = std::filesystem::path(description.path).parent_path().string();
  assemble_bodies(*world);
  if (!description.bones.empty()) at_place(*world, "bone", "", [&] { assemble_bones(*world); });
  assemble_skeletons(*world);
  place_tools(*world);
  const std::vector<scene::Hand> tools = scene::hands_of(world->description);
  hands.resize(tools.size());
  for (std::size_t i = 0; i < tools.size(); ++i)
    at_place(*world, tools[i].tool_key, "",
             [&] { world->tools.push_back(assemble_tool(*world, tools[i], std::move(hands[i]))); });
  assemble_attachments(*world);
  const bool carries = std::any_of(world->tools.begin(), world->tools.end(), [](const ToolInstance& tool) {
    const PartitionedTool* const partitioned = tool.partitioned();
    return partitioned && !partitioned->ties.empty();
  });
  if (carries || !description.contacts.empty()) assemble_contact(*world);
  if (world->state.layout().blocks.empty()) return world;  // only a tool with separate ticks
  world->system.prepare(world->state.view());
  world->system.impose(world->state.layout(), 0.0, world->state.q().data(), world->state.u().data());
  world->stepper = integrate::make_stepper(world->system, world->state, description.integrator);
  return world;
}

}  // namespace palpate::loop
