#pragma once
#include <vector>

#include "palpate/mesh/layered_model.h"

namespace palpate::proxy {

/// The proxy that each face belongs to: the first that has its three vertices as members.
/// @throws Error when a face or a vertex belongs to none, or a member is no vertex
std::vector<int> owner_of_faces(const Faces& faces, Eigen::Index vertices,
                                const std::vector<ProxyHull>& proxies);

/// The proxy that each tetrahedron belongs to: that of the skin in front of it.  Tetrahedra that hold skin go
/// with the proxy that owns most of it (of equals the first); from them the ownership spreads through common
/// nodes, ring by ring; what no skin reaches goes to proxy 0.
/// @param owner_of_vertex  for each skin vertex
std::vector<int> owner_of_tets(const Tets& tets, Eigen::Index nodes, const mesh::Embedding& embedding,
                               const std::vector<int>& owner_of_vertex);

/// The first proxy that has each vertex as a member; -1: none.
std::vector<int> owner_of_vertices(Eigen::Index vertices, const std::vector<ProxyHull>& proxies);

}  // namespace palpate::proxy
