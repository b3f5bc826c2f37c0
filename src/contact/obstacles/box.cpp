#include "contact/obstacles/box.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/analytic_source.h"
#include "contact/obstacles/keys.h"
#include "contact/segment_part.h"
#include "palpate/mesh/generators.h"

namespace palpate::contact {
namespace {

/// Box |x_i| <= h_i in its axes. Outside, e_i = max(|x_i| - h_i, 0) is the vector from the nearest point,
/// without signs.
class Box {
 public:
  static constexpr const char* kName = "box";
  Box(const Pose& pose_in_frame, const Vec3& size)
      : in_frame_(pose_in_frame), inverse_(pose_in_frame.inverse()), half_(0.5 * size) {}
  void move_to(const Pose& pose) { world_ = pose * in_frame_; }
  Nearest at(const Vec3& world) const {
    const Vec3 x = world_.inverse() * world, beyond = x.cwiseAbs() - half_, out = beyond.cwiseMax(0.0);
    const double distance = out.norm();
    Vec3 normal;
    if (distance > 0.0) {
      normal = out / distance;
    } else {
      Eigen::Index face;
      beyond.maxCoeff(&face);
      normal = Vec3::Unit(face);
    }
    for (int i = 0; i < 3; ++i)
      if (x[i] < 0.0) normal[i] = -normal[i];
    return {distance > 0.0 ? distance : beyond.maxCoeff(), world_.rotation * normal};
  }
  static constexpr bool kRound = false;
  double height(const Vec3& world, const Vec3& n) const {
    const Vec3 x = world_.inverse() * world, d = world_.rotation.conjugate() * n;
    Part part = Part::line();
    for (int i = 0; i < 3; ++i) part.cut(x[i], d[i], -half_[i], half_[i]);
    return part.end();
  }
  bool is_crossed(const Vec3& a_frame, const Vec3& b_frame) const {
    const Vec3 a = inverse_ * a_frame, b = inverse_ * b_frame;
    if (!outside(a) || !outside(b)) return false;
    Part part;
    for (int i = 0; i < 3; ++i) part.cut(a[i], b[i] - a[i], -half_[i], half_[i]);
    return part.s0 < part.s1;
  }
  // Integral of H dA: half of the edges' total length, 4 (a + b + c), times their angle pi/2.
  CharacteristicLengths lengths() const {
    const Vec3 size = 2.0 * half_;
    const double area = 2.0 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    return {size.minCoeff(), area / (std::numbers::pi * size.sum()), 0.0};
  }
  double curvature() const { return 0.0; }

 private:
  bool outside(const Vec3& x) const { return ((x.cwiseAbs() - half_).array() > 0.0).any(); }
  Pose in_frame_, inverse_;
  Vec3 half_;
  Pose world_;
};

Vec3 size_of(const Settings& shape) { return std::get<Vec3>(shape.at("size_m")); }

ObstaclePicture picture(const Settings& shape, const View&) {
  return {placed(mesh::box_surface(size_of(shape), {1, 1, 1}), shape), {}};
}

}  // namespace

std::unique_ptr<SampleSource> make_box_source(ContactSide side, int frame,
                                              std::shared_ptr<MovingFrame> motion, const Pose& pose_in_frame,
                                              const Vec3& size, double candidate_gap, double look_ahead) {
  if (!(size.minCoeff() > 0.0) || !size.allFinite())
    fail("box: size = ({}, {}, {}) must be positive", size.x(), size.y(), size.z());
  return make_analytic_source(std::move(side), frame, std::move(motion), Box(pose_in_frame, size),
                              candidate_gap, look_ahead);
}

const ObstacleEntry& box_obstacle() {
  static const ObstacleEntry entry = {
      "box",
      "box with edge lengths size_m, centred at position_m",
      {position_key("position of the centre"),
       rotation_key(),
       {.name = "size_m",
        .range = MeshRanges::length,
        .required = true,
        .fallback = Vec3(Vec3::Ones()),
        .meaning = "edge lengths along the local axes"}},
      [](ContactSide side, int frame, std::shared_ptr<MovingFrame> motion, const Settings& shape, double gap,
         double look_ahead) {
        return make_box_source(std::move(side), frame, std::move(motion), pose_of(shape), size_of(shape), gap,
                               look_ahead);
      },
      [](const Settings& shape) { return Box(pose_of(shape), size_of(shape)).lengths(); },
      [](const Settings& shape, const Vec3& x) { return nearest_to(Box(pose_of(shape), size_of(shape)), x); },
      picture,
      // Flat: points are created by subdivision; an edge has at most sixteen segments.
      [](const Settings& shape, double spacing) {
        std::array<int, 3> cells;
        for (int i = 0; i < 3; ++i)
          cells[static_cast<std::size_t>(i)] =
              std::max(1, static_cast<int>(std::ceil(1.5 * size_of(shape)[i] / (16.0 * spacing))));
        return placed(mesh::box_surface(size_of(shape), cells), shape);
      },
  };
  return entry;
}

}  // namespace palpate::contact
