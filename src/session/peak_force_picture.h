#pragma once
#include <string>

#include "session/world_snapshot.h"

namespace palpate::session {

/// Observer that keeps one snapshot of a run for a picture: the period with the largest force on the hand, or
/// the last period if there is no tool; for penetration the query after that period, or the last query.
class PeakForcePicture : public loop::Observer {
 public:
  explicit PeakForcePicture(Shade shade) : shade_(shade) {}
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  double time() const { return snapshot_.time; }  ///< Time of the kept snapshot [s]
  /// Draws the surfaces coloured by the shade, the tool, bones visible through the tissue, and the obstacles,
  /// and writes the PNG file.
  void save(const loop::World& world, const std::string& path) const;

 private:
  void consider(loop::World& world, double t);

  Shade shade_;
  WorldSnapshot snapshot_;
  /// Largest force [N] and its time [s], in the period of the kept snapshot and in the current period
  double force_n_ = -1.0, force_s_ = 0.0, newest_force_n_ = 0.0, newest_force_s_ = 0.0;
};

}  // namespace palpate::session
