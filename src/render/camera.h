#pragma once
#include <optional>

#include "palpate/core/types.h"

namespace palpate::render {

/// Camera at `eye`, directed at `target`.
struct Camera {
  Vec3 eye = Vec3(0, -1, 0), target = Vec3::Zero();  ///< world [m]
  Vec3 up = Vec3::UnitZ();                           ///< Approximate upward direction of the image.
  bool perspective = true;                           ///< Otherwise orthographic.
  /// Half of the image's height: tangent of half the viewing angle, or [m] when orthographic.
  double half_height = 0.25;
  /// Position of the target in the image, in half image sizes from its centre.
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double near = 0.01, far = 10.0;  ///< Clipping distances along the line of sight [m].
};

/// Direction and angle of a camera that frames a scene automatically.
struct View {
  double azimuth_deg = -60.0;   ///< Azimuth of the eye about z, from +x [degrees].
  double elevation_deg = 22.0;  ///< Elevation of the eye above the horizon [degrees]; less than 90.
  bool perspective = true;
  double angle_deg = 26.0;  ///< Viewing angle of the image's height, in perspective [degrees].
  /// Direction from the scene to the eye, not zero; replaces azimuth and elevation.
  std::optional<Vec3> backwards = {};
  Vec3 up = Vec3::UnitZ();          ///< Upward direction of the image; not zero.
  std::optional<Vec3> target = {};  ///< Point shown in the middle [m]; empty: the middle of the scene.
  double zoom = 1.0;                ///< Magnification; 1 shows the whole scene.
};

/// Margins of the image, as fractions of its size, that the scene leaves free.
struct Margins {
  double left = 0.06, right = 0.06, top = 0.06, bottom = 0.06;
};

/// Returns the nearest camera that shows all points inside the margins; with the target of the view, the same
/// camera moved sideways; with a zoom, with a narrower viewing angle.
/// @param points  not empty, finite
/// @param aspect  width over height
Camera framed(const Points& points, const View& view, double aspect, const Margins& margins);

/// Returns the axes of a camera; columns: right, up, backwards (from the scene to the eye).
Mat3 camera_axes(const Vec3& backwards, const Vec3& up);

/// Returns the unit vector from the scene to the eye.
Vec3 backwards_of(const View& view);

/// Returns the matrix from world to clip coordinates, in OpenGL's convention (z in [-1, 1]).
Eigen::Matrix4d view_projection(const Camera& camera, double aspect);

}  // namespace palpate::render
