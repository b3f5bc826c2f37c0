#pragma once
#include "contact/reduced_contact_model.h"
#include "palpate/dynamics/rigid_body.h"

namespace palpate::loop {

/// Returns the weighted sum of x over the nodes of a sample; x(node) returns rows of a matrix or a vector.
auto moved_by(const contact::ReducedSample& sample, const auto& x) {
  auto out = (sample.weight[0] * x(sample.node[0])).eval();
  for (std::size_t k = 1; k < static_cast<std::size_t>(sample.count); ++k)
    out += sample.weight[k] * x(sample.node[k]);
  return out;
}

/// Returns whether a sample exerts a force.
inline bool presses(const contact::ReducedSample& sample) { return sample.held || sample.gap < 0.0; }

/// Returns the nodes of all samples, each once, ascending, and renumbers the samples' nodes by their index in
/// this list.
std::vector<int> number_nodes(std::vector<contact::ReducedSample>& samples);

/// Returns the load patterns of the reduction: the nodal forces that small tool motions cause through the
/// pressing samples; and, if some samples do not press yet but will at constant velocities (a tool that comes
/// down touches within the period), the forces of all samples that will press then. At most six columns
/// (twelve with friction) and three for the latter; fewer if columns are linearly dependent, as for a
/// rotating spherical tool.
/// @param tool      motion of the tool at the exchange
/// @param friction  whether a contact of the tool has friction
/// @param nodes     number of nodes in the samples' numbering
/// @param H         length of the period [s]
/// @param most      largest number of columns
/// @return  3 nodes x columns
MatX load_patterns(const dynamics::RigidMotion& tool, bool friction,
                   const std::vector<contact::ReducedSample>& samples,
                   const std::vector<contact::ReducedTangent>& tangents, std::size_t nodes, double H,
                   Eigen::Index most);

}  // namespace palpate::loop
