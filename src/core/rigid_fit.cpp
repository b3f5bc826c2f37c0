#include "core/rigid_fit.h"

#include <Eigen/SVD>

namespace palpate {

Pose rigid_fit(const Points& before, const Points& after, const VecX& weights) {
  VecX w = weights.size() > 0 ? weights : VecX::Ones(before.cols());
  w /= w.sum();
  const Vec3 c = before * w, d = after * w;
  const Mat3 sum = (before.colwise() - c) * w.asDiagonal() * (after.colwise() - d).transpose();
  const Eigen::JacobiSVD<Mat3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 V = svd.matrixV(), Ut = svd.matrixU().transpose();
  // Avoids a reflection; for flat point sets the last direction is free.
  const Vec3 hand(1.0, 1.0, (V * Ut).determinant());
  const Mat3 R = V * hand.asDiagonal() * Ut;
  return {Quat(R), d - R * c};
}

Points without_rigid_motion(const Points& before, const Points& after, const VecX& weights) {
  const Pose motion = rigid_fit(before, after, weights);
  return after - ((motion.rotation.toRotationMatrix() * before).colwise() + motion.translation);
}

}  // namespace palpate
