#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/analytic_source.h"
#include "contact/obstacles/keys.h"
#include "contact/obstacles/sphere.h"

namespace palpate::contact {
namespace {

/// The points within distance r of the segment from (0, 0, -h) to (0, 0, h), in local axes.
class Capsule {
 public:
  static constexpr const char* kName = "capsule";
  static constexpr bool kRound = false;
  Capsule(const Pose& in_frame, double radius, double length)
      : in_frame_(in_frame), inverse_(in_frame.inverse()), radius_(radius), half_(0.5 * length) {}
  void move_to(const Pose& pose) { world_ = pose * in_frame_; }
  Nearest at(const Vec3& world) const {
    const Vec3 d = from_axis(world_.inverse() * world);
    const double distance = d.norm();
    const Vec3 normal = distance > 0.0 ? Vec3(d / distance) : Vec3(Vec3::UnitX());
    return {distance - radius_, world_.rotation * normal, radius_};
  }
  /// Returns where the line leaves the capsule.  The gap along the line falls and rises again; bisection
  /// finds its last zero.
  double height(const Vec3& world, const Vec3& n) const {
    const Vec3 x = world_.inverse() * world, d = world_.rotation.conjugate() * n;
    const double far = x.norm() + half_ + radius_;
    const double deepest = lowest(x, d, -far, far);
    if (gap(x + deepest * d) > 0.0) return -std::numeric_limits<double>::infinity();
    double inside = deepest, outside = far;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (inside + outside);
      (gap(x + middle * d) > 0.0 ? outside : inside) = middle;
    }
    return outside;
  }
  bool is_crossed(const Vec3& a_frame, const Vec3& b_frame) const {
    const Vec3 a = inverse_ * a_frame, b = inverse_ * b_frame;
    return gap(a) > 0.0 && gap(b) > 0.0 && gap(a + lowest(a, b - a, 0.0, 1.0) * (b - a)) < 0.0;
  }
  // The integral of the mean curvature is pi (length + 4 radius).
  CharacteristicLengths lengths() const {
    const double radius = 4.0 * radius_ * (half_ + radius_) / (2.0 * half_ + 4.0 * radius_);
    return {2.0 * radius_, radius, 1.0 / radius};
  }
  double curvature() const { return 0.0; }  // not constant

 private:
  Vec3 from_axis(const Vec3& x) const { return x - Vec3(0.0, 0.0, std::clamp(x.z(), -half_, half_)); }
  double gap(const Vec3& x) const { return from_axis(x).norm() - radius_; }
  /// The distance to a convex set is convex along a line; ternary search finds its minimum.
  double lowest(const Vec3& x, const Vec3& d, double low, double high) const {
    for (int i = 0; i < 120; ++i) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      (gap(x + a * d) < gap(x + b * d) ? high : low) = gap(x + a * d) < gap(x + b * d) ? b : a;
    }
    return 0.5 * (low + high);
  }
  Pose in_frame_, inverse_;
  double radius_, half_;
  Pose world_;
};

Capsule capsule_of(const Settings& shape) {
  return {pose_of(shape), radius_of(shape), std::get<double>(shape.at("length_m"))};
}

TriMesh surface(const Settings& shape, double spacing) {
  TriMesh out = sphere_surface(radius_of(shape), spacing);
  const double half = 0.5 * std::get<double>(shape.at("length_m"));
  for (Eigen::Index v = 0; v < out.vertices.cols(); ++v)
    out.vertices(2, v) += out.vertices(2, v) > 0.0 ? half : -half;
  return placed(std::move(out), shape);
}

ObstaclePicture picture(const Settings& shape, const View&) {
  return {surface(shape, radius_of(shape) / 18.0), {}};
}

}  // namespace

const ObstacleEntry& capsule_obstacle() {
  static const ObstacleEntry entry = {
      "capsule",
      "cylinder along its local z axis with hemispherical ends, centred at position_m",
      {position_key("centre"), rotation_key(), length_key("radius_m", "radius of cylinder and hemispheres"),
       length_key("length_m", "distance between the centres of the hemispheres")},
      [](ContactSide side, int frame, std::shared_ptr<MovingFrame> motion, const Settings& shape, double gap,
         double look_ahead) {
        return make_analytic_source(std::move(side), frame, std::move(motion), capsule_of(shape), gap,
                                    look_ahead);
      },
      [](const Settings& shape) { return capsule_of(shape).lengths(); },
      [](const Settings& shape, const Vec3& x) { return nearest_to(capsule_of(shape), x); },
      picture,
      surface,
  };
  return entry;
}

}  // namespace palpate::contact
