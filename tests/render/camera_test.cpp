#include "render/camera.h"

#include <gtest/gtest.h>

#include <random>

#include "palpate/core/error.h"

using namespace palpate;
using render::Camera;

namespace {

Points random_points(int n) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Points points(3, n);
  for (double& x : points.reshaped()) x = uniform(generator);
  points.row(0).array() = 3.0 * points.row(0).array() + 100.0;  // long, and far from the origin
  return points;
}

/// Normalised device coordinates.
Points projected(const Camera& camera, double aspect, const Points& points) {
  return (render::view_projection(camera, aspect) * points.colwise().homogeneous()).colwise().hnormalized();
}

}  // namespace

TEST(ViewProjection, PutsTheTargetAtTheShiftAndTheTopAtTheEdge) {
  Camera camera;
  camera.eye = {0, -5, 2};
  camera.target = {0, 0, 2};
  camera.shift = {-0.25, 0.1};
  for (const bool perspective : {true, false}) {
    camera.perspective = perspective;
    camera.half_height = perspective ? 0.2 : 1.0;  // 5 m away, a tangent of 0.2 is 1 m
    Points points(3, 3);
    points.col(0) = camera.target;
    points.col(1) = camera.target + Vec3(0, 0, 1.0);
    points.col(2) = camera.target + Vec3(1.5, 0, 0);
    const Points p = projected(camera, 1.5, points);
    EXPECT_LT((p.col(0).head<2>() - camera.shift).norm(), 1e-12);
    EXPECT_LT((p.col(1).head<2>() - camera.shift - Eigen::Vector2d(0, 1)).norm(), 1e-12);
    EXPECT_LT((p.col(2).head<2>() - camera.shift - Eigen::Vector2d(1, 0)).norm(), 1e-12);
  }
}

TEST(ViewProjection, MapsNearAndFarToTheEndsOfDepth) {
  Camera camera;
  camera.near = 0.5;
  camera.far = 8.0;
  for (const bool perspective : {true, false}) {
    camera.perspective = perspective;
    Points points(3, 2);
    points << 0, 0, -0.5, 7.0, 0, 0;  // the eye is at (0, -1, 0)
    const Points p = projected(camera, 1.0, points);
    EXPECT_NEAR(p(2, 0), -1.0, 1e-12);
    EXPECT_NEAR(p(2, 1), 1.0, 1e-12);
  }
}

TEST(Framed, ShowsEveryPointInsideTheMarginsAndNoSmallerThanItMust) {
  const Points points = random_points(500);
  const double aspect = 1.6;
  const render::Margins margins{0.05, 0.2, 0.1, 0.15};
  int checked = 0;
  for (const double azimuth : {-60.0, 30.0, 200.0})
    for (const double elevation : {-30.0, 0.0, 22.0, 90.0})
      for (const bool perspective : {true, false}) {
        const Camera camera =
            render::framed(points, {azimuth, elevation, perspective, 26.0}, aspect, margins);
        const Points p = projected(camera, aspect, points);
        const double left = p.row(0).minCoeff(), right = p.row(0).maxCoeff(), bottom = p.row(1).minCoeff(),
                     top = p.row(1).maxCoeff();
        // A margin is a fraction of the image, whose coordinates are from -1 to 1 here.
        EXPECT_GE(left, -1.0 + 2.0 * margins.left - 1e-9);
        EXPECT_LE(right, 1.0 - 2.0 * margins.right + 1e-9);
        EXPECT_GE(bottom, -1.0 + 2.0 * margins.bottom - 1e-9);
        EXPECT_LE(top, 1.0 - 2.0 * margins.top + 1e-9);
        const double free_x = 2.0 * (1.0 - margins.left - margins.right),
                     free_y = 2.0 * (1.0 - margins.bottom - margins.top);
        EXPECT_NEAR(std::max((right - left) / free_x, (top - bottom) / free_y), 1.0, 1e-9);
        EXPECT_GT(p.row(2).minCoeff(), -1.0);
        EXPECT_LT(p.row(2).maxCoeff(), 1.0);
        ++checked;
      }
  EXPECT_EQ(checked, 24);
}

TEST(Framed, TakesASinglePoint) {
  for (const bool perspective : {true, false}) {
    const Points point = Vec3(1, 2, 3);
    const Camera camera = render::framed(point, {.perspective = perspective}, 1.0, {0, 0, 0, 0});
    EXPECT_LT(projected(camera, 1.0, point).col(0).head<2>().norm(), 1e-6);
  }
}

TEST(Framed, RefusesNothingAndTheNonFinite) {
  EXPECT_THROW(render::framed(Points(3, 0), {}, 1.0, {}), InternalError);
  EXPECT_THROW(render::framed(Points::Constant(3, 1, std::nan("")), {}, 1.0, {}), InternalError);
}

TEST(Framed, ATargetIsInTheMiddleAndAZoomMagnifiesAboutIt) {
  const Points points = random_points(200);
  const double aspect = 1.5;
  const render::Margins margins{0.05, 0.25, 0.1, 0.1};
  const Eigen::Vector2d middle(-0.2, 0.0);  // of the part of the image inside the margins
  render::View view;
  view.target = points.col(17);
  const Camera whole = render::framed(points, view, aspect, margins);
  view.zoom = 3.0;
  const Camera near = render::framed(points, view, aspect, margins);
  EXPECT_LT((projected(whole, aspect, points).col(17).head<2>() - middle).norm(), 1e-9);
  const Points at_1 = projected(whole, aspect, points), at_3 = projected(near, aspect, points);
  for (int i = 0; i < 200; ++i)
    EXPECT_LT((at_3.col(i).head<2>() - middle - 3.0 * (at_1.col(i).head<2>() - middle)).norm(), 1e-9) << i;
  EXPECT_LE(at_1.row(2).maxCoeff(), 1.0);  // nothing is clipped
  EXPECT_GE(at_1.row(2).minCoeff(), -1.0);
}

TEST(Framed, TakesADirectionAndAnUpwardAxis) {
  const Points points = random_points(100);
  render::View view;
  view.backwards = Vec3(0, 0, 2);
  view.up = Vec3(1, 0, 0);
  const Camera camera = render::framed(points, view, 1.0, {});
  EXPECT_LT((render::backwards_of(view) - Vec3::UnitZ()).norm(), 1e-12);
  const Mat3 axes = render::camera_axes(camera.eye - camera.target, camera.up);
  EXPECT_LT((axes.col(1) - Vec3::UnitX()).norm(), 1e-9);
  EXPECT_LT((axes.col(2) - Vec3::UnitZ()).norm(), 1e-9);
}
