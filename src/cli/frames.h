#pragma once
#include <string>
#include <vector>

#include "instant.h"
#include "palpate/render/panels.h"

namespace palpate::cli {

class Undelivered;

/// Pictures of a whole run: keeps an instant a frame while it runs and draws them behind it, so that camera
/// and colours are the same in all and fit every one.
class Frames : public loop::Observer {
 public:
  /// @param per_s       frames a second of simulated time, at most one a period of the loop, rounded to whole
  ///   periods; 0: at the scene's state_period_s, else every period
  /// @param duration_s  of the run: frames stand in [0, duration)
  /// @throws Error where the loop has no period that short
  Frames(const loop::World& world, Shade shade, double per_s, double duration_s);
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;

  double between_s() const { return between_s_; }  ///< simulated time from frame to frame

  /// Draws 0000.png, 0001.png, ... into the folder, each whole or not at all; what lay there of an earlier
  /// run is removed first.  Ctrl-C ends it behind the frame under way.
  /// @param stoppable  false where Ctrl-C has ended the run: what it recorded is then drawn
  /// @return how many were written; the first that cannot be is named in `missing`, and ends it
  int save(const loop::World& world, const std::string& folder, bool stoppable, Undelivered& missing) const;
  int count() const { return static_cast<int>(instants_.size()); }

 private:
  void keep(loop::World& world, double t);

  Shade shade_;
  double between_s_, end_s_;
  long every_, periods_ = 0;
  bool due_ = false;  ///< the next query is that of a frame
  std::vector<Instant> instants_;
  render::Curve curve_;
};

}  // namespace palpate::cli
