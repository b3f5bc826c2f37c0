#include "product/contact/relative_path.h"

#include <cmath>
#include <numbers>

namespace palpate::bench {
namespace {

/// Returns the same numbers on every machine, unlike std::uniform_real_distribution.
double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

}  // namespace

Vec3 random_rotation(std::mt19937& random, double most) {
  Vec3 out;
  for (double& x : out) x = uniform(random, -most, most);
  return out;
}

RelativePath::RelativePath(const Meeting& meeting, std::mt19937& random) : meeting_(meeting) {
  axes_.col(0) = meeting.away;
  axes_.col(1) = meeting.away.unitOrthogonal();
  axes_.col(2) = axes_.col(0).cross(axes_.col(1));
  const double r = meeting.reach;
  if (meeting.inside) {
    amplitude_ << 0.01 * r, 0.01 * r, 0.01 * r, 0.02, 0.02, 0.02;
  } else {
    amplitude_ << 0.02 * r, 0.06 * r, 0.06 * r, 0.1, 0.1, 0.1;
    mean_(0) = -0.01 * r;
  }
  for (int i = 0; i < 6; ++i) {
    amplitude_(i) *= uniform(random, 0.3, 1.0);
    phase_(i) = uniform(random, 0.0, 2.0 * std::numbers::pi);
    turns_(i) = uniform(random, 1.0, 2.0);
  }
}

Pose RelativePath::at(double s) const {
  Vec6 x;
  for (int i = 0; i < 6; ++i)
    x(i) = mean_(i) + amplitude_(i) * std::sin(phase_(i) + 2.0 * std::numbers::pi * turns_(i) * s);
  const Quat turn = quaternion_of(x.tail<3>());
  const Pose about_pivot{turn, meeting_.pivot - turn * meeting_.pivot + axes_ * x.head<3>()};
  return about_pivot * meeting_.start;
}

}  // namespace palpate::bench
