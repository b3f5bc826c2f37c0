#include "placing_tables.h"

#include <fmt/format.h>

#include "loop/clearance.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string in_millimetres(const Vec3& x) {
  return fmt::format("{:.4g} {:.4g} {:.4g}", 1e3 * x.x(), 1e3 * x.y(), 1e3 * x.z());
}

void add_box(const std::string& name, const std::optional<Eigen::AlignedBox3d>& box, Rows& rows) {
  if (box)
    rows.push_back(
        {name, in_millimetres(box->sizes()), in_millimetres(box->min()), in_millimetres(box->max())});
  else
    rows.push_back({name, "unbounded", "-", "-"});
}

constexpr double kTouching = 2e-6;  // [m]; a tool that was placed has a smaller gap

std::string relation_of(const loop::Clearance& c) {
  if (c.gap.distance > kTouching) return "apart";
  if (c.gap.distance >= -kTouching) return "touching";
  const double length = c.way_out_m.norm();
  return fmt::format("overlapping: move {} by {:.4g} mm along {}", c.first, 1e3 * length,
                     loop::direction_text(c.way_out_m / (length > 0.0 ? length : 1.0)));
}

}  // namespace

void print_boxes(const loop::World& world) {
  Rows rows;
  for (const loop::Body& body : world.bodies) {
    const Points points = body.surface_points(body.placed);
    add_box(body.name,
            Eigen::AlignedBox3d(Vec3(points.rowwise().minCoeff()), Vec3(points.rowwise().maxCoeff())), rows);
  }
  for (const scene::Hand& hand : scene::hands_of(world.description))
    add_box(hand.name, loop::PlacedObject::tool(hand.name, *hand.tool, world.folder).bounds(), rows);
  for (const ObstacleSpec& obstacle : world.description.obstacles)
    add_box(obstacle.name, loop::PlacedObject::obstacle(obstacle).bounds(), rows);
  if (!rows.empty())
    fmt::print("{}\n", report::format_table({"bounding box", "size [mm]", "from [mm]", "to [mm]"}, rows));
}

void print_clearances(const loop::World& world, bool all) {
  for (const loop::ToolPlacement& p : world.placements)
    fmt::print("{} placed: moved by {:.4g} mm to ({}) mm, where it touches {}\n\n", p.tool, 1e3 * p.moved_m,
               in_millimetres(p.position_m), p.touched);
  Rows rows;
  try {
    for (const loop::Clearance& c : loop::clearances(world))
      if (all || c.in_contact || c.gap.distance <= kTouching)
        rows.push_back({c.first + " - " + c.second, fmt::format("{:.4g}", 1e3 * c.gap.distance),
                        relation_of(c), c.in_contact ? "yes" : "no"});
  } catch (const Error& error) {
    fmt::print("gaps at the start: {}\n\n", error.what());
    return;
  }
  if (!rows.empty())
    fmt::print("{}\n", report::format_table({"at the start", "gap [mm]", "", "in [[contact]]"}, rows));
}

}  // namespace palpate::cli
