#include <algorithm>
#include <cmath>

#include "assemble_parts.h"
#include "palpate/scene/hands.h"
#include "scene/contact_sides.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

/// Returns the longest edge of the bounding box [m].
double length_of(const Points& x) { return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff(); }

// Default speed v_r below which friction is viscous. Sticking contacts creep with it, and an error-controlled
// method resolves its time constant, v_r/(mu g), wherever sliding begins or ends: neither may depend on the
// unit of length of a scene. Froude scaling, under which geometrically similar scenes move alike, gives
// v_r = c sqrt(g L). A block of 20 m that lands and slides under cvode-bdf takes 23,600 steps per second at
// c = 1.4e-5, 4,300 at 7e-5, 1,160 at 3e-4 and 1,090 at 1e-3: below 3e-4 the time constant of friction limits
// the step, above it nothing is gained.
double friction_speed(const World& world, double length) {
  constexpr double kShare = 3e-4, kGravity = 9.81;
  const double g = world.description.gravity_m_s2.norm();
  return kShare * std::sqrt((g > 0.0 ? g : kGravity) * length);
}

}  // namespace

double tool_friction_speed(const World& world, const ToolSpec& tool) {
  const double length = tool.shape == ToolShape::kSphere
                            ? 2.0 * tool.radius_m
                            : length_of(tool_surface(tool, world.folder).vertices);
  return friction_speed(world, length);
}

// For a pair with a tool, the tool alone determines the speed, so that its ticks can be recomputed without
// the bodies.
void set_friction_speed(World& world, ContactSpec& contact) {
  if (contact.friction == 0.0 || contact.friction_regularisation_m_s > 0.0) return;
  double length = HUGE_VAL;
  for (const std::string& name : {contact.first, contact.second}) {
    if (const ToolInstance* const tool = world.find_tool(name)) {
      contact.friction_regularisation_m_s = tool_friction_speed(world, tool->spec);
      return;
    }
    if (const Body* const body = world.find_body(name))
      length = std::min(length, length_of(body->rest.nodes));
  }
  contact.friction_regularisation_m_s = friction_speed(world, length);
}

// The springs tie material points of a body. (Between rigid objects there are none: a ball has no fixed
// material points there, and its contact points are computed again at each tick.) Their retardation time is
// the interval of the queries that move the anchors, or of the ticks, over which the deflection is constant,
// whichever is longer.
double friction_retardation(const scene::Description& d, const ContactSpec& contact) {
  const auto is_body = [&](const std::string& name) {
    return std::any_of(d.bodies.begin(), d.bodies.end(), [&](const auto& body) { return body.name == name; });
  };
  const bool sticks = contact.friction > 0.0 && contact.friction_anchors &&
                      scene::contact_method(d, contact) == "distance" &&
                      (is_body(contact.first) || is_body(contact.second));
  if (!sticks) return 0.0;
  double slowest = d.exchange.contact_refresh_s;
  if (!d.exchange.has_tools_in_state())
    for (const std::string& name : {contact.first, contact.second})
      if (const ToolSpec* tool = scene::tool_named(d, name)) slowest = std::max(slowest, tool->tick_s);
  return slowest;
}

}  // namespace palpate::loop
