#pragma once
#include <filesystem>
#include <memory>

#include "palpate/render/picture.h"

namespace palpate::render {

/// Writes an animated PNG file (PNG third edition, 2025: chunks acTL, fcTL, fdAT): pictures of one size, each
/// shown for the same time, for ever from the start again.  Browsers play it; what knows only PNG shows the
/// first picture.  Lossless; a pixel that did not change is transparent, so that a still background costs
/// next to nothing.  Two pictures are kept in memory, however many there are.
class AnimationWriter {
 public:
  /// @param frame_s  how long a picture is shown, to 0.1 ms [s]
  /// @throws Error where the file cannot be made
  AnimationWriter(const std::filesystem::path& path, double frame_s);
  ~AnimationWriter();
  AnimationWriter(const AnimationWriter&) = delete;
  AnimationWriter& operator=(const AnimationWriter&) = delete;

  /// @pre the size of the first picture  @throws Error with the path where it cannot be written
  void add(const Picture& picture);
  /// Writes the number of pictures and the end.  Without it the file is not whole.
  /// @pre at least one picture  @throws Error with the path where it cannot be written
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A duration as the fraction of whole numbers below 65536 that animations and videos are told.
struct Fraction {
  int numerator = 0, denominator = 1;
};
/// @pre seconds > 0  @return to 0.1 ms, and to at least four digits above 6.5 s; at least 0.1 ms, at most
///   65535 s
Fraction fraction_of(double seconds);

}  // namespace palpate::render
