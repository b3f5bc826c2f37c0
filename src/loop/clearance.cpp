#include "loop/clearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "palpate/contact/obstacle.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/scene/hands.h"

namespace palpate::loop {
namespace {

using distance::Gap;

/// Facets of a bounded obstacle's surface per radius of curvature or thickness.
constexpr double kFacets = 16.0;

/// Returns the gap between the vertices of a surface and the exact shape of an obstacle, which is that of the
/// surface where the obstacle is a half-space.
Gap vertex_gap(const Points& vertices, const std::function<contact::Nearest(const Vec3& x)>& nearest) {
  Gap out{HUGE_VAL};
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    const Vec3 x = vertices.col(v);
    const contact::Nearest at = nearest(x);
    if (at.gap < out.distance) out = {at.gap, x, x - at.gap * at.normal};
  }
  return out;
}

/// Returns the gap of a ball, given that of its centre. The ball's nearest or deepest point lies on the line
/// through the centre and the other object's point.
Gap ball_gap(const Gap& of_centre, double radius) {
  const Vec3 inwards = of_centre.distance < 0.0 ? Vec3(of_centre.on_first - of_centre.on_second)
                                                : Vec3(of_centre.on_second - of_centre.on_first);
  const double length = inwards.norm();
  const Vec3 direction = length > 0.0 ? Vec3(inwards / length) : -Vec3::UnitZ();
  return {of_centre.distance - radius, of_centre.on_first + radius * direction, of_centre.on_second};
}

/// Returns all objects of the scene at its start: tools, bodies, obstacles.
std::vector<PlacedObject> objects_of(const World& world) {
  std::vector<PlacedObject> out;
  for (const scene::Hand& hand : scene::hands_of(world.description))
    out.push_back(PlacedObject::tool(hand.name, *hand.tool, world.folder));
  for (const Body& body : world.bodies) out.push_back(PlacedObject::body(body));
  for (const ObstacleSpec& obstacle : world.description.obstacles)
    out.push_back(PlacedObject::obstacle(obstacle));
  return out;
}

bool is_in_contact(const World& world, const std::string& a, const std::string& b) {
  const std::vector<ContactSpec>& contacts = world.description.contacts;
  return std::any_of(contacts.begin(), contacts.end(), [&](const ContactSpec& c) {
    return (c.first == a && c.second == b) || (c.first == b && c.second == a);
  });
}

Clearance clearance(const World& world, PlacedObject& first, const PlacedObject& second) {
  const Gap gap = gap_between(first, second);
  Clearance out{first.name(), second.name(), gap, is_in_contact(world, first.name(), second.name())};
  const Vec3 way = gap.on_second - gap.on_first;
  if (gap.distance < 0.0 && way.norm() > 0.0)
    out.way_out_m = distance_out(first, second, way.normalized()) * way.normalized();
  return out;
}

}  // namespace

PlacedObject PlacedObject::body(const Body& body) {
  PlacedObject out;
  out.name_ = body.name;
  try {
    out.surface_.emplace(TriMesh{body.surface_points(body.placed), body.surface_faces()});
  } catch (const Error& error) {
    fail("body \"{}\": its surface must be closed for distances: {}", body.name, error.what());
  }
  return out;
}

PlacedObject PlacedObject::tool(const std::string& name, const ToolSpec& spec, const std::string& folder) {
  PlacedObject out;
  out.name_ = name;
  out.pose_ = {quaternion_of(spec.rotation_vector_rad), spec.position_m};
  if (spec.shape == ToolShape::kSphere) {
    out.radius_ = spec.radius_m;
    return out;
  }
  out.surface_.emplace(tool_surface(spec, folder));
  out.surface_->move(out.pose_);
  return out;
}

PlacedObject PlacedObject::obstacle(const ObstacleSpec& spec) {
  const contact::ObstacleEntry& entry = contact::obstacle_entry(spec);
  const Settings shape = contact::obstacle_shape(spec);
  PlacedObject out;
  out.name_ = spec.name;
  out.nearest_ = [&entry, shape](const Vec3& x) { return entry.nearest(shape, x); };
  if (!entry.surface) return out;
  const contact::CharacteristicLengths lengths = entry.lengths(shape);
  out.surface_.emplace(entry.surface(shape, std::min(lengths.width, lengths.radius) / kFacets));
  return out;
}

void PlacedObject::shift(const Vec3& by) {
  pose_.translation += by;
  if (surface_) surface_->move(pose_);
}

std::optional<Eigen::AlignedBox3d> PlacedObject::bounds() const {
  if (radius_ > 0.0) {
    const Vec3 reach = Vec3::Constant(radius_);
    return Eigen::AlignedBox3d(Vec3(pose_.translation - reach), Vec3(pose_.translation + reach));
  }
  if (!surface_) return std::nullopt;
  const Points& all = surface_->vertices();
  return Eigen::AlignedBox3d(Vec3(all.rowwise().minCoeff()), Vec3(all.rowwise().maxCoeff()));
}

distance::Gap gap_between(const PlacedObject& first, const PlacedObject& second) {
  if (first.is_obstacle() || (second.radius_ > 0.0 && !(first.radius_ > 0.0)))
    return gap_between(second, first).reversed();
  if (first.radius_ > 0.0) {
    const Vec3& centre = first.pose_.translation;
    if (second.is_obstacle()) {
      const contact::Nearest at = second.nearest_(centre);
      return ball_gap({at.gap, centre, centre - at.gap * at.normal}, first.radius_);
    }
    if (second.surface_) return ball_gap(second.surface_->from_point(centre), first.radius_);
    const Vec3 apart = second.pose_.translation - centre;
    const double between = apart.norm();
    const Vec3 direction = between > 0.0 ? Vec3(apart / between) : Vec3(Vec3::UnitZ());
    return {between - first.radius_ - second.radius_, centre + first.radius_ * direction,
            second.pose_.translation - second.radius_ * direction};
  }
  if (second.is_obstacle() && !second.surface_)
    return vertex_gap(first.surface_->vertices(), second.nearest_);
  return gap_between(*first.surface_, *second.surface_);
}

// Each step moves the object by the depth that is left: the depth changes by no more than the displacement,
// so that the end of the overlap is not passed over.
double distance_out(PlacedObject& first, const PlacedObject& second, const Vec3& direction) {
  constexpr int kMostSteps = 1000;
  constexpr double kEnough = 1e-6;  // [m]
  double moved = 0.0;
  for (int i = 0; i < kMostSteps; ++i) {
    const double gap = gap_between(first, second).distance;
    if (gap >= 0.0) break;
    const double step = std::max(-gap, kEnough);
    first.shift(step * direction);
    moved += step;
  }
  first.shift(-moved * direction);
  return moved;
}

std::vector<Clearance> clearances(const World& world) {
  std::vector<PlacedObject> objects = objects_of(world);
  std::vector<Clearance> out;
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (std::size_t j = i + 1; j < objects.size(); ++j)
      if (!objects[i].is_obstacle()) out.push_back(clearance(world, objects[i], objects[j]));
  return out;
}

std::optional<Clearance> clearance_of(const World& world, std::size_t contact) {
  const ContactSpec& spec = world.description.contacts.at(contact);
  std::vector<PlacedObject> sides;
  for (PlacedObject& object : objects_of(world))
    if (object.name() == spec.first || object.name() == spec.second) sides.push_back(std::move(object));
  if (sides.size() != 2) return std::nullopt;
  return clearance(world, sides[0], sides[1]);
}

bool starts_enclosed(const World& world, std::size_t contact) {
  const ContactSpec& spec = world.description.contacts.at(contact);
  struct Side {
    TriMesh surface;            // empty for balls and obstacles
    std::optional<Vec3> point;  // of the object; none for obstacles
    const ObstacleSpec* obstacle = nullptr;
  };
  const auto side_of = [&](const std::string& name) {
    Side side;
    if (const Body* body = world.find_body(name)) {
      side.surface = {body->surface_points(body->placed), body->surface_faces()};
      side.point = side.surface.vertices.col(0);
    } else if (const ToolSpec* tool = scene::tool_named(world.description, name)) {
      side.point = tool->position_m;
      if (tool->shape != ToolShape::kMesh) return side;
      const Pose pose{quaternion_of(tool->rotation_vector_rad), tool->position_m};
      side.surface = tool_surface(*tool, world.folder);
      for (Eigen::Index v = 0; v < side.surface.vertices.cols(); ++v)
        side.surface.vertices.col(v) = pose * Vec3(side.surface.vertices.col(v));
      side.point = side.surface.vertices.col(0);
    }
    for (const ObstacleSpec& obstacle : world.description.obstacles)
      if (obstacle.name == name) side.obstacle = &obstacle;
    return side;
  };
  const auto is_inside = [](const std::optional<Vec3>& x, const Side& other) {
    if (!x) return false;
    if (other.obstacle)
      return contact::obstacle_entry(*other.obstacle)
                 .nearest(contact::obstacle_shape(*other.obstacle), *x)
                 .gap < 0.0;
    std::vector<int> all(static_cast<std::size_t>(other.surface.faces.cols()));
    std::iota(all.begin(), all.end(), 0);
    return !all.empty() && std::abs(mesh::winding_number(other.surface, all, *x)) > 0.5;
  };
  if (spec.first == spec.second) return false;
  const Side first = side_of(spec.first), second = side_of(spec.second);
  const bool with_tool =
      scene::tool_named(world.description, spec.first) || scene::tool_named(world.description, spec.second);
  // a body may rest on an obstacle, with a vertex behind its surface
  if (!with_tool && (first.obstacle || second.obstacle)) return false;
  return is_inside(first.point, second) || is_inside(second.point, first);
}

std::string direction_text(const Vec3& direction) {
  // rounding, such as -3.7e-16, is 0
  const auto clean = [&](int axis) { return std::abs(direction[axis]) < 1e-9 ? 0.0 : direction[axis]; };
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", clean(0), clean(1), clean(2));
}

std::string overlap_text(const Clearance& clearance) {
  std::string text = fmt::format("\"{}\" starts {:.3g} mm inside \"{}\"", clearance.first,
                                 -1e3 * clearance.gap.distance, clearance.second);
  const double length = clearance.way_out_m.norm();
  if (!(length > 0.0)) return text;
  return text + fmt::format("; move \"{}\" by {:.3g} mm along {}", clearance.first, 1e3 * length,
                            direction_text(clearance.way_out_m / length));
}

}  // namespace palpate::loop
