#include "contact/obstacles/plane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/analytic_source.h"
#include "contact/obstacles/keys.h"

namespace palpate::contact {
namespace {

class Plane {
 public:
  static constexpr const char* kName = "plane";
  Plane(const Vec3& point, const Vec3& normal) : point_(point), normal_(normal.normalized()) {}
  void move_to(const Pose& pose) {
    world_normal_ = pose.rotation * normal_;
    world_point_ = pose * point_;
  }
  Nearest at(const Vec3& x) const { return {world_normal_.dot(x - world_point_), world_normal_}; }
  static constexpr bool kRound = true;
  double height(const Vec3& x, const Vec3& n) const {
    const double along = world_normal_.dot(n);
    return along > 0.0 ? world_normal_.dot(world_point_ - x) / along
                       : -std::numeric_limits<double>::infinity();
  }
  bool is_crossed(const Vec3&, const Vec3&) const { return false; }  // Beyond the plane everything is inside.
  CharacteristicLengths lengths() const { return {HUGE_VAL, HUGE_VAL, 0.0}; }
  double curvature() const { return 0.0; }

 private:
  Vec3 point_, normal_;
  Vec3 world_point_ = Vec3::Zero(), world_normal_ = Vec3::UnitZ();
};

Vec3 normal_of(const Settings& shape) { return std::get<Vec3>(shape.at("normal")); }

std::string fault_of_normal(const Setting& value) {
  return std::get<Vec3>(value).norm() < 1e-12 ? "has no direction; [0, 0, 1] is up" : "";
}

/// Makes a square centred at the point of the plane nearest to the centre of the view.
ObstaclePicture picture(const Settings& shape, const View& view) {
  const Vec3 normal = normal_of(shape).normalized();
  ObstaclePicture out;
  if (normal.z() > 0.999) out.ground_m = position_of(shape).z();
  const Vec3 middle = view.centre - normal * normal.dot(view.centre - position_of(shape)),
             along = normal.unitOrthogonal(), across = normal.cross(along);
  out.surface.vertices.resize(3, 4);
  for (int i = 0; i < 4; ++i)
    out.surface.vertices.col(i) =
        middle +
        0.5 * view.extent * ((i == 0 || i == 3 ? -1.0 : 1.0) * along + (i < 2 ? -1.0 : 1.0) * across);
  out.surface.faces.resize(3, 2);
  out.surface.faces << 0, 0, 1, 2, 2, 3;
  return out;
}

}  // namespace

std::unique_ptr<SampleSource> make_plane_source(ContactSide side, int frame,
                                                std::shared_ptr<MovingFrame> motion, const Vec3& point,
                                                const Vec3& normal, double candidate_gap, double look_ahead) {
  if (!(normal.norm() > 0.0) || !normal.allFinite())
    fail("plane: normal = ({}, {}, {}) has no direction", normal.x(), normal.y(), normal.z());
  return make_analytic_source(std::move(side), frame, std::move(motion), Plane(point, normal), candidate_gap,
                              look_ahead);
}

const ObstacleEntry& plane_obstacle() {
  static const ObstacleEntry entry = {
      "plane",
      "half-space below a plane through position_m",
      {position_key("a point in the plane"),
       {.name = "normal",
        .fallback = Vec3(Vec3::UnitZ()),
        .meaning = "outward normal, of any length",
        .fault = fault_of_normal}},
      [](ContactSide side, int frame, std::shared_ptr<MovingFrame> motion, const Settings& shape, double gap,
         double look_ahead) {
        return make_plane_source(std::move(side), frame, std::move(motion), position_of(shape),
                                 normal_of(shape), gap, look_ahead);
      },
      [](const Settings&) {
        return CharacteristicLengths{HUGE_VAL, HUGE_VAL, 0.0};
      },
      [](const Settings& shape, const Vec3& x) {
        return nearest_to(Plane(position_of(shape), normal_of(shape)), x);
      },
      picture,
  };
  return entry;
}

}  // namespace palpate::contact
