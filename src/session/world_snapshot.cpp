#include "session/world_snapshot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "loop/contact_instant.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "render/available.h"
#include "render/marks.h"

namespace palpate::session {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

VecX values_of(const loop::Body& body, std::size_t index, const WorldSnapshot& snapshot, Shade shade,
               Eigen::Index surface_points) {
  switch (shade) {
    case Shade::kStress: return body.surface_values(snapshot.stress[index]);
    case Shade::kPenetration: {
      VecX out = VecX::Constant(surface_points, kNone);
      for (const auto& [vertex, depth] : snapshot.depths[index]) out[vertex] = depth;
      return out;
    }
    case Shade::kDisplacement: break;
  }
  const VecX moved = (snapshot.nodes[index] - body.placed).colwise().norm().transpose();
  return body.surface_values(moved);
}

/// Returns the colour scale of a shade. Differences below its resolution are rounding: a billionth of the
/// size of the scene for positions, a billionth of the largest Young's modulus for stress.
render::ColourScale scale_of(const loop::World& world, const render::Scene& scene, Shade shade) {
  render::ColourScale scale;
  const double size = view_of(scene).extent;
  double stiffest = 0.0;
  for (const SoftBodySpec& body : world.description.bodies)
    stiffest = std::max(stiffest, body.youngs_modulus_pa);
  scale.label = shade == Shade::kStress        ? "von Mises stress"
                : shade == Shade::kPenetration ? "penetration"
                                               : "displacement";
  scale.unit = shade == Shade::kStress ? "Pa" : "m";
  scale.resolution = 1e-9 * (shade == Shade::kStress ? stiffest : size);
  if (shade == Shade::kPenetration) scale.low = 0.0;
  return scale;
}

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
    surface.colour = {0.93f, 0.90f, 0.80f};
    scene.surfaces.push_back(surface);
  }
}

/// Adds three spindles along the axes of the handle; they extend beyond the tool, which encloses the handle
/// in free motion.
void add_handle(render::Scene& scene, const Pose& handle, const TriMesh& tool) {
  constexpr double kHandleLength = 1.5, kHandleWidth = 0.14;  // in diameters of the tool
  const double diameter = 2.0 * tool.vertices.colwise().norm().maxCoeff();
  const render::Surface spindle = render::dots(Points::Zero(3, 1), diameter);
  render::Surface jack{"handle", Points(3, 3 * spindle.points.cols()), Faces(3, 3 * spindle.faces.cols())};
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 scale = Vec3::Constant(kHandleWidth);
    scale[axis] = kHandleLength;
    const Eigen::Index points = spindle.points.cols(), faces = spindle.faces.cols();
    jack.points.middleCols(axis * points, points) =
        (handle.rotation.toRotationMatrix() * scale.asDiagonal() * spindle.points).colwise() +
        handle.translation;
    jack.faces.middleCols(axis * faces, faces) = spindle.faces.array() + static_cast<int>(axis * points);
  }
  jack.colour = {0.20f, 0.22f, 0.50f};
  scene.surfaces.push_back(std::move(jack));
}

}  // namespace

Shade check_picture(const std::string& name, const scene::Description& description) {
  render::check_available();
  const std::vector<std::string> known = {"displacement", "stress", "penetration"};
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end()) fail("--shade: unknown \"{}\"{}", name, suggestion(name, known));
  const auto shade = static_cast<Shade>(found - known.begin());
  if (shade == Shade::kPenetration && description.contacts.empty())
    fail("--shade penetration: the scene has no [[contact]]; add one, or choose another shade");
  return shade;
}

WorldSnapshot snapshot_of(loop::World& world, double time, Shade shade) {
  WorldSnapshot out;
  out.time = time;
  for (const loop::Body& body : world.bodies) {
    out.nodes.push_back(world.positions(body));
    if (shade == Shade::kStress) out.stress.push_back(body.nodal_stress(world.state.view()));
  }
  if (shade == Shade::kPenetration)
    for (const VecX& depths : loop::contact_instant(world).depths) {
      auto& list = out.depths.emplace_back();
      for (Eigen::Index v = 0; v < depths.size(); ++v)
        if (depths[v] > 0.0) list.emplace_back(static_cast<int>(v), static_cast<float>(depths[v]));
    }
  for (const loop::Bone& bone : world.bones) out.bones.push_back(world.bone_pose(bone));
  for (std::size_t i = 0; i < scene::hands_of(world.description).size(); ++i)
    out.tools.push_back(world.tool_pose(i));
  return out;
}

render::Scene scene_of(const loop::World& world, const WorldSnapshot& snapshot, Shade shade) {
  render::Scene scene;
  for (std::size_t i = 0; i < snapshot.nodes.size(); ++i) {
    const loop::Body& body = world.bodies[i];
    render::Surface surface{body.name, body.surface_points(snapshot.nodes[i]), body.surface_faces()};
    surface.values = values_of(body, i, snapshot, shade, surface.points.cols());
    scene.surfaces.push_back(std::move(surface));
  }
  add_bones(scene, world, snapshot);
  const std::vector<scene::Hand> hands = scene::hands_of(world.description);
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    TriMesh tool = loop::tool_surface(*hands[hand].tool, world.folder);
    if (hand == 0 && snapshot.handle) add_handle(scene, *snapshot.handle, tool);
    for (Eigen::Index i = 0; i < tool.vertices.cols(); ++i)
      tool.vertices.col(i) = snapshot.tools[hand] * Vec3(tool.vertices.col(i));
    render::Surface surface{hands[hand].name, tool.vertices, tool.faces};
    surface.colour = hand == 0 ? render::Rgb{0.80f, 0.42f, 0.20f} : render::Rgb{0.25f, 0.50f, 0.72f};
    surface.opacity = 0.45;  // the dent lies under the tool
    surface.subject = true;
    scene.surfaces.push_back(surface);
  }
  scene.scale = scale_of(world, scene, shade);
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
    surface.colour = {0.55f, 0.60f, 0.66f};
    surface.opacity = 0.45;  // objects in contact may lie behind
    scene.surfaces.push_back(std::move(surface));
  }
}

}  // namespace palpate::session
