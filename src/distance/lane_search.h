#pragma once
#include <vector>

#include "distance/search_kernels.h"
#include "palpate/distance/own_neighbourhood.h"
#include "palpate/distance/surface.h"

namespace palpate::distance {

/// Nearest points of a surface for packets of sixteen points, in single precision about an origin near them.
///
/// The face that it finds holds the nearest point but for rounding, about 1e-7 of the distance from the
/// origin; Surface::nearest_around() then gives the point in double precision.  What bounds the search
/// changes no bit: see SearchKernels::search.
class LaneSearch {
 public:
  static constexpr double kAnywhere = 1e15;  ///< a distance whose square single precision has [m]
  /// @param surface  outlives the search
  explicit LaneSearch(const Surface& surface);

  /// Takes the surface as it is now.  @param box  of all points that will be asked for
  void begin(const Vec3& origin, const Eigen::AlignedBox3d& box);
  /// Fills lanes `begin` to `end` of a packet's points, and the rest with the last one.
  /// @param within  farther faces are not looked for [m]
  void finish(Packet& packet, int used, double within = kAnywhere) const;
  void set_point(Packet& packet, int lane, const Vec3& x) const;
  /// Distances to some faces, which bound what follows.  @param faces  at least one; -1 is left out
  void start(Packet& packet, const int* faces, int count);
  /// Nearest faces of some packets that are near each other.  @pre each was started
  /// @param neighbours  of the surface: searches what may touch `cluster` alone; null: all of it
  void search(Packet* packets, int count, const OwnNeighbourhood* neighbours = nullptr, int cluster = -1);
  /// Bound on what rounding adds to a height over a plane [m].
  double slack() const { return slack_; }
  long tested() const { return tested_; }

 private:
  void collect(const Packet* packets, int count, const OwnNeighbourhood* neighbours, int own);
  void prepare(int cluster);

  const Surface& surface_;
  const SearchKernels& kernels_;
  Vec3 origin_ = Vec3::Zero();
  double slack_ = 0.0;
  std::vector<float> planes_;
  std::vector<int> prepared_;  ///< query in which a cluster's planes were made
  int query_ = 0;
  Targets targets_;
  std::vector<int> clusters_;  ///< that may hold a nearest point
  std::vector<float> boxes_;
  long tested_ = 0;
};

}  // namespace palpate::distance
