#include "contact/obstacles/cylinder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/analytic_source.h"
#include "contact/obstacles/keys.h"
#include "contact/segment_part.h"
#include "palpate/mesh/generators.h"

namespace palpate::contact {
namespace {

/// Cylinder x^2 + y^2 <= r^2, |z| <= h in its axes: a two-dimensional box in the plane (radius, |z|).
class Cylinder {
 public:
  static constexpr const char* kName = "cylinder";
  Cylinder(const Pose& pose_in_frame, double radius, double length)
      : in_frame_(pose_in_frame), inverse_(pose_in_frame.inverse()), radius_(radius), half_(0.5 * length) {}
  void move_to(const Pose& pose) { world_ = pose * in_frame_; }
  // On the axis all radial directions are equivalent; one is chosen.
  Nearest at(const Vec3& world) const {
    const Vec3 x = world_.inverse() * world;
    const double r = std::hypot(x.x(), x.y()), side = r - radius_, end = std::abs(x.z()) - half_;
    const Vec3 radial = r > 0.0 ? Vec3(x.x() / r, x.y() / r, 0.0) : Vec3(Vec3::UnitX()),
               axial = std::copysign(1.0, x.z()) * Vec3::UnitZ();
    const double out_side = std::max(side, 0.0), out_end = std::max(end, 0.0),
                 distance = std::hypot(out_side, out_end);
    if (out_end == 0.0 && (side > 0.0 || side > end)) return {side, world_.rotation * radial, radius_};
    if (distance > 0.0)
      return {distance, world_.rotation * Vec3((out_side * radial + out_end * axial) / distance)};
    return {end, world_.rotation * axial};
  }
  static constexpr bool kRound = false;
  double height(const Vec3& world, const Vec3& n) const {
    const Vec3 x = world_.inverse() * world, d = world_.rotation.conjugate() * n;
    Part part = Part::line();
    part.cut(x.z(), d.z(), -half_, half_);
    cut_round(x, d, part);
    return part.end();
  }
  bool is_crossed(const Vec3& a_frame, const Vec3& b_frame) const {
    const Vec3 a = inverse_ * a_frame, b = inverse_ * b_frame, d = b - a;
    if (!outside(a) || !outside(b)) return false;
    Part part;
    part.cut(a.z(), d.z(), -half_, half_);
    cut_round(a, d, part);
    return part.s0 < part.s1;
  }
  // Integral of H dA: 2 pi r l / (2 r) for the side, and 2 pi r pi/2 in all for both rims, which are edges of
  // 90 degrees.
  CharacteristicLengths lengths() const {
    return {2.0 * std::min(radius_, half_),
            2.0 * radius_ * (2.0 * half_ + radius_) / (2.0 * half_ + std::numbers::pi * radius_),
            0.5 / radius_};
  }
  double curvature() const { return 0.0; }  // Curvature of the flat ends.

 private:
  // |a + s d|^2 <= r^2 in x and y: A s^2 + 2 B s + C <= 0.
  void cut_round(const Vec3& a, const Vec3& d, Part& part) const {
    const double A = d.head<2>().squaredNorm(), B = a.head<2>().dot(d.head<2>()),
                 C = a.head<2>().squaredNorm() - radius_ * radius_, root2 = B * B - A * C;
    if (A == 0.0 ? C >= 0.0 : root2 <= 0.0) return part.clear();
    if (A == 0.0) return;
    const double root = std::sqrt(root2);
    part.s0 = std::max(part.s0, (-B - root) / A);
    part.s1 = std::min(part.s1, (-B + root) / A);
  }
  bool outside(const Vec3& x) const {
    return std::abs(x.z()) > half_ || x.head<2>().squaredNorm() > radius_ * radius_;
  }
  Pose in_frame_, inverse_;
  double radius_, half_;
  Pose world_;
};

double length_of(const Settings& shape) { return std::get<double>(shape.at("length_m")); }

ObstaclePicture picture(const Settings& shape, const View&) {
  const double radius = radius_of(shape), length = length_of(shape);
  // The number of triangles around does not depend on the length.
  TriMesh surface = mesh::cylinder_surface(radius, radius, radius / 8.0);
  surface.vertices.row(2) *= length / radius;
  return {placed(std::move(surface), shape), {}};
}

/// Builds rings of quadrilaterals, two triangles each, and a fan over either end.
TriMesh surface(const Settings& shape, double spacing) {
  const double radius = radius_of(shape), length = length_of(shape), edge = spacing / std::numbers::sqrt2;
  const int around = std::max(8, static_cast<int>(std::ceil(2.0 * std::numbers::pi * radius / edge))),
            along = std::max(1, static_cast<int>(std::ceil(length / edge)));
  TriMesh out{Points(3, around * (along + 1) + 2), Faces(3, 2 * around * (along + 1))};
  const int low = around * (along + 1), high = low + 1;
  for (int i = 0; i <= along; ++i)
    for (int k = 0; k < around; ++k) {
      const double phi = 2.0 * std::numbers::pi * k / around;
      out.vertices.col(around * i + k) = Vec3(radius * std::cos(phi), radius * std::sin(phi),
                                              length * (static_cast<double>(i) / along - 0.5));
    }
  out.vertices.col(low) = Vec3(0.0, 0.0, -0.5 * length);
  out.vertices.col(high) = Vec3(0.0, 0.0, 0.5 * length);
  int face = 0;
  for (int k = 0; k < around; ++k) {
    const int next = (k + 1) % around;
    for (int i = 0; i < along; ++i) {
      const int below = around * i, above = below + around;
      out.faces.col(face++) = Eigen::Vector3i(below + k, below + next, above + next);
      out.faces.col(face++) = Eigen::Vector3i(below + k, above + next, above + k);
    }
    out.faces.col(face++) = Eigen::Vector3i(low, next, k);
    out.faces.col(face++) = Eigen::Vector3i(high, around * along + k, around * along + next);
  }
  return placed(std::move(out), shape);
}

}  // namespace

std::unique_ptr<SampleSource> make_cylinder_source(ContactSide side, int frame,
                                                   std::shared_ptr<MovingFrame> motion,
                                                   const Pose& pose_in_frame, double radius, double length,
                                                   double candidate_gap, double look_ahead) {
  if (!(radius > 0.0) || !std::isfinite(radius)) fail("cylinder: radius = {} must be positive", radius);
  if (!(length > 0.0) || !std::isfinite(length)) fail("cylinder: length = {} must be positive", length);
  return make_analytic_source(std::move(side), frame, std::move(motion),
                              Cylinder(pose_in_frame, radius, length), candidate_gap, look_ahead);
}

const ObstacleEntry& cylinder_obstacle() {
  static const ObstacleEntry entry = {
      "cylinder",
      "cylinder along its local z axis with flat ends, centred at position_m",
      {position_key("position of the centre"), rotation_key(),
       length_key("radius_m", "radius of the surface"),
       length_key("length_m", "length along the local z axis")},
      [](ContactSide side, int frame, std::shared_ptr<MovingFrame> motion, const Settings& shape, double gap,
         double look_ahead) {
        return make_cylinder_source(std::move(side), frame, std::move(motion), pose_of(shape),
                                    radius_of(shape), length_of(shape), gap, look_ahead);
      },
      [](const Settings& shape) {
        return Cylinder(pose_of(shape), radius_of(shape), length_of(shape)).lengths();
      },
      [](const Settings& shape, const Vec3& x) {
        return nearest_to(Cylinder(pose_of(shape), radius_of(shape), length_of(shape)), x);
      },
      picture,
      surface,
  };
  return entry;
}

}  // namespace palpate::contact
