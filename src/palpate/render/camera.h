#pragma once
#include "palpate/core/types.h"

namespace palpate::render {

/// Looks from `eye` at `target`.
struct Camera {
  Vec3 eye = Vec3(0, -1, 0), target = Vec3::Zero();  ///< world [m]
  Vec3 up = Vec3::UnitZ();
  bool perspective = true;
  /// of the image: tangent of half its angle, or [m] when orthographic
  double half_height = 0.25;
  /// where the target falls, in halves of the image from its centre
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double near = 0.01, far = 10.0;  ///< along the line of sight [m]
};

/// Where a camera stands that frames a scene by itself.
struct View {
  double azimuth_deg = -60.0;   ///< of the eye about z, from +x
  double elevation_deg = 22.0;  ///< of the eye above the horizon; less than 90
  bool perspective = true;
  double angle_deg = 26.0;  ///< of the image's height, in perspective
};

/// Parts of the image, as fractions of its size, that stay free of the scene.
struct Margins {
  double left = 0.06, right = 0.06, top = 0.06, bottom = 0.06;
};

/// The camera nearest to the points that shows them all inside the margins.
/// @param points  not empty, finite
/// @param aspect  width over height
Camera framed(const Points& points, const View& view, double aspect, const Margins& margins);

/// World to clip coordinates, OpenGL's convention (z in [-1, 1]).
Eigen::Matrix4d view_projection(const Camera& camera, double aspect);

}  // namespace palpate::render
