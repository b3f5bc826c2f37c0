#pragma once
#include <vector>

#include "distance/own_neighbourhood.h"
#include "distance/search_kernels.h"
#include "distance/surface.h"

namespace palpate::distance {

/// Nearest-point search on a surface for packets of sixteen points, in single precision relative to an origin
/// near the points.
///
/// The face found contains the nearest point up to rounding, about 1e-7 of the distance from the origin;
/// Surface::nearest_around() then computes the point in double precision. Initial bounds on the search do not
/// change the result, bitwise: see SearchKernels::search.
class LaneSearch {
 public:
  /// Unbounded search: a distance whose square is finite in single precision [m].
  static constexpr double kAnywhere = 1e15;
  /// @param surface  must outlive the search
  explicit LaneSearch(const Surface& surface);

  /// Starts the queries of the current state of the surface.
  /// @param origin  origin of the single-precision coordinates [m]  @param box  box around all query points
  ///   [m]
  void begin(const Vec3& origin, const Eigen::AlignedBox3d& box);
  /// Completes a packet whose lanes 0 to used - 1 were set: repeats the last point in the other lanes and
  /// clears the nearest faces.
  /// @param within  largest distance of faces to be found [m]
  void finish(Packet& packet, int used, double within = kAnywhere) const;
  /// Sets the point of one lane [m, world frame].
  void set_point(Packet& packet, int lane, const Vec3& x) const;
  /// Tests some candidate faces, which bounds the search that follows.
  /// @param faces  candidates; -1 is skipped
  void start(Packet& packet, const int* faces, int count);
  /// Finds the nearest faces for packets of points that are close to each other. @pre start() was called for
  /// each packet
  /// @param neighbours  excludes the neighbours of `cluster` (self-contact); null: the whole surface is
  ///   searched
  void search(Packet* packets, int count, const OwnNeighbourhood* neighbours = nullptr, int cluster = -1);
  /// Returns an upper bound on the rounding error of a height above a plane [m].
  double slack() const { return slack_; }
  long tested() const { return tested_; }  ///< Returns the number of triangles tested since begin().

 private:
  void collect(const Packet* packets, int count, const OwnNeighbourhood* neighbours, int own);
  void prepare(int cluster);

  const Surface& surface_;
  const SearchKernels& kernels_;
  Vec3 origin_ = Vec3::Zero();
  double slack_ = 0.0;
  std::vector<float> planes_;  ///< Triangle planes per cluster, see SearchKernels::planes.
  std::vector<int> prepared_;  ///< Query in which each cluster's planes were computed.
  int query_ = 0;
  Targets targets_;
  std::vector<int> clusters_;  ///< Clusters that may contain a nearest point.
  std::vector<float> boxes_;   ///< Their boxes, see Targets::boxes.
  long tested_ = 0;
};

}  // namespace palpate::distance
