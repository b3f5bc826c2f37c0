#pragma once
#include "proxy/decompose.h"
#include "proxy/proxy_set.h"

namespace palpate::proxy {

/// Options of `decompose_solid`.
struct SolidOptions {
  int count = 24;        ///< largest number of hulls
  int max_corners = 32;  ///< corners per hull, at least 4
  /// A piece is cut again while its hull's surface is farther than this from its skin [solid sizes].
  double tolerance = 0.02;
};

/// Cuts the solid that a closed surface bounds into convex proxies by planes.  The piece with the largest
/// hollow volume between its hull and its surface is cut in two, until no hull is farther from its surface
/// than the tolerance.  A convex surface stays one hull, a torus becomes a ring of segments, a fork becomes
/// prongs and a handle.
///
/// The hulls, inflated as ProxySet does, cover the solid, inside and surface: a point of another body that is
/// inside the solid lies in at least one of them.  Every face has its three vertices among the members of one
/// proxy.  The result is deterministic: the same surface gives bitwise the same hulls.
/// @param surface  closed, faces outward (mesh::check_surface); parts may overlap
/// @param report   receives the quality of the hulls unless null
/// @throws Error for an empty surface or options out of range
std::vector<ProxyHull> decompose_solid(const TriMesh& surface, const SolidOptions& options = {},
                                       DecomposeReport* report = nullptr);

/// Builds the proxies of a rigid body from its surface.
ProxySet rigid_proxies(const TriMesh& surface, const SolidOptions& options = {});

}  // namespace palpate::proxy
