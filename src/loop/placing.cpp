#include "loop/placing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "assemble_parts.h"
#include "loop/clearance.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace palpate::loop {
namespace {

/// Steps of the search. A tool that slides along a surface at a distance takes one step per distance.
constexpr int kMostSteps = 20000;

/// Returns the objects that a tool may touch: the other sides of its contacts.
std::vector<PlacedObject> partners_of(const World& world, const std::string& tool) {
  std::vector<std::string> names;
  for (const ContactSpec& contact : world.description.contacts)
    if (contact.first == tool || contact.second == tool)
      names.push_back(contact.first == tool ? contact.second : contact.first);
  const auto is_partner = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<PlacedObject> out;
  for (const Body& body : world.bodies)
    if (is_partner(body.name)) out.push_back(PlacedObject::body(body));
  for (const ObstacleSpec& obstacle : world.description.obstacles)
    if (is_partner(obstacle.name)) out.push_back(PlacedObject::obstacle(obstacle));
  if (out.empty())
    fail("start = \"touching\": no [[contact]] lists the tool with a body or an obstacle; add one");
  return out;
}

void refuse_immovable(const World& world, const scene::Hand& hand) {
  if (hand.device->type == "recording")
    fail(
        "start = \"touching\" moves the device's keyframes with the tool, but type = \"recording\" repeats "
        "recorded positions; set position_m instead");
  for (const SoftBodySpec& body : world.description.bodies)
    for (const AttachmentSpec& attachment : body.attachments)
      if (attachment.to == hand.name)
        fail(
            "start = \"touching\" moves the tool, but body \"{}\" is attached to it and would not move; set "
            "position_m instead",
            body.name);
}

/// Returns the distance after which a tool that moves along `direction` has passed all objects [m]; for an
/// unbounded obstacle, kFarthest.
double distance_past(const std::vector<PlacedObject>& objects, const PlacedObject& tool,
                     const Vec3& direction) {
  constexpr double kFarthest = 100.0;  // [m]
  const Eigen::AlignedBox3d own = *tool.bounds();
  double farthest = 0.0;
  for (const PlacedObject& object : objects) {
    const auto box = object.bounds();
    if (!box) return kFarthest;
    farthest = std::max(farthest, direction.dot(box->center() - own.center()) + box->diagonal().norm());
  }
  return farthest + own.diagonal().norm();
}

struct Touch {
  double moved = 0.0;  // [m]
  std::string object;
  Vec3 at = Vec3::Zero();
};

[[noreturn]] void refuse_inside(PlacedObject& tool, const PlacedObject& object, double depth,
                                const Vec3& direction) {
  const Vec3 back = -direction;
  fail(
      "start = \"touching\": the tool starts {:.3g} mm inside \"{}\"; begin outside: move position_m by at "
      "least "
      "{:.4g} mm along {}",
      1e3 * depth, object.name(), 1e3 * distance_out(tool, object, back), direction_text(back));
}

/// Moves the tool to the first touch.
Touch find_touch(PlacedObject& tool, const std::vector<PlacedObject>& objects, const Vec3& direction) {
  const double past = distance_past(objects, tool, direction);
  Touch out;
  double closest = HUGE_VAL;
  for (int step = 0; step < kMostSteps && out.moved <= past; ++step) {
    distance::Gap gap{HUGE_VAL};
    for (const PlacedObject& object : objects)
      if (const distance::Gap one = gap_between(tool, object); one.distance < gap.distance)
        gap = one, out.object = object.name();
    if (step == 0 && gap.distance < 0.0)
      for (const PlacedObject& object : objects)
        if (object.name() == out.object) refuse_inside(tool, object, -gap.distance, direction);
    out.at = gap.on_second;
    if (gap.distance <= kTouchingGap) return out;
    closest = std::min(closest, gap.distance);
    // half of the tolerance short of the gap, so that rounding does not lead inside
    const double length = gap.distance - 0.5 * kTouchingGap;
    tool.shift(length * direction);
    out.moved += length;
  }
  std::vector<std::string> names;
  for (const PlacedObject& object : objects) names.push_back(fmt::format("\"{}\"", object.name()));
  fail(
      "start = \"touching\": the tool moved {:.3g} m along start_direction and missed {}, by {:.3g} mm at "
      "the "
      "closest; change position_m or start_direction",
      out.moved, fmt::join(names, ", "), 1e3 * closest);
}

/// Moves one tool, given its specs in the description of the World.
void place_tool(World& world, const scene::Hand& hand, ToolSpec& tool, DeviceSpec& device) {
  if (tool.start != ToolStart::kTouching) return;
  if (!(tool.start_direction.norm() > 0.0))
    fail("start_direction = [0, 0, 0] has no direction; [0, 0, -1] is downwards");
  refuse_immovable(world, hand);
  const Vec3 direction = tool.start_direction.normalized();
  const std::vector<PlacedObject> objects = partners_of(world, hand.name);
  PlacedObject placed = PlacedObject::tool(hand.name, tool, world.folder);
  const Touch touch = find_touch(placed, objects, direction);
  const Vec3 moved = touch.moved * direction;
  tool.position_m += moved;
  for (KeyframeSpec& keyframe : device.keyframes) keyframe.position_m += moved;
  world.placements.push_back({hand.name, touch.moved, tool.position_m, touch.object, touch.at});
}

}  // namespace

void place_tools(World& world) {
  scene::Description& d = world.description;
  const std::vector<scene::Hand> hands = scene::hands_of(d);
  for (std::size_t i = 0; i < hands.size(); ++i)
    at_place(world, hands[i].tool_key + ".start", hands[i].name == "tool" ? "tool" : hands[i].name, [&] {
      i == 0 ? place_tool(world, hands[0], *d.tool, *d.device)
             : place_tool(world, hands[i], d.hands[i - 1].tool, d.hands[i - 1].device);
    });
}

}  // namespace palpate::loop
