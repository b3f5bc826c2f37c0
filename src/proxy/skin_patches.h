#pragma once
#include <vector>

#include "proxy/proxy_set.h"

namespace palpate::proxy {

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
