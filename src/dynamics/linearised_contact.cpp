#include "palpate/dynamics/linearised_contact.h"

namespace palpate::dynamics {

void set_reference(LinearisedContact& record, double t, const Pose& pose, const Twist& twist) {
  const Quat& r = pose.rotation;
  const Vec3& p = pose.translation;
  record.time = t;
  record.x0 = {r.w(), r.x(), r.y(), r.z(), p.x(), p.y(), p.z()};
  Eigen::Map<Vec6>(record.v0.data()) << twist.angular, twist.linear;
}

Vec6 contact_wrench(const LinearisedContact& record, double t, const Pose& pose, const Twist& twist) {
  if (record.source == LinearisedContact::Source::kNone) return Vec6::Zero();
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const Pose x0{Quat(record.x0[0], record.x0[1], record.x0[2], record.x0[3]),
                Vec3(record.x0[4], record.x0[5], record.x0[6])};
  Vec6 v;
  v << twist.angular, twist.linear;
  return Eigen::Map<const Vec6>(record.F0.data()) +
         (t - record.time) * Eigen::Map<const Vec6>(record.F1.data()) +
         Eigen::Map<const RowMajor6>(record.J.data()) * pose_difference(x0, pose) +
         Eigen::Map<const RowMajor6>(record.B.data()) * (v - Eigen::Map<const Vec6>(record.v0.data()));
}

}  // namespace palpate::dynamics
