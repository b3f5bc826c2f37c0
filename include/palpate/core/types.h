#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

/// Scalars and small fixed shapes that every part uses.  SI units, double precision, and world axes, unless a
/// name indicates otherwise.
namespace palpate {

/// Position, vector or rotation vector.
using Vec3 = Eigen::Vector3d;
/// Spatial vector: angular part first, then linear (Simbody's order).
using Vec6 = Eigen::Matrix<double, 6, 1>;
/// 3 x 3 matrix.
using Mat3 = Eigen::Matrix3d;
/// 6 x 6 matrix on spatial vectors.
using Mat6 = Eigen::Matrix<double, 6, 6>;
/// Column vector of dynamic length.
using VecX = Eigen::VectorXd;
/// Matrix of dynamic size.
using MatX = Eigen::MatrixXd;
/// Rotation; has unit length wherever it represents one.
using Quat = Eigen::Quaterniond;
using Points = Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< 3 x n, one point per column [m].
/// 3 x n vertex indices, counter-clockwise seen from outside.
using Faces = Eigen::Matrix<int, 3, Eigen::Dynamic>;
using Tets = Eigen::Matrix<int, 4, Eigen::Dynamic>;  ///< 4 x n node indices, positive volume.

/// Returns [v]x, the matrix with [v]x w = v x w.
inline Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace palpate
