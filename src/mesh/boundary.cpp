#include "palpate/mesh/boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "palpate/mesh/quality.h"

namespace palpate::mesh {
namespace {

/// One face of one tetrahedron; equal faces have equal, sorted `nodes`.
struct NumberedSide {
  std::array<int, 3> nodes;
  int tet, face;
};

std::vector<NumberedSide> sides(const Tets& tets) {
  std::vector<NumberedSide> out;
  out.reserve(4 * static_cast<std::size_t>(tets.cols()));
  for (int t = 0; t < static_cast<int>(tets.cols()); ++t)
    for (int f = 0; f < 4; ++f) {
      NumberedSide side{{tets(kTetFaces[f][0], t), tets(kTetFaces[f][1], t), tets(kTetFaces[f][2], t)}, t, f};
      std::sort(side.nodes.begin(), side.nodes.end());
      out.push_back(side);
    }
  return out;
}

/// Returns the sides that belong to one tetrahedron, in the order of the tetrahedra.
std::vector<NumberedSide> single_sides(std::vector<NumberedSide> all) {
  std::sort(all.begin(), all.end(),
            [](const NumberedSide& a, const NumberedSide& b) { return a.nodes < b.nodes; });
  std::vector<NumberedSide> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool like_last = i > 0 && all[i - 1].nodes == all[i].nodes;
    const bool like_next = i + 1 < all.size() && all[i + 1].nodes == all[i].nodes;
    if (!like_last && !like_next) out.push_back(all[i]);
  }
  std::sort(out.begin(), out.end(), [](const NumberedSide& a, const NumberedSide& b) {
    return std::pair(a.tet, a.face) < std::pair(b.tet, b.face);
  });
  return out;
}

}  // namespace

Boundary boundary(const TetMesh& mesh) {
  const std::vector<NumberedSide> outer = single_sides(sides(mesh.tets));
  Boundary out;
  std::vector<int> vertex_of_node(static_cast<std::size_t>(mesh.nodes.cols()), -1);
  for (const NumberedSide& side : outer)
    for (const int node : side.nodes) vertex_of_node[static_cast<std::size_t>(node)] = 0;
  for (std::size_t node = 0; node < vertex_of_node.size(); ++node)
    if (vertex_of_node[node] == 0) {
      vertex_of_node[node] = static_cast<int>(out.node_of_vertex.size());
      out.node_of_vertex.push_back(static_cast<int>(node));
    }
  out.surface.vertices.resize(3, static_cast<Eigen::Index>(out.node_of_vertex.size()));
  for (std::size_t v = 0; v < out.node_of_vertex.size(); ++v)
    out.surface.vertices.col(static_cast<Eigen::Index>(v)) = mesh.nodes.col(out.node_of_vertex[v]);
  out.surface.faces.resize(3, static_cast<Eigen::Index>(outer.size()));
  for (std::size_t i = 0; i < outer.size(); ++i) {
    out.tet_of_face.push_back(outer[i].tet);
    for (int k = 0; k < 3; ++k) {
      const int node = mesh.tets(kTetFaces[outer[i].face][k], outer[i].tet);
      out.surface.faces(k, static_cast<Eigen::Index>(i)) = vertex_of_node[static_cast<std::size_t>(node)];
    }
  }
  return out;
}

// Divergence theorem with the field x/3: V = sum over faces of (a - o) . ((b - o) x (c - o)) / 6 for any o;
// the mean of the vertices keeps the terms small.
double enclosed_volume(const TriMesh& surface) {
  if (surface.vertices.cols() == 0) return 0.0;
  const Vec3 o = surface.vertices.rowwise().mean();
  double volume = 0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f) {
    const Vec3 a = surface.vertices.col(surface.faces(0, f)) - o,
               b = surface.vertices.col(surface.faces(1, f)) - o,
               c = surface.vertices.col(surface.faces(2, f)) - o;
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

// Sum of the solid angles of the faces seen from p, over 4 pi (Van Oosterom and Strackee 1983).
double winding_number(const TriMesh& surface, const std::vector<int>& faces, const Vec3& p) {
  double sum = 0;
  for (const int f : faces) {
    const Vec3 a = surface.vertices.col(surface.faces(0, f)) - p,
               b = surface.vertices.col(surface.faces(1, f)) - p,
               c = surface.vertices.col(surface.faces(2, f)) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace palpate::mesh
