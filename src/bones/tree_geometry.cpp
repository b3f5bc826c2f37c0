#include "bones/tree_impl.h"

namespace palpate::bones {
namespace {

/// Returns sum (w x r) x f = S w - w tr S for S = sum r f^T, since (w x r) x f = r (w . f) - w (r . f).
Vec3 rotated_moment(const Mat3& S, const Vec3& w) { return S * w - w * S.trace(); }

/// Returns sum r x f for S = sum r f^T.
Vec3 moment(const Mat3& S) { return {S(1, 2) - S(2, 1), S(2, 0) - S(0, 2), S(0, 1) - S(1, 0)}; }

}  // namespace

// Generalised force of constant forces f_k at points x_k, for a direction i that rotates the subtree of joint
// i about an axis w_i through p_i:
//     Q_i = w_i . m_i,   m_i = sum (x_k - p_i) x f_k over the subtree of i.
// Its derivative along a direction j, a rotation w_j about p_j:
//   j is an ancestor of i: points, p_i and w_i rotate together:
//     dQ_i = (w_j x w_i) . m_i + w_i . sum (w_j x (x_k - p_i)) x f_k
//   j belongs to the same joint as i: the axes are fixed in the parent, so the first term is absent:
//     dQ_i = w_i . sum (w_j x (x_k - p_i)) x f_k
//   j is a descendant of i: only the subtree of j moves:
//     dQ_i = w_i . sum (w_j x (x_k - p_j)) x f_k over the subtree of j
//   else, or where i or j translates a free root: 0 (a translation moves x_k and p_i alike, and its
//   direction is constant).
// K is symmetric between different joints.  Within a ball or a free root it is symmetric up to the cross
// matrix of m, as for one rigid body.
void BoneTree::add_geometric_stiffness(const VecX& q, const std::vector<ConstantForce>& held, MatX& K) const {
  Impl& t = *impl_;
  t.go_to(q, t.at_u.size() == t.u_size ? t.at_u : VecX(VecX::Zero(t.u_size)));
  t.need_jacobian();
  const auto bone_count = t.bones.size();

  // Sums over the subtree of each joint: about the origin of its first bone, then about the joint.
  std::vector<Mat3> S(bone_count);
  std::vector<Vec3> F(bone_count);
  for (std::size_t b = 0; b < bone_count; ++b) S[b] = held[b].moment, F[b] = held[b].force;
  for (std::size_t b = bone_count; b-- > 0;) {
    if (t.bones[b].parent < 0) continue;
    const auto p = static_cast<std::size_t>(t.bones[b].parent);
    S[p] += S[b] + (t.poses[b].translation - t.poses[p].translation) * F[b].transpose();
    F[p] += F[b];
  }
  for (std::size_t b = 0; b < bone_count; ++b) {
    if (t.bones[b].joint == JointType::kFree) continue;  // rotates about the bone's origin
    const Vec3 joint = t.poses[b] * (t.bones[b].start.inverse() * t.bones[b].joint_position);
    S[b] += (t.poses[b].translation - joint) * F[b].transpose();
  }

  const auto before = [&](int a, int b) {  // a is b or an ancestor of b
    for (; b > a; b = t.bones[static_cast<std::size_t>(b)].parent) {}
    return a == b;
  };
  const auto shifts = [&](int i) {
    const int b = t.bone_of_u[static_cast<std::size_t>(i)];
    return t.bones[static_cast<std::size_t>(b)].joint == JointType::kFree &&
           i - t.first_u[static_cast<std::size_t>(b)] >= 3;
  };
  const auto axis = [&](int i) -> Vec3 {
    return t.J.block<3, 1>(6 * t.bone_of_u[static_cast<std::size_t>(i)], i);
  };
  for (int i = 0; i < t.u_size; ++i) {
    if (shifts(i)) continue;
    const int bi = t.bone_of_u[static_cast<std::size_t>(i)];
    const Vec3 wi = axis(i);
    for (int j = 0; j < t.u_size; ++j) {
      if (shifts(j)) continue;
      const int bj = t.bone_of_u[static_cast<std::size_t>(j)];
      const Vec3 wj = axis(j);
      if (before(bj, bi)) {
        const Mat3& Si = S[static_cast<std::size_t>(bi)];
        K(i, j) -= wi.dot(rotated_moment(Si, wj));
        if (bi != bj) K(i, j) -= wj.cross(wi).dot(moment(Si));
      } else if (before(bi, bj)) {
        K(i, j) -= wi.dot(rotated_moment(S[static_cast<std::size_t>(bj)], wj));
      }
    }
  }
}

}  // namespace palpate::bones
