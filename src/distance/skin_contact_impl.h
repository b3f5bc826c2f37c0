#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "distance/lane_search.h"
#include "distance/skin_contact.h"

namespace palpate::distance {

/// Relative margin of bounds, for the rounding of the few operations that produce them.
inline constexpr double kMarginOfBounds = 1e-12;

/// Surfaces and searches that one thread of a shared loop uses. Surfaces evaluate vertices on demand, so each
/// thread but the calling one has copies, which follow the nodes when that thread takes part; results are
/// functions of the positions alone.
struct SkinContact::Searcher {
  struct Copies {
    Surface of[2];
  };
  /// Creates the searcher of the calling thread, on two surfaces that must outlive it.
  explicit Searcher(Surface* shared)
      : surfaces(shared), searches{LaneSearch(shared[0]), LaneSearch(shared[1])} {}
  /// Creates the searcher of another thread.
  explicit Searcher(std::unique_ptr<Copies> own) : Searcher(own->of) { copies = std::move(own); }
  Searcher(const Searcher&) = delete;
  Searcher& operator=(const Searcher&) = delete;

  std::unique_ptr<Copies> copies;  ///< null: the surfaces are those of the contact
  Surface* surfaces;               ///< one per skin
  LaneSearch searches[2];
  long begun[2] = {0, 0};      ///< SkinContact::Query::number of both searches
  long moved = 0, fitted = 0;  ///< SkinContact::Positions of the copies
  // Memory of find_cluster().
  std::vector<Packet> packets;  ///< packets of the points of one cluster
  std::vector<int> open;        ///< packets of the cluster that may contain points near the other skin
  std::vector<Spring> found;    ///< springs of the clusters of one find_side()
};

}  // namespace palpate::distance
