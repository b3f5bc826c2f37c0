#pragma once
#include <cstdint>

/// Loops over vertices, triangles and packets of points as plain functions on plain data: search_lanes.cpp,
/// compiled for each instruction set, with sixteen lanes in all of them.
namespace palpate::distance {

inline constexpr int kLanes = 16;
/// Rows of the planes of a cluster, each of 32 triangles: unit normal and offset; outward unit normal in the
/// plane and offset of the edges opposite to corners 0, 1, 2; corners 0, 1, 2; 1 over the edges' squared
/// lengths.
inline constexpr int kPlaneRows = 28;
inline constexpr int kPlaneFloats = 32 * kPlaneRows;

/// Sixteen points and what is nearest to each so far.
struct alignas(64) Packet {
  float x[3][kLanes];         ///< about the query's origin [m]; unused lanes repeat a used one
  float distance2[kLanes];    ///< [m^2]
  std::int32_t face[kLanes];  ///< -1: none
  float height[kLanes];       ///< above the plane of that face where the foot lies inside of it, else 0 [m]
};

/// The faces and clusters of the other skin that a packet of points is searched in.
struct Targets {
  const float* planes = nullptr;  ///< of all clusters, kPlaneFloats each; those below are up to date
  const int* faces = nullptr;     ///< single faces to begin with
  int face_count = 0;
  const int* clusters = nullptr;          ///< then those triangles of clusters that can be nearer
  const float* boxes = nullptr;           ///< low x y z, high x y z of each of them: six rows of `box_stride`
  int cluster_count = 0, box_stride = 0;  ///< rows are padded to a multiple of sixteen
  float slack2 = 0.0f;                    ///< square of the error of a distance by rounding [m^2]
};

struct SearchKernels {
  /// Some vertices from nodes.  @param nodes  four numbers each  @param carriers, weights  four a vertex
  /// @param list  their numbers  @param out  of all vertices, four numbers each
  void (*evaluate)(const double* nodes, const int* carriers, const double* weights, const int* list,
                   int count, double* out);
  /// Box of some vertices: low and high, four numbers each.
  void (*bound)(const double* vertices, const int* list, int count, double* low, double* high);
  /// Planes of up to 32 triangles, about `origin`.  @param corners  three vertices a triangle
  void (*planes)(const double* vertices, const int* corners, int count, const double* origin, float* out);
  /// Updates a packet by what is nearest among the targets.  Of equal distances the lower face wins, so that
  /// the result does not depend on the order.  @return number of triangles that were tested
  long (*search)(Packet& packet, const Targets& targets);
};

const SearchKernels& best_search_kernels();

}  // namespace palpate::distance
