#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "live/handle_follower.h"
#include "palpate/core/triple_buffer.h"
#include "palpate/device/device.h"

namespace palpate::live {

/// Target of the handle, as a viewer sent it.
struct HandleTarget {
  std::array<double, 3> position{};     ///< World axes [m].
  std::array<double, 4> rotation{1.0};  ///< Unit quaternion w x y z, handle to world.
  std::uint32_t switches = 0;           ///< Bits as in HandleSample.
  bool given = false;                   ///< Whether a viewer sent a target.

  static HandleTarget of(const Pose& pose, std::uint32_t switches);
  Pose pose() const;
};

/// Passes targets from the server's thread to the ticks: neither waits for the other.
using HandleMailbox = TripleBuffer<HandleTarget>;
/// One per hand, in the numbering of scene::hands_of(); null: the scene's device moves the hand.
using HandleMailboxes = std::vector<std::shared_ptr<HandleMailbox>>;

/// Device that viewers of the page move. The handle starts at rest and follows the newest target smoothly
/// (HandleFollower). Without a new target it comes to rest at the last one, so its pose is always valid. It
/// has no motors: viewers see the force.
class PageDevice : public device::Device {
 public:
  /// @param mailbox  receives the targets  @param start  pose until the first target
  PageDevice(std::shared_ptr<HandleMailbox> mailbox, const Pose& start, const FollowerLimits& limits = {});
  ~PageDevice() override { close(); }
  device::DeviceSpecification specification() const override;
  bool is_live() const override { return true; }
  void start_at(const Pose& start) override;
  /// Moves targets outside the ball to its nearest point.
  void bound(const device::PoseBounds& bounds) override { bounds_ = bounds; }

 protected:
  device::HandleSample do_sample(double t) override;

 private:
  std::shared_ptr<HandleMailbox> mailbox_;
  FollowerLimits limits_;
  HandleFollower follower_;
  Pose start_;
  device::PoseBounds bounds_;
  double time_ = 0.0;
  bool started_ = false;
};

}  // namespace palpate::live
