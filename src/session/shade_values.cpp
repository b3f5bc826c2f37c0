#include "session/shade_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rigid_fit.h"
#include "core/rounded_range.h"

namespace palpate::session {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Returns the length of the displacement of each node [m]; of a free body without its rigid motion.
VecX displacement(const loop::World& world, std::size_t index, const Points& nodes) {
  const loop::Body& body = world.bodies[index];
  const Points moved = is_free(world.description.bodies[index])
                           ? without_rigid_motion(body.placed, nodes, body.masses)
                           : Points(nodes - body.placed);
  return moved.colwise().norm().transpose();
}

}  // namespace

VecX surface_values(const loop::World& world, std::size_t body, const WorldSnapshot& snapshot, Shade shade) {
  const loop::Body& b = world.bodies[body];
  switch (shade) {
    case Shade::kStress: return b.surface_values(snapshot.stress[body]);
    case Shade::kPenetration: {
      VecX out = VecX::Constant(b.surface_points(snapshot.nodes[body]).cols(), kNone);
      for (const auto& [vertex, depth] : snapshot.depths[body]) out[vertex] = depth;
      return out;
    }
    case Shade::kDisplacement: break;
  }
  return b.surface_values(displacement(world, body, snapshot.nodes[body]));
}

// Nodes rather than surface vertices: a skin of 44,000 vertices interpolates between 2,500 nodes.
double largest_value(const loop::World& world, const WorldSnapshot& snapshot, Shade shade) {
  double largest = 0.0;
  const auto add = [&](double value) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  };
  for (std::size_t i = 0; i < snapshot.nodes.size(); ++i) {
    if (shade == Shade::kPenetration) {
      for (const auto& [vertex, depth] : snapshot.depths[i]) add(depth);
      continue;
    }
    const VecX values =
        shade == Shade::kStress ? snapshot.stress[i] : displacement(world, i, snapshot.nodes[i]);
    for (const double value : values) add(value);
  }
  return largest;
}

render::ColourScale colour_scale(const loop::World& world, Shade shade, double extent, double largest) {
  double stiffest = 0.0;
  for (const SoftBodySpec& body : world.description.bodies)
    stiffest = std::max(stiffest, body.youngs_modulus_pa);
  render::ColourScale scale;
  scale.label = shade == Shade::kStress        ? "von Mises stress"
                : shade == Shade::kPenetration ? "penetration"
                                               : "displacement";
  scale.unit = shade == Shade::kStress ? "Pa" : "m";
  scale.resolution = 1e-9 * (shade == Shade::kStress ? stiffest : extent);
  const std::size_t free = free_bodies(world.description).size();
  if (shade == Shade::kDisplacement && free > 0)
    scale.note = free == world.bodies.size() ? "without rigid motion" : "free bodies: without rigid motion";
  scale.low = 0.0;
  scale.high = largest > scale.resolution ? rounded_range(largest) : 0.0;
  return scale;
}

void LargestValue::period(loop::World& world, double t) {
  if (shade_ != Shade::kPenetration) add(world, t);
}

void LargestValue::queried(loop::World& world, double t) {
  if (shade_ == Shade::kPenetration) add(world, t);
}

void LargestValue::add(loop::World& world, double t) {
  largest_ = std::max(largest_, largest_value(world, snapshot_of(world, t, shade_), shade_));
}

}  // namespace palpate::session
