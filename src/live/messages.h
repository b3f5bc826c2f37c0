#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "palpate/core/pose.h"

/// Messages from viewers (docs/live.md). They come from an untrusted sender.
namespace palpate::live {

/// Longest message [bytes].
inline constexpr std::size_t kLongestMessage = 1024;
/// Largest coordinate of a handle's position [m].
inline constexpr double kFarthest = 1e3;

struct TakeHandle {};
struct DropHandle {};
struct MoveHandle {
  std::size_t hand = 0;
  Pose target;  ///< Finite, of a unit rotation.
  std::uint32_t switches = 0;
};
struct SetValue {
  std::string key;
  double value = 0.0;  ///< Finite.
};
struct Reset {};
struct SetRecording {
  bool on = false;
};
struct OpenScene {
  std::string scene;
};
struct SetPause {
  bool on = false;
};
using Message =
    std::variant<TakeHandle, DropHandle, MoveHandle, SetValue, Reset, SetRecording, OpenScene, SetPause>;

/// Reads one message: a JSON object of a known type, with all its keys and no others. Returns nothing for
/// anything else; does not throw.
std::optional<Message> read_message(std::string_view text);

}  // namespace palpate::live
