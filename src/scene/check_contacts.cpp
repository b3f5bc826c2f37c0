#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "palpate/scene/hands.h"
#include "scene/check.h"
#include "scene/contact_sides.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

/// Names that a contact may refer to.
struct Sides {
  Names bodies, obstacles, tools;
  bool is_body(const std::string& name) const { return contains(bodies, name); }
  bool is_obstacle(const std::string& name) const { return contains(obstacles, name); }
  bool is_tool(const std::string& name) const { return contains(tools, name); }
  bool known(const std::string& name) const { return is_body(name) || is_obstacle(name) || is_tool(name); }
  Names all() const {
    Names names = bodies;
    names.insert(names.end(), obstacles.begin(), obstacles.end());
    names.insert(names.end(), tools.begin(), tools.end());
    return names;
  }
  static bool contains(const Names& names, const std::string& name) {
    for (const auto& one : names)
      if (one == name) return true;
    return false;
  }
};

void check_sides(const Document& doc, const std::string& key, const std::string& where, const Sides& sides,
                 const ContactSpec& c) {
  int side = 0;
  for (const std::string& name : {c.first, c.second}) {
    const std::string at = location(doc, fmt::format("{}.between[{}]", key, side++));
    if (sides.known(name)) continue;
    if (name == "tool") refuse(at, where, "\"tool\" is given, but the scene has no [tool]");
    refuse(at, where, fmt::format("nothing is called \"{}\"{}", name, suggestion(name, sides.all())));
  }
  const std::string at = location(doc, key + ".between");
  if (c.first == c.second && !sides.is_body(c.first))
    refuse(at, where, "only a soft body may touch itself; give two different names");
  if (sides.is_obstacle(c.first) && sides.is_obstacle(c.second))
    refuse(
        at, where,
        "obstacles do not move, so these two cannot touch; one of the two must be a soft body or the tool");
}

/// Rejects, for methods other than nearest points, a contact that only nearest points support.
/// @param touches  description of the contact: "contact of a body with itself"
void check_nearest_points(const Document& doc, const std::string& key, const std::string& where,
                          const ContactSpec& c, std::string_view touches) {
  if (c.method == "distance") return;
  const std::string method = key + ".method";
  refuse(location(doc, given(doc, method) ? method : key + ".between"), where,
         fmt::format("{} requires method = \"distance\", not \"{}\"; write \"distance\", or remove the key "
                     "that selects the other",
                     touches, c.method));
}

void check_method(const Document& doc, const std::string& key, const std::string& where, const Sides& sides,
                  const Description& d, ContactSpec& c) {
  const ToolSpec *first_tool = tool_named(d, c.first), *second_tool = tool_named(d, c.second);
  const bool obstacle = sides.is_obstacle(c.second),
             sphere_tool = second_tool && second_tool->shape == ToolShape::kSphere;
  if (c.method == "auto") {
    c.method = contact_method(d, c);
    if (const std::string pixels = key + ".pixels"; given(doc, pixels)) {
      if (obstacle)
        refuse(location(doc, pixels), where,
               "pixels does not apply to an obstacle, whose gaps are exact; remove it");
      c.method = "image";
    }
  }
  if (c.spring == "per_point" && first_tool && second_tool)
    refuse(location(doc, key + ".spring"), where,
           "spring = \"per_point\" does not apply to two tools, whose contact is at nearest points that "
           "represent areas, not at vertices; remove it");
  if (c.spring == "per_point" && c.method == "distance")
    refuse(location(doc, key + ".spring"), where,
           "spring = \"per_point\" does not apply to method = \"distance\", whose points represent areas, "
           "not vertices; remove it");
  if (c.spring == "per_point" && first_tool && first_tool->shape == ToolShape::kSphere)
    refuse(location(doc, key + ".spring"), where,
           "spring = \"per_point\" does not apply to a tool with shape = \"sphere\", which has no vertices; "
           "remove it");
  if (is_in_images(c) && obstacle)
    refuse(location(doc, key + ".method"), where,
           fmt::format("method = \"{}\" is for tools and soft bodies: an obstacle has exact gaps; use "
                       "\"analytic\" or \"distance\"",
                       c.method));
  if (c.first == c.second)
    check_nearest_points(doc, key, where, c, "contact of a body with itself");
  else if (first_tool && second_tool)
    check_nearest_points(doc, key, where, c, "contact of two tools");
  else if (sides.is_body(c.second)) {
    if (c.method == "analytic")
      refuse(location(doc, key + ".method"), where,
             "two soft bodies have no exact gaps: leave the method out, or write \"auto\"");
    const auto proxies = [&](const std::string& name) {
      for (const auto& body : d.bodies)
        if (body.name == name) return body.proxies;
      return false;
    };
    if (is_in_images(c) && proxies(c.first) != proxies(c.second))
      refuse(location(doc, key + ".between"), where,
             fmt::format("proxies = true is set for \"{}\" alone; set it for both bodies or for neither",
                         proxies(c.first) ? c.first : c.second));
  } else if (c.method == "analytic" && !obstacle && !sphere_tool)
    refuse(location(doc, key + ".method"), where,
           "method = \"analytic\" needs a tool with shape = \"sphere\"; leave it out for a mesh, or write "
           "\"auto\"");
}

/// Checks friction_tangent.  A key of the file is accepted where an override sets friction to zero.
void check_friction(const Document& doc, const std::string& key, const std::string& where,
                    const ContactSpec& c) {
  const std::string tangent = key + ".friction_tangent", friction = key + ".friction";
  if (c.friction > 0.0 || !given(doc, tangent)) return;
  if (given(doc, friction) && location(doc, friction).starts_with("--set ") &&
      !location(doc, tangent).starts_with("--set "))
    return;
  refuse(location(doc, tangent), where,
         "friction_tangent does not apply where friction = 0; remove it, or set friction");
}

void check_grasp(const Document& doc, const Description& d, const Hand& hand) {
  if (hand.tool->grasp_switch < 0) return;
  // In canonical order the body precedes the tool.
  if (std::none_of(d.contacts.begin(), d.contacts.end(),
                   [&](const ContactSpec& c) { return c.second == hand.name && !tool_named(d, c.first); }))
    refuse(
        location(doc, hand.tool_key + ".grasp_switch"),
        hand.name == "tool" ? "tool" : fmt::format("hand \"{}\": tool", hand.name),
        fmt::format("grasp_switch = {}, but no [[contact]] is between the tool and a soft body, so there is "
                    "nothing to grasp; add one, or remove the key",
                    hand.tool->grasp_switch));
}

}  // namespace

void check_contacts(const Document& doc, Description& d) {
  Sides sides;
  for (const auto& body : d.bodies) sides.bodies.push_back(body.name);
  for (const auto& obstacle : d.obstacles) sides.obstacles.push_back(obstacle.name);
  for (const Hand& hand : hands_of(d)) sides.tools.push_back(hand.name);

  std::set<std::pair<std::string, std::string>> seen;
  for (std::size_t i = 0; i < d.contacts.size(); ++i) {
    ContactSpec& c = d.contacts[i];
    const std::string key = fmt::format("contact[{}]", i),
                      where = fmt::format("contact between \"{}\" and \"{}\"", c.first, c.second);
    check_sides(doc, key, where, sides, c);
    order_sides(d, c);
    check_method(doc, key, where, sides, d, c);
    check_friction(doc, key, where, c);
    if (!seen.emplace(c.first, c.second).second)
      refuse(location(doc, key + ".between"), where, "this pair has two [[contact]] tables; remove one");
  }
  for (const Hand& hand : hands_of(d)) check_grasp(doc, d, hand);
}

}  // namespace palpate::scene
