#pragma once
#include <gtest/gtest.h>

#include "palpate/loop/run.h"

namespace palpate {

/// Records the ticks of the first hand.
struct Ticks : loop::Observer {
  void tick(const loop::TickRecord& tick) override { all.push_back(tick); }
  std::vector<loop::TickRecord> all;
};

/// Returns the first hand's ticks in a run of the scene.
inline std::vector<loop::TickRecord> ticks_of(loop::World& world) {
  Ticks ticks;
  loop::RunOptions options;
  options.observers = {&ticks};
  const loop::RunResult result = loop::run(world, options);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  return ticks.all;
}
inline std::vector<loop::TickRecord> ticks_of(const scene::Description& d) {
  return ticks_of(*loop::assemble(d));
}

}  // namespace palpate
