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
// Several.  The overlap of a's proxy with one of b's, the pair i, has P_i and V_i of its own.  All along one
// normal give the volume of the overlap exactly (a height field), each along its own the forces of surfaces
// that push different ways (two walls of a corner, both flanks of a tooth).  Either is right where the other
// is wrong, and a force that changes from one to the other at some angle jumps: two equal parts at an angle
// alpha push with 2 k V along one normal, with 2 k V cos(alpha/2) along two.  Here the normal of a pair is
// that of all that pushes about as it does,
//     n_i = P'_i / |P'_i|,    P'_i = sum_j l_ij w(cos a_ij) P_j,    a_ij the angle between P_i and P_j,
// w = 1 up to 60 degrees, 0 beyond 90, and C1 between.  Pairs within 60 degrees of each other are one plane,
// the walls of a right corner are strangers.
//
// What is linked.  Two contacts in different places share no normal.  Pairs touch where the skins of their
// proxies do, on both bodies.  A touch is as strong as the smaller overlap, and a link as the weakest touch
// of its strongest path, S_ij, a max-min over paths (Kruskal's forest, the strongest first).  l_ij rises
// smoothly from 0 to 1 as S_ij goes to a quarter of min(V_i, V_j): pairs that touch are linked, and one that
// comes between two others joins them no faster than it grows.
//
// The bound.  The force is k sum V_i n_i.  V_i and P_i are continuous in the pose, and so are products, max
// and min, l and w, and with them n_i wherever V_i > 0: P'_i . P_i >= |P_i|^2, for no term of the sum is more
// than 90 degrees from P_i.  Hence V_i |dn_i| <= V_i |dP'_i| / |P'_i|, with |P'_i| >= |P_i| >= V_i, so
//     |dF| <= k sum_i |dV_i| + k sum_ij (l w |dP_j| + r_ij |P_j| |d(l w)|),    r_ij = V_i / |P'_i| <= 1:
// no jump.  Appearing, a pair has V_i = 0, and P_i = 0 in the sums of the others.  Merging and splitting are
// changes of l w.  A small pair i beside a large one j turns fast, but with small force: near its onset
// |dw| <= c sqrt(w) da, so r_ij |P_j| |dw| <= c/2 sqrt(|P_i| |P_j|) da.  A second step of the same mean, from
// n_i (mean shift), would multiply |P_j| / |P_i| once more, and is not taken.  What remains is the width
// phi within which normals count as one (RegionParts::kOnePlane: the forces' sum keeps its direction and
// loses phi^2 / 8 of its size, 3e-4), what looks leave (pruned_source.cpp), what the pixels err, and a change
// of the volume itself where a line along n meets other skin, k |dV|.
#include "contact/region_planes.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace palpate::contact {
namespace {

constexpr double kWhole = 0.5;    // cosine of the angle within which parts are one plane
constexpr double kStrong = 0.25;  // strength of a whole link, over the smaller volume

}  // namespace

void RegionPlanes::find_links() {
  const std::size_t n = overlaps_.size();
  links_.assign(n * n, 0.0);
  tree_.resize(n);
  next_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    links_[i * n + i] = 1.0;
    tree_[i] = next_[i] = i;
  }
  std::sort(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) {
    return std::tuple(-x.strength, x.i, x.j) < std::tuple(-y.strength, y.i, y.j);
  });
  for (const Edge& edge : edges_)
    if (tree_[edge.i] != tree_[edge.j]) join(edge.i, edge.j, edge.strength);
}

/// Links all of one's tree with all of the other's, and makes one tree of both.
void RegionPlanes::join(std::size_t one, std::size_t other, double strength) {
  const std::size_t n = overlaps_.size();
  std::size_t x = one;
  do {
    std::size_t y = other;
    do {
      links_[x * n + y] = links_[y * n + x] =
          smooth_step(strength / (kStrong * std::min(overlaps_[x].volume, overlaps_[y].volume)));
      y = next_[y];
    } while (y != other);
    x = next_[x];
  } while (x != one);
  do {
    tree_[x] = tree_[other];
    x = next_[x];
  } while (x != one);
  std::swap(next_[one], next_[other]);
}

void RegionPlanes::blend() {
  const std::size_t n = overlaps_.size();
  normals_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 own = overlaps_[i].push.normalized();
    Vec3 sum = Vec3::Zero();
    for (std::size_t j = 0; j < n; ++j)
      if (const double link = links_[i * n + j]; link > 0.0)
        sum += link * smooth_step(own.dot(overlaps_[j].push) / (kWhole * overlaps_[j].push.norm())) *
               overlaps_[j].push;
    normals_[i] = sum.normalized();
  }
}

}  // namespace palpate::contact
