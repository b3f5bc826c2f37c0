#pragma once
#include <algorithm>
#include <vector>

#include "palpate/distance/skin.h"

namespace palpate::distance {

/// Which parts of a skin are too near to each other to touch each other, along it or through the tissue: the
/// material neighbourhood of each of its clusters.
///
/// Two clusters are neighbours where they share a vertex; where the shortest chain of clusters between them,
/// from centre to centre, is no longer than a radius and what both reach from their centres; and where they
/// are no farther from each other at rest than the radius, with tissue in between.  All else may touch:
/// fingers side by side, however near they are, for between them is air.
class OwnNeighbourhood {
 public:
  /// @param skin    of connected clusters (Clusters::kConnected)
  /// @param rest    its vertices at rest [m]
  /// @param radius  [m]
  OwnNeighbourhood(const Skin& skin, const Points& rest, double radius);

  double radius() const { return radius_; }
  bool may_touch(int cluster, int other) const {
    const auto c = static_cast<std::size_t>(cluster);
    return !std::binary_search(list_.begin() + begin_[c], list_.begin() + begin_[c + 1], other);
  }

 private:
  double radius_;
  std::vector<int> begin_, list_;  ///< neighbours of each cluster, ascending
};

}  // namespace palpate::distance
