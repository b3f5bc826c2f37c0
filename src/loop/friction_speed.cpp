#include <algorithm>
#include <cmath>

#include "assemble_parts.h"
#include "palpate/scene/contact_sides.h"
#include "palpate/scene/hands.h"
#include "tool_side.h"

namespace palpate::loop {
namespace {

/// Longest edge of the box about them [m].
double length_of(const Points& x) { return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff(); }

// The speed below which friction is viscous, where a scene names none.  What sticks creeps with it, and an
// error-controlled method follows its time, v_r/(mu g), wherever sliding begins or ends: neither may depend
// on the units of length that a scene happens to have.  Froude's scaling, by which scenes of one shape move
// alike, leaves v_r = c sqrt(g L).  A block of 20 m that lands and slides under cvode-bdf takes 23,600 steps
// a second at c = 1.4e-5, 4,300 at 7e-5, 1,160 at 3e-4 and 1,090 at 1e-3: below 3e-4 the friction's own time
// decides, above it nothing is gained.
double friction_speed(const World& world, double length) {
  constexpr double kShare = 3e-4, kGravity = 9.81;
  const double g = world.description.gravity_m_s2.norm();
  return kShare * std::sqrt((g > 0.0 ? g : kGravity) * length);
}

}  // namespace

double tool_friction_speed(const World& world, const ToolSpec& tool) {
  const double length =
      tool.shape == "sphere" ? 2.0 * tool.radius_m : length_of(tool_surface(tool, world.folder).vertices);
  return friction_speed(world, length);
}

// A tool decides for its pairs alone, so that its ticks can be repeated without the bodies.
void set_friction_speed(World& world, ContactSpec& contact) {
  if (contact.friction == 0.0 || contact.friction_regularisation_m_s > 0.0) return;
  double length = HUGE_VAL;
  for (const std::string& name : {contact.first, contact.second}) {
    if (const ToolSide* const side = ToolSide::named(world, name)) {
      contact.friction_regularisation_m_s = tool_friction_speed(world, *side->spec);
      return;
    }
    if (const Body* const body = world.find_body(name))
      length = std::min(length, length_of(body->rest.nodes));
  }
  contact.friction_regularisation_m_s = friction_speed(world, length);
}

// Springs tie material points of a body.  (Between rigid things there are none: a ball has no material points
// there, and what its contact takes from tick to tick is found anew.)  They are as slow as the queries that
// move their anchors, and as the ticks that hold their deflection for so long.
double friction_retardation(const scene::Description& d, const ContactSpec& contact) {
  const auto is_body = [&](const std::string& name) {
    return std::any_of(d.bodies.begin(), d.bodies.end(), [&](const auto& body) { return body.name == name; });
  };
  const bool sticks = contact.friction > 0.0 && contact.friction_anchors &&
                      scene::contact_method(d, contact) == "distance" &&
                      (is_body(contact.first) || is_body(contact.second));
  if (!sticks) return 0.0;
  double slowest = d.exchange.contact_refresh_s;
  if (d.exchange.scheme == "partitioned")
    for (const std::string& name : {contact.first, contact.second})
      if (const ToolSpec* tool = scene::tool_named(d, name)) slowest = std::max(slowest, tool->tick_s);
  return slowest;
}

}  // namespace palpate::loop
