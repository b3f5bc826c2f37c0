#include "dynamics/carried_motion.h"

namespace palpate::dynamics {

void carry(const RigidMotion& frame, const Twist& acceleration, const std::vector<int>& dofs,
           const Points& local, VecX& x, VecX& v, VecX& a) {
  const Mat3 R = frame.pose.rotation.toRotationMatrix();
  const Vec3& w = frame.twist.angular;
  x.resize(local.cols());
  v.resize(local.cols());
  a.resize(local.cols());
  for (Eigen::Index i = 0; i < local.cols(); ++i) {
    const int k = dofs[static_cast<std::size_t>(i)] % 3;
    const Vec3 r = R * local.col(i), spin = w.cross(r);
    x[i] = frame.pose.translation[k] + r[k];
    v[i] = frame.twist.linear[k] + spin[k];
    a[i] = acceleration.linear[k] + acceleration.angular.cross(r)[k] + w.cross(spin)[k];
  }
}

}  // namespace palpate::dynamics
