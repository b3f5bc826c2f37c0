#include "contact/obstacles/sphere.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/analytic_source.h"
#include "contact/obstacles/keys.h"
#include "palpate/mesh/generators.h"

namespace palpate::contact {
namespace {

class Sphere {
 public:
  static constexpr const char* kName = "sphere";
  Sphere(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
  void move_to(const Pose& pose) { world_centre_ = pose * centre_; }
  // At the centre all directions are equivalent; one is chosen.
  Nearest at(const Vec3& x) const {
    const Vec3 from_centre = x - world_centre_;
    const double distance = from_centre.norm();
    return {distance - radius_, distance > 0.0 ? Vec3(from_centre / distance) : Vec3(Vec3::UnitZ()), radius_};
  }
  static constexpr bool kRound = true;
  // The larger root of |p + t n|^2 = r^2.
  double height(const Vec3& x, const Vec3& n) const {
    const Vec3 p = x - world_centre_;
    const double b = p.dot(n), root2 = b * b - p.squaredNorm() + radius_ * radius_;
    return root2 >= 0.0 ? std::sqrt(root2) - b : -std::numeric_limits<double>::infinity();
  }
  // Tests the point of the segment nearest to the centre.
  bool is_crossed(const Vec3& a, const Vec3& b) const {
    const Vec3 d = b - a, from_a = centre_ - a;
    const double length2 = d.squaredNorm(),
                 s = length2 > 0.0 ? std::clamp(from_a.dot(d) / length2, 0.0, 1.0) : 0.0;
    const double r2 = radius_ * radius_;
    return from_a.squaredNorm() > r2 && (centre_ - b).squaredNorm() > r2 &&
           (from_a - s * d).squaredNorm() < r2;
  }
  CharacteristicLengths lengths() const { return {2.0 * radius_, radius_, 0.0}; }
  double curvature() const { return 1.0 / radius_; }

 private:
  Vec3 centre_;
  double radius_;
  Vec3 world_centre_ = Vec3::Zero();
};

ObstaclePicture picture(const Settings& shape, const View&) {
  TriMesh ball = mesh::sphere(radius_of(shape), 24);
  ball.vertices.colwise() += position_of(shape);
  return {std::move(ball), {}};
}

}  // namespace

// The edges of an icosahedron are 1.05 R long, and the centres of its faces 0.795 R from its centre, so that
// an edge divided into n segments has length 1.32 R/n on the sphere there; elsewhere less.
TriMesh sphere_surface(double radius, double spacing) {
  return mesh::sphere(radius, std::max(4, static_cast<int>(std::ceil(1.33 * radius / spacing))));
}

std::unique_ptr<SampleSource> make_sphere_source(ContactSide side, int frame,
                                                 std::shared_ptr<MovingFrame> motion, const Vec3& centre,
                                                 double radius, double candidate_gap, double look_ahead) {
  if (!(radius > 0.0) || !std::isfinite(radius)) fail("sphere: radius = {} must be positive", radius);
  return make_analytic_source(std::move(side), frame, std::move(motion), Sphere(centre, radius),
                              candidate_gap, look_ahead);
}

const ObstacleEntry& sphere_obstacle() {
  static const ObstacleEntry entry = {
      "sphere",
      "ball of radius radius_m, centred at position_m",
      {position_key("position of the centre"), length_key("radius_m", "radius of the surface")},
      [](ContactSide side, int frame, std::shared_ptr<MovingFrame> motion, const Settings& shape, double gap,
         double look_ahead) {
        return make_sphere_source(std::move(side), frame, std::move(motion), position_of(shape),
                                  radius_of(shape), gap, look_ahead);
      },
      [](const Settings& shape) { return Sphere(position_of(shape), radius_of(shape)).lengths(); },
      [](const Settings& shape, const Vec3& x) {
        return nearest_to(Sphere(position_of(shape), radius_of(shape)), x);
      },
      picture,
      [](const Settings& shape, double spacing) {
        TriMesh ball = sphere_surface(radius_of(shape), spacing);
        ball.vertices.colwise() += position_of(shape);
        return ball;
      },
  };
  return entry;
}

}  // namespace palpate::contact
