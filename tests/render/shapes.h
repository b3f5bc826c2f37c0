#pragma once
#include <cmath>
#include <numbers>

#include "render/scene.h"

/// A ball of `n` bands from pole to pole: its silhouette is a polygon within r (1 - cos(pi / 2n)) of the
/// circle.
inline palpate::render::Surface ball_surface(const palpate::Vec3& centre, double radius, int n) {
  using std::numbers::pi;
  palpate::render::Surface surface;
  const int around = 2 * n;
  surface.points.resize(3, (n + 1) * around);
  surface.faces.resize(3, 2 * n * around - 2 * around);
  int face = 0;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j < around; ++j) {
      const double polar = pi * i / n, azimuth = 2.0 * pi * j / around;
      surface.points.col(i * around + j) =
          centre + radius * palpate::Vec3(std::sin(polar) * std::cos(azimuth),
                                          std::sin(polar) * std::sin(azimuth), std::cos(polar));
      const int a = i * around + j, b = i * around + (j + 1) % around;
      if (i > 0 && i < n) surface.faces.col(face++) = Eigen::Vector3i(a, b + around, b);
      if (i < n - 1) surface.faces.col(face++) = Eigen::Vector3i(a, a + around, b + around);
    }
  }
  return surface;
}

/// The unit cube [0, 1]^3 with shared corners, outward faces.
inline palpate::render::Surface cube_surface() {
  palpate::render::Surface surface;
  surface.points.resize(3, 8);
  for (int i = 0; i < 8; ++i) surface.points.col(i) = palpate::Vec3(i & 1, i >> 1 & 1, i >> 2 & 1);
  surface.faces.resize(3, 12);
  surface.faces << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1, 2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7, 3, 1, 7, 6, 5, 4,
      7, 3, 6, 2, 7, 5;
  return surface;
}

/// Camera looking along +y at the origin, parallel projection: world x to the right, world z up;
/// `half_height` metres from the centre to the top.
inline palpate::render::Camera front_camera(double half_height) {
  palpate::render::Camera camera;
  camera.eye = {0.0, -10.0 * half_height, 0.0};
  camera.perspective = false;
  camera.half_height = half_height;
  camera.near = half_height;
  camera.far = 20.0 * half_height;
  return camera;
}
