#pragma once
#include <optional>
#include <string>
#include <vector>

#include "session/callbacks.h"
#include "session/movie_frames.h"
#include "session/options.h"
#include "session/peak_contact_picture.h"
#include "session/peak_force_picture.h"
#include "session/run_output.h"
#include "session/shade_values.h"

/// Pictures and movies of a run, drawn when it is over.
namespace palpate::session {

/// Appearance of the pictures.
struct PictureOptions {
  Shade shade = Shade::kDisplacement;
  double between_s = 0.0;  ///< Simulated time between frames [s]
  FrameSize size = {};     ///< Size of frames
};

/// Checks at the start whether the requested pictures can be drawn.  @throws Error if not
PictureOptions check_pictures(const Options& options, const scene::Description& description);

/// Observes a run for its pictures.
class RunPictures {
 public:
  /// @param folder  output folder of the run; the snapshots of frames are kept there during the run
  RunPictures(loop::World& world, const Options& options, const PictureOptions& pictures,
              const std::string& folder);

  std::vector<loop::Observer*> observers();

  /// Returns the largest value of the run so far; empty if no picture shows it.
  std::optional<double> largest_value() const;

  /// Saves picture.png and the pictures of the contact.
  void save_pictures(const loop::World& world, MissingOutputs& missing);

  /// Draws the frames.  @return figures of them; empty if none were requested
  std::optional<DrawnFrames> draw_frames(const loop::World& world, const Callbacks& callbacks,
                                         MissingOutputs& missing);

 private:
  const Options& options_;
  std::string folder_;
  LargestValue largest_;
  PeakForcePicture picture_;
  PeakContactPicture contact_picture_;
  std::optional<MovieFrames> frames_;
};

}  // namespace palpate::session
