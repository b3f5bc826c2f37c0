#pragma once
#include "palpate/proxy/decompose.h"
#include "palpate/proxy/proxy_set.h"

namespace palpate::proxy {

struct SolidOptions {
  int count = 24;        ///< hulls at most
  int max_corners = 32;  ///< of a hull, at least 4
  /// a piece is cut on while its hull stands off its surface by more than this, of the solid's size
  double tolerance = 0.02;
};

/// Cuts what a closed surface bounds into convex proxies by planes: the piece whose hull stands off the
/// surface most is cut in two until none does by more than the tolerance.  A convex surface stays one hull, a
/// torus becomes a ring of segments, a fork prongs and a handle.
///
/// The hulls, inflated as ProxySet does, cover the solid, inside and surface: a point of another body that is
/// inside lies in one of them.  Every face has its three vertices among the members of one proxy.  The same
/// surface gives the same hulls, to the last bit.
/// @param surface  closed, outwards (mesh::check_surface); parts may overlap
/// @throws Error for an empty surface or options out of range
std::vector<ProxyHull> decompose_solid(const TriMesh& surface, const SolidOptions& options = {},
                                       DecomposeReport* report = nullptr);

/// The proxies of a rigid body by its surface alone.
ProxySet rigid_proxies(const TriMesh& surface, const SolidOptions& options = {});

}  // namespace palpate::proxy
