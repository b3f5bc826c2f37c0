#pragma once
#include <vector>

namespace palpate::gl {

/// Instants on the GPU's own clock: when it has done what it was told so far, which the processor does not
/// wait for (OpenGL's timer queries, GL_TIMESTAMP).
class Timestamps {
 public:
  explicit Timestamps(int count);
  ~Timestamps();
  Timestamps(const Timestamps&) = delete;
  Timestamps& operator=(const Timestamps&) = delete;

  void mark(int which);  ///< that one, 0 <= which < count, behind all commands before
  /// From one mark to another [s]; waits until the GPU has passed both.  0 where the driver has no such
  /// clock.
  double seconds(int from, int to) const;

 private:
  std::vector<unsigned> ids_;  ///< none where the driver has no such clock
};

}  // namespace palpate::gl
