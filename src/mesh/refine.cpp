#include "mesh/refine.h"

#include <algorithm>

namespace palpate::mesh {
namespace {

using Edge = std::array<int, 2>;

Edge edge_of(int a, int b) { return a < b ? Edge{a, b} : Edge{b, a}; }

/// Edges of a mesh, in ascending order of their ends: the numbers of midpoints do not depend on the order of
/// elements.
template <int Corners>
class Edges {
 public:
  Edges(const Eigen::Matrix<int, Corners, Eigen::Dynamic>& elements, int nodes) : nodes_(nodes) {
    list_.reserve(static_cast<std::size_t>(elements.cols()) * (Corners == 4 ? 6 : 3));
    for (Eigen::Index e = 0; e < elements.cols(); ++e)
      for (int i = 0; i < Corners; ++i)
        for (int j = i + 1; j < Corners; ++j) list_.push_back(edge_of(elements(i, e), elements(j, e)));
    std::sort(list_.begin(), list_.end());
    list_.erase(std::unique(list_.begin(), list_.end()), list_.end());
  }
  int midpoint(int a, int b) const {
    const auto at = std::lower_bound(list_.begin(), list_.end(), edge_of(a, b));
    return nodes_ + static_cast<int>(at - list_.begin());
  }
  Points with_midpoints(const Points& nodes) const {
    Points out(3, nodes.cols() + static_cast<Eigen::Index>(list_.size()));
    out.leftCols(nodes.cols()) = nodes;
    for (std::size_t i = 0; i < list_.size(); ++i)
      out.col(nodes.cols() + static_cast<Eigen::Index>(i)) =
          0.5 * (nodes.col(list_[i][0]) + nodes.col(list_[i][1]));
    return out;
  }
  std::vector<Edge> take() { return std::move(list_); }

 private:
  int nodes_;
  std::vector<Edge> list_;
};

double volume6(const Points& x, const Eigen::Vector4i& t) {
  const Vec3 a = x.col(t[0]);
  return (x.col(t[1]) - a).cross(x.col(t[2]) - a).dot(x.col(t[3]) - a);
}

/// Midpoints of the edges of one tetrahedron; those of opposite edges are opposite in the octahedron.
struct Octahedron {
  int m01, m02, m03, m12, m13, m23;

  /// Returns the four tetrahedra around the diagonal from a to b, whose neighbours form the ring.
  static std::array<Eigen::Vector4i, 4> around(int a, int b, const std::array<int, 4>& ring) {
    std::array<Eigen::Vector4i, 4> out;
    for (std::size_t i = 0; i < 4; ++i) out[i] = {a, b, ring[i], ring[(i + 1) % 4]};
    return out;
  }
  std::array<Eigen::Vector4i, 4> tets(const Points& x) const {
    const double first = (x.col(m02) - x.col(m13)).squaredNorm(),
                 second = (x.col(m01) - x.col(m23)).squaredNorm(),
                 third = (x.col(m03) - x.col(m12)).squaredNorm();
    if (first <= second && first <= third) return around(m02, m13, {m01, m03, m23, m12});
    if (second <= third) return around(m01, m23, {m02, m03, m13, m12});
    return around(m03, m12, {m01, m02, m23, m13});
  }
};

}  // namespace

RefinedTets refine(const TetMesh& coarse) {
  Edges<4> edges(coarse.tets, static_cast<int>(coarse.nodes.cols()));
  RefinedTets out;
  out.mesh.nodes = edges.with_midpoints(coarse.nodes);
  const Points& x = out.mesh.nodes;
  out.mesh.tets.resize(4, 8 * coarse.tets.cols());
  Eigen::Index next = 0;
  const auto add = [&](Eigen::Vector4i tet) {
    if (volume6(x, tet) < 0.0) std::swap(tet[2], tet[3]);
    out.mesh.tets.col(next++) = tet;
  };
  for (Eigen::Index e = 0; e < coarse.tets.cols(); ++e) {
    const Eigen::Vector4i t = coarse.tets.col(e);
    const auto mid = [&](int i, int j) { return edges.midpoint(t[i], t[j]); };
    const Octahedron o{mid(0, 1), mid(0, 2), mid(0, 3), mid(1, 2), mid(1, 3), mid(2, 3)};
    add({t[0], o.m01, o.m02, o.m03});
    add({o.m01, t[1], o.m12, o.m13});
    add({o.m02, o.m12, t[2], o.m23});
    add({o.m03, o.m13, o.m23, t[3]});
    for (const Eigen::Vector4i& inner : o.tets(x)) add(inner);
  }
  out.edges = edges.take();
  return out;
}

TriMesh refine(const TriMesh& coarse) {
  const Edges<3> edges(coarse.faces, static_cast<int>(coarse.vertices.cols()));
  TriMesh out;
  out.vertices = edges.with_midpoints(coarse.vertices);
  out.faces.resize(3, 4 * coarse.faces.cols());
  for (Eigen::Index f = 0; f < coarse.faces.cols(); ++f) {
    const Eigen::Vector3i t = coarse.faces.col(f);
    const int a = edges.midpoint(t[0], t[1]), b = edges.midpoint(t[1], t[2]), c = edges.midpoint(t[2], t[0]);
    out.faces.col(4 * f) << t[0], a, c;
    out.faces.col(4 * f + 1) << a, t[1], b;
    out.faces.col(4 * f + 2) << c, b, t[2];
    out.faces.col(4 * f + 3) << a, b, c;
  }
  return out;
}

}  // namespace palpate::mesh
