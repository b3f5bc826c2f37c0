#pragma once
#include "proxy/proxy_set.h"

namespace palpate::proxy {

/// Proofs that inflated hulls are apart and stay out of reach.  A proof is a direction u with u.x > u.y +
/// inexact + reach.along(u) for every x of one hull and y of the other.  Two support calls check it, so an
/// exclusion is exact up to rounding.  If no proof is found in a few steps, the result is false: the hulls
/// may touch.
///
/// The search (Frank and Wolfe 1956, Gilbert 1966) is the distance algorithm for the swept hull of a, which
/// contains x and x + drift for every x.  The iterate v, a difference of points of the two hulls, is the
/// direction to try.  It moves toward the farthest difference s along -v as long as |v| falls, and converges
/// to the shortest difference.  The search stops when |v| is within the margin: then the hulls touch.

/// Tests hull p of a against hull q of b.
/// @param inexact    sum of their inflations [m]
/// @param reach      of a relative to b
/// @param direction  unit; in: the direction to try first, zero for none; out: the proof, or the last
///   direction of the search
/// @param by_memory  out: whether the given direction was the proof
/// @returns true if the hulls are proven apart
bool apart(const ProxySet& a, int p, const ProxySet& b, int q, double inexact, const Reach& reach,
           Vec3& direction, bool& by_memory);

}  // namespace palpate::proxy
