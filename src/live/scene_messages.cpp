#include "live/scene_messages.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/object_colours.h"
#include "palpate/contact/obstacle.h"
#include "palpate/device/profile.h"
#include "palpate/scene/hands.h"
#include "store/provenance.h"

namespace palpate::live {
namespace {

using nlohmann::json;
using Box = Eigen::AlignedBox3d;

constexpr double kObstacleOpacity = 0.45;

void extend(Box& box, const Points& points) {
  for (Eigen::Index i = 0; i < points.cols(); ++i) box.extend(Vec3(points.col(i)));
}

Pose start_of(const ToolSpec& tool) { return {quaternion_of(tool.rotation_vector_rad), tool.position_m}; }

/// Returns the bounding box of bodies and tools at the start.
Box moving_box(const loop::World& world) {
  Box box;
  for (const loop::Body& body : world.bodies) extend(box, body.placed);
  for (const scene::Hand& hand : scene::hands_of(world.description)) {
    Points tool = loop::tool_surface(*hand.tool, world.folder).vertices;
    const Pose pose = start_of(*hand.tool);
    tool = pose.rotation.toRotationMatrix() * tool;
    tool.colwise() += pose.translation;
    extend(box, tool);
  }
  if (box.isEmpty()) box.extend(Vec3(Vec3::Zero()));
  return box;
}

json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json surface_entry(const std::string& name, const TriMesh& surface, std::string_view colour) {
  return {{"name", name},
          {"vertices", surface.vertices.cols()},
          {"triangles", surface.faces.cols()},
          {"colour", colour}};
}

json body_entries(const loop::World& world) {
  json out = json::array();
  for (const loop::Body& body : world.bodies)
    out.push_back({{"name", body.name},
                   {"attached", !world.description.bodies[out.size()].attachments.empty()},
                   {"nodes", body.placed.cols()},
                   {"vertices", body.skin ? body.skin->rest.vertices.cols()
                                          : static_cast<Eigen::Index>(body.boundary.node_of_vertex.size())},
                   {"triangles", body.surface_faces().cols()},
                   {"tets", body.rest.tets.cols()},
                   {"colour", colours::kBody}});
  return out;
}

json hand_entry(const scene::Hand& hand, bool live) {
  const device::DeviceFigures figures = device::figures_of(*hand.device);
  const device::Workspace& space = figures.workspace;
  json workspace = nullptr;
  if (space.is_bounded())
    workspace = {{"center", numbers(space.center)},
                 {"radius", space.radius > 0.0 ? space.radius : 0.5 * space.size.minCoeff()}};
  return {{"name", hand.name},
          {"live", live},
          {"max_force_n", figures.max_force},
          {"stiffness_n_m", hand.tool->coupling.stiffness_n_m},
          {"workspace", workspace}};
}

json slider_entries(const std::vector<Slider>& sliders) {
  json out = json::array();
  for (const Slider& s : sliders)
    out.push_back({{"key", s.key},
                   {"label", s.label},
                   {"unit", s.unit},
                   {"value", s.value},
                   {"min", s.least},
                   {"max", s.most},
                   {"logarithmic", s.logarithmic}});
  return out;
}

/// Returns the direction that a picture shows upwards: against gravity, else z.
Vec3 up_of(const scene::Description& d) {
  const double g = d.gravity_m_s2.norm();
  return g > 0.0 ? Vec3(-d.gravity_m_s2 / g) : Vec3(Vec3::UnitZ());
}

void add_points(ByteWriter& out, const Points& points) {
  const Eigen::MatrixXf single = points.cast<float>();
  out.add(std::span<const float>(single.data(), static_cast<std::size_t>(single.size())));
}

template <class Indices>
void add_indices(ByteWriter& out, const Indices& indices) {
  static_assert(sizeof(typename Indices::Scalar) == 4);
  out.add(std::span<const int>(indices.data(), static_cast<std::size_t>(indices.size())));
}

/// Returns for each vertex of the boundary a tetrahedron that contains it, with weight 1 on its node.
mesh::Embedding boundary_embedding(const loop::Body& body) {
  std::vector<std::pair<int, int>> corner_of(static_cast<std::size_t>(body.placed.cols()), {0, 0});
  for (Eigen::Index t = body.rest.tets.cols(); t-- > 0;)
    for (int k = 0; k < 4; ++k)
      corner_of[static_cast<std::size_t>(body.rest.tets(k, t))] = {static_cast<int>(t), k};
  mesh::Embedding out;
  const std::vector<int>& nodes = body.boundary.node_of_vertex;
  out.weights.setZero(4, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t v = 0; v < nodes.size(); ++v) {
    const auto [tet, corner] = corner_of[static_cast<std::size_t>(nodes[v])];
    out.tet.push_back(tet);
    out.weights(corner, static_cast<Eigen::Index>(v)) = 1.0;
  }
  return out;
}

void add_body(ByteWriter& out, const loop::Body& body) {
  add_points(out, body.placed);
  add_indices(out, body.rest.tets);
  const mesh::Embedding embedding = body.skin ? body.skin->embedding : boundary_embedding(body);
  out.add(std::span<const int>(embedding.tet));
  const Eigen::MatrixXf weights = embedding.weights.cast<float>();
  out.add(std::span<const float>(weights.data(), static_cast<std::size_t>(weights.size())));
  add_indices(out, body.surface_faces());
}

void add_surface(ByteWriter& out, const TriMesh& surface) {
  add_points(out, surface.vertices);
  add_indices(out, surface.faces);
}

}  // namespace

std::vector<SceneSurface> obstacle_surfaces(const loop::World& world) {
  const Box box = moving_box(world);
  const contact::View view{box.center(), 2.0 * std::max(box.diagonal().norm(), 1e-3)};
  std::vector<SceneSurface> out;
  for (const ObstacleSpec& spec : world.description.obstacles)
    out.push_back({spec.name, loop::obstacle_picture(spec, view).surface,
                   contact::obstacle_entry(spec).surface != nullptr});
  return out;
}

std::string scene_message(const loop::World& world, const std::string& name,
                          const std::vector<Slider>& sliders, const std::vector<SceneSurface>& obstacles,
                          const HandleMailboxes& handles) {
  const scene::Description& d = world.description;
  Box box = moving_box(world);
  json out = {{"type", "scene"}, {"protocol", 1}, {"version", store::provenance().version}};
  out["scene"] = name;
  out["tick_s"] = d.tool ? json(d.tool->tick_s) : json(nullptr);
  out["scheme"] = option_names(d.exchange.scheme)[static_cast<std::size_t>(d.exchange.scheme)];
  out["integrator"] = d.integrator.name;
  out["up"] = numbers(up_of(d));
  out["bodies"] = body_entries(world);
  out["tools"] = out["bones"] = out["obstacles"] = out["hands"] = json::array();
  for (const scene::Hand& hand : scene::hands_of(d)) {
    const auto index = out["tools"].size();
    json tool = surface_entry(hand.name, loop::tool_surface(*hand.tool, world.folder), colours::tool(index));
    tool["hand"] = index;
    out["tools"].push_back(tool);
    out["hands"].push_back(hand_entry(hand, index < handles.size() && handles[index]));
  }
  for (const loop::Bone& bone : world.bones)
    out["bones"].push_back(surface_entry(bone.name, bone.surface, colours::kBone));
  for (const SceneSurface& obstacle : obstacles) {
    json entry = surface_entry(obstacle.name, obstacle.surface, colours::kObstacle);
    entry["opacity"] = kObstacleOpacity;
    out["obstacles"].push_back(entry);
    if (obstacle.is_bounded) extend(box, obstacle.surface.vertices);
  }
  out["bounds"] = {{"min", numbers(box.min())}, {"max", numbers(box.max())}};
  out["sliders"] = slider_entries(sliders);
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

Bytes geometry_message(const loop::World& world, const std::vector<SceneSurface>& obstacles) {
  Bytes bytes;
  ByteWriter out(bytes, 1);
  for (const loop::Body& body : world.bodies) add_body(out, body);
  for (const scene::Hand& hand : scene::hands_of(world.description))
    add_surface(out, loop::tool_surface(*hand.tool, world.folder));
  for (const loop::Bone& bone : world.bones) add_surface(out, bone.surface);
  for (const SceneSurface& obstacle : obstacles) add_surface(out, obstacle.surface);
  out.close();
  return bytes;
}

}  // namespace palpate::live
