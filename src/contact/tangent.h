#pragma once
#include "contact/sample_math.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/point_stiffness.h"
#include "palpate/dynamics/sparse_border.h"

namespace palpate::contact {

using Mat36 = Eigen::Matrix<double, 3, 6>;
using Mat63 = Eigen::Matrix<double, 6, 3>;

/// One side of a sample as a map from u-directions to its point, and back from forces.
///
/// The point moves by dx = sum_i w_i dx_i (nodes) or dx = Z dxi, Z = [-[r]x, I] (frame; dxi = (dtheta, dp),
/// arm r = R o + s; see tangent.cpp for the slide s). Forces are mapped back by the transpose: w_i F on node
/// i, (r x F, F) on the frame. `sign` is +1 for a, -1 for b: x_rel = sum of sign * x.
struct Side {
  const SurfacePoint& point;
  const FrameState* frame;  ///< Null for nodes.
  double sign;
  Vec3 arm;  ///< Frames only: r [m].
  Mat36 Z;   ///< Frames only: Z.
  /// Frames only: the point's velocity v = v0 + w x r changes by w x (dtheta x R o) = V dtheta, V = -[w]x [R
  /// o]x, when the frame rotates with constant twist.
  Mat3 V;
  Mat3 G;  ///< Frames only: [F]x [R o]x, with F the force on a: see `geometric` in tangent.cpp.

  Side(const SurfacePoint& surface_point, const PointMotion& motion, const std::vector<FrameState>& frames,
       double side_sign, const Vec3& force_on_a);
  bool is_nodes() const { return frame == nullptr; }
};

/// Adds k_scale K + d_scale D of one sample to A, for the sides that have rows in the State.
void add_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                        int nodal_size, dynamics::BorderedMatrix& A);
/// Adds k_scale K + d_scale D of one sample: the part on nodes to C, rows and columns of frames in the State
/// to `border`. The nodes' part is symmetric only where K and D are.
void add_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                        int nodal_size, dynamics::PointStiffness& C, dynamics::SparseBorder& border);
/// Adds (k_scale K + d_scale D) x of one sample to y.
void apply_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                          const VecX& x, VecX& y);
/// Adds a force at a surface point to f: on its nodes or, where frame_row >= 0, moment and force on the six
/// rows from there.
void add_point_force(const SurfacePoint& point, const Vec3& arm, const Vec3& force, int frame_row, VecX& f);

}  // namespace palpate::contact
