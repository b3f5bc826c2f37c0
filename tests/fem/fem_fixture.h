#pragma once
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/core/pose.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"
#include "palpate/fem/soft_body.h"

namespace palpate::fem::testing {

using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

/// Uniform numbers in [-1, 1] with a fixed seed.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return uniform_(engine_); }
  VecX vector(Eigen::Index n) {
    return VecX::NullaryExpr(n, [this] { return (*this)(); });
  }
  Mat3 matrix() {
    return Mat3::NullaryExpr([this] { return (*this)(); });
  }
  Mat3 rotation() { return quaternion_of(3.0 * vector(3)).toRotationMatrix(); }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

/// The unit cube, divided into n^3 cubes of six tetrahedra each; all nodes moved by `jitter` cells.
inline TetMesh jittered_cube(int n, double jitter, unsigned seed) {
  Random random(seed);
  TetMesh mesh;
  const int m = n + 1;
  mesh.nodes.resize(3, m * m * m);
  const auto node = [m](int i, int j, int k) { return (i * m + j) * m + k; };
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      for (int k = 0; k < m; ++k)
        mesh.nodes.col(node(i, j, k)) = (Vec3(i, j, k) + jitter * Vec3(random.vector(3))) / n;
  const int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  mesh.tets.resize(4, 6 * n * n * n);
  int e = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (int p = 0; p < 6; ++p, ++e) {
          int at[3] = {i, j, k};
          mesh.tets(0, e) = node(i, j, k);
          for (int s = 0; s < 3; ++s) {
            ++at[paths[p][s]];
            mesh.tets(s + 1, e) = node(at[0], at[1], at[2]);
          }
          if (p >= 3) std::swap(mesh.tets(2, e), mesh.tets(3, e));  // odd permutations
        }
  return mesh;
}

/// One well-shaped tetrahedron without symmetry.
inline TetMesh one_tet() {
  TetMesh mesh;
  mesh.nodes.resize(3, 4);
  mesh.nodes << 0.1, 1.2, 0.2, 0.0,  //
      0.0, 0.1, 0.9, 0.2,            //
      0.0, 0.2, 0.1, 1.1;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  return mesh;
}

inline Material soft_material() {
  Material m;
  m.youngs_modulus = 3.0;
  m.poissons_ratio = 0.35;
  m.density = 2.0;
  return m;
}

/// A state with one body with the mesh's nodes, at x and v.
struct OneBody {
  dynamics::State state;
  int id;
  OneBody(const VecX& x, const VecX& v) : state(static_cast<int>(x.size()), static_cast<int>(x.size())) {
    dynamics::BlockSpec spec;
    spec.name = "body";
    spec.q_size = spec.u_size = static_cast<int>(x.size());
    id = state.insert(spec, x, v);
  }
};

inline VecX flat(const Points& p) { return p.reshaped(); }
inline Points unflat(const VecX& x) { return x.reshaped(3, x.size() / 3); }

/// Checks that the remainder of a first-order expansion decreases with slope 2: r(h) = |y(h) - y(0) - h y'|
/// over h = h0 / 2^k.
inline void expect_slope_two(const std::function<VecX(double)>& y, const VecX& derivative, double h0,
                             const std::string& what, int steps = 6) {
  const VecX y0 = y(0.0);
  double previous = 0.0;
  int counted = 0;
  for (int k = 0; k <= steps; ++k) {
    const double h = h0 / std::pow(2.0, k);
    const double remainder = (y(h) - y0 - h * derivative).norm();
    if (k > 0) {
      const double slope = std::log2(previous / remainder);
      EXPECT_NEAR(slope, 2.0, 0.1) << what << ", step " << h << ", remainder " << remainder;
      ++counted;
    }
    previous = remainder;
  }
  EXPECT_GE(counted, 5);
}

/// Checks that forces f on nodes at x have zero resultant and moment.
inline void expect_balanced(const Points& f, const Points& x) {
  Vec3 moment = Vec3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) moment += x.col(i).cross(f.col(i));
  const double scale = f.colwise().norm().sum();
  EXPECT_GT(scale, 1.0);
  EXPECT_LT(f.rowwise().sum().norm(), 1e-14 * scale);
  EXPECT_LT(moment.norm(), 1e-12 * scale);
}

/// Deformation gradient with given signed stretches, rotated on both sides.
inline Mat3 deformation(Random& random, const Vec3& stretches) {
  return random.rotation() * stretches.asDiagonal() * random.rotation();
}

/// Typical signed stretches: regular, large, flattened to a plane, inverted.
inline std::vector<std::pair<std::string, Vec3>> stretch_cases() {
  return {{"regular", {1.2, 0.9, 0.8}},
          {"stretched", {3.0, 1.5, 1.2}},
          {"flat", {1.1, 0.8, 0.0}},
          {"inverted", {1.3, 0.9, -0.4}}};
}

}  // namespace palpate::fem::testing
