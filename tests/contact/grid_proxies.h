#pragma once
#include <algorithm>
#include <memory>
#include <set>

#include "mesh/layered_model.h"
#include "proxy/decompose_solid.h"

namespace contact_tests {

using namespace palpate;

/// Cuts a skin into the cells of a grid: a cell's proxy has the faces whose centres are in the cell, and is
/// the box around them.
inline std::vector<ProxyHull> grid_proxies(const TriMesh& skin, int cells) {
  const Vec3 low = skin.vertices.rowwise().minCoeff(), size = Vec3(skin.vertices.rowwise().maxCoeff()) - low;
  std::vector<std::set<int>> members(static_cast<std::size_t>(cells * cells * cells));
  for (Eigen::Index f = 0; f < skin.faces.cols(); ++f) {
    Vec3 middle = Vec3::Zero();
    for (const int v : skin.faces.col(f)) middle += skin.vertices.col(v) / 3.0;
    int cell = 0;
    for (int axis = 0; axis < 3; ++axis)
      cell = cells * cell +
             std::clamp(static_cast<int>(cells * (middle - low)[axis] / size[axis]), 0, cells - 1);
    for (const int v : skin.faces.col(f)) members[static_cast<std::size_t>(cell)].insert(v);
  }
  std::vector<ProxyHull> out;
  for (const auto& set : members) {
    if (set.empty()) continue;
    ProxyHull hull;
    hull.members.assign(set.begin(), set.end());
    const Points points = skin.vertices(Eigen::all, hull.members);
    const Vec3 a = points.rowwise().minCoeff(), b = points.rowwise().maxCoeff();
    hull.corners.resize(3, 8);
    for (int i = 0; i < 8; ++i)
      hull.corners.col(i) = Vec3(i & 1 ? b.x() : a.x(), i & 2 ? b.y() : a.y(), i & 4 ? b.z() : a.z());
    out.push_back(hull);
  }
  return out;
}

inline std::shared_ptr<proxy::ProxySet> proxies_of(const TetMesh& tets, const TriMesh& skin,
                                                   const mesh::Embedding& embedding, int cells) {
  LayeredModel model;
  model.name = "test";
  model.tets = tets;
  model.skin = skin;
  model.embedding = embedding;
  model.proxies = grid_proxies(skin, cells);
  return std::make_shared<proxy::ProxySet>(model);
}

/// Returns the proxies of a rigid surface.
inline std::shared_ptr<proxy::ProxySet> proxies_of(const TriMesh& rigid,
                                                   const proxy::SolidOptions& options = {}) {
  return std::make_shared<proxy::ProxySet>(proxy::rigid_proxies(rigid, options));
}

}  // namespace contact_tests
