#include "manifold.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "palpate/mesh/boundary.h"
#include "palpate/mesh/quality.h"

namespace palpate::model {
namespace {

using TetList = std::vector<int>;

/// Disjoint sets of tetrahedra or of face corners.
class Groups {
 public:
  explicit Groups(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0u); }
  std::size_t of(std::size_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = of(a), b = of(b);
    root_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> root_;
};

/// Returns the groups of a list's tetrahedra that are connected by faces containing all of `at`; each group
/// ascending.
std::vector<TetList> fans(const TetMesh& mesh, const TetList& list, const std::vector<int>& at) {
  std::map<std::array<int, 3>, std::size_t> first;
  Groups groups(list.size());
  for (std::size_t i = 0; i < list.size(); ++i)
    for (const auto& face : mesh::kTetFaces) {
      std::array<int, 3> nodes{mesh.tets(face[0], list[i]), mesh.tets(face[1], list[i]),
                               mesh.tets(face[2], list[i])};
      if (!std::all_of(at.begin(), at.end(),
                       [&](int node) { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); }))
        continue;
      std::sort(nodes.begin(), nodes.end());
      if (const auto [old, fresh] = first.emplace(nodes, i); !fresh) groups.join(old->second, i);
    }
  std::map<std::size_t, TetList> by_root;
  for (std::size_t i = 0; i < list.size(); ++i) by_root[groups.of(i)].push_back(list[i]);
  std::vector<TetList> out;
  for (auto& [root, group] : by_root) out.push_back(std::move(group));
  return out;
}

double volume_of(const TetMesh& mesh, const TetList& list) {
  double out = 0;
  for (const int tet : list) out += mesh::tet_volume(mesh, tet);
  return out;
}

/// Marks all fans but the largest; returns false if there is only one.
bool mark_lesser(const TetMesh& mesh, const std::vector<TetList>& fans, std::vector<char>& marked) {
  if (fans.size() < 2) return false;
  std::size_t largest = 0;
  for (std::size_t i = 1; i < fans.size(); ++i)
    if (volume_of(mesh, fans[i]) > volume_of(mesh, fans[largest])) largest = i;
  for (std::size_t i = 0; i < fans.size(); ++i)
    if (i != largest)
      for (const int tet : fans[i]) marked[static_cast<std::size_t>(tet)] = 1;
  return true;
}

/// Returns the places where the boundary touches itself: edges (two nodes) and nodes (one).
std::vector<std::vector<int>> touching(const TetMesh& mesh) {
  const mesh::Boundary boundary = mesh::boundary(mesh);
  const Faces& faces = boundary.surface.faces;
  std::map<std::array<int, 2>, std::vector<std::size_t>> faces_at;
  for (Eigen::Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces(k, f), faces((k + 1) % 3, f));
      faces_at[{low, high}].push_back(static_cast<std::size_t>(f));
    }
  const auto node = [&](int v) { return boundary.node_of_vertex[static_cast<std::size_t>(v)]; };
  std::vector<std::vector<int>> out;
  std::vector<char> at_edge(boundary.node_of_vertex.size(), 0);
  // Corners of faces are joined along edges around their vertex; a manifold vertex has one group.
  Groups corners(static_cast<std::size_t>(3 * faces.cols()));
  const auto corner = [&](std::size_t f, int v) {
    const auto face = static_cast<Eigen::Index>(f);
    return 3 * f + static_cast<std::size_t>(faces(0, face) == v ? 0 : faces(1, face) == v ? 1 : 2);
  };
  for (const auto& [edge, there] : faces_at) {
    if (there.size() > 2) {
      out.push_back({node(edge[0]), node(edge[1])});
      for (const int v : edge) at_edge[static_cast<std::size_t>(v)] = 1;
    }
    for (std::size_t i = 1; i < there.size(); ++i)
      for (const int v : edge) corners.join(corner(there[0], v), corner(there[i], v));
  }
  std::vector<std::size_t> group_of(boundary.node_of_vertex.size(), static_cast<std::size_t>(-1));
  for (Eigen::Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = faces(k, f);
      const std::size_t group = corners.of(corner(static_cast<std::size_t>(f), v));
      std::size_t& known = group_of[static_cast<std::size_t>(v)];
      if (known == static_cast<std::size_t>(-1)) known = group;
      if (known == group || at_edge[static_cast<std::size_t>(v)]) continue;
      out.push_back({node(v)});
      at_edge[static_cast<std::size_t>(v)] = 1;  // report each vertex once
    }
  return out;
}

/// Returns the smallest tetrahedron of a list that has a boundary face at the place.
int smallest_outer(const TetMesh& mesh, const TetList& list, const std::vector<int>& at) {
  int best = list[0];
  double least = std::numeric_limits<double>::infinity();
  for (const int tet : list) {
    int inner = 0;  // faces at the place that are shared with another tetrahedron of the list
    for (const int other : list)
      if (other != tet && fans(mesh, {tet, other}, at).size() == 1) ++inner;
    if (const double volume = mesh::tet_volume(mesh, tet);
        inner < (at.size() == 1 ? 3 : 2) && volume < least) {
      least = volume;
      best = tet;
    }
  }
  return best;
}

void remove(FittedMesh& mesh, const std::vector<char>& marked, ManifoldReport& report) {
  TetMesh out{Points(3, mesh.mesh.nodes.cols()), Tets(4, mesh.mesh.tets.cols())};
  std::vector<int> number(static_cast<std::size_t>(mesh.mesh.nodes.cols()), -1);
  std::vector<char> used(number.size(), 0);
  Eigen::Index tets = 0;
  for (Eigen::Index t = 0; t < mesh.mesh.tets.cols(); ++t) {
    if (!marked[static_cast<std::size_t>(t)]) {
      for (int k = 0; k < 4; ++k) used[static_cast<std::size_t>(mesh.mesh.tets(k, t))] = 1;
      out.tets.col(tets++) = mesh.mesh.tets.col(t);
      continue;
    }
    if (report.taken++ == 0)
      for (int k = 0; k < 4; ++k) report.place += mesh.mesh.nodes.col(mesh.mesh.tets(k, t)) / 4;
    report.volume += mesh::tet_volume(mesh.mesh, static_cast<int>(t));
  }
  Eigen::Index nodes = 0;
  std::vector<char> on_crease;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (!used[i]) continue;
    number[i] = static_cast<int>(nodes);
    out.nodes.col(nodes++) = mesh.mesh.nodes.col(static_cast<Eigen::Index>(i));
    on_crease.push_back(mesh.on_crease[i]);
  }
  out.nodes.conservativeResize(3, nodes);
  out.tets.conservativeResize(4, tets);
  for (Eigen::Index t = 0; t < tets; ++t)
    for (int k = 0; k < 4; ++k) out.tets(k, t) = number[static_cast<std::size_t>(out.tets(k, t))];
  mesh.mesh = std::move(out);
  mesh.on_crease = std::move(on_crease);
}

/// Returns for each place of a list the tetrahedra that contain all of its nodes.
std::vector<TetList> tetrahedra_at(const TetMesh& mesh, const std::vector<std::vector<int>>& places) {
  std::map<int, TetList> around;
  for (const std::vector<int>& at : places)
    for (const int node : at) around[node];
  for (Eigen::Index t = 0; t < mesh.tets.cols(); ++t)
    for (int k = 0; k < 4; ++k)
      if (const auto found = around.find(mesh.tets(k, t)); found != around.end())
        found->second.push_back(static_cast<int>(t));
  std::vector<TetList> out;
  for (const std::vector<int>& at : places) {
    TetList both = around[at[0]];
    for (std::size_t i = 1; i < at.size(); ++i) {
      TetList shared;
      std::set_intersection(both.begin(), both.end(), around[at[i]].begin(), around[at[i]].end(),
                            std::back_inserter(shared));
      both = std::move(shared);
    }
    out.push_back(std::move(both));
  }
  return out;
}

}  // namespace

ManifoldReport make_boundary_manifold(FittedMesh& mesh) {
  ManifoldReport report;
  // Each round removes at least one tetrahedron, so the loop ends.
  for (;;) {
    const std::vector<std::vector<int>> places = touching(mesh.mesh);
    if (places.empty()) break;
    const std::vector<TetList> there = tetrahedra_at(mesh.mesh, places);
    std::vector<char> marked(static_cast<std::size_t>(mesh.mesh.tets.cols()), 0);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto taken = [&](int tet) { return marked[static_cast<std::size_t>(tet)] != 0; };
      if (std::any_of(there[i].begin(), there[i].end(), taken)) continue;  // checked again in the next round
      if (!mark_lesser(mesh.mesh, fans(mesh.mesh, there[i], places[i]), marked))
        marked[static_cast<std::size_t>(smallest_outer(mesh.mesh, there[i], places[i]))] = 1;
    }
    remove(mesh, marked, report);
  }
  if (report.taken == 0) return report;
  TetList all(static_cast<std::size_t>(mesh.mesh.tets.cols()));
  std::iota(all.begin(), all.end(), 0);
  std::vector<char> marked(all.size(), 0);
  if (mark_lesser(mesh.mesh, fans(mesh.mesh, all, {}), marked)) remove(mesh, marked, report);
  return report;
}

}  // namespace palpate::model
