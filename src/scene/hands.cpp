#include "palpate/scene/hands.h"

#include <fmt/format.h>

namespace palpate::scene {

std::vector<Hand> hands_of(const Description& d) {
  std::vector<Hand> out;
  if (d.tool) out.push_back({"tool", "tool", "device", &*d.tool, d.device ? &*d.device : nullptr});
  for (std::size_t i = 0; i < d.hands.size(); ++i)
    out.push_back({d.hands[i].name, fmt::format("hand[{}].tool", i), fmt::format("hand[{}].device", i),
                   &d.hands[i].tool, &d.hands[i].device});
  return out;
}

const ToolSpec* tool_named(const Description& d, const std::string& name) {
  for (const Hand& hand : hands_of(d))
    if (hand.name == name) return hand.tool;
  return nullptr;
}

}  // namespace palpate::scene
