#pragma once
#include <optional>
#include <string>

#include "session/world_snapshot.h"

namespace palpate::session {

/// Observer that keeps one snapshot of a run for a picture: the period with the largest force on the hand; if
/// there is no tool, the period with the largest value of the shade; for penetration a query in place of the
/// period.
class PeakForcePicture : public loop::Observer {
 public:
  explicit PeakForcePicture(Shade shade) : shade_(shade) {}
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  double time() const { return snapshot_.time; }  ///< Time of the kept snapshot [s]
  /// Draws the surfaces coloured by the shade, tool and handle, bones visible through the tissue, and the
  /// obstacles, in the view of the scene, and writes the PNG file.
  /// @param largest  largest value of the run, the upper end of the range of colours; 0: that of the snapshot
  void save(const loop::World& world, const std::string& path, double largest = 0.0) const;

 private:
  void consider(loop::World& world, double t);

  Shade shade_;
  WorldSnapshot snapshot_;
  double value_ = -1.0;         ///< Largest value of the shade so far, without a tool
  std::optional<Pose> handle_;  ///< Newest pose of the first hand
  /// Largest force [N] and its time [s], in the period of the kept snapshot and in the current period
  double force_n_ = -1.0, force_s_ = 0.0, newest_force_n_ = 0.0, newest_force_s_ = 0.0;
};

}  // namespace palpate::session
