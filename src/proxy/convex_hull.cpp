#include "proxy/convex_hull.h"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <set>
#include <string>

#include "palpate/core/error.h"

namespace palpate::proxy {
namespace {

/// Affine space spanned by points: `dimension` orthonormal columns of `axes` lie along it, the others across
/// it.
struct Span {
  Vec3 origin;
  Mat3 axes;
  int dimension = 0;
};

// Each axis points to the point farthest from the space spanned so far.  A remainder within kFlat of the size
// is rounding, or negligible thickness.
Span span(const Points& points) {
  constexpr double kFlat = 1e-7;
  Span out{points.col(0), Mat3::Zero(), 0};
  Points rest = points.colwise() - out.origin;
  const double size = rest.colwise().norm().maxCoeff();
  for (; out.dimension < 3; ++out.dimension) {
    Eigen::Index farthest = 0;
    const double distance = rest.colwise().norm().maxCoeff(&farthest);
    if (!(distance > kFlat * size)) break;
    const Vec3 axis = rest.col(farthest) / distance;
    out.axes.col(out.dimension) = axis;
    rest -= (axis * (axis.transpose() * rest)).eval();
  }
  if (out.dimension == 0) out.axes.setIdentity();
  if (out.dimension == 1) out.axes.col(1) = out.axes.col(0).unitOrthogonal();
  if (out.dimension == 1 || out.dimension == 2) out.axes.col(2) = out.axes.col(0).cross(out.axes.col(1));
  return out;
}

/// Qhull's result for points in the plane or in space: facets (normal, offset), extreme points, volume or
/// area.
struct Facets {
  std::vector<std::array<double, 4>> planes;  // inside is normal . x + offset <= 0
  std::vector<int> corners;
  double content = 0.0;
};

class Qhull {
 public:
  Qhull() { qh_zero(&qh_, log_.get()); }
  ~Qhull() {
    qh_freeqhull(&qh_, !qh_ALL);
    int left = 0, bytes = 0;
    qh_memfreeshort(&qh_, &left, &bytes);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  Facets run(int dimension, MatX& coordinates) {
    char command[] = "qhull Pp";
    const int failed = qh_new_qhull(&qh_, dimension, static_cast<int>(coordinates.cols()), coordinates.data(),
                                    False, command, nullptr, log_.get());
    PALPATE_CHECK(failed == 0, "Qhull returned error {} for {} points in {} dimensions", failed,
                  coordinates.cols(), dimension);
    Facets out;
    qh_getarea(&qh_, qh_.facet_list);
    out.content = qh_.totvol;
    for (const facetT* facet = qh_.facet_list; facet && facet->next; facet = facet->next) {
      std::array<double, 4> plane{};
      std::copy_n(facet->normal, dimension, plane.begin());
      plane[3] = facet->offset;
      out.planes.push_back(plane);
    }
    for (vertexT* vertex = qh_.vertex_list; vertex && vertex->next; vertex = vertex->next)
      out.corners.push_back(qh_pointid(&qh_, vertex->point));
    std::sort(out.corners.begin(), out.corners.end());
    return out;
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> log_{std::tmpfile()};  // Qhull requires a stream for its messages
  qhT qh_{};
};

}  // namespace

// A facet reads n . y + o <= 0 in the coordinates y = axes^T (x - origin) / size of its span, which is (axes
// n) . x <= (axes n) . origin - o size.
ConvexHull convex_hull(const Points& points) {
  PALPATE_CHECK(points.cols() > 0 && points.allFinite(),
                "convex hull: {} points; at least one is needed, and all must be finite", points.cols());
  const Span in = span(points);
  const int d = in.dimension;
  MatX y = in.axes.leftCols(d).transpose() * (points.colwise() - in.origin);
  const double size = d > 0 ? y.cwiseAbs().maxCoeff() : 1.0;
  y /= size;
  Facets facets;
  if (d == 0) facets.corners = {0};
  if (d == 1) {
    Eigen::Index low = 0, high = 0;
    facets.planes = {{-1.0, 0, 0, y.row(0).minCoeff(&low)}, {1.0, 0, 0, -y.row(0).maxCoeff(&high)}};
    facets.corners = {static_cast<int>(std::min(low, high)), static_cast<int>(std::max(low, high))};
  }
  if (d >= 2) facets = Qhull().run(d, y);

  ConvexHull out;
  out.corners = std::move(facets.corners);
  out.volume = d == 3 ? facets.content * size * size * size : 0.0;
  const int count = static_cast<int>(facets.planes.size()), across = 3 - d;
  out.normals.resize(3, count + 2 * across);
  out.offsets.resize(count + 2 * across);
  for (int f = 0; f < count; ++f) {
    const auto& plane = facets.planes[static_cast<std::size_t>(f)];
    const Vec3 n = in.axes * Vec3(plane[0], plane[1], plane[2]);
    out.normals.col(f) = n;
    out.offsets[f] = n.dot(in.origin) - plane[3] * size;
  }
  for (int k = 0; k < across; ++k)
    for (int side = 0; side < 2; ++side) {
      const Vec3 n = (side ? -1.0 : 1.0) * in.axes.col(d + k);
      out.normals.col(count + 2 * k + side) = n;
      out.offsets[count + 2 * k + side] = (n.transpose() * points).maxCoeff();
    }
  return out;
}

std::vector<int> greedy_corners(const Points& points, int count, double tolerance) {
  const std::vector<int> extreme = convex_hull(points).corners;
  if (static_cast<int>(extreme.size()) <= count) return extreme;
  std::set<int> taken;
  // Start with the extreme points along the axes, where most hulls reach farthest.
  for (int axis = 0; axis < 3 && static_cast<int>(taken.size()) + 2 <= count; ++axis) {
    const auto along = [&](int i, int j) { return points(axis, i) < points(axis, j); };
    const auto [low, high] = std::minmax_element(extreme.begin(), extreme.end(), along);
    taken.insert({*low, *high});
  }
  for (;;) {
    const std::vector<int> corners(taken.begin(), taken.end());
    if (static_cast<int>(corners.size()) == count) return corners;
    const ConvexHull hull = convex_hull(points(Eigen::all, corners));
    int farthest = -1;
    double most = tolerance;
    for (const int i : extreme) {
      const double beyond = hull.beyond(points.col(i));
      if (beyond > most && !taken.contains(i)) {
        most = beyond;
        farthest = i;
      }
    }
    if (farthest < 0) return corners;
    taken.insert(farthest);
  }
}

}  // namespace palpate::proxy
