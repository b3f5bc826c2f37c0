#pragma once
#include <cstdint>

/// SIMD loops over vertices, triangles and packets of points, as plain functions on plain data. They are
/// implemented in search_lanes.cpp, which is compiled once per instruction set, with sixteen lanes in each.
namespace palpate::distance {

/// Points per packet.
inline constexpr int kLanes = 16;
/// Rows of the plane data of a cluster, each with one value for each of its 32 triangles: unit normal and
/// offset; outward unit normal in the plane and offset of the edges opposite to corners 0, 1, 2; corners 0,
/// 1, 2; inverse squared lengths of the edges.
inline constexpr int kPlaneRows = 28;
inline constexpr int kPlaneFloats = 32 * kPlaneRows;

/// Sixteen query points and the nearest face found so far for each.
struct alignas(64) Packet {
  float x[3][kLanes];  ///< Coordinates relative to the query's origin [m]; unused lanes repeat a used one.
  float distance2[kLanes];    ///< Squared distance to the nearest face [m^2].
  std::int32_t face[kLanes];  ///< Nearest face; -1: none.
  /// Signed height above the plane of that face if the foot lies inside the face, else 0 [m].
  float height[kLanes];
};

/// Faces and clusters of the other skin among which a packet's nearest faces are searched.
struct Targets {
  /// Plane data of all clusters, kPlaneFloats each; valid for the clusters below.
  const float* planes = nullptr;
  const int* faces = nullptr;  ///< Single faces, tested first.
  int face_count = 0;
  const int* clusters = nullptr;  ///< Clusters, searched after the faces.
  /// Boxes of these clusters, low x y z and high x y z: six rows of `box_stride` values.
  const float* boxes = nullptr;
  int cluster_count = 0, box_stride = 0;  ///< Rows are padded to a multiple of sixteen.
  float slack2 = 0.0f;                    ///< Square of the rounding error of a distance [m^2].
};

/// Kernels for one instruction set.
struct SearchKernels {
  /// Evaluates vertices from nodes.
  /// @param nodes  four numbers per node  @param carriers,  weights four nodes and weights per vertex
  /// @param list  indices of the vertices to be evaluated, `count` entries
  /// @param out  positions of all vertices, four numbers per vertex
  void (*evaluate)(const double* nodes, const int* carriers, const double* weights, const int* list,
                   int count, double* out);
  /// Copies positions or velocities of three numbers per point to `out`, with four numbers per point, the
  /// fourth of them 0. @param before  as `out`, at an earlier time  @param sum, moved  sums of out and of
  /// out - before, four numbers each
  void (*take)(const double* points, int count, const double* before, double* out, double* sum,
               double* moved);
  /// Returns the largest |now - before - about|^2 of points of four numbers each; a NaN is skipped.
  /// @param before  null: all 0  @param about  four numbers, the fourth of them 0
  /// @param low, high  corners of the bounding box of `now`, four numbers each, which are extended
  double (*compare)(const double* now, const double* before, int count, const double* about, double* low,
                    double* high);
  /// Computes the bounding box of the listed vertices: low and high corner, four numbers each.
  void (*bound)(const double* vertices, const int* list, int count, double* low, double* high);
  /// Computes the plane data of up to 32 triangles, relative to `origin`. @param corners  three vertices per
  /// triangle
  void (*planes)(const double* vertices, const int* corners, int count, const double* origin, float* out);
  /// Updates a packet with the nearest faces among the targets. At equal distance the face with the lower
  /// index is taken, so that the result does not depend on the search order. @return number of tested
  /// triangles
  long (*search)(Packet& packet, const Targets& targets);
};

/// Returns the kernels for the best instruction set that this CPU supports.
const SearchKernels& best_search_kernels();

}  // namespace palpate::distance
