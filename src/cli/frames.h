#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame_sink.h"
#include "instant_spool.h"
#include "render/panels.h"

namespace palpate::cli {

class MissingOutputs;

/// Simulated time from frame to frame [s], in whole periods of the loop: what it can be seen in.
/// @param per_s  frames a second of simulated time; 0: at the scene's state_period_s, else every period
/// @throws Error where the loop has no period that short
double between_frames(const scene::Description& description, double per_s);

inline constexpr double kMovieRate = 25.0;  ///< frames a second, as it is played

/// As between_frames, for a movie.
/// @param fps   frames a second as it is played; 0: kMovieRate, or as many as the loop has periods
/// @param slow  how many times longer than the simulated time it takes
double between_movie_frames(const scene::Description& description, double fps, double slow);

/// Of a frame with its curve [pixels]; even, as video encoders want them.
struct FrameSize {
  int width = 0, height = 0;  ///< 0: the default
};
/// "640x480".  @throws Error for what is no such size, is odd, or too small or large to draw
FrameSize frame_size(const std::string& text);

/// Pictures of a whole run: keeps an instant a frame on disk while it runs and draws them behind it, so that
/// camera and colours are the same in all and fit every one.  Memory holds one frame, and the curve.
class Frames : public loop::Observer {
 public:
  /// @param folder      for the instants
  /// @param between_s   simulated time from frame to frame
  /// @param duration_s  of the run: frames stand in [0, duration)
  Frames(const loop::World& world, const std::string& folder, Shade shade, double between_s,
         double duration_s, FrameSize size = {});
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  /// Of a run that is over: what it was at a time, after the ticks until then.
  void show(Instant instant);

  double between_s() const { return between_s_; }

  /// Draws each frame once for all sinks; where bodies stood still (in real time, when they fell behind)
  /// frames show them so.  Ctrl-C ends it behind the frame under way: sinks are closed with what they have.
  /// @param stoppable  false where Ctrl-C has ended the run: what it recorded is then drawn
  /// @param missing    gets what a sink could not write, or what cannot be drawn; the other sinks go on
  void save(const loop::World& world, const std::vector<FrameSink*>& sinks, bool stoppable,
            MissingOutputs& missing);
  int count() const;  ///< frames of what was run

 private:
  int frame_at(double t) const;
  void reach(double t);
  void keep(Instant instant);

  Shade shade_;
  double between_s_, end_s_;
  int width_, height_, strip_ = 0;  ///< of the picture above the curve, and of the curve [pixels]
  int next_ = 0;                    ///< frame to come
  double reached_ = 0.0;            ///< by the run [s]
  bool due_ = false;                ///< the next query is that of a frame
  InstantSpool instants_;
  render::Curve curve_;
  std::optional<Pose> first_handle_, handle_;
};

}  // namespace palpate::cli
