#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/clock.h"
#include "palpate/loop/run.h"

// A tool rests for many ticks against a body that does not move: any motion is an error. A tick is one
// linearly implicit Euler step of tool and coupling: about its equilibrium the tool's deviation decays by the
// factor rho per tick, 1/rho^2 = 1 + h b/m + h^2 k/m or less stiff, and each tick rounds its pose p by eps
// |p|. It therefore stays within eps |p|/(1 - rho) of its equilibrium for any duration, and the coupling's
// wrench within k times that. 1 - rho is at least 1e-3 if the coupling settles within a second.
namespace palpate::long_touch {

/// Largest and last drift, with the bounds due to rounding.
struct Drift {
  double pose = 0.0;         ///< tick against the first tick that counts: norm of (rotation, translation)
  double force = 0.0;        ///< [N]
  double moment = 0.0;       ///< [N m]
  double memory_mib = 0.0;   ///< resident memory at the end minus that at the first tick that counts
  double pressing_n = 0.0;   ///< force on the hand at the first tick that counts
  double pose_bound = 0.0;   ///< eps |p|/(1 - rho)
  double force_bound = 0.0;  ///< k times pose_bound
  long ticks = 0;
};

/// Holds every node of every body, so that bodies do not move, and queries contact every `period_s`.
inline void freeze(scene::Description& d, double period_s) {
  AttachmentSpec all;
  all.region = Selection::kBox;
  all.box_min_m = Vec3::Constant(-100.0);
  all.box_max_m = Vec3::Constant(100.0);
  for (SoftBodySpec& body : d.bodies) body.attachments.assign(1, all);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = d.integrator.step_s = period_s;
}

/// Holds the tool at `depth` below first touch of a frozen body.
/// @param settled  first tick that counts
inline Drift rest(const scene::Description& d, long ticks, long settled) {
  struct Watch : loop::Observer {
    void tick(const loop::TickRecord& tick) override {
      if (++count < settled) return;
      if (count == settled) {
        first = tick;
        memory = resident_memory_mib();
        out.pressing_n = tick.device.force.norm();
      }
      out.pose = std::max(out.pose, pose_difference(first.tool, tick.tool).norm());
      out.force = std::max(out.force, (tick.requested.force - first.requested.force).norm());
      out.moment = std::max(out.moment, (tick.requested.moment - first.requested.moment).norm());
      finite = finite && tick.tool.translation.allFinite() && tick.device.force.allFinite();
    }
    long count = 0, settled = 0;
    bool finite = true;
    loop::TickRecord first;
    double memory = 0.0;
    Drift out;
  } watch;
  watch.settled = settled;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.duration_s = static_cast<double>(ticks) * d.tool->tick_s;
  options.observers = {&watch};
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_TRUE(watch.finite);
  watch.out.memory_mib = resident_memory_mib() - watch.memory;
  watch.out.ticks = result.ticks;
  constexpr double kSlowest = 1e-3;  // lower bound on 1 - rho
  watch.out.pose_bound =
      std::numeric_limits<double>::epsilon() * std::max(1.0, d.tool->position_m.norm()) / kSlowest;
  watch.out.force_bound = d.tool->coupling.stiffness_n_m * watch.out.pose_bound;
  return watch.out;
}

inline void expect_no_drift(const Drift& drift) {
  EXPECT_GT(drift.pressing_n, 0.1) << "it touches";
  EXPECT_LT(drift.pose, drift.pose_bound);
  EXPECT_LT(drift.force, drift.force_bound);
  EXPECT_LT(drift.moment, drift.force_bound) << "about the tool's own centre";
}

}  // namespace palpate::long_touch
