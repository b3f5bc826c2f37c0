#pragma once
#include <optional>
#include <string>
#include <vector>

#include "render/panels.h"
#include "session/callbacks.h"
#include "session/frame_sink.h"
#include "session/snapshot_spool.h"

namespace palpate {
class MissingOutputs;
}

namespace palpate::session {

/// Returns the simulated time between frames [s], a multiple of the period of the loop, in which snapshots
/// can be taken.
/// @param per_s  frames per second of simulated time; 0: the state_period_s of the scene, or else every
/// period
/// @throws Error if the period of the loop is longer than requested
double between_frames(const scene::Description& description, double per_s);

inline constexpr double kMovieRate = 25.0;  ///< Frames per second of playback

/// Returns the simulated time between the frames of a movie [s], as between_frames().
/// @param fps   frames per second of playback; 0: kMovieRate, or the rate of the periods of the loop if it is
/// lower
/// @param slow  factor by which playback is slower than simulated time
double between_movie_frames(const scene::Description& description, double fps, double slow);

/// Size of a frame including its curve [pixels]; even numbers, as video encoders require.
struct FrameSize {
  int width = 0, height = 0;  ///< 0: default size
};
/// Parses a size as "640x480".
/// @throws Error for another format, and for sides that are odd or outside [160, 4096]
FrameSize frame_size(const std::string& text);

/// Observer that makes pictures of a whole run. It keeps one snapshot per frame on disk during the run and
/// draws them afterwards, so that camera and colour scale are the same in all frames and fit each of them.
/// Memory holds one frame and the curve.
class MovieFrames : public loop::Observer {
 public:
  /// @param folder      folder for the file of snapshots
  /// @param between_s   simulated time between frames [s]
  /// @param duration_s  duration of the run [s]: frames lie in [0, duration)
  MovieFrames(const loop::World& world, const std::string& folder, Shade shade, double between_s,
              double duration_s, FrameSize size = {});
  void period(loop::World& world, double t) override;
  void queried(loop::World& world, double t) override;
  void tick(const loop::TickRecord& tick) override;
  /// Adds a recorded snapshot of a finished run; the ticks up to its time must have been added by tick().
  void show(WorldSnapshot snapshot);

  double between_s() const { return between_s_; }

  /// Draws each frame once for all sinks; frames without a snapshot (in real time, if the bodies fell behind)
  /// repeat the last one. A stop ends drawing after the current frame: sinks are then closed with the frames
  /// that they have.
  /// @param missing    receives failures of drawing and of sinks; the other sinks continue
  /// @param largest    largest value of the run, the upper end of the range of colours; 0: that of the frames
  void save(const loop::World& world, const std::vector<FrameSink*>& sinks, const Callbacks& callbacks,
            MissingOutputs& missing, double largest = 0.0);
  int count() const;  ///< Number of frames for the simulated time so far

 private:
  int frame_at(double t) const;
  void reach(double t);
  void keep(WorldSnapshot snapshot);

  Shade shade_;
  double between_s_, end_s_;
  int width_, height_, strip_ = 0;  ///< Size of the picture above the curve, and height of the curve [pixels]
  int next_ = 0;                    ///< Next frame
  double reached_ = 0.0;            ///< Simulated time reached by the run [s]
  bool due_ = false;                ///< Whether a frame is due at the next snapshot
  SnapshotSpool snapshots_;
  render::Curve curve_;
  std::optional<Pose> first_handle_, handle_;
};

}  // namespace palpate::session
