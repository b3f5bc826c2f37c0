#include "distance/gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "distance/surface.h"

namespace palpate::distance {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Computes the nearest points of segments a + s u and b + t v, s and t in [0, 1]. For a fixed s the best t
/// is the projection, clamped; the minimum over s of the clamped problem is that of the lines, of s = 0, or
/// of s = 1.
void take_segments(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v, TrianglePair& best) {
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), det = uu * vv - uv * uv;
  const Vec3 w = b - a;
  const auto take = [&](double s) {
    const double t = vv > 0.0 ? std::clamp((s * uv - w.dot(v)) / vv, 0.0, 1.0) : 0.0;
    const double again = uu > 0.0 ? std::clamp((t * uv + w.dot(u)) / uu, 0.0, 1.0) : 0.0;
    const Vec3 x = a + again * u, y = b + t * v;
    if (const double d2 = (x - y).squaredNorm(); d2 < best.distance2) best = {d2, x, y};
  };
  if (det > 0.0) take(std::clamp((w.dot(u) * vv - w.dot(v) * uv) / det, 0.0, 1.0));
  take(0.0);
  take(1.0);
}

/// Returns whether the segment from p to q crosses the triangle; the point goes into `at`.
bool crosses(const Vec3& p, const Vec3& q, const Mat3& triangle, Vec3& at) {
  const Vec3 a = triangle.col(0), normal = (triangle.col(1) - a).cross(triangle.col(2) - a);
  const double from = normal.dot(p - a), to = normal.dot(q - a);
  if (!(from * to <= 0.0) || from == to) return false;
  at = p + from / (from - to) * (q - p);
  for (int k = 0; k < 3; ++k) {
    const Vec3 edge = triangle.col((k + 1) % 3) - triangle.col(k);
    if (normal.dot(edge.cross(at - triangle.col(k))) < 0.0) return false;
  }
  return true;
}

double exterior2(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return a.squaredExteriorDistance(b);
}

Mat3 corners_of(const Surface& surface, int face) {
  Mat3 out;
  for (int k = 0; k < 3; ++k) out.col(k) = surface.corner(face, k);
  return out;
}

Eigen::AlignedBox3d box_of(const Mat3& corners) {
  return {corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()};
}

/// Search for the nearest points of two surfaces, over both trees.
class PairSearch {
 public:
  PairSearch(const Surface& a, const Surface& b) : a_(a), b_(b) { best_.distance2 = kInfinity; }
  TrianglePair run() {
    visit(0, 0);
    return best_;
  }

 private:
  const ClusterNode& node(const Surface& s, int i) const {
    return s.skin().tree[static_cast<std::size_t>(i)];
  }

  void visit(int i, int j) {
    if (exterior2(a_.box(i), b_.box(j)) >= best_.distance2) return;
    const ClusterNode &first = node(a_, i), &second = node(b_, j);
    if (!first.right && !second.right) return visit_clusters(first.begin, second.begin);
    const bool split_first =
        first.right && (!second.right || a_.box(i).diagonal().norm() >= b_.box(j).diagonal().norm());
    int left[2] = {i, j}, right[2] = {i, j};
    left[split_first ? 0 : 1] = (split_first ? i : j) + 1;
    right[split_first ? 0 : 1] = split_first ? first.right : second.right;
    const bool right_first =
        exterior2(a_.box(right[0]), b_.box(right[1])) < exterior2(a_.box(left[0]), b_.box(left[1]));
    if (right_first) std::swap(left, right);
    visit(left[0], left[1]);
    visit(right[0], right[1]);
  }

  void visit_clusters(int c, int d) {
    a_.place(c);
    b_.place(d);
    const auto end = [](const Surface& s, int cluster) {
      return std::min(kClusterFaces * (cluster + 1), s.skin().face_count());
    };
    Eigen::AlignedBox3d second;
    for (int g = kClusterFaces * d; g < end(b_, d); ++g) second.extend(box_of(corners_of(b_, g)));
    for (int f = kClusterFaces * c; f < end(a_, c); ++f) {
      const Mat3 own = corners_of(a_, f);
      const Eigen::AlignedBox3d box = box_of(own);
      if (exterior2(box, second) >= best_.distance2) continue;
      for (int g = kClusterFaces * d; g < end(b_, d); ++g) {
        const Mat3 other = corners_of(b_, g);
        if (exterior2(box, box_of(other)) >= best_.distance2) continue;
        if (const TrianglePair pair = nearest_of_triangles(own, other); pair.distance2 < best_.distance2)
          best_ = pair;
      }
    }
  }

  const Surface &a_, &b_;
  TrianglePair best_;
};

/// Finds the deepest vertex of `points` in a surface, deeper than that in `deepest`.
void take_deepest(const Points& points, const Surface& in, Gap& deepest, bool reversed) {
  int face = -1;
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    const Vec3 x = points.col(v);
    if (!in.bound().contains(x)) continue;
    const Foot foot = in.nearest(x, face);
    face = foot.face;
    const double depth = std::sqrt(foot.at.distance2);
    if (depth <= -deepest.distance || !in.is_inside(foot)) continue;
    const Gap gap{-depth, x, x - foot.at.away};
    deepest = reversed ? gap.reversed() : gap;
  }
}

}  // namespace

TrianglePair nearest_of_triangles(const Mat3& a, const Mat3& b) {
  TrianglePair best{kInfinity};
  Vec3 at;
  for (int k = 0; k < 3; ++k)
    if (crosses(a.col(k), a.col((k + 1) % 3), b, at) || crosses(b.col(k), b.col((k + 1) % 3), a, at))
      return {0.0, at, at};
  for (int k = 0; k < 3; ++k) {
    const TrianglePoint on_b = nearest_on_triangle(b.col(0), b.col(1), b.col(2), a.col(k)),
                        on_a = nearest_on_triangle(a.col(0), a.col(1), a.col(2), b.col(k));
    if (on_b.distance2 < best.distance2) best = {on_b.distance2, a.col(k), a.col(k) - on_b.away};
    if (on_a.distance2 < best.distance2) best = {on_a.distance2, b.col(k) - on_a.away, b.col(k)};
    for (int l = 0; l < 3; ++l)
      take_segments(a.col(k), a.col((k + 1) % 3) - a.col(k), b.col(l), b.col((l + 1) % 3) - b.col(l), best);
  }
  return best;
}

struct RigidSurface::Impl {
  explicit Impl(const TriMesh& mesh) : skin(make_skin(mesh)), surface(skin) {}
  Skin skin;
  Surface surface;
};

RigidSurface::RigidSurface(TriMesh mesh)
    : mesh_(std::move(mesh)), vertices_(mesh_.vertices), impl_(std::make_unique<Impl>(mesh_)) {
  impl_->surface.move(vertices_.data());
}
RigidSurface::~RigidSurface() = default;
RigidSurface::RigidSurface(RigidSurface&&) noexcept = default;
RigidSurface& RigidSurface::operator=(RigidSurface&&) noexcept = default;

void RigidSurface::move(const Pose& pose) {
  vertices_ = (pose.rotation.toRotationMatrix() * mesh_.vertices).colwise() + pose.translation;
  impl_->surface.move(vertices_.data());
}

Gap RigidSurface::from_point(const Vec3& x) const {
  const Foot foot = impl_->surface.nearest(x);
  const double distance = std::sqrt(foot.at.distance2);
  return {impl_->surface.is_inside(foot) ? -distance : distance, x, x - foot.at.away};
}

Gap gap_between(const RigidSurface& first, const RigidSurface& second) {
  Gap deepest;
  take_deepest(first.vertices_, second.impl_->surface, deepest, false);
  take_deepest(second.vertices_, first.impl_->surface, deepest, true);
  if (deepest.distance < 0.0) return deepest;
  const TrianglePair nearest = PairSearch(first.impl_->surface, second.impl_->surface).run();
  return {std::sqrt(nearest.distance2), nearest.on_first, nearest.on_second};
}

}  // namespace palpate::distance
