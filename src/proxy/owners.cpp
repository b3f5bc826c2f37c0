#include "proxy/owners.h"

#include <algorithm>
#include <map>

#include "palpate/core/error.h"

namespace palpate::proxy {

std::vector<int> owner_of_vertices(Eigen::Index vertices, const std::vector<ProxyHull>& proxies) {
  std::vector<int> owner(static_cast<std::size_t>(vertices), -1);
  for (std::size_t p = 0; p < proxies.size(); ++p)
    for (const int v : proxies[p].members) {
      if (v < 0 || v >= vertices)
        fail("proxy {}: member {} is not one of the {} skin vertices", p, v, vertices);
      if (owner[static_cast<std::size_t>(v)] < 0) owner[static_cast<std::size_t>(v)] = static_cast<int>(p);
    }
  return owner;
}

std::vector<int> owner_of_faces(const Faces& faces, Eigen::Index vertices,
                                const std::vector<ProxyHull>& proxies) {
  const std::vector<int> first = owner_of_vertices(vertices, proxies);
  for (std::size_t v = 0; v < first.size(); ++v)
    if (first[v] < 0) fail("skin vertex {} belongs to no proxy; add it to the members of one", v);
  std::vector<int> owner(static_cast<std::size_t>(faces.cols()), -1);
  std::vector<char> is_member(first.size(), 0);
  std::vector<std::vector<int>> faces_of_vertex(first.size());
  for (Eigen::Index f = 0; f < faces.cols(); ++f)
    faces_of_vertex[static_cast<std::size_t>(faces(0, f))].push_back(static_cast<int>(f));
  for (std::size_t p = 0; p < proxies.size(); ++p) {
    for (const int v : proxies[p].members) is_member[static_cast<std::size_t>(v)] = 1;
    for (const int v : proxies[p].members)
      for (const int f : faces_of_vertex[static_cast<std::size_t>(v)])
        if (owner[static_cast<std::size_t>(f)] < 0 && is_member[static_cast<std::size_t>(faces(1, f))] &&
            is_member[static_cast<std::size_t>(faces(2, f))])
          owner[static_cast<std::size_t>(f)] = static_cast<int>(p);
    for (const int v : proxies[p].members) is_member[static_cast<std::size_t>(v)] = 0;
  }
  for (std::size_t f = 0; f < owner.size(); ++f)
    if (owner[f] < 0)
      fail("skin face {} belongs to no proxy; add its three vertices to the members of one", f);
  return owner;
}

std::vector<int> owner_of_tets(const Tets& tets, Eigen::Index nodes, const mesh::Embedding& embedding,
                               const std::vector<int>& owner_of_vertex) {
  std::vector<std::map<int, int>> votes(static_cast<std::size_t>(tets.cols()));
  for (int v = 0; v < embedding.size(); ++v)
    if (const int owner = owner_of_vertex[static_cast<std::size_t>(v)]; owner >= 0)
      ++votes[static_cast<std::size_t>(embedding.tet[static_cast<std::size_t>(v)])][owner];
  const auto winner = [](const std::map<int, int>& count) {
    return std::max_element(count.begin(), count.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  };
  std::vector<int> owner(votes.size(), -1);
  for (std::size_t t = 0; t < votes.size(); ++t)
    if (!votes[t].empty()) owner[t] = winner(votes[t]);

  std::vector<std::map<int, int>> at_node(static_cast<std::size_t>(nodes));
  // One ring: owned tetrahedra vote at their nodes, then the others take the majority of their nodes' votes.
  for (bool spread = true; spread;) {
    spread = false;
    for (auto& node : at_node) node.clear();
    for (std::size_t t = 0; t < owner.size(); ++t)
      if (owner[t] >= 0)
        for (int k = 0; k < 4; ++k)
          ++at_node[static_cast<std::size_t>(tets(k, static_cast<Eigen::Index>(t)))][owner[t]];
    for (std::size_t t = 0; t < owner.size(); ++t) {
      if (owner[t] >= 0) continue;
      std::map<int, int> count;
      for (int k = 0; k < 4; ++k)
        for (const auto& [p, n] : at_node[static_cast<std::size_t>(tets(k, static_cast<Eigen::Index>(t)))])
          count[p] += n;
      if (count.empty()) continue;
      owner[t] = winner(count);
      spread = true;
    }
  }
  for (int& o : owner) o = std::max(o, 0);
  return owner;
}

}  // namespace palpate::proxy
