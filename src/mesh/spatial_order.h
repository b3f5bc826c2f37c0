#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

/// Spatial reordering: points that are close in space become close in memory.
///
/// A mesher numbers nodes in the order of their creation: Gmsh the surfaces first, then the interior.
/// Elements that are computed together then touch nodes and matrix rows scattered over memory, one page and
/// one cache line each, most of it unused.  Recursive bisection across the longest side of the bounding box
/// improves locality: a compact set of n points occupies at most as many runs of consecutive numbers as it
/// has surface points, about n^(2/3); in a mesher's order it occupies nearly n runs.
namespace palpate::mesh {

/// Partitions order[begin, end), indices into `points`, at `middle` by a plane across the longest side of
/// their bounding box.  Ties in the plane are broken by index, so the sets do not depend on the initial
/// order.
void cut_across_longest(const Points& points, std::vector<int>& order, int begin, int end, int middle);

/// Reorders order[begin, end) by recursive bisection; leaves of at most 8 points are sorted by index.
void spatial_order(const Points& points, std::vector<int>& order, int begin, int end);
/// Returns the spatial order of all points.
std::vector<int> spatial_order(const Points& points);

/// Renumbers nodes: node k becomes the former node order[k]; elements keep their order and their corners.
/// @pre order holds each node once
void renumber_nodes(TetMesh& mesh, const std::vector<int>& order);

}  // namespace palpate::mesh
