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

constexpr double kArm = 1.0;  ///< Reach of a hand [m].

void extend(Box& box, const Points& points) {
  if (points.cols() == 0) return;
  box.extend(Vec3(points.rowwise().minCoeff()));
  box.extend(Vec3(points.rowwise().maxCoeff()));
}

/// Returns the bounding box of the scene at the start. An unbounded plane contributes the part that a
/// picture of the rest shows.
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

// A ball contains the scene. A hand may be outside it by as much as its diameter, which suits scenes of any
// size, plus an arm's length, which suits small ones. A handle that crosses that region, or rotates by a full
// turn, while the watchdog still holds the last force is not moved by a hand.
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
