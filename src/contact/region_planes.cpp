// Which normal an overlap is seen along.
//
// One plane.  Seen along n, an overlap with the gap w_a - w_b = -d has the energy (k/2) int d^2 dA, and its
// force is k int d dA = k V along n.  Moved by t across n, the energy changes by -k t . int d grad w_a dA,
// for d is zero on the overlap's boundary and int d grad d dA = 0 (so grad w_b may stand there as well): a
// force across n that the sample does not have, unless int d grad w dA = 0.  That is so where n is the
// direction of
//     P = int d dS,         dS = (-grad w, 1) dA the area vector of the skin,
// the resultant of a pressure d normal to the skin.  So n = P / |P|: depth counts, as in the force.  A skin
// that only just begins to touch turns no normal, were it ever so large.
//
// What it leaves of a moment.  A ball of radius R without friction feels none about its centre c.  Here it
// feels, with x - c = R n_a and its own normal n_a = (n_a . n) (-grad w_a, 1),
//     M = k int d (x - c) x n dA = -k R (int d (n_a . n) grad w_a dA) x n,
// which is zero but for the factor n_a . n = (1 + |grad w_a|^2)^(-1/2): a term of third order in the slopes,
// where the depth is skew about the axis of the patch.  On touch-head that is an arm of 0.1 mm (R = 12 mm).
//
// Several.  A part of a's skin, its proxy i, has P_i and V_i of its own.  All parts along one normal give the
// volume of the overlap exactly (a height field), each along its own the forces of surfaces that push
// different ways (two walls of a corner).  Either is right where the other is wrong, and a force that changes
// from one to the other at some angle jumps: two equal parts at an angle alpha push with 2 k V along one
// normal, with 2 k V cos(alpha/2) along two.  Here the normal of a part is that of all that pushes about as
// it does,
//     n_i = P'_i / |P'_i|,    P'_i = sum_j l_ij w(cos a_ij) P_j,    a_ij the angle between P_i and P_j,
// w = 1 up to 60 degrees, 0 beyond 90, and C1 between.  Parts within 60 degrees of each other are one plane,
// the walls of a right corner are strangers.
//
// What is linked.  Two contacts in different places share no normal.  Parts touch where their skin does on
// both bodies: c_ij = sum V_ip V_jq / (V_i V_j) over the proxies p, q of b that i and j overlap and that
// touch, if i and j do, is between 0 and 1.  A touch is as strong as s_ij = c_ij min(V_i, V_j), and a link as
// the weakest touch of its strongest path, S_ij, a max-min over paths (Kruskal's forest, the strongest
// first). l_ij rises smoothly from 0 to 1 as S_ij goes to a quarter of min(V_i, V_j).  A part that comes
// between two others joins them no faster than it grows.
//
// The bound.  The force is k sum V_i n_i.  V_i and P_i are continuous in the pose, and so are products, max
// and min, l and w, and with them n_i wherever V_i > 0: P'_i . P_i >= |P_i|^2, for no term of the sum is more
// than 90 degrees from P_i.  Hence V_i |dn_i| <= V_i |dP'_i| / |P'_i|, with |P'_i| >= |P_i| >= V_i, so
//     |dF| <= k sum_i |dV_i| + k sum_ij (l w |dP_j| + r_ij |P_j| |d(l w)|),    r_ij = V_i / |P'_i| <= 1:
// no jump.  Appearing, a part has V_i = 0, and P_i = 0 in the sums of the others.  Merging and splitting are
// changes of l w.  A small part i beside a large one j turns fast, but with small force: near its onset
// |dw| <= c sqrt(w) da, so r_ij |P_j| |dw| <= c/2 sqrt(|P_i| |P_j|) da.  A second step of the same mean, from
// n_i (mean shift), would multiply |P_j| / |P_i| once more, and is not taken.  What remains is the width
// phi within which normals count as one (RegionParts::kOnePlane: the forces' sum keeps its direction and
// loses phi^2 / 8 of its size, 3e-4), what looks leave (pruned_region.cpp), what the pixels err, and a change
// of the volume itself where a line along n meets other skin, k |dV|.
#include "contact/region_planes.h"

#include <algorithm>
#include <tuple>

namespace palpate::contact {
namespace {

constexpr double kWhole = 0.5;    // cosine of the angle within which parts are one plane
constexpr double kStrong = 0.25;  // strength of a whole link, over the smaller volume

}  // namespace

void RegionPlanes::begin(std::span<const PairOverlap> overlaps) {
  units_.clear();
  unit_.clear();
  for (const PairOverlap& pair : overlaps) {
    if (units_.empty() || units_.back().proxy != pair.a) units_.push_back({.proxy = pair.a});
    unit_.push_back(units_.size() - 1);
    units_.back().push += pair.push;
    units_.back().volume += pair.volume;
  }
  touch_.assign(units_.size() * units_.size(), 0.0);
}

std::size_t RegionPlanes::root(std::size_t i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void RegionPlanes::find_links() {
  const std::size_t n = units_.size();
  edges_.clear();
  links_.assign(n * n, 0.0);
  parent_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    parent_[i] = i;
    links_[i * n + i] = 1.0;
    for (std::size_t j = 0; j < i; ++j)
      if (const double touch = touch_[i * n + j]; touch > 0.0)
        edges_.push_back({touch / std::max(units_[i].volume, units_[j].volume), i, j});
  }
  std::sort(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) {
    return std::tuple(-x.strength, x.i, x.j) < std::tuple(-y.strength, y.i, y.j);
  });
  for (const Edge& edge : edges_) {
    const std::size_t from = root(edge.i), to = root(edge.j);
    if (from == to) continue;
    for (std::size_t x = 0; x < n; ++x)
      for (std::size_t y = 0; y < n; ++y)
        if (root(x) == from && root(y) == to)
          links_[x * n + y] = links_[y * n + x] =
              smooth_step(edge.strength / (kStrong * std::min(units_[x].volume, units_[y].volume)));
    parent_[from] = to;
  }
}

void RegionPlanes::blend() {
  const std::size_t n = units_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 own = units_[i].push.normalized();
    Vec3 sum = Vec3::Zero();
    for (std::size_t j = 0; j < n; ++j)
      if (const double link = links_[i * n + j]; link > 0.0)
        sum +=
            link * smooth_step(own.dot(units_[j].push) / (kWhole * units_[j].push.norm())) * units_[j].push;
    units_[i].normal = sum.normalized();
  }
}

}  // namespace palpate::contact
