#include "coupling.h"

#include "core/so3.h"

namespace palpate::tool {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

bool is_none(const dynamics::LinearisedContact& record) {
  return record.source == dynamics::LinearisedContact::Source::kNone;
}

}  // namespace

CouplingGains coupling_gains(const ToolSpec& spec) {
  return {spec.coupling.stiffness_n_m, spec.coupling.damping_n_s_m,
          spec.coupling.rotational_stiffness_n_m_rad, spec.coupling.rotational_damping_n_m_s_rad};
}

Vec6 stacked(const Twist& twist) {
  Vec6 v;
  v << twist.angular, twist.linear;
  return v;
}
Twist twist_of(const Vec6& v) { return {v.head<3>(), v.tail<3>()}; }
Wrench wrench_of(const Vec6& w) { return {w.head<3>(), w.tail<3>()}; }

Vec6 coupling_wrench(const CouplingGains& gains, const RigidMotion& tool, const RigidMotion& handle) {
  const Vec6 d = pose_difference(tool.pose, handle.pose), v = stacked(handle.twist) - stacked(tool.twist);
  Vec6 wrench;
  wrench << gains.k_r * d.head<3>() + gains.b_r * v.head<3>(), gains.k * d.tail<3>() + gains.b * v.tail<3>();
  return wrench;
}

// Q = R_h R_t^T = exp(d). A rotation of the tool, R_t -> exp(e) R_t, changes it to Q exp(-e) =
// exp(d) exp(-e), a perturbation from the right, so dd = -J_right^-1(d) e, and J_right^-1(d) = J_left^-1(-d).
// Hence
//     -d(moment)/de = k_r J_left^-1(-d),
// whose unsymmetric part is [moment]/2, because increments in world axes are not coordinates.
Mat6 coupling_stiffness(const CouplingGains& gains, const Pose& tool, const Pose& handle) {
  Mat6 K = Mat6::Zero();
  K.topLeftCorner<3, 3>() = gains.k_r * left_jacobian_inverse(-pose_difference(tool, handle).head<3>());
  K.bottomRightCorner<3, 3>() = gains.k * Mat3::Identity();
  return K;
}

Mat6 coupling_damping(const CouplingGains& gains) {
  Mat6 B = Mat6::Zero();
  B.diagonal() << Vec3::Constant(gains.b_r), Vec3::Constant(gains.b);
  return B;
}

double coupling_energy(const CouplingGains& gains, const Pose& tool, const Pose& handle) {
  const Vec6 d = pose_difference(tool, handle);
  return 0.5 * (gains.k_r * d.head<3>().squaredNorm() + gains.k * d.tail<3>().squaredNorm());
}

double coupling_dissipation(const CouplingGains& gains, const Twist& tool, const Twist& handle) {
  return gains.b_r * (handle.angular - tool.angular).squaredNorm() +
         gains.b * (handle.linear - tool.linear).squaredNorm();
}

// The record is linear in e, the rotation vector of R R0^T; a rotation from the left changes e by
// J_left^-1(e).
Mat6 contact_stiffness(const dynamics::LinearisedContact& record, const Pose& tool) {
  if (is_none(record)) return Mat6::Zero();
  const Pose x0{Quat(record.x0[0], record.x0[1], record.x0[2], record.x0[3]),
                Vec3(record.x0[4], record.x0[5], record.x0[6])};
  Mat6 K = -Eigen::Map<const RowMajor6>(record.J.data());
  K.leftCols<3>() *= left_jacobian_inverse(pose_difference(x0, tool).head<3>());
  return K;
}

Mat6 contact_damping(const dynamics::LinearisedContact& record) {
  return is_none(record) ? Mat6(Mat6::Zero()) : Mat6(-Eigen::Map<const RowMajor6>(record.B.data()));
}

}  // namespace palpate::tool
