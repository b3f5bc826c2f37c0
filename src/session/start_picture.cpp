#include "session/start_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "loop/attached_nodes.h"
#include "palpate/core/error.h"
#include "render/available.h"
#include "render/labels.h"
#include "render/marks.h"
#include "session/scene_view.h"
#include "session/snapshot_scene.h"
#include "session/world_snapshot.h"

namespace palpate::session {
namespace {

constexpr render::Rgb kHeld = {0.75f, 0.12f, 0.16f}, kCarried = {0.12f, 0.35f, 0.75f},
                      kDimension = {0.35f, 0.38f, 0.42f};
constexpr render::Rgb kAxes[3] = {{0.80f, 0.15f, 0.15f}, {0.10f, 0.55f, 0.20f}, {0.15f, 0.30f, 0.80f}};

/// Returns a length in the unit that suits it: "98 mm", "1.2 m".
std::string length_text(double metres) {
  return metres < 1.0 ? fmt::format("{:.3g} mm", 1e3 * metres) : fmt::format("{:.3g} m", metres);
}

/// Adds the edges of a box, three of them with their lengths.
void add_box(const Eigen::AlignedBox3d& box, double width, render::Scene& scene,
             std::vector<render::Label>& labels) {
  const Vec3 low = box.min(), size = box.sizes();
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      Vec3 from = low;
      from[(axis + 1) % 3] += corner % 2 * size[(axis + 1) % 3];
      from[(axis + 2) % 3] += corner / 2 * size[(axis + 2) % 3];
      const Vec3 to = from + size[axis] * Vec3::Unit(axis);
      render::Surface edge = render::bar(from, to, width);
      edge.colour = kDimension;
      scene.surfaces.push_back(std::move(edge));
      // edges at the outline for the default eye, at (+x, -y) above: in front and right below, and far right
      const bool labelled = axis == 0 ? corner == 0 : axis == 1 ? corner == 2 : corner == 3;
      if (labelled) labels.push_back({0.5 * (from + to), length_text(size[axis])});
    }
}

/// Adds the axes of the world, from a point.
void add_axes(const Vec3& origin, double length, render::Scene& scene, std::vector<render::Label>& labels) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 tip = origin + length * Vec3::Unit(axis);
    render::Surface arrow = render::bar(origin, tip, 0.05 * length);
    arrow.colour = kAxes[axis];
    scene.surfaces.push_back(std::move(arrow));
    labels.push_back({tip + 0.15 * length * Vec3::Unit(axis), std::string(1, "xyz"[axis]), kAxes[axis]});
  }
}

void add_dots(const Points& placed, const std::set<int>& nodes, double size, const std::string& name,
              render::Rgb colour, render::Scene& scene) {
  if (nodes.empty()) return;
  Points at(3, static_cast<Eigen::Index>(nodes.size()));
  Eigen::Index i = 0;
  for (const int node : nodes) at.col(i++) = placed.col(node);
  render::Surface dots = render::dots(at, size);
  dots.name = name;
  dots.colour = colour;
  scene.surfaces.push_back(std::move(dots));
}

void add_attachments(const loop::World& world, double size, render::Scene& scene) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const loop::Body& body = world.bodies[i];
    const std::set<int> carried = loop::carried_nodes(world, i);
    std::set<int> held = loop::driven_nodes(world, i);
    for (const int node : carried) held.erase(node);
    add_dots(body.placed, held, size, fmt::format("held nodes of {}", body.name), kHeld, scene);
    add_dots(body.placed, carried, size, fmt::format("carried nodes of {}", body.name), kCarried, scene);
  }
}

Eigen::AlignedBox3d box_of(const Points& points) {
  return {Vec3(points.rowwise().minCoeff()), Vec3(points.rowwise().maxCoeff())};
}

}  // namespace

void check_start_picture(const std::string& path) {
  render::check_available();
  if (!path.ends_with(".png")) fail("--picture {}: pictures are PNG files; end the name in .png", path);
}

void draw_start(loop::World& world, const std::string& path) {
  render::Scene scene = scene_of(world, snapshot_of(world, 0.0, Shade::kDisplacement), Shade::kDisplacement);
  const contact::View view = view_of(scene);
  const double size = 0.5 * view.extent;  // diagonal of the bounding box
  std::vector<render::Label> labels;
  Eigen::AlignedBox3d all;
  for (const render::Surface& surface : scene.surfaces) all.extend(box_of(surface.points));
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    scene.surfaces[i].opacity = 0.6;  // attached nodes may lie behind
    add_box(box_of(scene.surfaces[i].points), 0.002 * size, scene, labels);
  }
  add_attachments(world, 0.015 * size, scene);
  // beside the objects, and above a ground on which they stand
  if (!all.isEmpty()) add_axes(all.min() + size * Vec3(-0.05, -0.05, 0.01), 0.12 * size, scene, labels);
  add_obstacles(scene, world, view);
  scene.title = fmt::format("{} at its start", world.description.name);
  scene.subtitle = "sizes of the bounding boxes; axes of the world";
  render::Options options;
  options.view = scene_view(world.description.view);
  render::save_png(render::draw_labelled(std::move(scene), options, labels), path);
}

}  // namespace palpate::session
