#include "picture.h"

#include "palpate/core/error.h"
#include "palpate/render/available.h"
#include "palpate/render/scene.h"

namespace palpate::cli {
namespace {

VecX shading(loop::World& world, const loop::Body& body, const Points& now, const std::string& shade) {
  if (shade == "stress") return body.nodal_stress(world.state.view());
  return (now - body.placed).colwise().norm().transpose();
}

/// The box around all surfaces: how much of an obstacle without an end is worth drawing.
contact::View view_of(const render::Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const render::Surface& surface : scene.surfaces)
    for (Eigen::Index i = 0; i < surface.points.cols(); ++i) box.extend(Vec3(surface.points.col(i)));
  return box.isEmpty() ? contact::View{} : contact::View{box.center(), 2.0 * box.diagonal().norm()};
}

}  // namespace

void check_picture(const std::string& shade) {
  render::check_available();
  const std::vector<std::string> known = {"displacement", "stress"};
  if (shade != known[0] && shade != known[1])
    fail("--shade: unknown \"{}\"{}", shade, suggestion(shade, known));
}

void Snapshot::tick(const loop::TickRecord& tick) {
  newest_force_n_ = std::max(newest_force_n_, tick.device.force.norm());
  newest_tool_ = tick.tool;
}

void Snapshot::period(loop::World& world, double t) {
  const double felt = newest_force_n_;
  newest_force_n_ = 0.0;
  if (world.has_tool_of_ticks() && felt <= force_n_) return;
  force_n_ = felt;
  time_ = t;
  tool_ = newest_tool_;
  bones_.clear();
  for (const loop::Bone& bone : world.bones) bones_.push_back(world.bone_pose(bone));
  bodies_.clear();
  for (const loop::Body& body : world.bodies) {
    const Points now = world.positions(body);
    const VecX values = shading(world, body, now, shade_);
    bodies_.push_back({body.surface_points(now), body.surface_values(values)});
  }
}

void Snapshot::save(const loop::World& world, const std::string& path) const {
  render::Scene scene;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    scene.surfaces.push_back(
        {world.bodies[i].name, bodies_[i].points, world.bodies[i].surface_faces(), bodies_[i].values});
  if (!bones_.empty())
    for (render::Surface& tissue : scene.surfaces) tissue.opacity = 0.55;
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    const TriMesh& shape = world.bones[i].surface;
    if (shape.vertices.cols() == 0) continue;
    Points now = bones_[i].rotation.toRotationMatrix() * shape.vertices;
    now.colwise() += bones_[i].translation;
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
  if (world.description.tool) {
    TriMesh tool = loop::tool_surface(*world.description.tool, world.folder);
    for (Eigen::Index i = 0; i < tool.vertices.cols(); ++i)
      tool.vertices.col(i) = tool_ * Vec3(tool.vertices.col(i));
    render::Surface surface{"tool", tool.vertices, tool.faces};
    surface.colour = {0.80f, 0.42f, 0.20f};
    surface.opacity = 0.45;  // the dent lies under it
    scene.surfaces.push_back(surface);
  }
  const contact::View view = view_of(scene);
  for (const ObstacleSpec& obstacle : world.description.obstacles) {
    contact::ObstaclePicture picture = loop::obstacle_picture(obstacle, view);
    if (picture.ground_m) {
      scene.ground = render::Ground{*picture.ground_m};
      continue;
    }
    render::Surface surface{obstacle.name, std::move(picture.surface.vertices),
                            std::move(picture.surface.faces)};
    surface.colour = {0.55f, 0.60f, 0.66f};
    surface.opacity = 0.45;  // what touches it may lie behind
    scene.surfaces.push_back(std::move(surface));
  }
  scene.scale.label = shade_ == "stress" ? "von Mises stress" : "displacement";
  scene.scale.unit = shade_ == "stress" ? "Pa" : "m";
  scene.title = fmt::format("{}, t = {:g} s", world.description.name, time_);
  if (world.has_tool_of_ticks()) scene.subtitle = fmt::format("the hand feels {:.3g} N", force_n_);
  render::save_png(render::draw(scene), path);
}

}  // namespace palpate::cli
