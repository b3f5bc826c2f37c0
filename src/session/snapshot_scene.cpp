#include "session/snapshot_scene.h"

#include <algorithm>

#include "core/object_colours.h"
#include "palpate/scene/hands.h"
#include "render/marks.h"
#include "session/shade_values.h"

namespace palpate::session {
namespace {

/// Edges of a skin that turn by more are drawn sharp [degrees]: teeth are, wrinkles, which a coarse skin
/// resolves badly, are not.
constexpr double kSkinCrease = 70.0;

render::Rgb tool_colour(std::size_t hand) { return render::colour_of(colours::tool(hand)); }

void add_bones(render::Scene& scene, const loop::World& world, const WorldSnapshot& snapshot) {
  if (!snapshot.bones.empty())
    for (render::Surface& tissue : scene.surfaces) tissue.opacity = 0.55;
  for (std::size_t i = 0; i < snapshot.bones.size(); ++i) {
    const TriMesh& shape = world.bones[i].surface;
    if (shape.vertices.cols() == 0) continue;
    Points now = snapshot.bones[i].rotation.toRotationMatrix() * shape.vertices;
    now.colwise() += snapshot.bones[i].translation;
    // A skeleton has one entry in the legend.
    const int body = world.bones[i].body;
    const bool first = i == 0 || world.bones[i - 1].body != body;
    const std::string name = body < 0 ? world.bones[i].name
                             : first  ? "bones of " + world.bodies[static_cast<std::size_t>(body)].name
                                      : "";
    render::Surface surface{name, now, shape.faces};
    surface.colour = render::colour_of(colours::kBone);
    scene.surfaces.push_back(surface);
  }
}

/// Adds the outline of the handle, three rings about the axes of the tool at the pose of the hand, and the
/// virtual spring to the tool. They are thin: the dent lies under them.
void add_handle(render::Scene& scene, const Pose& handle, const Pose& tool_pose, const TriMesh& tool) {
  constexpr double kWidth = 0.011, kLeastWidth = 0.0018;  // in sizes of the tool, and of the scene
  constexpr double kRoom = 1.03;      // rings of a handle at the tool's pose stay visible on its surface
  constexpr double kShortest = 0.05;  // spring that is drawn, in sizes of the tool
  const Vec3 low = tool.vertices.rowwise().minCoeff(), high = tool.vertices.rowwise().maxCoeff();
  const double size = (high - low).maxCoeff(),
               width = std::max(kWidth * (high - low).minCoeff(), kLeastWidth * view_of(scene).extent / 2.0);
  render::Surface rings = render::rings(kRoom * 0.5 * (high - low), width);
  const Vec3 middle = 0.5 * (low + high);
  for (Eigen::Index i = 0; i < rings.points.cols(); ++i)
    rings.points.col(i) = handle * Vec3(rings.points.col(i) + middle);
  rings.name = "handle";
  const Vec3 from = handle * middle, to = tool_pose * middle;
  std::vector<render::Surface> parts = {std::move(rings)};
  if ((to - from).norm() > kShortest * size) parts.push_back(render::bar(from, to, width));
  for (render::Surface& part : parts) {
    part.colour = render::colour_of(colours::kHandle);
    part.casts_shadow = false;
    scene.surfaces.push_back(std::move(part));
  }
}

}  // namespace

render::Scene scene_of(const loop::World& world, const WorldSnapshot& snapshot, Shade shade, double largest) {
  render::Scene scene;
  for (std::size_t i = 0; i < snapshot.nodes.size(); ++i) {
    const loop::Body& body = world.bodies[i];
    render::Surface surface{body.name, body.surface_points(snapshot.nodes[i]), body.surface_faces()};
    surface.values = surface_values(world, i, snapshot, shade);
    surface.colour = render::colour_of(colours::kBody);
    if (body.skin) surface.crease_deg = kSkinCrease;
    scene.surfaces.push_back(std::move(surface));
  }
  add_bones(scene, world, snapshot);
  const std::vector<scene::Hand> hands = scene::hands_of(world.description);
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    TriMesh tool = loop::tool_surface(*hands[hand].tool, world.folder);
    if (hand == 0 && snapshot.handle) add_handle(scene, *snapshot.handle, snapshot.tools[hand], tool);
    for (Eigen::Index i = 0; i < tool.vertices.cols(); ++i)
      tool.vertices.col(i) = snapshot.tools[hand] * Vec3(tool.vertices.col(i));
    render::Surface surface{hands[hand].name, tool.vertices, tool.faces};
    surface.colour = tool_colour(hand);
    surface.opacity = 0.3;  // the dent lies under the tool
    surface.subject = true;
    scene.surfaces.push_back(surface);
  }
  scene.scale = colour_scale(world, shade, view_of(scene).extent,
                             largest > 0.0 ? largest : largest_value(world, snapshot, shade));
  return scene;
}

contact::View view_of(const render::Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const render::Surface& surface : scene.surfaces)
    for (Eigen::Index i = 0; i < surface.points.cols(); ++i) box.extend(Vec3(surface.points.col(i)));
  return box.isEmpty() ? contact::View{} : contact::View{box.center(), 2.0 * box.diagonal().norm()};
}

void add_obstacles(render::Scene& scene, const loop::World& world, const contact::View& view) {
  for (const ObstacleSpec& obstacle : world.description.obstacles) {
    contact::ObstaclePicture picture = loop::obstacle_picture(obstacle, view);
    if (picture.ground_m) {
      scene.ground = render::Ground{*picture.ground_m};
      continue;
    }
    render::Surface surface{obstacle.name, std::move(picture.surface.vertices),
                            std::move(picture.surface.faces)};
    surface.colour = render::colour_of(colours::kObstacle);
    surface.opacity = 0.45;  // objects in contact may lie behind
    scene.surfaces.push_back(std::move(surface));
  }
}

}  // namespace palpate::session
