#pragma once
#include <vector>

#include "mesh/layered_model.h"

namespace palpate::proxy {

/// Returns the owning proxy of each face: the first that has its three vertices as members.
/// @throws Error when a face or a vertex belongs to no proxy, or a member is not a vertex
std::vector<int> owner_of_faces(const Faces& faces, Eigen::Index vertices,
                                const std::vector<ProxyHull>& proxies);

/// Returns the owning proxy of each tetrahedron, determined by the skin in front of it.  A tetrahedron that
/// holds skin vertices goes to the proxy that owns most of them (the first of equals).  From these the
/// ownership spreads through common nodes, ring by ring.  Tetrahedra that no skin reaches go to proxy 0.
/// @param owner_of_vertex  per skin vertex
std::vector<int> owner_of_tets(const Tets& tets, Eigen::Index nodes, const mesh::Embedding& embedding,
                               const std::vector<int>& owner_of_vertex);

/// Returns the first proxy that has each vertex as a member; -1: none.
std::vector<int> owner_of_vertices(Eigen::Index vertices, const std::vector<ProxyHull>& proxies);

}  // namespace palpate::proxy
