#pragma once
#include <vector>

#include "distance/lane_search.h"
#include "palpate/distance/skin_contact.h"

namespace palpate::distance {

/// Packets of the points of one cluster.
struct SkinContact::Scratch {
  std::vector<Packet> packets;
  std::vector<int> open;  ///< packets of the cluster that may have points near
};

}  // namespace palpate::distance
