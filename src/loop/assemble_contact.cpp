#include <algorithm>
#include <cmath>
#include <map>

#include "assemble_parts.h"
#include "contact/gpu_device.h"
#include "contact/methods.h"
#include "contact/sources.h"
#include "contact_shapes.h"
#include "core/counters.h"
#include "palpate/contact/obstacle.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "proxy/decompose_solid.h"
#include "proxy/region.h"
#include "rigid_contact.h"
#include "scene/contact_sides.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

double mean_edge(const TriMesh& surface) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      sum += (surface.vertices.col(surface.faces(k, f)) - surface.vertices.col(surface.faces((k + 1) % 3, f)))
                 .norm();
  return sum / static_cast<double>(3 * surface.faces.cols());
}

/// Proxies of the tools, by name: created by the first contact that needs them.
using ToolProxies = std::map<std::string, std::shared_ptr<proxy::ProxySet>>;

struct Pair {
  const ContactSpec& spec;
  contact::NodeSurface surface;
  const Points& rest;   ///< Vertices of the surface.
  const TetMesh& body;  ///< Tetrahedra at rest.
  double candidate_gap, look_ahead;
  std::shared_ptr<proxy::ProxySet> proxies{};
};

Pair pair_of(const World& world, const ContactSpec& spec, const std::string& name) {
  const Body* body = world.find_body(name);
  if (!body) fail("contact: no body is called \"{}\"", name);
  const double gap = spec.candidate_gap_m > 0.0
                         ? spec.candidate_gap_m
                         : mean_edge(body->skin ? body->skin->rest : body->boundary.surface);
  const double look_ahead = world.description.exchange.contact_refresh_s;
  if (body->skin)
    return {spec,
            {body->block_id, {}, body->skin->rest.faces, body->skin->embedding, body->rest.tets},
            body->skin->rest.vertices,
            body->rest,
            gap,
            look_ahead,
            body->skin->proxies};
  return {spec,
          {body->block_id, body->boundary.node_of_vertex, body->boundary.surface.faces},
          body->boundary.surface.vertices,
          body->rest,
          gap,
          look_ahead};
}

contact::ImageOptions image_options(const Pair& pair) {
  if (!contact::gpu_available())
    fail(
        "contact {} - {}: method = \"image\" is not built in; use \"distance\", or configure with "
        "-DPALPATE_WITH_GL=ON (packages libepoxy-dev, libegl-dev)",
        pair.spec.first, pair.spec.second);
  return {.pixels = pair.spec.pixels, .candidate_gap = pair.candidate_gap, .look_ahead = pair.look_ahead};
}

contact::DistanceOptions options_of(const Pair& pair) { return distance_options(pair.spec, pair.look_ahead); }

/// Returns nearest-point contact of a body and another surface; both must be closed.
template <class... Other>
std::unique_ptr<contact::SampleSource> distance_source(Pair pair, Other... other) {
  try {
    return contact::make_distance_source(std::move(pair.surface), pair.rest, std::move(other)...,
                                         options_of(pair));
  } catch (const Error& error) { refuse_distance(pair.spec, error); }
}

/// Adds the sample points of a shape to the source with a surface's points on that shape.
std::unique_ptr<contact::SampleSource> with_own_points(std::unique_ptr<contact::SampleSource> source,
                                                       const Pair& pair, const Shape& shape) {
  const auto own =
      own_points(shape, contact::lengths_of({pair.rest, pair.surface.faces}), pair.spec.quadrature_error);
  if (!own) return source;
  return contact::make_half_and_half(
      std::move(source), contact::make_distance_source(pair.surface, pair.rest, *own, options_of(pair)));
}

/// Returns the sample points of a soft body, with a spacing suited to a shape of these lengths.
contact::MaterialPoints points_on(const Pair& pair, const contact::CharacteristicLengths& lengths) {
  try {
    const auto own = contact::lengths_of({pair.rest, pair.surface.faces});
    return contact::material_points(pair.surface, pair.rest, pair.body,
                                    contact::point_spacing(own, lengths, pair.spec.quadrature_error));
  } catch (const Error& error) { refuse_distance(pair.spec, error); }
}

/// Returns contact of two soft bodies.
std::unique_ptr<contact::SampleSource> pair_source(Pair a, Pair b) {
  if (a.spec.method == "distance") return distance_source(std::move(a), std::move(b.surface), b.rest);
  if (a.spec.method == "analytic")
    fail("contact {} - {}: method = \"analytic\" does not apply to two soft bodies; use method = \"auto\"",
         a.spec.first, a.spec.second);
  if (!a.proxies != !b.proxies)
    fail("contact {} - {}: only one side has proxies; enable proxies for both bodies or for neither",
         a.spec.first, a.spec.second);
  const contact::ImageOptions options = image_options(a);
  if (a.proxies)
    return contact::make_image_source(std::move(a.surface), std::move(a.proxies), std::move(b.surface),
                                      std::move(b.proxies), options);
  return contact::make_image_source(std::move(a.surface), std::move(b.surface), options);
}

/// Returns a surface made of nodes as a skin embedded in the tetrahedra.
contact::NodeSurface in_tetrahedra(contact::NodeSurface surface, const TetMesh& body) {
  if (surface.node_of_vertex.empty()) return surface;
  std::vector<std::pair<int, int>> place_of(static_cast<std::size_t>(body.nodes.cols()));  // tet, corner
  for (Eigen::Index t = body.tets.cols(); t-- > 0;)
    for (int k = 0; k < 4; ++k)
      place_of[static_cast<std::size_t>(body.tets(k, t))] = {static_cast<int>(t), k};
  const auto count = static_cast<Eigen::Index>(surface.node_of_vertex.size());
  surface.embedding.weights.setZero(4, count);
  for (Eigen::Index v = 0; v < count; ++v) {
    const int node = surface.node_of_vertex[static_cast<std::size_t>(v)];
    const auto [tet, corner] = place_of[static_cast<std::size_t>(node)];
    surface.embedding.tet.push_back(tet);
    surface.embedding.weights(corner, v) = 1.0;
  }
  surface.tets = body.tets;
  surface.node_of_vertex.clear();
  return surface;
}

/// Returns contact of a soft body with itself.
std::unique_ptr<contact::SampleSource> own_source(Pair pair) {
  if (pair.spec.method != "distance")
    fail("contact {} - {}: self-contact needs method = \"distance\" (nearest points); use method = \"auto\"",
         pair.spec.first, pair.spec.second);
  try {
    return contact::make_own_distance_source(in_tetrahedra(std::move(pair.surface), pair.body), pair.rest,
                                             pair.body.nodes, options_of(pair));
  } catch (const Error& error) { refuse_distance(pair.spec, error); }
}

/// Returns contact of a soft body with a rigid surface in a frame.
/// @param rigid_proxies  proxies of the surface; created if the body has proxies and they do not exist yet
std::unique_ptr<contact::SampleSource> image_source(Pair pair, TriMesh rigid,
                                                    std::shared_ptr<proxy::ProxySet>& rigid_proxies,
                                                    int frame, std::shared_ptr<contact::MovingFrame> motion) {
  const contact::ImageOptions options = image_options(pair);
  if (!pair.proxies)
    return contact::make_image_source(std::move(pair.surface), std::move(rigid), frame, std::move(motion),
                                      options);
  if (!rigid_proxies) rigid_proxies = std::make_shared<proxy::ProxySet>(proxy::rigid_proxies(rigid));
  return contact::make_image_source(std::move(pair.surface), std::move(pair.proxies), std::move(rigid),
                                    rigid_proxies, frame, std::move(motion), options);
}

std::unique_ptr<contact::SampleSource> tool_source(World& world, ToolInstance& instance, Pair pair,
                                                   ToolProxies& proxies) {
  const ToolSpec& tool = instance.spec;
  const std::shared_ptr<contact::MovingFrame> motion = frame_in_contact(world, instance);
  const bool sphere = tool.shape == ToolShape::kSphere;
  if (pair.spec.method == "distance" && sphere) {
    const Shape shape = round_tool(tool.radius_m, instance.frame, motion);
    return with_own_points(
        contact::make_sphere_source(points_on(pair, shape.lengths), instance.frame, motion, Vec3::Zero(),
                                    tool.radius_m, pair.spec.candidate_gap_m, pair.look_ahead),
        pair, shape);
  }
  if (pair.spec.method == "distance")
    return distance_source(std::move(pair),
                           contact::FrameSurface{tool_surface(tool, world.folder), instance.frame, motion});
  if (pair.spec.method != "analytic")
    return image_source(std::move(pair), tool_surface(tool, world.folder), proxies[instance.name],
                        instance.frame, motion);
  if (!sphere)
    fail(
        "contact {} - {}: method = \"analytic\" needs a tool with shape = \"sphere\", not \"{}\"; use method "
        "= \"auto\"",
        pair.spec.first, pair.spec.second, name_of(tool.shape));
  return contact::make_sphere_source(std::move(pair.surface), instance.frame, motion, Vec3::Zero(),
                                     tool.radius_m, pair.candidate_gap, pair.look_ahead);
}

/// Returns whether a step of the bodies is a single linear solve.
bool steps_are_linearised(const World& world) {
  const auto& registry = integrate::stepper_registry();
  const auto entry = std::find_if(registry.begin(), registry.end(),
                                  [&](const auto& e) { return e.name == world.description.integrator.name; });
  return entry != registry.end() && entry->traits.linearised;
}

std::unique_ptr<contact::SampleSource> obstacle_source(World& world, Pair pair,
                                                       const ObstacleSpec& obstacle) {
  const Shape shape = shape_of(*world.contact, obstacle);
  if (pair.spec.method != "distance")
    return obstacle_source(shape, pair.spec, std::move(pair.surface), pair.candidate_gap, pair.look_ahead,
                           obstacle);
  return with_own_points(obstacle_source(shape, pair.spec, points_on(pair, shape.lengths),
                                         pair.spec.candidate_gap_m, pair.look_ahead, obstacle),
                         pair, shape);
}

/// Creates the model reduction for a tool with ticks that contacts or carries bodies, unless it exists.
void make_reduction(World& world, const ToolInstance& tool, PartitionedTool& partitioned) {
  const scene::Description& d = world.description;
  if (partitioned.reduction || d.exchange.linearisation != "points") return;
  ReductionOptions options{.error = d.exchange.linearisation_error,
                           .keep = steps_are_linearised(world) || world.tools.size() > 1,
                           .threads = d.integrator.threads};
  for (const ContactSpec& contact : d.contacts) {
    const bool own = contact.first == tool.name || contact.second == tool.name;
    options.has_friction = options.has_friction || (own && contact.friction > 0.0);
    options.others_touch = options.others_touch || !own;
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    options.damping.push_back(
        {world.bodies[i].block_id, d.bodies[i].mass_damping_per_s, d.bodies[i].stiffness_damping_s});
  partitioned.reduction = std::make_unique<ModelReduction>(world.system, std::move(options));
}

/// @pre the names are in canonical order (scene::order_sides)
std::unique_ptr<contact::SampleSource> source_of(World& world, const ContactSpec& spec,
                                                 ToolProxies& proxies) {
  contact::check_method(spec.method, fmt::format("contact {} - {}", spec.first, spec.second));
  if (auto source = rigid_source(world, spec)) return source;
  if (!world.find_body(spec.first))
    fail(
        "contact {} - {}: one side must be a soft body, or a tool if the other is an obstacle or another "
        "tool",
        spec.first, spec.second);
  Pair pair = pair_of(world, spec, spec.first);
  if (ToolInstance* const tool = world.find_tool(spec.second))
    return tool_source(world, *tool, std::move(pair), proxies);
  for (const ObstacleSpec& obstacle : world.description.obstacles)
    if (obstacle.name == spec.second) return obstacle_source(world, std::move(pair), obstacle);
  if (spec.second == spec.first) return own_source(std::move(pair));
  if (world.find_body(spec.second)) return pair_source(std::move(pair), pair_of(world, spec, spec.second));
  fail("contact {} - {}: nothing is called \"{}\"; use the names of soft bodies, obstacles or tools",
       spec.first, spec.second, spec.second);
}

void add_contact(World& world, ContactSpec& given, ToolProxies& proxies) {
  scene::order_sides(world.description, given);
  if (given.method == "auto") given.method = scene::contact_method(world.description, given);
  set_friction_speed(world, given);
  given.friction_retardation_s = friction_retardation(world.description, given);
  ContactSpec spec = given;
  // Steps of a single linear solve need the secant tangent, although it does not make the matrix symmetric if
  // other parts of a tool's rows are omitted: with the full tangent, sliding friction reverses the nodes'
  // velocity in each step and does not hold.
  if (spec.friction_tangent == FrictionTangent::kAuto)
    spec.friction_tangent = steps_are_linearised(world) ? FrictionTangent::kSecant : FrictionTangent::kFull;
  // No step matrix contains tools with separate ticks; their ticks are a single solve each.
  if (world.find_tool(spec.first) && !world.monolithic()) spec.friction_tangent = FrictionTangent::kSecant;
  world.contact->add_pair(source_of(world, spec, proxies), spec);
  ToolInstance* const tool = world.find_tool(spec.second);
  if (tool && tool->partitioned() && world.find_body(spec.first))
    make_reduction(world, *tool, *tool->partitioned());
}

}  // namespace

void assemble_contact(World& world) {
  world.contact = std::make_shared<contact::ContactForce>();
  make_rigid_contact_solver(world);
  std::vector<ContactSpec>& contacts = world.description.contacts;
  ToolProxies proxies;
  for (std::size_t i = 0; i < contacts.size(); ++i)
    at_place(world, fmt::format("contact[{}]", i), "", [&] { add_contact(world, contacts[i], proxies); });
  for (ToolInstance& tool : world.tools) {
    PartitionedTool* const partitioned = tool.partitioned();
    if (!partitioned || partitioned->ties.empty()) continue;
    frame_in_contact(world, tool);
    world.contact->tie(tool.frame, partitioned->ties);
    make_reduction(world, tool, *partitioned);
  }
  world.system.add(std::shared_ptr<dynamics::ForceTerm>(world.contact));
}

contact::ObstaclePicture obstacle_picture(const ObstacleSpec& spec, const contact::View& view) {
  return contact::obstacle_entry(spec).picture(contact::obstacle_shape(spec), view);
}

}  // namespace palpate::loop
