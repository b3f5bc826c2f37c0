#pragma once
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::cli {

/// Refuses at the start what could not be drawn at the end.
/// @param shade  "displacement" or "stress"
/// @throws Error where pictures were not compiled in, or for another name
void check_picture(const std::string& shade);

/// Keeps one instant of a run for a picture: the period in which the hand felt the largest force, or the last
/// one where there is no tool.
class Snapshot : public loop::Observer {
 public:
  explicit Snapshot(std::string shade) : shade_(std::move(shade)) {}
  void period(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  /// Surfaces shaded by displacement [m] or von Mises stress [Pa], the tool, bones seen through the tissue,
  /// and the obstacles.
  void save(const loop::World& world, const std::string& path) const;

 private:
  struct BodyNow {
    Points points;
    VecX values;
  };
  std::string shade_;
  std::vector<BodyNow> bodies_;
  std::vector<Pose> bones_;
  Pose tool_, newest_tool_;
  double time_ = 0.0, force_n_ = -1.0, newest_force_n_ = 0.0;
};

}  // namespace palpate::cli
