#pragma once
#include "palpate/contact/touch_model.h"
#include "tool_side.h"

namespace palpate::loop {

/// The weighted sum of what X, or x, has for a sample's nodes.
auto moved_by(const contact::TouchSample& sample, const auto& x) {
  auto out = (sample.weight[0] * x(sample.node[0])).eval();
  for (std::size_t k = 1; k < static_cast<std::size_t>(sample.count); ++k)
    out += sample.weight[k] * x(sample.node[k]);
  return out;
}

inline bool presses(const contact::TouchSample& sample) { return sample.held || sample.gap < 0.0; }

inline bool names(const ContactSpec& contact, const std::string& tool) {
  return contact.first == tool || contact.second == tool;
}

/// The nodes that samples stand on, each once, in their order.  From then on the samples' are numbered by
/// them.
std::vector<int> number_nodes(std::vector<contact::TouchSample>& samples);

/// Load patterns: what a tool that moves a little does to the nodes through the samples that press; and the
/// forces of the samples that will press if all goes on as it does, where some of these do not yet: a tool
/// that comes down touches within the period.  Fewer than six and three, or twice that with friction, where
/// they are alike: a round tool that turns does nothing.
/// @param nodes    that samples are numbered by
/// @param most     columns, at most
/// @return  3 nodes x columns
MatX load_patterns(const World& world, const ToolSide& side, const std::vector<contact::TouchSample>& samples,
                   const std::vector<contact::TouchTangent>& tangents, std::size_t nodes, double H,
                   Eigen::Index most);

}  // namespace palpate::loop
