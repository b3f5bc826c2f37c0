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

PenetrationReport report_of(const World& world, std::size_t i, const contact::PairReport& pair) {
  const ContactSpec& contact = world.description.contacts[i];
  PenetrationReport out{fmt::format("{} - {}", contact.first, contact.second), pair.deepest, HUGE_VAL,
                        contact.first == contact.second};
  if (const contact::SumError* error = pair.sum_error) {
    out.quadrature_error = error->largest();
    out.largest_share = error->largest_share();
  }
  if (out.deepest_m > 0.0) out.half_width_m = penetration_limit(world, i);
  return out;
}

}  // namespace

double penetration_limit(const World& world, std::size_t contact) {
  const ContactSpec& spec = world.description.contacts.at(contact);
  if (spec.first == spec.second)
    return PenetrationReport::kOwnShare * depth_within_itself(*world.find_body(spec.first));
  return std::min(half_width(world, spec.first), half_width(world, spec.second));
}

PenetrationReport penetration_report(const World& world, std::size_t contact) {
  return report_of(world, contact, world.contact->pairs().at(contact));
}

std::vector<PenetrationReport> penetration_reports(const World& world) {
  std::vector<PenetrationReport> out;
  if (!world.contact) return out;
  for (const contact::PairReport& pair : world.contact->pairs())
    out.push_back(report_of(world, out.size(), pair));
  return out;
}

}  // namespace palpate::loop
