#pragma once
#include <vector>

#include "palpate/contact/query_view.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// A convex proxy in contact.
struct ProxyShape {
  TriMesh surface;   ///< of its hull, not inflated; world [m]
  bool of_a = true;  ///< of the side that normals point to, else of the other
};

/// Contact at one query, on the surfaces that pictures show.
struct ContactInstant {
  double force_n = 0.0;  ///< sum of pressure times area over all samples
  /// One a body: how deep each vertex of its surface (Body::surface_points) lies in what it touches [m]; NaN
  /// where it is outside.  In an image it is read between the four pixels around, as Galoppo et al. (2007)
  /// do; else it is the samples' own.
  std::vector<VecX> depths;
  std::vector<ProxyShape> proxies;           ///< in regions where something presses; each pair's own
  std::vector<contact::RegionView> regions;  ///< of images
};

/// What the last query saw, at the World's state, which is that of the query inside Observer::queried.
/// @pre the contact keeps views (contact::ContactForce::keep_views) since before that query
ContactInstant contact_instant(const World& world);

/// The deepest penetration that a region shows [m]; 0 where nothing presses.
double deepest(const contact::RegionView& region);

}  // namespace palpate::loop
