#pragma once
#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <random>
#include <tuple>

#include "palpate/dynamics/matrix.h"

namespace palpate {

/// A row of nodes on springs, each also tied to the ground by `ground`; every `every`-th is pressed by a
/// contact k (n - mu s) n^T with random n and s: friction follows the pressure.
inline dynamics::BorderedMatrix row_with_friction(int nodes, double ground, int every, double k, double mu) {
  dynamics::PatternBuilder pattern(nodes);
  for (int i = 0; i + 1 < nodes; ++i) pattern.add_pair(i, i + 1);
  dynamics::BorderedMatrix A;
  A.body = pattern.build();
  A.symmetric = false;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (int i = 0; i < nodes; ++i) A.body.add(A.body.slot(i, i), ground * Mat3::Identity());
  for (int i = 0; i + 1 < nodes; ++i)
    for (const auto& [a, b, sign] :
         {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
      A.body.add(A.body.slot(a, b), sign * Mat3::Identity());
  for (int i = 0; i < nodes; i += every) {
    const Vec3 n = Vec3::NullaryExpr([&] { return value(random); }).normalized(), s = n.unitOrthogonal();
    A.body.add(A.body.slot(i, i), k * (n - mu * s) * n.transpose());
  }
  A.right = MatX::Zero(3 * nodes, 0);
  A.bottom = MatX::Zero(0, 3 * nodes);
  A.corner = MatX::Zero(0, 0);
  A.touch();
  return A;
}

/// S = 1 and N of uncoupled nodes, v -> c_i axis x v: |N|_S is the largest c_i, and all eigenvalues differ.
inline dynamics::BorderedMatrix spinning_nodes(int nodes, double largest) {
  dynamics::BorderedMatrix A = row_with_friction(nodes, 0.0, 1, 0.0, 0.0);
  A.body.set_zero();
  for (int i = 0; i < nodes; ++i) {
    Mat3 block = Mat3::Identity();
    block(0, 1) = largest * (i + 1) / nodes;
    block(1, 0) = -block(0, 1);
    A.body.add(A.body.slot(i, i), block);
  }
  A.touch();
  return A;
}

/// Adds a border with random entries below 1, whose row and column parts are not transposes, around a
/// corner of `corner` times the identity.
inline void add_border(dynamics::BorderedMatrix& A, int border, double corner) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  const auto at_random = [&](Eigen::Index rows, Eigen::Index columns) -> MatX {
    return MatX::NullaryExpr(rows, columns, [&] { return value(random); });
  };
  A.right = at_random(A.nodal_size(), border);
  A.bottom = at_random(border, A.nodal_size());
  A.corner = corner * MatX::Identity(border, border) + at_random(border, border);
  A.touch();
}

/// Largest |x . N y| over |x|_S |y|_S: the largest singular value of L^-1 N L^-T, S = L L^T.
inline double skew_norm(const dynamics::BorderedMatrix& A) {
  const MatX dense = A.to_dense(), S = 0.5 * (dense + dense.transpose()), N = dense - S;
  const MatX L = Eigen::LLT<MatX>(S).matrixL();
  MatX M = L.triangularView<Eigen::Lower>().solve(N);
  M = L.triangularView<Eigen::Lower>().solve(MatX(M.transpose()));
  return Eigen::JacobiSVD<MatX>(M).singularValues()[0];
}

}  // namespace palpate
