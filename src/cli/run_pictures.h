#pragma once
#include <optional>
#include <string>
#include <vector>

#include "contact_picture.h"
#include "frames.h"
#include "picture.h"
#include "run.h"

/// Pictures and movies of a run, drawn when it is over.
namespace palpate::cli {

/// Appearance of the pictures.
struct PictureOptions {
  Shade shade = Shade::kDisplacement;
  double between_s = 0.0;  ///< Simulated time between frames [s]
  FrameSize size = {};     ///< Size of frames
};

/// Checks at the start whether the requested pictures can be drawn.  @throws Error if not
PictureOptions check_pictures(const RunArguments& arguments, const scene::Description& description);

/// Observes a run for its pictures.
class RunPictures {
 public:
  /// @param folder  output folder of the run; the snapshots of frames are kept there during the run
  RunPictures(loop::World& world, const RunArguments& arguments, const PictureOptions& options,
              const std::string& folder);

  std::vector<loop::Observer*> observers();

  /// Saves picture.png and the pictures of the contact.
  void save_pictures(const loop::World& world, MissingOutputs& missing);

  /// Draws the frames and prints where they are.
  /// @param run_stopped  whether Ctrl-C ended the run
  /// @return whether Ctrl-C ended the drawing before all frames were complete
  bool save_frames(const loop::World& world, bool run_stopped, MissingOutputs& missing);

 private:
  const RunArguments& arguments_;
  std::string folder_;
  Snapshot snapshot_;
  ContactSnapshot contact_;
  std::optional<Frames> frames_;
};

}  // namespace palpate::cli
