#pragma once
#include <vector>

#include "mesh/layered_model.h"
#include "proxy/hull_quality.h"

namespace palpate::proxy {

/// Options of `decompose`.
struct DecomposeOptions {
  int count = 60;        ///< target number of hulls; with a skeleton at least one per bone that has skin
  int max_corners = 32;  ///< corners per hull, at least 4
  /// Weight of the normals in the clustering, which separates surfaces that face apart: opposite normals
  /// count as this many cluster sizes; 0 clusters by position alone.
  double normal_weight = 0.5;
  /// A hull takes no more corners once its points lie outside by less than this [skin sizes].
  double tolerance = 1e-4;
};

/// Decomposes one body into convex proxies (docs/theory/proxies.md).  The skin is clustered by bone, then by
/// position and normal (k-means).  Each cluster takes the tetrahedra behind it, and its hull is spanned by at
/// most `max_corners` of its points, added greedily: the point farthest outside the current hull is next.
///
/// Every face of the skin has its three vertices among the members of one proxy, and every tetrahedron is
/// owned by one proxy, whose hull includes its nodes.  The hulls, inflated as ProxySet does, therefore cover
/// skin and inside without a gap.  The result is deterministic: the same model gives bitwise the same hulls.
/// @param model  skin; tets and embedding unless both are empty (then only the skin is covered); skeleton if
///   there is one
/// @param report  receives the quality of the hulls unless null
/// @returns one hull per cluster
/// @throws Error for an empty skin or options out of range
std::vector<ProxyHull> decompose(const LayeredModel& model, const DecomposeOptions& options = {},
                                 DecomposeReport* report = nullptr);

}  // namespace palpate::proxy
