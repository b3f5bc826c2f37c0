#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::contact {

/// Axes (u, v, w) of a contact region about its origin, w along the normal from b to a.
struct ContactAxes {
  Mat3 to_world = Mat3::Identity();  ///< Columns u, v, n in world axes.
  Vec3 origin = Vec3::Zero();

  ContactAxes() = default;
  ContactAxes(const Vec3& region_origin, const Vec3& normal);
  /// Transforms world positions to the axes, one point per column.
  void to_axes(const Points& world, Points& out) const {
    out.resize(3, world.cols());
    const Mat3 turn = to_world.transpose();
    // Per point: for the whole matrix Eigen would make a copy.
    for (Eigen::Index i = 0; i < world.cols(); ++i) out.col(i).noalias() = turn * (world.col(i) - origin);
  }
  Vec3 in_axes(const Vec3& world) const { return to_world.transpose() * (world - origin); }
  Vec3 world(const Vec3& uvw) const { return origin + to_world * uvw; }
  Vec3 normal() const { return to_world.col(2); }
};

/// Orthographic camera of a contact region: a rectangle of the plane divided into square pixels, and a slab
/// along the normal.
struct ContactCamera {
  double u0 = 0, v0 = 0;      ///< Lower left corner [m].
  double pixel = 0;           ///< Edge length of a pixel [m].
  int width = 0, height = 0;  ///< Size of the image [pixels].
  double near = 0, far = 0;   ///< Limits of the slab along w [m].

  bool sees_something() const { return width > 0 && far > near; }
  double u(int column) const { return u0 + (column + 0.5) * pixel; }
  double v(int row) const { return v0 + (row + 0.5) * pixel; }
};

/// Bounding box in contact axes; empty by default.
struct AxisBox {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());
};

/// One surface in contact axes, and its faces that the camera may see.
struct Patch {
  Points uvw;  ///< Vertices [m].
  const Faces* faces = nullptr;
  std::vector<int> visible;    ///< Faces that may be visible.
  std::vector<AxisBox> boxes;  ///< Bounding boxes of these faces.
};

/// Returns the bounding box of a face.
inline AxisBox box_of(const Patch& patch, int face) {
  const auto corner = [&](int k) { return patch.uvw.col((*patch.faces)(k, face)); };
  return {corner(0).cwiseMin(corner(1)).cwiseMin(corner(2)),
          corner(0).cwiseMax(corner(1)).cwiseMax(corner(2))};
}

/// Rectangle of the plane and slab along the normal [m].
struct ContactWindow {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  double near = 0, far = 0;

  double longer_edge() const { return (high - low).maxCoeff(); }
  bool is_empty() const { return !(longer_edge() > 0.0) || !std::isfinite(longer_edge()); }
};

/// Fits a window to the overlap of a (above) and b (below), and sets `visible` of both patches.
///
/// At a pixel the pair is a's lowest point and b's highest; it counts if their gap is less than
/// `candidate_gap`. Faces of a entirely above max(w of b) + candidate_gap, faces of b entirely below min(w of
/// a) - candidate_gap, and everything outside the rectangle that both patches cover are removed. Removing
/// faces shrinks the slab and thereby the rectangle, so the cut is repeated.
ContactWindow fit_window(Patch& a, Patch& b, double candidate_gap);

/// Returns the camera of a window with pixels of the given edge [m]; it sees nothing where the window is
/// empty.
///
/// The image is one pixel larger than the rectangle, so that the grid may be shifted by a fraction of a pixel
/// (`shift`, in [0, 1)) and still cover it.
ContactCamera camera_of(const ContactWindow& window, double pixel, const Eigen::Vector2d& shift);
/// Returns the camera of a window with the given number of pixels along the window's longer edge.
ContactCamera camera_of(const ContactWindow& window, int pixels, const Eigen::Vector2d& shift);
/// Returns the camera of the window that fits a and b.
ContactCamera fit_camera(Patch& a, Patch& b, double candidate_gap, int pixels, const Eigen::Vector2d& shift);

}  // namespace palpate::contact
