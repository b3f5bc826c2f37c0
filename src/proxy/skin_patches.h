#pragma once
#include <vector>

#include "mesh/layered_model.h"

namespace palpate::proxy {

/// Patch of neighbouring faces of one proxy's skin, enclosed by a ball at rest.
struct SkinPatch {
  int proxy = 0;
  int first_face = 0, face_count = 0;  ///< in ProxySet::faces
  int first_slot = 0, slot_count = 0;  ///< its nodes, among the proxy's nodes
  double weight_sum = 1.0;             ///< largest sum |w| of its vertices
  Vec3 centre = Vec3::Zero();          ///< [m]
  double radius = 0.0;                 ///< [m]
  Vec3 area = Vec3::Zero();            ///< sum of the faces' area vectors, outward [m^2]
};
/// Ball in world coordinates [m].
struct Ball {
  Vec3 centre;
  double radius;
};

/// Branch of the tree over a body's proxies, in preorder: its first child follows it, and `after` is the next
/// branch outside its subtree.  Its box contains all skin and tetrahedra of its proxies and is not tight
/// (proxy_set.cpp).
struct ProxyBranch {
  int parent = -1, after = 0;
  int proxy = -1;  ///< proxy of a leaf; -1 for an inner branch
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
};

/// Patches of skin: the faces of each proxy, bisected along their longest extent until a piece has at most
/// `patch_faces` faces.
struct SkinPatches {
  std::vector<SkinPatch> patches;   ///< proxy by proxy
  std::vector<int> first_of_proxy;  ///< per proxy, and the total at the end
  std::vector<int> faces;           ///< every face once, patch by patch
};
/// Cuts the skin into patches.
/// @param owner_of_face  proxy of each face (owners.h)
SkinPatches skin_patches(const TriMesh& skin, const std::vector<int>& owner_of_face, int proxies,
                         int patch_faces);

/// Builds the tree over the proxies: by bone (each bone's proxies, then its child bones); proxies with no
/// bone between them are bisected by position.
/// @param middle  rest position of each proxy [m], 3 x count
std::vector<ProxyBranch> proxy_tree(const Skeleton& skeleton, const std::vector<ProxyHull>& proxies,
                                    const Points& middle);

/// Axis-aligned box [m].
struct Box {
  Vec3 low, high;
};
/// Recomputes the tree's boxes bottom-up from the boxes of the proxies.
void refit(std::vector<ProxyBranch>& tree, const std::vector<Box>& boxes);

}  // namespace palpate::proxy
