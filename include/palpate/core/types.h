#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

/// Scalars and small fixed shapes that every part uses.  SI units, double precision, world axes unless a name
/// says otherwise.
namespace palpate {

/// position, vector or rotation vector, of three components
using Vec3 = Eigen::Vector3d;
/// spatial vector: angular part first, then linear (Simbody's order)
using Vec6 = Eigen::Matrix<double, 6, 1>;
/// 3 x 3
using Mat3 = Eigen::Matrix3d;
/// 6 x 6, on spatial vectors
using Mat6 = Eigen::Matrix<double, 6, 6>;
/// column of any length
using VecX = Eigen::VectorXd;
/// matrix of any size
using MatX = Eigen::MatrixXd;
/// rotation; of unit length wherever it stands for one
using Quat = Eigen::Quaterniond;
using Points = Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< 3 x n, one point a column [m]
/// 3 x n, vertex indices, counter-clockwise seen from outside
using Faces = Eigen::Matrix<int, 3, Eigen::Dynamic>;
using Tets = Eigen::Matrix<int, 4, Eigen::Dynamic>;  ///< 4 x n, node indices, positive volume

/// [v]x, the matrix with [v]x w = v x w.
inline Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace palpate
