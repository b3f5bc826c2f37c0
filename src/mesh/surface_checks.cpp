#include "mesh/surface_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common_checks.h"
#include "palpate/mesh/boundary.h"

namespace palpate::mesh {
namespace {

/// An edge and one of its faces: nodes sorted; `forward` if the face runs from the smaller to the larger
/// vertex.
struct EdgeOfFace {
  std::array<int, 2> nodes;
  int face;
  bool forward;
  auto operator<=>(const EdgeOfFace&) const = default;
};

std::vector<EdgeOfFace> sorted_edges(const Faces& faces) {
  std::vector<EdgeOfFace> out;
  out.reserve(3 * static_cast<std::size_t>(faces.cols()));
  for (int f = 0; f < static_cast<int>(faces.cols()); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = faces(k, f), b = faces((k + 1) % 3, f);
      out.push_back({{std::min(a, b), std::max(a, b)}, f, a < b});
    }
  std::sort(out.begin(), out.end());
  return out;
}

/// Face across an edge, and whether both faces run along the edge in the same direction (then one of them is
/// flipped).
struct Neighbour {
  int face;
  bool same_way;
};
using Neighbours = std::vector<std::vector<Neighbour>>;

/// Pairs the faces across each edge; rejects an edge that does not have exactly two.
Neighbours neighbours(const Faces& faces, const Provenance& from) {
  const std::vector<EdgeOfFace> edges = sorted_edges(faces);
  Neighbours out(static_cast<std::size_t>(faces.cols()));
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end].nodes == edges[i].nodes) ++end;
    const auto& [a, b] = edges[i].nodes;
    if (end - i == 1)
      fail(
          "{}: the edge from {} to {} belongs to no other face: the surface is not closed there; fill the "
          "hole",
          from.element(edges[i].face), from.node_name(a), from.node_name(b));
    if (end - i > 2)
      fail(
          "{}: the edge from {} to {} belongs to {} faces; a closed surface has two at each edge, separate "
          "the parts",
          from.element(edges[i].face), from.node_name(a), from.node_name(b), end - i);
    const EdgeOfFace &p = edges[i], &q = edges[i + 1];
    out[static_cast<std::size_t>(p.face)].push_back({q.face, p.forward == q.forward});
    out[static_cast<std::size_t>(q.face)].push_back({p.face, p.forward == q.forward});
    i = end;
  }
  return out;
}

void flip(Faces& faces, int f) { std::swap(faces(1, f), faces(2, f)); }

/// Walks from face to face within each connected shell and flips faces that disagree with the shell's first.
/// Returns the shell of each face; `flipped` records which faces were flipped.
std::vector<int> walk(Faces& faces, const Neighbours& across, const Provenance& from,
                      std::vector<char>& flipped) {
  std::vector<int> shell(across.size(), -1), stack;
  int shells = 0;
  for (int seed = 0; seed < static_cast<int>(across.size()); ++seed) {
    if (shell[static_cast<std::size_t>(seed)] >= 0) continue;
    shell[static_cast<std::size_t>(seed)] = shells;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const auto f = static_cast<std::size_t>(stack.back());
      stack.pop_back();
      for (const Neighbour& n : across[f]) {
        const auto g = static_cast<std::size_t>(n.face);
        const bool needs_flip = (flipped[f] != 0) != n.same_way;
        if (shell[g] < 0) {
          shell[g] = shells;
          flipped[g] = needs_flip;
          stack.push_back(n.face);
        } else if ((flipped[g] != 0) != needs_flip) {
          fail("{}: the surface cannot be oriented (it is one-sided, like a Moebius strip); repair it",
               from.element(n.face));
        }
      }
    }
    ++shells;
  }
  for (int f = 0; f < static_cast<int>(across.size()); ++f)
    if (flipped[static_cast<std::size_t>(f)]) flip(faces, f);
  return shell;
}

/// Returns the signed volume of a shell (as enclosed_volume), and the rounding error of a flat shell's
/// volume.
std::pair<double, double> shell_volume(const TriMesh& mesh, const std::vector<int>& faces) {
  const Vec3 o = mesh.vertices.col(mesh.faces(0, faces[0]));
  double volume = 0, terms = 0;
  for (const int f : faces) {
    const Vec3 a = mesh.vertices.col(mesh.faces(0, f)) - o, b = mesh.vertices.col(mesh.faces(1, f)) - o,
               c = mesh.vertices.col(mesh.faces(2, f)) - o;
    volume += a.dot(b.cross(c)) / 6;
    terms += a.norm() * b.cross(c).norm() / 6;
  }
  return {volume, 16 * std::numeric_limits<double>::epsilon() * terms};
}

/// Orients each shell outwards, or inwards if it lies within an odd number of others (it then bounds a
/// cavity).
void orient_shells_outwards(TriMesh& mesh, const std::vector<int>& shell_of_face, const Provenance& from,
                            std::vector<char>& flipped) {
  std::vector<std::vector<int>> shells;
  for (int f = 0; f < static_cast<int>(shell_of_face.size()); ++f) {
    const auto s = static_cast<std::size_t>(shell_of_face[static_cast<std::size_t>(f)]);
    if (s >= shells.size()) shells.resize(s + 1);
    shells[s].push_back(f);
  }
  for (std::size_t s = 0; s < shells.size(); ++s) {
    const auto [volume, rounding] = shell_volume(mesh, shells[s]);
    if (!(std::abs(volume) > rounding))
      fail("{}: the closed shell of {} faces that starts here encloses no volume ({:.3g} m^3); remove it",
           from.element(shells[s][0]), shells[s].size(), volume);
    int depth = 0;
    const Vec3 point = mesh.vertices.col(mesh.faces(0, shells[s][0]));
    for (std::size_t other = 0; other < shells.size(); ++other)
      if (other != s && std::abs(winding_number(mesh, shells[other], point)) > 0.5) ++depth;
    if ((volume > 0) == (depth % 2 == 0)) continue;
    for (const int f : shells[s]) {
      flip(mesh.faces, f);
      flipped[static_cast<std::size_t>(f)] ^= 1;
    }
  }
}

/// Rejects degenerate faces; fills in the edge lengths of the report.
void measure_faces(const TriMesh& mesh, const Provenance& from, MeshReport& report) {
  report.smallest_edge = std::numeric_limits<double>::infinity();
  for (int f = 0; f < static_cast<int>(mesh.faces.cols()); ++f) {
    const Vec3 a = mesh.vertices.col(mesh.faces(0, f)), b = mesh.vertices.col(mesh.faces(1, f)),
               c = mesh.vertices.col(mesh.faces(2, f));
    const std::array<double, 3> edges = {(b - a).norm(), (c - b).norm(), (a - c).norm()};
    const double longest = *std::max_element(edges.begin(), edges.end()),
                 twice_area = (b - a).cross(c - a).norm();
    if (!(twice_area > kDegenerateTriangle * longest * longest))
      fail("{} is degenerate: area = {:.3g} m^2 with edges up to {:.3g} m; collapse its shortest edge",
           from.element(f), twice_area / 2, longest);
    report.largest_edge = std::max(report.largest_edge, longest);
    report.smallest_edge = std::min(report.smallest_edge, *std::min_element(edges.begin(), edges.end()));
  }
}

}  // namespace

MeshReport check_surface(TriMesh& mesh, const Provenance& from) {
  if (mesh.faces.cols() == 0) fail("{}: the surface has no faces", from.source);
  refuse_non_finite(mesh.vertices, from);
  refuse_repeated_nodes(mesh.faces, from);
  refuse_duplicates(mesh.faces, from);
  MeshReport report;
  measure_faces(mesh, from, report);
  const Neighbours across = neighbours(mesh.faces, from);
  std::vector<char> flipped(across.size(), 0);
  const std::vector<int> shell_of_face = walk(mesh.faces, across, from, flipped);
  orient_shells_outwards(mesh, shell_of_face, from, flipped);
  refuse_unreferenced(mesh.vertices.cols(), mesh.faces, from, "belongs to no face; delete such vertices");
  report.nodes = static_cast<int>(mesh.vertices.cols());
  report.elements = static_cast<int>(mesh.faces.cols());
  report.flipped = static_cast<int>(std::count(flipped.begin(), flipped.end(), 1));
  report.volume = enclosed_volume(mesh);
  return report;
}

}  // namespace palpate::mesh
