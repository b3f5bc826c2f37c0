#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "distance/skin_contact.h"
#include "messages.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "shapes/shapes.h"

namespace distance_tests {

using namespace palpate;
using namespace palpate::distance;

inline void expect_message(const std::function<void()>& f, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) expectations::expect_contains(expectations::message_of(f), part);
}

/// A skin with its current node positions.
struct Body {
  Skin skin;
  Points rest, nodes;

  const double* at() const { return nodes.data(); }
  void place(const Mat3& rotation, const Vec3& shift) { nodes = (rotation * rest).colwise() + shift; }
  void place(const Vec3& shift) { place(Mat3::Identity(), shift); }
};

inline Body shell(const TriMesh& mesh) { return {make_skin(mesh), mesh.vertices, mesh.vertices}; }

/// A sphere with bumps, that has concave and convex edges and 20 n^2 faces.
inline TriMesh bumpy_sphere(double radius, int n, double bump) {
  TriMesh mesh = mesh::sphere(radius, n);
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const Vec3 u = mesh.vertices.col(i) / radius;
    mesh.vertices.col(i) *=
        1.0 + bump * std::sin(9 * u.x()) * std::sin(8 * u.y() + 1) * std::sin(7 * u.z() + 2);
  }
  return mesh;
}

inline TriMesh shape_skin(const std::string& name, int vertices) {
  return shapes::make(name, {.skin_vertices = vertices, .base_vertices = 0}).skin;
}

/// A body of tetrahedra with an embedded bumpy skin, which extends beyond the tetrahedra in places.
inline Body soft_bumpy(double radius, int n, double bump) {
  const TetMesh tets = mesh::ball(radius, radius / 3);
  const TriMesh surface = bumpy_sphere(radius, n, bump);
  const mesh::Embedding embedding = mesh::embed(tets, surface.vertices);
  return {make_skin(surface, embedding, tets.tets, static_cast<int>(tets.nodes.cols())), tets.nodes,
          tets.nodes};
}

inline Mat3 rotation(const Vec3& vector) {
  return Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
}

/// Two bumpy bodies that overlap by about a tenth of their radius.
struct Pair {
  Body a = soft_bumpy(0.1, 16, 0.05), b = soft_bumpy(0.08, 14, 0.06);
  Pair() { b.place(rotation({0.3, -0.8, 0.4}), {0.168, 0.01, -0.006}); }
};

inline double contact_force(SkinContact& contact, const Body& a, const Body& b, Points& fa, Points& fb) {
  contact.find(a.at(), b.at());
  fa.setZero(3, a.nodes.cols());
  fb.setZero(3, b.nodes.cols());
  contact.add_force(fa.data(), fb.data());
  return contact.energy();
}

inline Vec3 moment_of(const Points& at, const Points& forces) {
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < at.cols(); ++i) sum += at.col(i).cross(forces.col(i));
  return sum;
}

}  // namespace distance_tests
