#include "palpate/loop/run_options.h"

#include "palpate/core/error.h"
#include "palpate/loop/world.h"
#include "tool_instance.h"

namespace palpate::loop {

double period_of(const scene::Description& d) {
  if (d.tool && d.exchange.scheme == scene::ExchangeScheme::kPartitioned) return d.exchange.exchange_period_s;
  if (d.tool && d.exchange.scheme == scene::ExchangeScheme::kSingleRate) return d.exchange.contact_refresh_s;
  if (!d.contacts.empty()) return d.exchange.contact_refresh_s;
  return d.record ? d.record->state_period_s : d.duration_s;
}

void check_clock(const World& world, bool real_time) {
  const scene::Description& d = world.description;
  if (!real_time) {
    for (const ToolInstance& tool : world.tools)
      if (tool.device->is_live())
        fail(
            "device: type = \"{}\" is driven from outside, by the wall clock; run in real time (palpate run "
            "--realtime)",
            tool.device_spec.type);
    return;
  }
  if (!d.tool) fail("real time: the scene has no [tool], so there is no force for a hand to feel");
  if (d.exchange.scheme == scene::ExchangeScheme::kMonolithic)
    fail(
        "real time: exchange.scheme = \"monolithic\" needs the handle's path in advance; use \"partitioned\" "
        "or "
        "\"single_rate\"");
  for (const scene::HandSpec& hand : d.hands)
    if (hand.tool.tick_s != d.tool->tick_s)
      fail(
          "real time: hand \"{}\" has tick_s = {}, the first hand {}; all hands share one clock, so make "
          "them equal",
          hand.name, hand.tool.tick_s, d.tool->tick_s);
}

}  // namespace palpate::loop
