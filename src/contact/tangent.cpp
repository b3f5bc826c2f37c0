#include "contact/tangent.h"

#include "palpate/core/error.h"

namespace palpate::contact {

// Tangent of one sample. With x_rel = x_a - x_b, the sample's force F on a and its derivatives
// K = -dF/dx_rel, D = -dF/dv_rel, and each side's map B (w_i I or Z), the generalised force on side p is
// s_p B_p^T F. Its derivatives, negated:
//
//   by side q's position   s_p s_q B_p^T (K B_q + D V_q)      V_q: at constant twist the velocity of a
//                          frame's rotated arm changes
//   by side q's velocity   s_p s_q B_p^T  D B_q
//   geometric (p = q)      a frame's moment s_p (r x F) changes with its arm, dr = dtheta x R o:
//                          d(r x F) = (dtheta x R o) x F = F x (R o x dtheta) = [F]x [R o]x dtheta = G
//                          dtheta,  so K_theta,theta += -s_p G
//
// The slide s does not rotate, so that positions move with R o and velocities, w x r, with r = R o + s; but s
// is parallel to n, and K acts on n . dx only: K (dtheta x s) = 0, and Z serves for both.
//
// Node-node blocks are symmetric without friction (K = A k n n^T). Frame blocks are not: G is symmetric only
// up to the moment that it is the derivative of (rotations do not commute), and D V has no transpose
// counterpart.
Side::Side(const SurfacePoint& surface_point, const PointMotion& motion,
           const std::vector<FrameState>& frames, double side_sign, const Vec3& force_on_a)
    : point(surface_point), frame(nullptr), sign(side_sign), arm(motion.arm) {
  if (point.frame < 0) return;
  frame = &frames[static_cast<std::size_t>(point.frame)];
  const Mat3 rotating = cross_matrix(motion.rotating);
  Z << -cross_matrix(arm), Mat3::Identity();
  V.noalias() = -cross_matrix(frame->twist.angular) * rotating;
  G.noalias() = cross_matrix(force_on_a) * rotating;
}

namespace {

/// Writes to a BorderedMatrix.
struct WholeMatrix {
  dynamics::BorderedMatrix& A;
  MatX& corner() const { return A.corner; }
  void node_node(const Side& p, const Side& q, const Mat3& block) const {
    for (int i = 0; i < p.point.count; ++i)
      for (int j = 0; j < q.point.count; ++j) {
        const auto ki = static_cast<std::size_t>(i), kj = static_cast<std::size_t>(j);
        const int slot = A.body.slot(p.point.node[ki], q.point.node[kj]);
        PALPATE_CHECK(slot >= 0,
                      "contact couples nodes {} and {}, which are missing from the pattern that its source "
                      "added in add_pattern",
                      p.point.node[ki], q.point.node[kj]);
        A.body.add(slot, p.point.weight[ki] * q.point.weight[kj] * block);
      }
  }
  void right(int node, int column, const Mat36& block) const {
    A.right.block<3, 6>(3 * node, column) += block;
  }
  void bottom(int node, int column, const Mat63& block) const {
    A.bottom.block<6, 3>(column, 3 * node) += block;
  }
};

/// Writes rows and columns of frames to a SparseBorder.
struct BorderAlone {
  dynamics::SparseBorder& border;
  MatX& corner() const { return border.corner; }
  void node_node(const Side&, const Side&, const Mat3&) const {}
  void right(int node, int column, const Mat36& block) const { border.at(node, column).right += block; }
  void bottom(int node, int column, const Mat63& block) const { border.at(node, column).bottom += block; }
};

/// Adds s_p s_q B_p^T (k (K B_q + D V_q) + d D B_q) for one pair of sides.
template <class Matrix>
void add_pair_block(const Side& p, const Side& q, const SampleForce& s, double k_scale, double d_scale,
                    int nodal_size, const Matrix& A) {
  const double sign = p.sign * q.sign;
  const Mat3 C = sign * (k_scale * s.K + d_scale * s.D);
  if (q.is_nodes()) {
    if (p.is_nodes()) return A.node_node(p, q, C);
    if (p.frame->u_offset < 0) return;
    const Mat63 rows = p.Z.transpose() * C;
    for (int j = 0; j < q.point.count; ++j) {
      const auto kj = static_cast<std::size_t>(j);
      A.bottom(q.point.node[kj], p.frame->u_offset - nodal_size, q.point.weight[kj] * rows);
    }
    return;
  }
  if (q.frame->u_offset < 0) return;
  const int column = q.frame->u_offset - nodal_size;
  Mat36 CB = C * q.Z;
  CB.leftCols<3>().noalias() += sign * k_scale * s.D * q.V;
  if (p.is_nodes()) {
    for (int i = 0; i < p.point.count; ++i) {
      const auto ki = static_cast<std::size_t>(i);
      A.right(p.point.node[ki], column, p.point.weight[ki] * CB);
    }
  } else if (p.frame->u_offset >= 0) {
    A.corner().template block<6, 6>(p.frame->u_offset - nodal_size, column) += p.Z.transpose() * CB;
  }
}

template <class Matrix>
void add_all_blocks(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                    int nodal_size, const Matrix& A) {
  for (const Side* p : {&a, &b}) {
    for (const Side* q : {&a, &b}) add_pair_block(*p, *q, s, k_scale, d_scale, nodal_size, A);
    if (p->is_nodes() || p->frame->u_offset < 0) continue;
    const int at = p->frame->u_offset - nodal_size;
    A.corner().template block<3, 3>(at, at) -= k_scale * p->sign * p->G;
  }
}

/// Returns whether a side is a frame in the State.
bool has_rows(const Side& side) { return !side.is_nodes() && side.frame->u_offset >= 0; }

}  // namespace

void add_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                        int nodal_size, dynamics::BorderedMatrix& A) {
  add_all_blocks(a, b, s, k_scale, d_scale, nodal_size, WholeMatrix{A});
}

// A sample is one point on its nodes, x_a - x_b.
void add_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                        int nodal_size, dynamics::PointStiffness& C, dynamics::SparseBorder& border) {
  if (has_rows(a) || has_rows(b)) add_all_blocks(a, b, s, k_scale, d_scale, nodal_size, BorderAlone{border});
  dynamics::PointStiffness::OfPoint point;
  for (const Side* side : {&a, &b}) {
    if (!side->is_nodes()) continue;
    for (int i = 0; i < side->point.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const int at = point.nodes.count++;
      point.nodes.node[static_cast<std::size_t>(at)] = side->point.node[k];
      point.weight[at] = side->sign * side->point.weight[k];
    }
  }
  if (point.nodes.count == 0) return;
  point.nodes.relative = a.is_nodes() && b.is_nodes();
  point.C = k_scale * s.K + d_scale * s.D;
  C.points.push_back(point);
}

void apply_sample_tangent(const Side& a, const Side& b, const SampleForce& s, double k_scale, double d_scale,
                          const VecX& x, VecX& y) {
  // Changes of x_rel along u-directions, and of v_rel due to rotating arms.
  Vec3 dx = Vec3::Zero(), dv = Vec3::Zero();
  for (const Side* q : {&a, &b}) {
    if (q->is_nodes()) {
      for (int j = 0; j < q->point.count; ++j) {
        const auto kj = static_cast<std::size_t>(j);
        dx += q->sign * q->point.weight[kj] * x.segment<3>(3 * q->point.node[kj]);
      }
    } else if (q->frame->u_offset >= 0) {
      dx += q->sign * (q->Z * x.segment<6>(q->frame->u_offset));
      dv += q->sign * (q->V * x.segment<3>(q->frame->u_offset));
    }
  }
  const Vec3 g = k_scale * (s.K * dx + s.D * dv) + d_scale * (s.D * dx);
  for (const Side* p : {&a, &b}) {
    add_point_force(p->point, p->arm, p->sign * g, p->is_nodes() ? -1 : p->frame->u_offset, y);
    if (!p->is_nodes() && p->frame->u_offset >= 0)
      y.segment<3>(p->frame->u_offset) -= k_scale * p->sign * (p->G * x.segment<3>(p->frame->u_offset));
  }
}

void add_point_force(const SurfacePoint& point, const Vec3& arm, const Vec3& force, int frame_row, VecX& f) {
  if (point.frame < 0) {
    for (int i = 0; i < point.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      f.segment<3>(3 * point.node[k]) += point.weight[k] * force;
    }
  } else if (frame_row >= 0) {
    f.segment<3>(frame_row) += arm.cross(force);
    f.segment<3>(frame_row + 3) += force;
  }
}

}  // namespace palpate::contact
