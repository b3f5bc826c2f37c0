#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// Rigid tool, the device that moves it, and their common name.
struct Hand {
  std::string name;                    ///< Name of the tool in [[contact]].
  std::string tool_key, device_key;    ///< Keys of their tables: "tool", "hand[0].device".
  const ToolSpec* tool = nullptr;      ///< Points into the description.
  const DeviceSpec* device = nullptr;  ///< Points into the description; null where missing.
};

/// Returns all hands of a scene: [tool] and [device], under the name "tool", then each [[hand]].
std::vector<Hand> hands_of(const Description& description);

/// Returns, for each hand, the index of the first hand whose tool is connected to its tool by a chain of
/// [[contact]]s; its index where there is none.
std::vector<std::size_t> connected_tools(const Description& description);

/// Returns the tool of that name in [[contact]]; null where there is none.
const ToolSpec* tool_named(const Description& description, const std::string& name);

}  // namespace palpate::scene
