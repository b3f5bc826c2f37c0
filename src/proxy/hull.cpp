#include "proxy/hull.h"

#include <Eigen/LU>

#include <limits>

namespace palpate::proxy {
namespace {

/// At most four points, one per column.
struct Simplex {
  Eigen::Matrix<double, 3, 4> points;
  int count = 0;
};

/// Finds the point nearest to the origin in the hull of N + 1 points: p0 + E l with l = -(E^T E)^-1 E^T p0, E
/// = [p1 - p0, ...].  Returns false when it lies outside (a subset of the points then holds the nearest
/// point) or the points are degenerate: det(E^T E) over the product of its diagonal is 1 for orthogonal edges
/// (Hadamard), and the squared sine of the angle for two edges.
template <int N>
bool nearest_of(const Simplex& s, const int* index, Vec3& nearest) {
  constexpr double kFlat = 1e-14;
  Eigen::Matrix<double, 3, N> E;
  for (int i = 0; i < N; ++i) E.col(i) = s.points.col(index[i + 1]) - s.points.col(index[0]);
  const Eigen::Matrix<double, N, N> gram = E.transpose() * E;
  const double determinant = gram.determinant();
  if (!(determinant > kFlat * gram.diagonal().prod())) return false;
  const Eigen::Matrix<double, N, 1> l = -(gram.inverse() * (E.transpose() * s.points.col(index[0])));
  if (!(l.minCoeff() >= 0.0 && l.sum() <= 1.0)) return false;
  nearest = s.points.col(index[0]) + E * l;
  return true;
}

bool nearest_in_subset(const Simplex& s, int mask, Vec3& nearest) {
  int index[4] = {}, count = 0;
  for (int i = 0; i < s.count; ++i)
    if (mask & (1 << i)) index[count++] = i;
  switch (count) {
    case 1: nearest = s.points.col(index[0]); return true;
    case 2: return nearest_of<1>(s, index, nearest);
    case 3: return nearest_of<2>(s, index, nearest);
    default: return nearest_of<3>(s, index, nearest);
  }
}

/// Returns the nearest point of the simplex's hull, over all its subsets, and drops the points outside the
/// best subset.
Vec3 reduce(Simplex& s) {
  double least = std::numeric_limits<double>::infinity();
  Vec3 best = Vec3::Zero();
  int best_mask = 1;
  for (int mask = 1; mask < (1 << s.count); ++mask) {
    Vec3 p;
    if (!nearest_in_subset(s, mask, p) || !(p.squaredNorm() < least)) continue;
    least = p.squaredNorm();
    best = p;
    best_mask = mask;
  }
  int kept = 0;
  for (int i = 0; i < s.count; ++i)
    if (best_mask & (1 << i)) s.points.col(kept++) = s.points.col(i);
  s.count = kept;
  return best;
}

}  // namespace

void Hull::assign(const Eigen::Ref<const Points>& points, const Vec3& origin, double scale) {
  const auto count = static_cast<std::size_t>(padded(static_cast<int>(points.cols())));
  for (auto* column : {&x_, &y_, &z_}) column->resize(count);
  centre_.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_point = static_cast<Eigen::Index>(i) < points.cols();
    const Vec3 p = scale * (points.col(is_point ? static_cast<Eigen::Index>(i) : 0) - origin);
    x_[i] = p.x();
    y_[i] = p.y();
    z_[i] = p.z();
    if (is_point) centre_ += p;
  }
  centre_ /= static_cast<double>(points.cols());
}

// Let v be a point of the convex set C = a - b, s = argmin over C of v.s.  The difference v.v - v.s bounds
// how much nearer to the origin another point can be.  s joins the simplex that supports v, and the next v is
// the point of that simplex nearest to the origin.
Vec3 nearest_difference(const Hull& a, const Hull& b) {
  constexpr int kMaxSteps = 100;
  constexpr double kRelativeGap = 1e-9;
  Simplex simplex;
  Vec3 v = a.centre() - b.centre();
  for (int i = 0; i < kMaxSteps; ++i) {
    const Vec3 s = a.support(-v) - b.support(v);
    if (simplex.count > 0 && v.dot(v - s) <= kRelativeGap * v.squaredNorm()) break;
    if (simplex.count == 4) break;  // four points support v: the origin is inside
    simplex.points.col(simplex.count++) = s;
    const double before = v.squaredNorm();
    v = reduce(simplex);
    if (i > 0 && !(v.squaredNorm() < before)) break;  // stagnation at rounding level
  }
  return v;
}

}  // namespace palpate::proxy
