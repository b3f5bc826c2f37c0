#include "model/manifold.h"

#include <gtest/gtest.h>

#include <functional>

#include "mesh/surface_checks.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"

using namespace palpate;

namespace {

/// The tetrahedra of a box of unit cubes for whose centres `keep` holds; all nodes, used or not.
model::FittedMesh kept(const std::function<bool(const Vec3&)>& keep) {
  model::FittedMesh out;
  out.mesh = mesh::box(Vec3::Constant(4), {4, 4, 4});
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < out.mesh.tets.cols(); ++t) {
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 4; ++k) middle += out.mesh.nodes.col(out.mesh.tets(k, t)) / 4;
    if (keep(middle)) out.mesh.tets.col(count++) = out.mesh.tets.col(t);
  }
  out.mesh.tets.conservativeResize(4, count);
  out.on_crease.assign(static_cast<std::size_t>(out.mesh.nodes.cols()), 0);
  return out;
}

double volume(const TetMesh& mesh) {
  double out = 0;
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t) out += mesh::tet_volume(mesh, t);
  return out;
}

void expect_sound(const TetMesh& mesh) {
  mesh::Provenance from;
  from.source = "test";
  TriMesh skin = mesh::boundary(mesh).surface;
  EXPECT_NO_THROW(mesh::check_surface(skin, from));
}

TEST(Manifold, ASoundMeshStaysToTheLastBit) {
  model::FittedMesh mesh;
  mesh.mesh = mesh::ball(1.0, 0.3);
  mesh.on_crease.assign(static_cast<std::size_t>(mesh.mesh.nodes.cols()), 0);
  const TetMesh before = mesh.mesh;
  EXPECT_EQ(model::make_boundary_manifold(mesh).taken, 0);
  EXPECT_EQ(mesh.mesh.tets, before.tets);
  EXPECT_EQ(mesh.mesh.nodes, before.nodes);
}

// Half of the box, and one cube that shares an edge or a corner with it: the cube is removed as a whole.
TEST(Manifold, WhatHangsByAnEdgeOrANodeGoes) {
  const auto in_cube = [](const Vec3& p, const Vec3& low) {
    return ((p - low).array() > 0).all() && ((p - low).array() < 1).all();
  };
  for (const Vec3& low : {Vec3(0, 0, 0), Vec3(0, 2, 0)})
    for (const bool corner : {false, true}) {
      model::FittedMesh mesh = kept([&](const Vec3& p) {
        const bool base = corner ? p.x() < 0 && (p.array() < 0).all() : p.x() < 0 && p.y() < 0;
        return base || (low.y() == 0 && in_cube(p, low));
      });
      const double all = volume(mesh.mesh);
      const model::ManifoldReport report = model::make_boundary_manifold(mesh);
      expect_sound(mesh.mesh);
      if (low.y() != 0) {
        EXPECT_EQ(report.taken, 0);
        continue;
      }
      EXPECT_EQ(report.taken, 5);
      EXPECT_NEAR(report.volume, 1.0, 1e-12);
      EXPECT_NEAR(volume(mesh.mesh), all - 1.0, 1e-12);
      EXPECT_TRUE(in_cube(report.place, low));
    }
}

// A tunnel of one cube through the middle whose walls touch along an edge inside the body.
TEST(Manifold, HolesThatTouchAreOpenedIntoEachOther) {
  model::FittedMesh mesh = kept([](const Vec3& p) {
    const bool one = p.x() > 0 && p.x() < 1 && p.y() > 0 && p.y() < 1,
               other = p.x() < 0 && p.x() > -1 && p.y() < 0 && p.y() > -1;
    return !one && !other;
  });
  const model::ManifoldReport report = model::make_boundary_manifold(mesh);
  EXPECT_GT(report.taken, 0);
  EXPECT_LT(report.volume, 8.0);
  expect_sound(mesh.mesh);
  EXPECT_EQ(mesh.on_crease.size(), static_cast<std::size_t>(mesh.mesh.nodes.cols()));
}

}  // namespace
