#pragma once
#include "contact/sample_math.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::contact {

using Mat36 = Eigen::Matrix<double, 3, 6>;
using Mat63 = Eigen::Matrix<double, 6, 3>;

/// One side of a sample as a map from u-directions to its point, and back from forces.
///
/// The point moves as  dx = sum_i w_i dx_i  (nodes)  or  dx = Z dxi, Z = [-[r]x, I]  (a frame; dxi = (dtheta,
/// dp), arm r = R o + s; see tangent.cpp for the slide s). Forces go back by the transpose: w_i F on node i,
/// (r x F, F) on the frame.  `sign` is +1 for a, -1 for b: x_rel = sum of sign * x.
struct Side {
  const SurfacePoint& point;
  const FrameState* frame;  ///< null for nodes
  double sign;
  Vec3 arm;  ///< frames: r
  Mat36 Z;   ///< frames only
  /// frames only: the point's velocity v = v0 + w x r changes by w x (dtheta x R o) = V dtheta, V = -[w]x [R
  /// o]x, when the frame rotates with its twist held
  Mat3 V;
  Mat3 G;  ///< frames only: [F]x [R o]x, F the force on a: see `geometric` in tangent.cpp

  Side(const SurfacePoint& surface_point, const PointMotion& motion, const std::vector<FrameState>& frames,
       double side_sign, const Vec3& force_on_a);
  bool is_nodes() const { return frame == nullptr; }
};

/// A += scale_k K + scale_d D of one sample, for the sides that have rows in the State.
void add_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                        int nodal_size, dynamics::BorderedMatrix& A);
/// y += (k_scale K + d_scale D) x of one sample.
void apply_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                          const VecX& x, VecX& y);
/// f += a force at a surface point: on its nodes, or, where frame_row >= 0, moment and force on the six rows
/// from there.
void add_point_force(const SurfacePoint& point, const Vec3& arm, const Vec3& force, int frame_row, VecX& f);

}  // namespace palpate::contact
