#include "proxy/least_width.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace palpate::proxy {
namespace {

double width_along(const Eigen::Ref<const Points>& points, const Vec3& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double at = direction.dot(points.col(i));
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return high - low;
}

/// Returns the best direction of a coarse lattice over the half sphere.  Every direction is within a
/// quarter of a radian of a lattice direction.
Vec3 best_of_lattice(const Eigen::Ref<const Points>& points) {
  Vec3 best = Vec3::UnitZ();
  double least = std::numeric_limits<double>::infinity();
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = 0; z <= 2; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vec3 direction = Vec3(x, y, z).normalized();
        if (const double width = width_along(points, direction); width < least) {
          least = width;
          best = direction;
        }
      }
  return best;
}

}  // namespace

// Compass search over the sphere: a thin plate whose normal is between the lattice's directions is many times
// thinner than its width along any of them.
double least_width(const Eigen::Ref<const Points>& points) {
  constexpr double kFirst = 0.25, kLast = 1e-5;  // [rad]
  constexpr int kMostSteps = 1000;
  Vec3 best = best_of_lattice(points);
  double least = width_along(points, best);
  int steps = 0;
  for (double angle = kFirst; angle > kLast && steps < kMostSteps;) {
    const Vec3 u = best.unitOrthogonal(), v = best.cross(u), centre = best;
    for (int i = 0; i < 8; ++i, ++steps) {
      const double along = i * M_PI / 4.0;
      const Vec3 direction = (centre + angle * (std::cos(along) * u + std::sin(along) * v)).normalized();
      if (const double width = width_along(points, direction); width < least) {
        least = width;
        best = direction;
      }
    }
    if (best == centre) angle *= 0.5;
  }
  return least;
}

}  // namespace palpate::proxy
