// What the sums of a group (group_sums.cpp, whose derivation gives the names) are on nodes and frames.
#include "contact/sample_groups.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

/// E and M: see above.
struct FrameMaps {
  Eigen::Matrix<double, 6, 4> E = Eigen::Matrix<double, 6, 4>::Zero();
  Mat3 M, turn, R;
  FrameMaps(const Vec3& n, const FrameState& frame)
      : M(cross_matrix(frame.twist.angular.cross(n)) * frame.R), turn(cross_matrix(n)), R(frame.R) {
    E.topLeftCorner<3, 3>().noalias() = -turn * frame.R;
    E.bottomRightCorner<3, 1>() = n;
  }
  /// -[n]x [R F_o]x
  template <class Vec8>
  Mat3 rotating_moment(const Vec8& f) const {
    return -turn * cross_matrix(R * f.template segment<3>(4));
  }
};

}  // namespace

/// visit(i, node): entry i of y is the weight of this node.
template <class Visit>
void SampleGroups::for_each_node(const Group& group, Visit visit) {
  for (int i = 0; i < group.count_a; ++i) visit(i, group.a[static_cast<std::size_t>(i)]);
  for (int i = 0; group.frame < 0 && i < group.count_b; ++i)
    visit(4 + i, group.b[static_cast<std::size_t>(i)]);
}

void SampleGroups::add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                             const std::vector<int>& frame_row, VecX& f,
                             std::vector<Wrench>* resultants) const {
  for (const Group& group : groups_) {
    const Vec8 sum = sum_forces(group, motion(group, state, frames));
    if (sum.isZero(0.0)) continue;
    add_force(group, sum, frames, frame_row, f);
    if (!resultants) continue;
    Vec3 moment = Vec3::Zero();
    for (int i = 0; i < group.count_a; ++i)
      moment += sum[i] * state.position(group.a[static_cast<std::size_t>(i)]);
    (*resultants)[static_cast<std::size_t>(group.pair)] +=
        Wrench{moment.cross(group.normal), sum.head<4>().sum() * group.normal};
  }
}

void SampleGroups::add_force(const Group& group, const Vec8& sum, const std::vector<FrameState>& frames,
                             const std::vector<int>& frame_row, VecX& f) {
  for_each_node(group, [&](int i, int node) { f.segment<3>(3 * node) += sum[i] * group.normal; });
  if (group.frame < 0) return;
  if (const int row = frame_row[static_cast<std::size_t>(group.frame)]; row >= 0)
    f.segment<6>(row) += on_frame(group, sum, frames[static_cast<std::size_t>(group.frame)]);
}

Wrench SampleGroups::wrench(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                            int frame) const {
  Vec6 sum = Vec6::Zero();
  for (const Group& group : groups_)
    if (group.frame == frame)
      sum += on_frame(group, sum_forces(group, motion(group, state, frames)),
                      frames[static_cast<std::size_t>(frame)]);
  return {sum.head<3>(), sum.tail<3>()};
}

Vec6 SampleGroups::on_frame(const Group& group, const Vec8& f, const FrameState& frame) {
  Vec6 out;
  out << (frame.R * f.segment<3>(4)).cross(group.normal), f[7] * group.normal;
  return out;
}

void SampleGroups::add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                               double k_scale, double d_scale, dynamics::BorderedMatrix& A) const {
  Sums s;
  for (const Group& group : groups_) {
    if (!sum(group, motion(group, state, frames), s)) continue;
    const Vec3& n = group.normal;
    const Mat3 nn = n * n.transpose();
    const Mat8 C = k_scale * s.k + d_scale * s.d;
    for_each_node(group, [&](int i, int row) {
      for_each_node(group, [&](int j, int column) {
        const int slot = A.body.slot(row, column);
        PALPATE_CHECK(slot >= 0,
                      "contact couples nodes {} and {}, which its source did not announce in add_pattern",
                      row, column);
        A.body.add(slot, C(i, j) * nn);
      });
    });
    const int offset = group.frame < 0 ? -1 : frames[static_cast<std::size_t>(group.frame)].u_offset;
    if (offset < 0) continue;
    const int at = offset - state.layout->nodal_size;
    const FrameMaps maps(n, frames[static_cast<std::size_t>(group.frame)]);
    for_each_node(group, [&](int i, int node) {
      const Vec6 z = maps.E * C.block<4, 1>(4, i);
      A.bottom.block<6, 3>(at, 3 * node).noalias() += z * n.transpose();
      A.right.block<3, 6>(3 * node, at).noalias() += n * z.transpose();
      A.right.block<3, 3>(3 * node, at).noalias() +=
          n * (maps.M * (k_scale * s.d.block<3, 1>(4, i))).transpose();
    });
    A.corner.block<6, 6>(at, at) += maps.E * C.bottomRightCorner<4, 4>() * maps.E.transpose();
    A.corner.block<6, 3>(at, at) += k_scale * maps.E * s.d.block<4, 3>(4, 4) * maps.M.transpose();
    A.corner.block<3, 3>(at, at) += k_scale * maps.rotating_moment(s.f);
  }
}

void SampleGroups::add_step(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                            const std::vector<int>& frame_row, const VecX& shift, double k_scale,
                            double d_scale, VecX& f, dynamics::PointStiffness& C) const {
  Sums s;
  for (const Group& group : groups_) {
    if (!sum(group, motion(group, state, frames), s)) continue;
    add_force(group, s.f, frames, frame_row, f);
    apply(group, s, frames, -1.0, 0.0, shift, f);
    add_stiffness(group, s, k_scale, d_scale, C);
  }
}

void SampleGroups::add_step_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                                  const std::vector<int>& frame_row, const VecX& shift, const VecX& change,
                                  VecX& f) const {
  Sums s;
  for (const Group& group : groups_) {
    if (!sum(group, motion(group, state, frames), s)) continue;
    add_force(group, s.f, frames, frame_row, f);
    apply(group, s, frames, -1.0, 0.0, shift, f);
    apply(group, s, frames, 0.0, -1.0, change, f);
  }
}

// The group's share is C x n n^T over its nodes.
void SampleGroups::add_stiffness(const Group& group, const Sums& s, double k_scale, double d_scale,
                                 dynamics::PointStiffness& C) {
  dynamics::PointStiffness::AlongNormal& out = C.along.emplace_back();
  out.normal = group.normal;
  out.nodes.relative = group.frame < 0;
  std::array<int, 8> at{};  // in `s`
  for_each_node(group, [&](int i, int node) {
    const auto next = static_cast<std::size_t>(out.nodes.count++);
    out.nodes.node[next] = node;
    at[next] = i;
  });
  for (int i = 0; i < out.nodes.count; ++i)
    for (int j = 0; j < out.nodes.count; ++j) {
      const int p = at[static_cast<std::size_t>(i)], q = at[static_cast<std::size_t>(j)];
      out.G(i, j) = k_scale * s.k(p, q) + d_scale * s.d(p, q);
    }
}

void SampleGroups::apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                                 double k_scale, double d_scale, const VecX& x, VecX& y) const {
  Sums s;
  for (const Group& group : groups_)
    if (sum(group, motion(group, state, frames), s)) apply(group, s, frames, k_scale, d_scale, x, y);
}

void SampleGroups::apply(const Group& group, const Sums& s, const std::vector<FrameState>& frames,
                         double k_scale, double d_scale, const VecX& x, VecX& y) {
  const Vec3& n = group.normal;
  const FrameState* frame = group.frame < 0 ? nullptr : &frames[static_cast<std::size_t>(group.frame)];
  const int offset = frame ? frame->u_offset : -1;
  Vec8 moved = Vec8::Zero();  // by which the gap changes
  for_each_node(group, [&](int i, int node) { moved[i] = n.dot(x.segment<3>(3 * node)); });
  if (offset < 0) {
    const Vec8 g = k_scale * (s.k * moved) + d_scale * (s.d * moved);
    return for_each_node(group, [&](int i, int node) { y.segment<3>(3 * node) += g[i] * n; });
  }
  const FrameMaps maps(n, *frame);
  moved.tail<4>().noalias() = maps.E.transpose() * x.segment<6>(offset);
  const Vec3 turned = maps.M.transpose() * x.segment<3>(offset);  // by which the rate changes, times -o
  Vec8 g = k_scale * (s.k * moved) + d_scale * (s.d * moved);
  g.noalias() += k_scale * (s.d.middleCols<3>(4) * turned);
  for_each_node(group, [&](int i, int node) { y.segment<3>(3 * node) += g[i] * n; });
  y.segment<6>(offset).noalias() += maps.E * g.tail<4>();
  y.segment<3>(offset) += k_scale * (maps.rotating_moment(s.f) * x.segment<3>(offset));
}

void SampleGroups::linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                             int frame, FrameLinearisation& out) const {
  Sums s;
  for (const Group& group : groups_) {
    if (group.frame != frame) continue;
    const FrameState& at = frames[static_cast<std::size_t>(frame)];
    if (!sum(group, motion(group, state, frames), s) || s.pressed == 0) continue;
    out.active += s.pressed;
    const Vec3& n = group.normal;
    const FrameMaps maps(n, at);
    const Vec6 wrench = on_frame(group, s.f, at);
    const Mat3 moment = maps.rotating_moment(s.f);
    out.wrench += Wrench{wrench.head<3>(), wrench.tail<3>()};
    out.K += maps.E * s.k.bottomRightCorner<4, 4>() * maps.E.transpose();
    out.K.leftCols<3>() += maps.E * s.d.block<4, 3>(4, 4) * maps.M.transpose();
    out.K.topLeftCorner<3, 3>() += moment;
    out.geometric -= moment;
    out.B += maps.E * s.d.bottomRightCorner<4, 4>() * maps.E.transpose();
    for_each_node(group, [&](int i, int node) {
      const Vec6 zk = maps.E * s.k.block<4, 1>(4, i), zd = maps.E * s.d.block<4, 1>(4, i);
      NodeCoupling& to = out.of_node(node);
      to.K_body.noalias() += n * zk.transpose();
      to.K_body.leftCols<3>().noalias() += n * (maps.M * s.d.block<3, 1>(4, i)).transpose();
      to.B_body.noalias() += n * zd.transpose();
      to.K_frame.noalias() += zk * n.transpose();
      to.B_frame.noalias() += zd * n.transpose();
    });
  }
}

Mat3 SampleGroups::geometric_stiffness(const dynamics::StateView& state,
                                       const std::vector<FrameState>& frames, int frame) const {
  Mat3 out = Mat3::Zero();
  for (const Group& group : groups_) {
    if (group.frame != frame) continue;
    const Vec8 f = sum_forces(group, motion(group, state, frames));
    if (f.isZero(0.0)) continue;
    const FrameState& at = frames[static_cast<std::size_t>(frame)];
    out -= FrameMaps(group.normal, at).rotating_moment(f);
  }
  return out;
}

}  // namespace palpate::contact
