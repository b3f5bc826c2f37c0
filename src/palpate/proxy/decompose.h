#pragma once
#include <vector>

#include "palpate/mesh/layered_model.h"

namespace palpate::proxy {

struct DecomposeOptions {
  int count = 60;        ///< hulls wanted; with a skeleton at least one for each bone that has skin
  int max_corners = 32;  ///< of a hull, at least 4
  /// how much clusters keep apart what faces apart:
  /// opposite normals count as this many cluster sizes; 0: position alone
  double normal_weight = 0.5;
  /// a hull takes no more corners when its points lie outside by less than this, of the skin's size
  double tolerance = 1e-4;
};

/// How well one hull stands for its skin, at rest.
struct HullQuality {
  double volume = 0.0;   ///< [m^3]
  double outside = 0.0;  ///< convexity: largest distance of a member outside the hull [m]
  /// tightness: how far the hull's surface stands off its members, along their normals; by area [m]
  double mean_gap = 0.0;
  double largest_gap = 0.0;  ///< [m]
};

struct DecomposeReport {
  std::vector<HullQuality> hulls;
  double skin_size = 0.0;    ///< diagonal of the skin's box [m]
  double skin_volume = 0.0;  ///< [m^3]
  double hull_volume = 0.0;  ///< sum over the hulls; neighbours overlap, so more than skin_volume [m^3]
  double largest_outside = 0.0, largest_gap = 0.0;  ///< over all hulls [m]
};

/// Cuts a body into convex proxies (docs/design.md, 4.2): clusters of skin by bone, then by position and
/// normal (k-means); each cluster with the tetrahedra behind it; and of each the hull of at most
/// `max_corners` of its points, taken one by one where the hull so far is missed by most.
///
/// Every face of the skin has its three vertices among the members of one proxy, and every tetrahedron
/// belongs to one whose hull was made for its nodes too:
/// the hulls, inflated as ProxySet does, cover skin and inside without a gap.  The same model gives the same
/// hulls, to the last bit.
/// @param model  skin; tets and embedding unless both are empty (then only the skin is covered); skeleton
///   where there is one
/// @throws Error for an empty skin or options out of range
std::vector<ProxyHull> decompose(const LayeredModel& model, const DecomposeOptions& options = {},
                                 DecomposeReport* report = nullptr);

}  // namespace palpate::proxy
