#pragma once
#include <algorithm>
#include <cmath>

#include "mesh/layered_model.h"
#include "palpate/mesh/generators.h"
#include "proxy/decompose.h"

/// A bar around a chain of three bones, bent in its middle until its arms collide.
namespace bent_bar {

using namespace palpate;

/// [m]; the middle bone extends from -kMiddle to kMiddle
inline constexpr double kLength = 1.8, kWidth = 0.3, kHeight = 0.24, kMiddle = 0.4;

/// Maps a point of the straight bar along x to the bar bent by `angle`: |x| < kMiddle lies on an arc with +z
/// inwards, and the arms are straight.
inline Vec3 bend(const Vec3& x, double angle) {
  if (angle == 0.0) return x;
  const double r = 2.0 * kMiddle / angle, along = std::clamp(x.x(), -kMiddle, kMiddle), phi = along / r,
               beyond = x.x() - along;
  const Vec3 tangent(std::cos(phi), 0, std::sin(phi)), inwards(-std::sin(phi), 0, std::cos(phi));
  return Vec3(r * std::sin(phi), x.y(), r * (1.0 - std::cos(phi))) + beyond * tangent + x.z() * inwards;
}

inline Points bend(const Points& straight, double angle) {
  Points out(3, straight.cols());
  for (Eigen::Index i = 0; i < straight.cols(); ++i) out.col(i) = bend(Vec3(straight.col(i)), angle);
  return out;
}

/// Angle at which the inner edges of the tips overlap by about `depth`, found by bisection; the distance from
/// tip to tip is 2 (r sin(phi) - l sin(alpha) - h cos(alpha) / 2), phi = angle / 2 = pi / 2 + alpha.
inline double closing_angle(double depth) {
  const auto apart = [](double angle) {
    return 2.0 * bend(Vec3(0.5 * kLength, 0, 0.5 * kHeight), angle).x();
  };
  double low = M_PI, high = 1.6 * M_PI;
  while (high - low > 1e-12) (apart(0.5 * (low + high)) > -depth ? low : high) = 0.5 * (low + high);
  return low;
}

/// The bar, bent by `rest_angle` at rest; nodes on its axis within a bone are carried by the bone.
/// @param count  number of proxies, split by bone
inline LayeredModel model(int count = 24, double rest_angle = 0.0) {
  LayeredModel bar;
  bar.name = "bar";
  const Vec3 size(kLength, kWidth, kHeight);
  bar.tets = mesh::box(size, {18, 2, 2});
  bar.skin = mesh::box_surface(size, {54, 9, 9});
  // from and to of the middle bone, and of each arm
  const double ends[] = {-kMiddle, kMiddle, -kMiddle, -0.5 * kLength, kMiddle, 0.5 * kLength}, tissue = 0.15;
  const char* names[] = {"middle", "left", "right"};
  const auto on_axis = [&](double x) { return bend(Vec3(x, 0, 0), rest_angle); };
  for (std::size_t i = 0; i < 3; ++i)
    bar.skeleton.bones.push_back(
        {names[i], i == 0 ? -1 : 0, on_axis(ends[2 * i]), on_axis(ends[2 * i + 1]), 0.05, 0.05});
  for (Eigen::Index n = 0; n < bar.tets.nodes.cols(); ++n) {
    const Vec3 x = bar.tets.nodes.col(n);
    const bool bone = x.tail<2>().norm() < 1e-9 && std::abs(std::abs(x.x()) - kMiddle) > tissue - 1e-9;
    bar.bone_of_node.push_back(!bone ? -1 : x.x() < -kMiddle ? 1 : x.x() > kMiddle ? 2 : 0);
  }
  bar.tets.nodes = bend(bar.tets.nodes, rest_angle);
  bar.skin.vertices = bend(bar.skin.vertices, rest_angle);
  bar.embedding = mesh::embed(bar.tets, bar.skin.vertices);
  bar.proxies = proxy::decompose(bar, {.count = count});
  return bar;
}

}  // namespace bent_bar
