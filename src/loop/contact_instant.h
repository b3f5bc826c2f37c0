#pragma once
#include <vector>

#include "palpate/contact/query_view.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Convex proxy in a contact.
struct ProxyShape {
  TriMesh surface;   ///< Surface of the hull, not inflated; world [m].
  bool of_a = true;  ///< Whether it belongs to the side that normals point to.
};

/// Contact state at one query, on the surfaces that pictures show.
struct ContactInstant {
  double force_n = 0.0;  ///< Sum of pressure times area over all samples.
  /// Per body: penetration depth of each vertex of its surface (Body::surface_points) [m]; NaN outside. With
  /// images it is interpolated between the four surrounding pixels, as in Galoppo et al. (2007); otherwise it
  /// is the depth of the contact samples.
  std::vector<VecX> depths;
  std::vector<ProxyShape> proxies;           ///< In regions with pressure, one set per contact pair.
  std::vector<contact::RegionView> regions;  ///< Image regions.
};

/// Returns the contact of the last query at the World's state, which is the query's state inside
/// Observer::queried.
/// @pre contact::ContactForce::keep_views was enabled before that query
ContactInstant contact_instant(const World& world);

/// Returns the deepest penetration in a region [m]; 0 without pressure.
double deepest(const contact::RegionView& region);

}  // namespace palpate::loop
