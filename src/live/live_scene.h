#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "live/byte_writer.h"
#include "live/force_strip.h"
#include "live/frame_buffer.h"
#include "live/page_device.h"
#include "live/sliders.h"
#include "live/timing_window.h"
#include "palpate/core/triple_buffer.h"
#include "palpate/loop/world.h"

namespace palpate::live {

/// One assembled scene as its viewers see it: two messages that describe it, and the buffers through
/// which its simulation and the server's thread exchange data without waiting.
struct LiveScene {
  /// @throws Error for more than kMostHands hands
  /// @param sliders  their body indices are those of the world
  LiveScene(const loop::World& world, const std::string& name, std::vector<Slider> sliders,
            HandleMailboxes mailboxes);

  std::string name;         ///< Name by which it was opened.
  std::string description;  ///< Message `scene`; the server keeps its sliders up to date.
  Bytes geometry;           ///< Message `geometry`.
  std::vector<Slider> sliders;
  std::size_t hands;         ///< Number of hands.
  bool has_hand;             ///< Whether there is a hand; viewers may move the first.
  bool is_recorded = false;  ///< Set before it is shown.

  FrameBuffer frames;               ///< Simulation to server.
  ForceStrip strip;                 ///< Simulation to server.
  TripleBuffer<LiveStatus> status;  ///< Simulation to server.
  HandleMailboxes handles;          ///< Server to the hands' devices.
  /// Server to simulation: new Young's modulus of each body [Pa], 0: unchanged.
  std::vector<std::atomic<double>> moduli;
  std::atomic<bool> watched{false};  ///< Whether anybody watches; otherwise no frames are needed.
};

/// Number of values of a frame (docs/live.md).
std::size_t frame_values(const loop::World& world);

}  // namespace palpate::live
