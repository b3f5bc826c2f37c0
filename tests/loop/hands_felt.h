#pragma once
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate {

/// Records the ticks of two hands and their order, and the last energy balance if requested.
struct HandsFelt final : loop::Observer {
  std::vector<loop::TickRecord> of[2];
  std::vector<std::size_t> order;
  std::optional<loop::EnergyBalance> last;
  bool weighs = false;
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override {
    of[hand].push_back(tick);
    order.push_back(hand);
  }
  bool wants_energy() const override { return weighs; }
  void energy(const loop::EnergyBalance& balance) override { last = balance; }
};

inline loop::RunResult run(const scene::Description& d, HandsFelt& felt, bool real_time = false) {
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.real_time = real_time;
  options.observers = {&felt};
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  return result;
}

}  // namespace palpate
