#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

/// Orders in which what lies near in space lies near in memory.
///
/// A file numbers its nodes as its mesher met them: Gmsh the surfaces first, then the inside as it was
/// filled.  Elements that are computed together then touch nodes, and rows of a matrix, all over the memory:
/// a page and a line of the cache each, hardly used.  Cut the points in two across the longest side of the
/// box around them, then each half, until a few are left: a compact set of n points then lies in as many runs
/// as its surface has points, some n^(2/3), at most; in a mesher's order in nearly n.
namespace palpate::mesh {

/// Rearranges order[begin, end), numbers of `points`, so that those before `middle` lie on one side of a
/// plane across the longest side of the box around them, those from it on the other.
/// Points in the plane go by number: the same points are cut the same way, whatever their order was.
void cut_across_longest(const Points& points, std::vector<int>& order, int begin, int end, int middle);

/// Puts order[begin, end) in such an order; the last few points of a part keep that of their numbers.
void order_by_place(const Points& points, std::vector<int>& order, int begin, int end);
/// All points.
std::vector<int> order_by_place(const Points& points);

/// Node k becomes what node order[k] was; elements keep their order and their corners.  @pre order holds each
/// node once
void renumber_nodes(TetMesh& mesh, const std::vector<int>& order);

}  // namespace palpate::mesh
