#include "b_free_tool.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::validation {

scene::Description free_tool_scene(double length, double width, double element_size) {
  constexpr double kThickness = 0.01;
  scene::Description d;
  d.name = "free-tool";
  SoftBodySpec block;
  block.name = "block";
  block.mesh.generator = "box";
  block.mesh.size_m = Vec3(length, width, kThickness);
  block.mesh.element_size_m = element_size;
  block.position_m = Vec3(0, 0, -0.5 * kThickness);
  AttachmentSpec all;
  all.box_min_m = Vec3::Constant(-10.0);
  all.box_max_m = Vec3::Constant(10.0);
  block.attachments = {all};
  d.bodies = {block};
  ContactSpec contact;
  contact.first = "block";
  contact.second = "tool";
  contact.method = "distance";
  d.contacts = {contact};
  d.tool.emplace();
  d.tool->shape = ToolShape::kMesh;
  d.tool->gravity = true;
  d.tool->coupling = {0.0, 0.0, 0.0, 0.0};
  d.device.emplace();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 1e-3;
  d.integrator.name = "implicit-midpoint";
  d.integrator.step_s = 1e-4;
  return d;
}

std::vector<loop::TickRecord> run_free_tool(const scene::Description& description,
                                            const Spoiler& seed_defect) {
  struct Keep final : loop::Observer {
    std::vector<loop::TickRecord> ticks;
    void tick(const loop::TickRecord& tick) override { ticks.push_back(tick); }
  } keep;
  scene::Description d = description;
  KeyframeSpec start;  // The handle has no influence: the coupling is zero.
  start.position_m = d.tool->position_m;
  KeyframeSpec end = start;
  end.time_s = d.duration_s;
  d.device->keyframes = {start, end};
  const auto world = loop::assemble(d);
  if (seed_defect) seed_defect(*world);
  loop::RunOptions options;
  options.observers = {&keep};
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("free tool: {} at t = {}", result.status.message, result.time);
  return keep.ticks;
}

double mean_acceleration(const std::vector<loop::TickRecord>& ticks, double from_s, double to_s) {
  const loop::TickRecord *first = nullptr, *last = nullptr;
  for (const loop::TickRecord& tick : ticks) {
    if (!first && tick.time >= from_s - 1e-9) first = &tick;
    if (tick.time <= to_s + 1e-9) last = &tick;
  }
  PALPATE_CHECK(first && last && last->time > first->time, "no ticks from {} to {} s", from_s, to_s);
  return (last->tool_twist.linear.x() - first->tool_twist.linear.x()) / (last->time - first->time);
}

}  // namespace palpate::validation
