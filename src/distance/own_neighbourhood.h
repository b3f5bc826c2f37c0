#pragma once
#include <algorithm>
#include <vector>

#include "distance/skin.h"

namespace palpate::distance {

/// Material neighbourhood of each cluster of a skin, for self-contact: the clusters that are too close along
/// the skin or through the tissue to come into contact with it.
///
/// Two clusters are neighbours if at least one of these holds:
/// - They share a vertex.
/// - The shortest chain of clusters between them, measured from centre to centre, is no longer than `radius`
///   plus the distances from both centres to their farthest vertices.
/// - They are no farther apart at rest than `radius`, with tissue in between.
///
/// All other pairs may touch. Two fingers side by side may touch however close they are, because air
/// separates them.
class OwnNeighbourhood {
 public:
  /// Finds the neighbours of all clusters at rest.
  /// @param skin    skin built with Clusters::kConnected
  /// @param rest    vertices of the skin at rest [m]
  /// @param radius  largest distance of neighbours [m]
  /// @throws Error where the radius is not positive
  OwnNeighbourhood(const Skin& skin, const Points& rest, double radius);

  /// Returns the radius of the neighbourhood [m].
  double radius() const { return radius_; }
  /// Returns whether two clusters are not neighbours, so that contact between them is possible.
  bool may_touch(int cluster, int other) const {
    const auto c = static_cast<std::size_t>(cluster);
    return !std::binary_search(list_.begin() + begin_[c], list_.begin() + begin_[c + 1], other);
  }

 private:
  double radius_;
  std::vector<int> begin_, list_;  ///< Neighbours per cluster, ascending (CSR offsets and indices).
};

}  // namespace palpate::distance
