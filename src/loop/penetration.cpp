#include "loop/penetration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact/sources.h"
#include "palpate/contact/obstacle.h"
#include "palpate/scene/hands.h"

namespace palpate::loop {
namespace {

/// Returns half of the smallest extent of a side of a contact, along the axes in which it was defined [m].
double half_width(const World& world, const std::string& side) {
  const auto of_points = [](const Points& points) {
    return 0.5 * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).minCoeff();
  };
  if (const Body* body = world.find_body(side)) return of_points(body->rest.nodes);
  if (const ToolSpec* tool = scene::tool_named(world.description, side))
    return tool->shape == ToolShape::kSphere ? tool->radius_m
                                             : of_points(tool_surface(*tool, world.folder).vertices);
  for (const ObstacleSpec& obstacle : world.description.obstacles)
    if (obstacle.name == side)
      return 0.5 * contact::obstacle_entry(obstacle).lengths(contact::obstacle_shape(obstacle)).width;
  return HUGE_VAL;
}

double depth_within_itself(const Body& body) {
  return contact::own_contact_depth(contact::lengths_of(body.skin ? body.skin->rest : body.boundary.surface));
}

}  // namespace

std::vector<PenetrationReport> penetration_reports(const World& world) {
  std::vector<PenetrationReport> out;
  if (!world.contact) return out;
  const std::vector<contact::PairReport> pairs = world.contact->pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ContactSpec& contact = world.description.contacts[i];
    PenetrationReport one{fmt::format("{} - {}", contact.first, contact.second), pairs[i].deepest, HUGE_VAL,
                          contact.first == contact.second};
    if (const contact::SumError* error = pairs[i].sum_error) {
      one.quadrature_error = error->largest();
      one.largest_share = error->largest_share();
    }
    if (one.deepest_m > 0.0 && one.of_itself)
      one.half_width_m = PenetrationReport::kOwnShare * depth_within_itself(*world.find_body(contact.first));
    else if (one.deepest_m > 0.0)
      one.half_width_m = std::min(half_width(world, contact.first), half_width(world, contact.second));
    out.push_back(one);
  }
  return out;
}

}  // namespace palpate::loop
