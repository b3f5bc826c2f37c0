#pragma once
#include <vector>

#include "distance/lane_search.h"
#include "distance/skin_contact.h"

namespace palpate::distance {

/// Scratch memory of find_cluster(): packets of the points of one cluster.
struct SkinContact::Scratch {
  std::vector<Packet> packets;
  std::vector<int> open;  ///< Packets of the cluster that may contain points near the other skin.
};

}  // namespace palpate::distance
