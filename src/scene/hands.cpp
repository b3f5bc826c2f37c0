#include "palpate/scene/hands.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace palpate::scene {

std::vector<Hand> hands_of(const Description& d) {
  std::vector<Hand> out;
  if (d.tool) out.push_back({"tool", "tool", "device", &*d.tool, d.device ? &*d.device : nullptr});
  for (std::size_t i = 0; i < d.hands.size(); ++i)
    out.push_back({d.hands[i].name, fmt::format("hand[{}].tool", i), fmt::format("hand[{}].device", i),
                   &d.hands[i].tool, &d.hands[i].device});
  return out;
}

std::vector<std::size_t> connected_tools(const Description& d) {
  const std::vector<Hand> hands = hands_of(d);
  std::vector<std::size_t> out(hands.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  const auto place = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::find_if(hands.begin(), hands.end(), [&](const Hand& h) { return h.name == name; }) -
        hands.begin());
  };
  for (const ContactSpec& contact : d.contacts) {
    const std::size_t a = place(contact.first), b = place(contact.second);
    if (a == hands.size() || b == hands.size()) continue;
    const auto [first, other] = std::minmax(out[a], out[b]);
    std::replace(out.begin(), out.end(), std::size_t(other), std::size_t(first));
  }
  return out;
}

const ToolSpec* tool_named(const Description& d, const std::string& name) {
  for (const Hand& hand : hands_of(d))
    if (hand.name == name) return hand.tool;
  return nullptr;
}

}  // namespace palpate::scene
