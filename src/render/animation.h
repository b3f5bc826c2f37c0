#pragma once
#include <filesystem>
#include <memory>

#include "render/picture.h"

namespace palpate::render {

/// Writer of an animated PNG file (PNG third edition, 2025: chunks acTL, fcTL, fdAT): frames of one size and
/// equal duration, played in an endless loop.  Browsers play it; programs that support only plain PNG show
/// the first frame.  Lossless; unchanged pixels are transparent, so that a constant background costs next to
/// nothing. Holds at most two frames in memory.
class AnimationWriter {
 public:
  /// Creates the file.
  /// @param frame_s  duration of a frame [s], rounded to 0.1 ms
  /// @throws Error where the file cannot be created
  AnimationWriter(const std::filesystem::path& path, double frame_s);
  ~AnimationWriter();
  AnimationWriter(const AnimationWriter&) = delete;
  AnimationWriter& operator=(const AnimationWriter&) = delete;

  /// Appends a frame.  @pre same size as the first frame  @throws Error with the path where it cannot be
  /// written
  void add(const Picture& picture);
  /// Writes the number of frames and the end; without it the file is incomplete.
  /// @pre at least one frame  @throws Error with the path where it cannot be written
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Duration as a fraction of whole numbers below 65536, the form that animation and video formats require.
struct Fraction {
  int numerator = 0, denominator = 1;
};
/// Approximates a duration [s].
/// @pre seconds > 0
/// @return fraction exact to 0.1 ms, above 6.5 s to at least four digits; between 0.1 ms and 65535 s
Fraction fraction_of(double seconds);

}  // namespace palpate::render
