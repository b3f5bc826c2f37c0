#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace palpate::live {

/// Newest state of the scene for its viewers, in single precision and in the layout of the protocol:
/// positions of all bodies' nodes, poses of tools and bones, then per hand the handle's pose, force, torque
/// and flags.
struct Frame {
  double time_s = 0.0;
  std::vector<float> values;
};

/// Exchange of frames of a fixed size between the simulation, which writes, and the server's thread. The
/// reader gets the newest complete frame; neither waits for the other, and no memory is allocated after
/// construction (triple buffer, as core/triple_buffer.h for records of a fixed type).
class FrameBuffer {
 public:
  explicit FrameBuffer(std::size_t values) {
    for (Frame& slot : slots_) slot.values.resize(values);
  }
  std::size_t size() const { return slots_[0].values.size(); }  ///< Number of values per frame.
  /// Returns the frame to fill. Called by the writer's thread only.
  Frame& back() { return slots_[back_]; }
  /// Publishes that frame as the newest one. Called by the writer's thread only.
  void publish() { back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex; }
  /// Takes the newest frame, if there is one that was not taken yet. Returns whether there is. Called by the
  /// reader's thread only.
  bool take() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  /// Returns the frame taken last. Called by the reader's thread only; valid until the next take().
  const Frame& front() const { return slots_[front_]; }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<Frame, 3> slots_;
  unsigned back_ = 0;
  std::atomic<unsigned> middle_{1};
  unsigned front_ = 2;
};

}  // namespace palpate::live
