#pragma once
#include "mesh/layered_model.h"

namespace contact_tests {

using namespace palpate;

template <class Matrix>
Matrix beside(const Matrix& a, const Matrix& b) {
  Matrix out(a.rows(), a.cols() + b.cols());
  out << a, b;
  return out;
}

/// Merges two models into one body: nodes, vertices and proxies of b after those of a; a's proxies on bone 0,
/// b's on bone 1.
inline LayeredModel together(const LayeredModel& a, const LayeredModel& b) {
  LayeredModel out;
  out.name = "both";
  const int nodes = static_cast<int>(a.tets.nodes.cols()), tets = static_cast<int>(a.tets.tets.cols()),
            vertices = static_cast<int>(a.skin.vertices.cols());
  out.tets.nodes = beside(a.tets.nodes, b.tets.nodes);
  out.tets.tets = beside(a.tets.tets, Tets(b.tets.tets.array() + nodes));
  out.skin.vertices = beside(a.skin.vertices, b.skin.vertices);
  out.skin.faces = beside(a.skin.faces, Faces(b.skin.faces.array() + vertices));
  out.embedding.weights = beside(a.embedding.weights, b.embedding.weights);
  out.embedding.tet = a.embedding.tet;
  for (const int tet : b.embedding.tet) out.embedding.tet.push_back(tet + tets);
  for (const char* name : {"first", "second"})
    out.skeleton.bones.push_back({name, -1, Vec3::Zero(), Vec3::UnitZ(), 0.1, 0.1});
  out.bone_of_node.assign(static_cast<std::size_t>(out.tets.nodes.cols()), -1);
  out.proxies = a.proxies;
  for (ProxyHull& hull : out.proxies) hull.bone = 0;
  for (ProxyHull hull : b.proxies) {
    hull.bone = 1;
    for (int& member : hull.members) member += vertices;
    out.proxies.push_back(std::move(hull));
  }
  return out;
}

}  // namespace contact_tests
