#pragma once
#include <string>

#include "instant.h"

namespace palpate::cli {

/// Keeps one instant of a run for a picture: the period in which the hand felt the largest force, or the last
/// one where there is no tool; for penetration the query behind that period, or the last one.
class Snapshot : public loop::Observer {
 public:
  explicit Snapshot(Shade shade) : shade_(shade) {}
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  double time() const { return instant_.time; }  ///< of the instant that is kept [s]
  /// Surfaces as the shade colours them, the tool, bones seen through the tissue, and the obstacles.
  void save(const loop::World& world, const std::string& path) const;

 private:
  void consider(loop::World& world, double t);

  Shade shade_;
  Instant instant_;
  /// of the kept instant's period and of the current one: the largest force, and when
  double force_n_ = -1.0, force_s_ = 0.0, newest_force_n_ = 0.0, newest_force_s_ = 0.0;
};

}  // namespace palpate::cli
