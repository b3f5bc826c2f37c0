#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "palpate/core/named_enum.h"
#include "palpate/device/device.h"
#include "palpate/loop/run.h"

/// The ramp of a scene's device is applied to the force on its hand.
namespace {

using namespace palpate;

struct Keep final : loop::Observer {
  void tick(const loop::TickRecord& tick) override { ticks.push_back(tick); }
  std::vector<loop::TickRecord> ticks;
};

/// Force on the hand relative to the unlimited force, at each tick.
/// @param ramp_s  empty: the default
std::vector<double> shares(const std::string& scheme, std::optional<double> ramp_s) {
  scene::Description d = small_scenes::pressed_block(0.002);
  d.device->keyframes[0].position_m.z() -= 0.002;  // a coupling that pulls from the start
  d.device->ramp_s = ramp_s;
  d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
  Keep keep;
  loop::RunOptions options;
  options.observers = {&keep};
  const auto world = loop::assemble(d);
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  std::vector<double> out;
  for (const loop::TickRecord& tick : keep.ticks)
    out.push_back(tick.device.force.norm() / tick.requested.force.norm());
  return out;
}

// Smoothstep over 30 ms from the first tick, then the full force. A bounded slew passes nothing at the first
// tick, which has no previous time.
TEST(Ramp, IsFeltAsTheSceneSays) {
  for (const std::string scheme : {"partitioned", "monolithic", "single_rate"}) {
    SCOPED_TRACE(scheme);
    const std::vector<double> ramped = shares(scheme, 0.03), at_once = shares(scheme, {});
    ASSERT_EQ(ramped.size(), 40u);
    ASSERT_EQ(at_once.size(), 40u);
    for (std::size_t i = 0; i < 40; ++i) {
      EXPECT_NEAR(at_once[i], i > 0 ? 1.0 : 0.0, 1e-3) << "a script is the computer's; tick " << i;
      const double x = std::min(1.0, static_cast<double>(i) / 30.0);
      EXPECT_NEAR(ramped[i], x * x * (3.0 - 2.0 * x), 1e-3) << "tick " << i;
    }
  }
}

}  // namespace
