#include "loop/choose_scheme.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "palpate/core/named_enum.h"
#include "palpate/device/device.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"
#include "palpate/scene/hands.h"

namespace palpate::loop {
namespace {

constexpr double kShareOfTick = 0.5;
/// Ticks before the measured ones, which allocate memory and choose linear solvers, and measured ticks.
constexpr int kFirst = 8, kMeasured = 32;

/// Handle at rest at the tool's start: the scene's device may be a peer that nobody moves yet.
class AtRest : public device::Device {
 public:
  explicit AtRest(const ToolSpec& tool) : pose_{quaternion_of(tool.rotation_vector_rad), tool.position_m} {}
  device::DeviceSpecification specification() const override { return {}; }

 private:
  device::HandleSample do_sample(double) override {
    device::HandleSample out;
    out.pose = pose_;
    return out;
  }
  Pose pose_;
};

/// Notes the wall time of each tick.
class Watch : public Observer {
 public:
  void tick(const TickRecord&) override { at.push_back(wall_seconds()); }
  std::vector<double> at;
};

}  // namespace

std::string SchemeChoice::text() const {
  const bool holds = scheme == scene::ExchangeScheme::kSingleRate;
  return fmt::format(
      "exchange.scheme = \"auto\": {}, because a step of tool and bodies takes {:.2f} ms, {} of a "
      "tick of {:g} ms",
      name_of(scheme), 1e3 * step_s, holds ? "less than half" : "more than half", 1e3 * tick_s);
}

scene::Description with_scheme(const scene::Description& d, scene::ExchangeScheme scheme) {
  if (!d.source.empty())
    return parse(d.source, d.path, {fmt::format("exchange.scheme=\"{}\"", name_of(scheme))});
  scene::Description out = d;
  out.exchange.scheme = scheme;
  return out;
}

SchemeChoice choose_scheme(const scene::Description& d) {
  SchemeChoice out{.tick_s = d.tool->tick_s};
  if (d.bodies.empty()) return out;  // nothing is exchanged
  const scene::Description one = with_scheme(d, scene::ExchangeScheme::kSingleRate);
  std::vector<std::unique_ptr<device::Device>> hands;
  for (const scene::Hand& hand : scene::hands_of(one)) hands.push_back(std::make_unique<AtRest>(*hand.tool));
  const auto world = assemble(one, std::move(hands));
  Watch watch;
  RunOptions options;
  options.duration_s = (kFirst + kMeasured) * out.tick_s;
  options.observers = {&watch};
  if (!run(*world, options).status.ok() || watch.at.size() < kFirst + 2) return out;
  std::vector<double> taken;
  for (std::size_t i = kFirst; i < watch.at.size(); ++i) taken.push_back(watch.at[i] - watch.at[i - 1]);
  std::nth_element(taken.begin(), taken.begin() + std::ssize(taken) / 2, taken.end());
  out.step_s = taken[taken.size() / 2];
  if (out.step_s <= kShareOfTick * out.tick_s) out.scheme = scene::ExchangeScheme::kSingleRate;
  return out;
}

}  // namespace palpate::loop
