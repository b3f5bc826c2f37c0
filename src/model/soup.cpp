#include "soup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "palpate/core/error.h"

namespace palpate::model {
namespace {

/// Keeps the faces for which `keep` is true; returns how many were dropped.
template <class Keep>
int keep_faces(Soup& soup, Keep keep) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    if (keep(f)) {
      soup.faces[kept] = soup.faces[f];
      soup.face_source[kept++] = soup.face_source[f];
    }
  const auto gone = static_cast<int>(soup.faces.size() - kept);
  soup.faces.resize(kept);
  soup.face_source.resize(kept);
  return gone;
}

std::string place(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", p.x(), p.y(), p.z()); }

}  // namespace

TriMesh Soup::surface() const {
  TriMesh out{Points(3, static_cast<Eigen::Index>(vertices.size())),
              Faces(3, static_cast<Eigen::Index>(faces.size()))};
  for (std::size_t i = 0; i < vertices.size(); ++i)
    out.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
  for (std::size_t f = 0; f < faces.size(); ++f)
    out.faces.col(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return out;
}

double Soup::diagonal() const {
  const TriMesh mesh = surface();
  return (mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff()).norm();
}

std::string Soup::vertex_name(int v) const {
  const int source = vertex_source[static_cast<std::size_t>(v)];
  return fmt::format("{} at {}", source >= 0 ? from->node(source) : from->source + ": a vertex",
                     place(vertices[static_cast<std::size_t>(v)]));
}

std::string Soup::face_name(int f) const {
  const int source = face_source[static_cast<std::size_t>(f)];
  Vec3 middle = Vec3::Zero();
  for (const int v : faces[static_cast<std::size_t>(f)]) middle += vertices[static_cast<std::size_t>(v)] / 3;
  return fmt::format("{} at {}", source >= 0 ? from->element(source) : from->source + ": a face",
                     place(middle));
}

Soup soup_of(const TriMesh& faces, const mesh::Provenance& from) {
  constexpr double kLargest = 1e30;  // [m]; volumes beyond it overflow
  if (faces.faces.cols() == 0) fail("{}: the surface has no faces", from.source);
  Soup out;
  out.from = &from;
  for (int i = 0; i < static_cast<int>(faces.vertices.cols()); ++i) {
    const Vec3 p = faces.vertices.col(i);
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(p[k]) <= kLargest))
        fail("{}: {} = {} is not a finite length within 1e30 m; write the surface again", from.node(i),
             "xyz"[k], p[k]);
    out.vertices.push_back(p);
    out.vertex_source.push_back(i);
  }
  for (int f = 0; f < static_cast<int>(faces.faces.cols()); ++f) {
    for (int k = 0; k < 3; ++k)
      if (const int v = faces.faces(k, f); v < 0 || v >= static_cast<int>(faces.vertices.cols()))
        fail("{} refers to vertex {} (counted from 0), but the surface has {} vertices", from.element(f), v,
             faces.vertices.cols());
    out.faces.push_back({faces.faces(0, f), faces.faces(1, f), faces.faces(2, f)});
    out.face_source.push_back(f);
  }
  return out;
}

// Sorted by x, each vertex is compared with its successors until x exceeds the tolerance; the first in the
// file's order is kept.
int weld(Soup& soup, double tolerance) {
  const std::size_t count = soup.vertices.size();
  std::vector<int> order(count), target(count);
  std::iota(order.begin(), order.end(), 0);
  std::iota(target.begin(), target.end(), 0);
  const auto at = [&](int v) -> const Vec3& { return soup.vertices[static_cast<std::size_t>(v)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const std::array<double, 3> p{at(a).x(), at(a).y(), at(a).z()}, q{at(b).x(), at(b).y(), at(b).z()};
    return p != q ? p < q : a < b;
  });
  // Each target is at most its source, so following targets ends.
  const auto root = [&](int v) {
    while (target[static_cast<std::size_t>(v)] != v) v = target[static_cast<std::size_t>(v)];
    return v;
  };
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count && at(order[j]).x() - at(order[i]).x() <= tolerance; ++j) {
      if ((at(order[j]) - at(order[i])).cwiseAbs().maxCoeff() > tolerance) continue;
      const int a = root(order[i]), b = root(order[j]);
      target[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  int gone = 0;
  for (int v = 0; v < static_cast<int>(count); ++v) gone += root(v) != v;
  for (auto& face : soup.faces)
    for (int& v : face) v = root(v);
  return gone;
}

int drop_collapsed(Soup& soup) {
  return keep_faces(soup, [&](std::size_t f) {
    const auto& [a, b, c] = soup.faces[f];
    return a != b && b != c && c != a;
  });
}

int drop_duplicates(Soup& soup) {
  std::vector<std::pair<std::array<int, 3>, std::size_t>> sets;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    std::array<int, 3> set = soup.faces[f];
    std::sort(set.begin(), set.end());
    sets.emplace_back(set, f);
  }
  std::sort(sets.begin(), sets.end());
  std::vector<char> again(soup.faces.size(), 0);
  for (std::size_t i = 1; i < sets.size(); ++i) again[sets[i].second] = sets[i].first == sets[i - 1].first;
  return keep_faces(soup, [&](std::size_t f) { return !again[f]; });
}

int drop_unused(Soup& soup) {
  std::vector<int> place(soup.vertices.size(), -1);
  for (const auto& face : soup.faces)
    for (const int v : face) place[static_cast<std::size_t>(v)] = 0;
  std::size_t kept = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] < 0) continue;
    place[v] = static_cast<int>(kept);
    soup.vertices[kept] = soup.vertices[v];
    soup.vertex_source[kept++] = soup.vertex_source[v];
  }
  const auto gone = static_cast<int>(soup.vertices.size() - kept);
  soup.vertices.resize(kept);
  soup.vertex_source.resize(kept);
  for (auto& face : soup.faces)
    for (int& v : face) v = place[static_cast<std::size_t>(v)];
  return gone;
}

}  // namespace palpate::model
