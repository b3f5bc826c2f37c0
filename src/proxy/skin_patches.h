#pragma once
#include <vector>

#include "palpate/proxy/proxy_set.h"

namespace palpate::proxy {

/// The faces of each proxy, cut in two along their longest extent until a piece has at most `patch_faces`.
struct SkinPatches {
  std::vector<SkinPatch> patches;   ///< proxy by proxy
  std::vector<int> first_of_proxy;  ///< and one more at the end
  std::vector<int> faces;           ///< every face once, patch by patch
};
SkinPatches skin_patches(const TriMesh& skin, const std::vector<int>& owner_of_face, int proxies,
                         int patch_faces);

/// The tree over the proxies: by bone (each bone's own proxies, then the bones that hang on it), and where
/// there are several without bones between them, halved by place.  `middle`: the rest place of each.
std::vector<ProxyBranch> proxy_tree(const Skeleton& skeleton, const std::vector<ProxyHull>& proxies,
                                    const Points& middle);

struct Box {
  Vec3 low, high;
};
/// Boxes of the proxies, and from the leaves' up.
void refit(std::vector<ProxyBranch>& tree, const std::vector<Box>& boxes);

}  // namespace palpate::proxy
