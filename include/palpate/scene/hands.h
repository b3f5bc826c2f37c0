#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// A rigid tool, the device that moves it, and the name of both.
struct Hand {
  std::string name;                    ///< what [[contact]] calls its tool
  std::string tool_key, device_key;    ///< of their tables: "tool", "hand[0].device"
  const ToolSpec* tool = nullptr;      ///< in the description
  const DeviceSpec* device = nullptr;  ///< in the description; null where it is missing
};

/// All hands of a scene: that of [tool] and [device], which is called "tool", then each [[hand]].
std::vector<Hand> hands_of(const Description& description);

/// Returns of each hand the first whose tool meets its tool, by a [[contact]] or by way of others; itself
/// where none does.
std::vector<std::size_t> meeting_tools(const Description& description);

/// The tool that [[contact]] calls so; null where there is none.
const ToolSpec* tool_named(const Description& description, const std::string& name);

}  // namespace palpate::scene
