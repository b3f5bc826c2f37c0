#pragma once
#include <string>
#include <vector>

#include "palpate/mesh/embedding.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/regions.h"
#include "palpate/mesh/skeleton.h"

namespace palpate {

/// One convex proxy at rest (docs/theory/proxies.md), which covers the skin vertices `members`.  Every vertex
/// belongs to at least one proxy, and may belong to several.
struct ProxyHull {
  Points corners;            ///< 3 x at most 32, in convex position, at rest [m]
  std::vector<int> members;  ///< skin vertices, ascending
  int bone = -1;             ///< the bone that it follows; -1: the mean motion of its nodes
  /// Largest distance outside the hull of covered points other than its members: the inside of a rigid solid
  /// [m].
  double outside = 0.0;
};

/// The three levels of a soft object, as stored in one model file.  Absent parts are empty.
struct LayeredModel {
  std::string name;                ///< name of the model
  TetMesh tets;                    ///< the body's tetrahedra
  TriMesh skin;                    ///< closed, outwards, at rest
  mesh::Embedding embedding;       ///< embedding of skin.vertices in tets
  std::vector<ProxyHull> proxies;  ///< convex hulls around the skin
  Skeleton skeleton;               ///< bones, if any
  /// Bone that carries each node, -1 for tissue; empty without a skeleton.
  std::vector<int> bone_of_node;
  std::vector<MaterialRegion> regions;  ///< elements of other materials; empty: one material
};

}  // namespace palpate
