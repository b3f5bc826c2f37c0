#include "distance/surface.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "distance/search_kernels.h"

namespace palpate::distance {
namespace {

/// Returns an upper bound on the squared distance that may be computed for a box containing a triangle for
/// which nearest_on_triangle() found `distance2`. A foot is a convex combination of corners, so it lies in
/// the box up to rounding: a few units in the last place of the coordinates and of the sum of squares.
/// Sixteen units bound both.
constexpr double kUnit = std::numeric_limits<double>::epsilon();
double with_rounding(double distance2, double largest_coordinate) {
  const double slack = 16.0 * kUnit * largest_coordinate;
  return distance2 + 2.0 * slack * std::sqrt(distance2) + slack * slack + 16.0 * kUnit * distance2;
}

bool is_before(double distance2, int face, const Foot& foot) {
  return distance2 < foot.at.distance2 || (distance2 == foot.at.distance2 && face < foot.face);
}

}  // namespace

// The foot lies inside where all three barycentric coordinates of the projection are positive. Otherwise it
// lies on an edge with the projection on its outer side: if the foot is an interior point of an edge, the
// projection lies along that edge's outward normal; if it is a corner, p - y = s m + t n with the outward
// normals m, n of its edges and s, t >= 0, and one of (p - y) . m and (p - y) . n is positive unless m = -n.
TrianglePoint nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 corners[3] = {a, b, c};
  const Vec3 edge[3] = {c - b, a - c, b - a};  // Edge opposite to each corner.
  const Vec3 normal = edge[2].cross(-edge[1]);
  const double size2 = normal.squaredNorm();
  TrianglePoint out;
  double inside[3];
  for (int k = 0; k < 3; ++k) inside[k] = normal.dot(edge[k].cross(x - corners[(k + 1) % 3]));
  if (size2 > 0.0 && inside[0] > 0.0 && inside[1] > 0.0 && inside[2] > 0.0) {
    const double sum = inside[0] + inside[1] + inside[2];
    out.weights = Vec3(inside[0], inside[1], inside[2]) / sum;
    // Measured from the foot rather than along the normal: the foot lies in the triangle, however thin the
    // triangle is.
    out.away = x - a - (out.weights[1] * edge[2] - out.weights[2] * edge[1]);
    out.distance2 = out.away.squaredNorm();
    return out;
  }
  out.distance2 = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (inside[k] > 0.0 && size2 > 0.0) continue;
    const int from = (k + 1) % 3, to = (k + 2) % 3;
    const Vec3 v = x - corners[from];
    const double length2 = edge[k].squaredNorm();
    const double t = length2 > 0.0 ? std::min(1.0, std::max(0.0, v.dot(edge[k]) / length2)) : 0.0;
    const Vec3 away = t == 1.0 ? Vec3(x - corners[to]) : Vec3(v - t * edge[k]);
    const double distance2 = away.squaredNorm();
    if (!(distance2 < out.distance2)) continue;
    out.distance2 = distance2;
    out.away = away;
    out.weights.setZero();
    out.weights[from] = 1.0 - t;
    out.weights[to] = t;
  }
  return out;
}

Surface::Surface(const Skin& skin)
    : skin_(skin),
      nodes_(Padded::Zero(4, skin.node_count)),
      before_(nodes_),
      far_(Padded::Zero(4, skin.far_nodes.cols())),
      far_before_(far_),
      far_list_(static_cast<std::size_t>(far_.cols())),
      leaf_(static_cast<std::size_t>(skin.cluster_count())),
      placed_(leaf_.size(), 0),
      vertices_(Padded::Zero(4, skin.vertex_count())),
      boxes_(skin.tree.size()),
      since_(skin.tree.size()) {
  if (far_.cols() > 0) far_sum_ = skin.far_weights.cwiseAbs().colwise().sum().maxCoeff();
  std::iota(far_list_.begin(), far_list_.end(), 0);
  for (std::size_t i = 0; i < skin.tree.size(); ++i)
    if (!skin.tree[i].right) leaf_[static_cast<std::size_t>(skin.tree[i].begin)] = static_cast<int>(i);
}

void Surface::carry_far(const Padded& of_nodes, Padded& far) const {
  best_search_kernels().evaluate(of_nodes.data(), skin_.far_nodes.data(), skin_.far_weights.data(),
                                 far_list_.data(), static_cast<int>(far_list_.size()), far.data());
}

namespace {

constexpr double kRounding = 16.0 * kUnit;

double largest_coordinate(const Eigen::AlignedBox3d& box) {
  return std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
}

}  // namespace

/// Bounding boxes of the nodes and of the vertices evaluated explicitly: corners, padded to four numbers.
struct Surface::Extent {
  struct Box {
    Eigen::Vector4d low = Eigen::Vector4d::Constant(HUGE_VAL), high = Eigen::Vector4d::Constant(-HUGE_VAL);
    Eigen::AlignedBox3d box() const { return {low.head<3>(), high.head<3>()}; }
  };
  Box nodes, far;
};

// A vertex is at sum w x over its nodes, with sum w = 1 and W = sum |w|. Velocity and displacement follow the
// same formula: they differ from `about` by no more than W times the largest difference of a node. The few
// vertices with large W are evaluated explicitly: with x for the velocity, and with x - x_before, up to
// rounding, for the displacement.
double Surface::farthest(const Padded& nodes, const double* nodes_before, const Padded& far,
                         const double* far_before, const Vec3& about, Extent& extent) const {
  const SearchKernels& kernels = best_search_kernels();
  const Eigen::Vector4d middle(about[0], about[1], about[2], 0.0);
  const auto most2 = [&](const Padded& now, const double* before, Extent::Box& box) {
    return kernels.compare(now.data(), before, static_cast<int>(now.cols()), middle.data(), box.low.data(),
                           box.high.data());
  };
  const double of_nodes = skin_.weight_sum * skin_.weight_sum * most2(nodes, nodes_before, extent.nodes);
  return std::sqrt(far.cols() > 0 ? std::max(of_nodes, most2(far, far_before, extent.far)) : of_nodes);
}

double Surface::spread(const double* node_velocities, const Vec3& about) const {
  Eigen::Vector4d sum, moved;
  Extent extent;
  best_search_kernels().take(node_velocities, skin_.node_count, nodes_.data(), before_.data(), sum.data(),
                             moved.data());
  carry_far(before_, far_before_);
  const double out = farthest(before_, nullptr, far_before_, nullptr, about, extent);
  return sum.allFinite() && about.allFinite() ? out : std::numeric_limits<double>::infinity();
}

// If weights sum to 1, their negative entries sum to -(W - 1)/2: a vertex lies outside the nodes' box by no
// more than (W - 1)/2 times the box's edges.
void Surface::move(const double* nodes, Tree tree) {
  const bool is_first = state_++ == 0;
  nodes_.swap(before_);
  far_.swap(far_before_);
  Eigen::Vector4d sum, moved;
  best_search_kernels().take(nodes, skin_.node_count, before_.data(), nodes_.data(), sum.data(),
                             moved.data());
  carry_far(nodes_, far_);
  shift_ = moved.head<3>() / skin_.node_count;
  Extent extent;
  stretch_ = farthest(nodes_, before_.data(), far_, far_before_.data(), shift_, extent);
  bound_ = extent.nodes.box();
  const double size = largest_coordinate(bound_);
  const Vec3 outside = 0.5 * (skin_.weight_sum - 1.0) * bound_.sizes() + Vec3::Constant(kRounding * size);
  bound_ = {bound_.min() - outside, bound_.max() + outside};
  if (far_.cols() > 0) bound_.extend(extent.far.box());
  stretch_ += far_sum_ * kRounding * size;
  const bool is_known = !is_first && shift_.allFinite() && std::isfinite(stretch_);
  if (!sum.allFinite()) bound_ = {Vec3::Constant(-HUGE_VAL), Vec3::Constant(HUGE_VAL)};
  if (!is_known) {
    shift_.setZero();
    stretch_ = HUGE_VAL;
  } else {
    path_.way += shift_;
    path_.wider += stretch_ + kRounding * (size + path_.way.cwiseAbs().maxCoeff());
  }
  if (tree == Tree::kFit || !is_known) fit_tree(is_known);
}

// Between two fits the box of any node of the tree contains its vertices after displacement by the sum of
// the shifts, widened by the sum of the stretches: each move() displaces a vertex by shift() up to stretch().
void Surface::fit_tree(bool is_known) {
  for (std::size_t i = skin_.tree.size(); i-- > 0;) {
    const ClusterNode& node = skin_.tree[i];
    if (node.right)
      boxes_[i] = boxes_[i + 1].merged(boxes_[static_cast<std::size_t>(node.right)]);
    else if (is_known)
      boxes_[i] = box(static_cast<int>(i));
    else
      evaluate(node.begin);
  }
  path_ = {};
  std::fill(since_.begin(), since_.end(), path_);
}

void Surface::evaluate(int cluster) const {
  const auto c = static_cast<std::size_t>(cluster);
  placed_[c] = state_;
  const int begin = skin_.cluster_begin[c], count = skin_.cluster_begin[c + 1] - begin;
  const int* const list = skin_.cluster_vertices.data() + begin;
  const SearchKernels& kernels = best_search_kernels();
  double low[4], high[4];
  kernels.evaluate(nodes_.data(), skin_.nodes.data(), skin_.weights.data(), list, count, vertices_.data());
  kernels.bound(vertices_.data(), list, count, low, high);
  const auto leaf = static_cast<std::size_t>(leaf_[c]);
  boxes_[leaf] = {Eigen::Map<const Vec3>(low), Eigen::Map<const Vec3>(high)};
  since_[leaf] = path_;
}

Vec3 Surface::point(int face, const Vec3& weights) const {
  place(face / kClusterFaces);
  return weights[0] * corner(face, 0) + weights[1] * corner(face, 1) + weights[2] * corner(face, 2);
}

TrianglePoint Surface::nearest_on_face(int face, const Vec3& x) const {
  place(face / kClusterFaces);
  return nearest_on_triangle(corner(face, 0), corner(face, 1), corner(face, 2), x);
}

void Surface::search_cluster(int cluster, const Vec3& x, Foot& best) const {
  const int end = std::min(kClusterFaces * (cluster + 1), skin_.face_count());
  for (int f = kClusterFaces * cluster; f < end; ++f) {
    const TrianglePoint at = nearest_on_face(f, x);
    if (is_before(at.distance2, f, best)) best = {f, at};
  }
  count_.triangles += end - kClusterFaces * cluster;
}

Foot Surface::nearest(const Vec3& x, int start) const {
  Foot best;
  best.at.distance2 = std::numeric_limits<double>::infinity();
  if (start >= 0) best = {start, nearest_on_face(start, x)};
  ++count_.searches;
  const double size = std::max(bound_.min().cwiseAbs().maxCoeff(), bound_.max().cwiseAbs().maxCoeff()) +
                      x.cwiseAbs().maxCoeff();
  int open[64], depth = 0;  // Bisection halves the faces: 64 levels are never reached.
  open[depth++] = 0;
  while (depth > 0) {
    const int i = open[--depth];
    if (box(i).squaredExteriorDistance(x) > with_rounding(best.at.distance2, size)) continue;
    const ClusterNode& node = skin_.tree[static_cast<std::size_t>(i)];
    if (!node.right) {
      search_cluster(node.begin, x, best);
      continue;
    }
    const bool is_left_nearer =
        box(i + 1).squaredExteriorDistance(x) <= box(node.right).squaredExteriorDistance(x);
    open[depth++] = is_left_nearer ? node.right : i + 1;
    open[depth++] = is_left_nearer ? i + 1 : node.right;
  }
  return best;
}

Foot Surface::nearest_around(const Vec3& x, int face) const {
  Foot best{face, nearest_on_face(face, x)};
  for (int seen = -1; seen != best.face;) {  // Terminates because the pair (distance, face) decreases.
    seen = best.face;
    const Vec3 w = best.at.weights;
    const auto take = [&](int f) {
      const TrianglePoint at = nearest_on_face(f, x);
      if (is_before(at.distance2, f, best)) best = {f, at};
    };
    const int zeros = (w[0] == 0.0) + (w[1] == 0.0) + (w[2] == 0.0);
    if (zeros == 1) take(skin_.across(w[0] == 0.0 ? 0 : w[1] == 0.0 ? 1 : 2, seen));
    if (zeros == 2) {
      const auto v = static_cast<std::size_t>(skin_.faces(w[0] != 0.0 ? 0 : w[1] != 0.0 ? 1 : 2, seen));
      for (int i = skin_.fan_begin[v]; i < skin_.fan_begin[v + 1]; ++i)
        take(skin_.fan[static_cast<std::size_t>(i)]);
    }
  }
  return best;
}

Vec3 Surface::unit_normal(int face) const {
  place(face / kClusterFaces);
  const Vec3 normal = (corner(face, 1) - corner(face, 0)).cross(corner(face, 2) - corner(face, 0));
  const double size = normal.norm();
  return size > 0.0 ? Vec3(normal / size) : Vec3::Zero();
}

Vec3 Surface::outward(const Foot& foot) const {
  const Vec3& w = foot.at.weights;
  Vec3 normal = unit_normal(foot.face);
  const int zeros = (w[0] == 0.0) + (w[1] == 0.0) + (w[2] == 0.0);
  if (zeros == 1) {
    const int opposite = w[0] == 0.0 ? 0 : w[1] == 0.0 ? 1 : 2;
    normal += unit_normal(skin_.across(opposite, foot.face));
  } else if (zeros == 2) {
    const int v = skin_.faces(w[0] != 0.0 ? 0 : w[1] != 0.0 ? 1 : 2, foot.face);
    normal.setZero();
    for (int i = skin_.fan_begin[static_cast<std::size_t>(v)];
         i < skin_.fan_begin[static_cast<std::size_t>(v) + 1]; ++i) {
      const int face = skin_.fan[static_cast<std::size_t>(i)];
      const int k = skin_.faces(0, face) == v ? 0 : skin_.faces(1, face) == v ? 1 : 2;
      const Vec3 n = unit_normal(face);
      const Vec3 e = corner(face, (k + 1) % 3) - vertex(v), g = corner(face, (k + 2) % 3) - vertex(v);
      normal += std::atan2(e.cross(g).norm(), e.dot(g)) * n;
    }
  }
  return normal;
}

}  // namespace palpate::distance
