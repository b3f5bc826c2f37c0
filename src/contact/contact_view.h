#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::contact {

/// Axes of a contact region: (u, v, w) about its origin, w along the normal from b to a.
struct ContactAxes {
  Mat3 to_world = Mat3::Identity();  ///< columns u, v, n
  Vec3 origin = Vec3::Zero();

  ContactAxes() = default;
  ContactAxes(const Vec3& region_origin, const Vec3& normal);
  void to_axes(const Points& world, Points& out) const {
    out.resize(3, world.cols());
    const Mat3 turn = to_world.transpose();
    for (Eigen::Index i = 0; i < world.cols(); ++i)  // of all at once Eigen would make a copy
      out.col(i).noalias() = turn * (world.col(i) - origin);
  }
  Vec3 in_axes(const Vec3& world) const { return to_world.transpose() * (world - origin); }
  Vec3 world(const Vec3& uvw) const { return origin + to_world * uvw; }
  Vec3 normal() const { return to_world.col(2); }
};

/// The orthographic camera of a region and what it sees: a rectangle of the plane, cut into square pixels,
/// and a slab along the normal.
struct ContactCamera {
  double u0 = 0, v0 = 0;      ///< lower left corner [m]
  double pixel = 0;           ///< edge of a pixel [m]
  int width = 0, height = 0;  ///< [pixels]
  double near = 0, far = 0;   ///< along w [m]

  bool sees_something() const { return width > 0 && far > near; }
  double u(int column) const { return u0 + (column + 0.5) * pixel; }
  double v(int row) const { return v0 + (row + 0.5) * pixel; }
};

/// Bounds in contact axes; empty as it is made.
struct AxisBox {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());
};

/// One surface in contact axes, and which of its faces the camera may see.
struct Patch {
  Points uvw;  ///< vertices
  const Faces* faces = nullptr;
  std::vector<int> visible;    ///< faces
  std::vector<AxisBox> boxes;  ///< theirs
};

inline AxisBox box_of(const Patch& patch, int face) {
  const auto corner = [&](int k) { return patch.uvw.col((*patch.faces)(k, face)); };
  return {corner(0).cwiseMin(corner(1)).cwiseMin(corner(2)),
          corner(0).cwiseMax(corner(1)).cwiseMax(corner(2))};
}

/// A rectangle of the plane and a slab along the normal [m].
struct ContactWindow {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  double near = 0, far = 0;

  double longer_edge() const { return (high - low).maxCoeff(); }
  bool is_empty() const { return !(longer_edge() > 0.0) || !std::isfinite(longer_edge()); }
};

/// Fits a window to the overlap of a (above) and b (below), and fills both patches' `visible`.
///
/// At a pixel the pair is a's lowest point against b's highest; it counts when that gap is under
/// `candidate_gap`.  So a's faces wholly above max(w of b) + candidate_gap, and b's wholly below min(w of a)
/// - candidate_gap, are of no interest; nor is anything outside the rectangle that both patches cover.
///   Leaving faces out shrinks the slab and that the rectangle, so the cut is repeated.
ContactWindow fit_window(Patch& a, Patch& b, double candidate_gap);

/// The camera of a window with pixels of the given edge [m]; sees nothing where the window is empty.
///
/// The pixels span one more than the rectangle, so that the grid may be shifted by a part of a pixel
/// (`shift`, in [0, 1)) and still cover it.
ContactCamera camera_of(const ContactWindow& window, double pixel, const Eigen::Vector2d& shift);
/// With this many pixels along the window's longer edge.
ContactCamera camera_of(const ContactWindow& window, int pixels, const Eigen::Vector2d& shift);
/// That of the window which fits a and b.
ContactCamera fit_camera(Patch& a, Patch& b, double candidate_gap, int pixels, const Eigen::Vector2d& shift);

}  // namespace palpate::contact
