#pragma once
#include <vector>

namespace palpate::gl {

/// Timestamps on the GPU clock: each marks the completion of all earlier commands, without waiting on the CPU
/// (OpenGL timer queries, GL_TIMESTAMP).
class Timestamps {
 public:
  explicit Timestamps(int count);
  ~Timestamps();
  Timestamps(const Timestamps&) = delete;
  Timestamps& operator=(const Timestamps&) = delete;

  void mark(int which);  ///< Records mark `which`, 0 <= which < count, behind all earlier commands.
  /// Returns the time between two marks [s]; waits until the GPU has passed both.  0 where the driver has no
  /// timer.
  double seconds(int from, int to) const;

 private:
  std::vector<unsigned> ids_;  ///< Empty where the driver has no timer.
};

}  // namespace palpate::gl
