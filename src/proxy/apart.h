#pragma once
#include "palpate/proxy/proxy_set.h"

namespace palpate::proxy {

/// Proofs that inflated hulls are apart and stay out of reach.  A proof is a direction u with
/// u.x > u.y + inexact + reach.along(u) for every x of one hull and y of the other: two support calls check
/// it, so a hull is left out for a reason that cannot be wrong.  Where none is found in a few steps the
/// answer is false, "may touch".
///
/// The search (Frank and Wolfe 1956, Gilbert 1966) is that for the distance of the swept hull of a, which
/// holds x and x + drift for every x: v, a difference of points of the two hulls, is both the direction to
/// try and, at last, the shortest; from it toward the farthest difference s along -v as far as |v| falls.  It
/// stops when |v| is within the margin: then they do touch.

/// Hull p of a against hull q of b.  @param inexact  the sum of their inflations  @param reach  of a against
/// b
/// @param direction  unit; in: the one to try first, zero for none; out: the one that proved it, or that the
/// search ended with
bool apart(const ProxySet& a, int p, const ProxySet& b, int q, double inexact, const Reach& reach,
           Vec3& direction, bool& by_memory);

}  // namespace palpate::proxy
