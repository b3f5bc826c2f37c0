#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "palpate/core/error.h"

namespace palpate::render {
Mat3 camera_axes(const Vec3& backwards, const Vec3& up) {
  Mat3 axes;
  axes.col(2) = backwards.normalized();
  Vec3 right = up.cross(axes.col(2));
  // The line of sight is parallel to `up`.
  if (right.norm() < 1e-9) right = Vec3::UnitY().cross(axes.col(2));
  if (right.norm() < 1e-9) right = Vec3::UnitX();
  axes.col(0) = right.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Vec3 backwards_of(const View& view) {
  if (view.backwards) return view.backwards->normalized();
  const double degree = std::numbers::pi / 180.0;
  const double azimuth = view.azimuth_deg * degree, elevation = view.elevation_deg * degree;
  return {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

// In camera axes about the middle of the points, with its target at (cx, cy, 0) and the eye a distance d
// behind, a point p appears at x = (px - cx) / ((d - pz) t), where t is the tangent of half the image's
// angle. |x| <= 1 for all points means px + t pz - cx <= t d and -px + t pz + cx <= t d: with R and L the
// maxima of px + t pz and -px + t pz, the nearest eye has d = (R + L) / (2 t) at cx = (R - L) / 2.  The
// vertical direction is analogous; the larger d serves both.  Margins shrink t, and shift the image by their
// difference.
Camera framed(const Points& points, const View& view, double aspect, const Margins& margins) {
  PALPATE_CHECK(points.cols() > 0 && points.allFinite(), "{} points to frame", points.cols());
  const double degree = std::numbers::pi / 180.0;
  PALPATE_CHECK(view.zoom > 0.0, "zoom {}", view.zoom);
  const Mat3 axes = camera_axes(backwards_of(view), view.up);
  const Vec3 middle = 0.5 * (points.rowwise().minCoeff() + points.rowwise().maxCoeff());
  const Points p = axes.transpose() * (points.colwise() - middle);
  const double front = p.row(2).maxCoeff(), behind = p.row(2).minCoeff();

  Camera camera;
  camera.up = view.up;
  camera.perspective = view.perspective;
  camera.shift = {margins.left - margins.right, margins.bottom - margins.top};
  const double width = 1.0 - margins.left - margins.right, height = 1.0 - margins.bottom - margins.top;
  const double tangent = std::tan(0.5 * view.angle_deg * degree);
  const double tx = view.perspective ? tangent * aspect * width : 0.0,
               ty = view.perspective ? tangent * height : 0.0;
  const auto reach = [&](int row, double sign, double t) {
    return (sign * p.row(row) + t * p.row(2)).maxCoeff();
  };
  const double right = reach(0, 1.0, tx), left = reach(0, -1.0, tx), top = reach(1, 1.0, ty),
               bottom = reach(1, -1.0, ty);
  const double depth = std::max(front - behind, 1e-6 * (1.0 + middle.norm()));
  double distance = front + 2.0 * depth;
  if (view.perspective) {
    distance = std::max({(right + left) / (2.0 * tx), (top + bottom) / (2.0 * ty), front + 0.05 * depth});
    camera.half_height = tangent;
  } else {
    camera.half_height =
        std::max({(right + left) / (2.0 * aspect * width), (top + bottom) / (2.0 * height), 1e-9});
  }
  // A target moves the camera sideways only: its distance from the scene, and so its clipping planes, stay.
  Vec3 centre((right - left) / 2.0, (top - bottom) / 2.0, 0.0);
  if (view.target) centre.head<2>() = (axes.transpose() * (*view.target - middle)).head<2>();
  camera.half_height /= view.zoom;
  camera.target = middle + axes * centre;
  camera.eye = middle + axes * (centre + Vec3(0, 0, distance));
  camera.near = std::max(0.5 * (distance - front), 1e-3 * distance);
  camera.far = distance - behind + 40.0 * depth;  // The ground extends behind the scene.
  return camera;
}

Eigen::Matrix4d view_projection(const Camera& camera, double aspect) {
  const Mat3 axes = camera_axes(camera.eye - camera.target, camera.up);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = axes.transpose();
  view.topRightCorner<3, 1>() = -axes.transpose() * camera.eye;

  const double n = camera.near, f = camera.far, h = camera.half_height;
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = 1.0 / (h * aspect);
  projection(1, 1) = 1.0 / h;
  if (camera.perspective) {
    projection(0, 2) = -camera.shift.x();
    projection(1, 2) = -camera.shift.y();
    projection(2, 2) = -(f + n) / (f - n);
    projection(2, 3) = -2.0 * f * n / (f - n);
    projection(3, 2) = -1.0;
  } else {
    projection(0, 3) = camera.shift.x();
    projection(1, 3) = camera.shift.y();
    projection(2, 2) = -2.0 / (f - n);
    projection(2, 3) = -(f + n) / (f - n);
    projection(3, 3) = 1.0;
  }
  return projection * view;
}

}  // namespace palpate::render
