#include "contact/tunnelling_check.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::contact {
namespace {

struct Cubic {
  std::array<double, 4> c;  ///< Coefficients of 1, t, t^2, t^3.
  double at(double t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
};

/// Computes the zeros of the cubic's slope in (0, 1), together with 0 and 1: between them it is monotonic.
/// Returns their number.
int monotonic_parts(const Cubic& f, std::array<double, 4>& ends) {
  int count = 0;
  ends[static_cast<std::size_t>(count++)] = 0.0;
  const double a = 3.0 * f.c[3], b = 2.0 * f.c[2], c = f.c[1];
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant >= 0.0) {
    // Both roots without cancellation; a quotient by zero is not a root.
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    std::array<double, 2> roots{q / a, c / q};
    if (roots[1] < roots[0]) std::swap(roots[0], roots[1]);
    for (const double t : roots)
      if (t > 0.0 && t < 1.0) ends[static_cast<std::size_t>(count++)] = t;
  }
  ends[static_cast<std::size_t>(count++)] = 1.0;
  return count;
}

/// Returns the zero of a monotonic part that has one.
double zero_between(const Cubic& f, double low, double high) {
  const bool falls = f.at(low) >= 0.0;
  for (int i = 0; i < 60 && high - low > 1e-15; ++i) {
    const double middle = 0.5 * (low + high);
    ((f.at(middle) >= 0.0) == falls ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// First and last time at which a vertex crosses the surface, and the direction of the crossings.
struct Meetings {
  double first = 2.0, last = -1.0;
  bool entered_first = false, left_last = false;
  double speed = 0.0;  ///< Speed relative to the face crossed first.
  void add(double t, bool entered, double relative_speed) {
    if (t < first) {
      first = t;
      entered_first = entered;
      speed = relative_speed;
    }
    if (t > last) {
      last = t;
      left_last = !entered;
    }
  }
  bool passed(double least_way) const {
    constexpr double kInstant = 1e-12;  // Shorter times: a ridge was touched.
    return entered_first && left_last && last - first > kInstant && (last - first) * speed > least_way;
  }
};

struct Line {
  Vec3 start, way;
  Vec3 at(double t) const { return start + t * way; }
};

bool is_inside(const Vec3& d, const Vec3& e1, const Vec3& e2) {
  constexpr double kEdge = 1e-9;  // An edge belongs to both of its faces.
  const Vec3 n = e1.cross(e2);
  const double area2 = n.squaredNorm();
  const double w1 = d.cross(e2).dot(n), w2 = e1.cross(d).dot(n);
  return w1 >= -kEdge * area2 && w2 >= -kEdge * area2 && w1 + w2 <= (1.0 + kEdge) * area2;
}

void meet(const Line& x, const SurfaceMotion& surface, int face, Meetings& out) {
  const auto corner = [&](int k) {
    const int v = surface.faces(k, face);
    return Line{surface.before.col(v), surface.now.col(v) - surface.before.col(v)};
  };
  const Line p0 = corner(0), p1 = corner(1), p2 = corner(2);
  const Line d{x.start - p0.start, x.way - p0.way}, e1{p1.start - p0.start, p1.way - p0.way},
      e2{p2.start - p0.start, p2.way - p0.way};
  const Vec3 c0 = e1.start.cross(e2.start), c1 = e1.start.cross(e2.way) + e1.way.cross(e2.start),
             c2 = e1.way.cross(e2.way);
  const Cubic f{
      {d.start.dot(c0), d.way.dot(c0) + d.start.dot(c1), d.way.dot(c1) + d.start.dot(c2), d.way.dot(c2)}};
  std::array<double, 4> ends{};
  const int count = monotonic_parts(f, ends);
  for (int i = 0; i + 1 < count; ++i) {
    const double low = ends[static_cast<std::size_t>(i)], high = ends[static_cast<std::size_t>(i) + 1];
    const bool above = f.at(low) >= 0.0, above_then = f.at(high) >= 0.0;
    if (above == above_then) continue;
    const double t = zero_between(f, low, high);
    if (is_inside(d.at(t), e1.at(t), e2.at(t))) out.add(t, above, d.way.norm());
  }
}

/// Bound on the displacements of vertices relative to all points of the faces: with m the mean of the faces'
/// displacements, |v - w| <= |v - m| + max |w - m|. Vertices within `least_way` cannot tunnel by more than
/// that.
class FastVertices {
 public:
  FastVertices(const SurfaceMotion& faces, double least_way) {
    const Points ways = faces.now - faces.before;
    mean_ = ways.rowwise().mean();
    const double spread = std::sqrt((ways.colwise() - mean_).colwise().squaredNorm().maxCoeff());
    rest2_ = spread < least_way ? (least_way - spread) * (least_way - spread) : -1.0;
  }
  bool has(const Vec3& way) const { return (way - mean_).squaredNorm() > rest2_; }

 private:
  Vec3 mean_;
  double rest2_;
};

/// Limits of the cost of count(): box tests per vertex and face, and the number of box tests to which one
/// crossing test is equivalent. A few tenths of a second for skins of 30,000 vertices.
constexpr long kLooksAVertex = 1000, kPriceOfMeeting = 50;

}  // namespace

long TunnellingCheck::count(const SurfaceMotion& vertices, const SurfaceMotion& faces, double least_way,
                            const std::function<bool(int vertex, int face)>& may_collide) {
  if (vertices.now.cols() == 0 || faces.faces.cols() == 0) return 0;
  const FastVertices fast(faces, least_way);
  const auto is_fast = [&](Eigen::Index v) { return fast.has(vertices.now.col(v) - vertices.before.col(v)); };
  Eigen::Index first = 0;
  while (first < vertices.now.cols() && !is_fast(first)) ++first;
  if (first == vertices.now.cols()) return 0;
  boxes_.clear();
  Vec3 mean = Vec3::Zero(), low = Vec3::Constant(HUGE_VAL), high = -low;
  for (Eigen::Index f = 0; f < faces.faces.cols(); ++f) {
    FaceBox box{Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL), static_cast<int>(f)};
    for (int k = 0; k < 3; ++k)
      for (const Points* x : {&faces.before, &faces.now}) {
        box.low = box.low.cwiseMin(x->col(faces.faces(k, f)));
        box.high = box.high.cwiseMax(x->col(faces.faces(k, f)));
      }
    const Vec3 rounding = Vec3::Constant(1e-12 * (box.low.cwiseAbs() + box.high.cwiseAbs()).maxCoeff());
    box.low -= rounding;
    box.high += rounding;
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
    mean += (box.high - box.low) / static_cast<double>(faces.faces.cols());
    boxes_.push_back(box);
  }
  const auto box_misses = [&](const Points& x, const Points& y) {
    const Vec3 x_low = x.rowwise().minCoeff().cwiseMin(y.rowwise().minCoeff()),
               x_high = x.rowwise().maxCoeff().cwiseMax(y.rowwise().maxCoeff());
    return (x_low.array() > high.array()).any() || (x_high.array() < low.array()).any();
  };
  if (box_misses(vertices.before, vertices.now)) return 0;
  const Vec3 way = (vertices.now - vertices.before).cwiseAbs().rowwise().mean();
  // Sorted along the axis on which a vertex overlaps the fewest boxes.
  Eigen::Index axis = 0;
  ((mean + way).array() / (high - low).array().max(1e-300)).minCoeff(&axis);
  std::sort(boxes_.begin(), boxes_.end(), [axis](const FaceBox& p, const FaceBox& q) {
    return p.low[axis] != q.low[axis] ? p.low[axis] < q.low[axis] : p.face < q.face;
  });
  double widest = 0.0;
  for (const FaceBox& box : boxes_) widest = std::max(widest, box.high[axis] - box.low[axis]);

  long passed = 0, left = kLooksAVertex *
                          static_cast<long>(boxes_.size() + static_cast<std::size_t>(vertices.now.cols()));
  for (Eigen::Index v = first; v < vertices.now.cols(); ++v) {
    if (!is_fast(v)) continue;
    if (left < 0) {
      ++given_up_;
      break;
    }
    const Line x{vertices.before.col(v), vertices.now.col(v) - vertices.before.col(v)};
    const Vec3 x_low = vertices.before.col(v).cwiseMin(vertices.now.col(v)),
               x_high = vertices.before.col(v).cwiseMax(vertices.now.col(v));
    Meetings meetings;
    auto box = std::lower_bound(boxes_.begin(), boxes_.end(), x_low[axis] - widest,
                                [axis](const FaceBox& b, double value) { return b.low[axis] < value; });
    for (; box != boxes_.end() && box->low[axis] <= x_high[axis]; ++box) {
      --left;
      if ((box->low.array() > x_high.array()).any() || (box->high.array() < x_low.array()).any()) continue;
      if (may_collide && !may_collide(vertices.vertex_of[static_cast<std::size_t>(v)],
                                      faces.face_of[static_cast<std::size_t>(box->face)]))
        continue;
      meet(x, faces, box->face, meetings);
      left -= kPriceOfMeeting;
    }
    passed += meetings.passed(least_way);
  }
  return passed;
}

}  // namespace palpate::contact
