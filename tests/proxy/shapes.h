#pragma once
#include <cmath>
#include <random>

#include "mesh/layered_model.h"
#include "palpate/mesh/generators.h"

/// A ball of tetrahedra under a bumpy skin r = radius (1 + depth cos(n azimuth) sin(polar angle)), which
/// extends slightly beyond the tetrahedra at the crests.
inline palpate::LayeredModel bumpy_ball(double radius, double element, int subdivisions, double depth = 0.05,
                                        int crests = 8) {
  using namespace palpate;
  LayeredModel model;
  model.name = "bumpy ball";
  const auto bump = [&](const Vec3& x) {
    const double planar = std::hypot(x.x(), x.y()), r = x.norm();
    return r > 0.0 ? 1.0 + depth * std::cos(crests * std::atan2(x.y(), x.x())) * planar / r : 1.0;
  };
  model.tets = mesh::ball(0.99 * radius, element);
  for (Eigen::Index i = 0; i < model.tets.nodes.cols(); ++i)
    model.tets.nodes.col(i) *= bump(model.tets.nodes.col(i));
  model.skin = mesh::sphere(radius, subdivisions);
  for (Eigen::Index i = 0; i < model.skin.vertices.cols(); ++i)
    model.skin.vertices.col(i) *= bump(model.skin.vertices.col(i));
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  return model;
}

/// A bar along x on two collinear bones.
inline palpate::LayeredModel bar_on_bones(const std::array<int, 3>& cells) {
  using namespace palpate;
  LayeredModel model;
  model.name = "bar";
  const Vec3 size(2.0, 0.5, 0.4);
  model.tets = mesh::box(size, cells);
  model.skin = mesh::box_surface(size, {3 * cells[0], 3 * cells[1], 3 * cells[2]});
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  Bone left{"left", -1, Vec3(-1, 0, 0), Vec3(0, 0, 0), 0.15, 0.15},
      right{"right", 0, Vec3(0, 0, 0), Vec3(1, 0, 0), 0.15, 0.15};
  model.skeleton.bones = {left, right};
  return model;
}
