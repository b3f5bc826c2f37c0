#pragma once
#include <gtest/gtest.h>

#include "palpate/loop/run.h"

namespace palpate {

/// Keeps what the first hand felt.
struct Ticks : loop::Observer {
  void tick(const loop::TickRecord& tick) override { all.push_back(tick); }
  std::vector<loop::TickRecord> all;
};

/// What the first hand felt in a run of the scene.
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
