#include "pose_bounds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "palpate/contact/obstacle.h"
#include "palpate/device/limiter.h"
#include "palpate/scene/hands.h"

namespace palpate::loop {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr double kArm = 1.0;  ///< a hand reaches that far [m]

void extend(Box& box, const Points& points) {
  if (points.cols() == 0) return;
  box.extend(Vec3(points.rowwise().minCoeff()));
  box.extend(Vec3(points.rowwise().maxCoeff()));
}

/// What is there at the start.  A plane has no end: of it counts what a picture of the rest shows.
Box box_of(const World& world, const device::Workspace& workspace) {
  Box box;
  for (const Body& body : world.bodies) extend(box, body.placed);
  for (const scene::Hand& hand : scene::hands_of(world.description)) box.extend(hand.tool->position_m);
  if (workspace.is_bounded()) {
    const Vec3 half =
        workspace.radius > 0.0 ? Vec3(Vec3::Constant(workspace.radius)) : Vec3(0.5 * workspace.size);
    box.extend(workspace.center - half);
    box.extend(workspace.center + half);
  }
  const contact::View view{box.center(), std::max(kArm, box.diagonal().norm())};
  for (const ObstacleSpec& spec : world.description.obstacles)
    extend(box, contact::obstacle_entry(spec).picture(contact::obstacle_shape(spec), view).surface.vertices);
  return box;
}

}  // namespace

// A ball holds the scene.  A hand may be as far outside of it as it is wide, which serves scenes of any size,
// and an arm's length, which serves small ones.  A handle that would cross that region while the watchdog
// still holds the last force, or turn once, is none that a hand moves.
device::PoseBounds pose_bounds(const World& world, const device::Workspace& workspace) {
  const Box box = box_of(world, workspace);
  const double scene_radius = 0.5 * box.diagonal().norm();
  device::PoseBounds out;
  out.center = box.center();
  out.radius = 3.0 * scene_radius + kArm;
  out.speed = 2.0 * out.radius / device::kHoldTime;
  out.rotation = 2.0 * std::numbers::pi / device::kHoldTime;
  return out;
}

}  // namespace palpate::loop
