#pragma once
#include <memory>
#include <span>
#include <vector>

#include "mesh/layered_model.h"
#include "palpate/core/pose.h"
#include "proxy/reach.h"
#include "proxy/skin_patches.h"

namespace palpate::proxy {

/// How a hull follows its nodes.
enum class Follow {
  kAffine,  ///< affine least-squares fit to the nodes: the tightest bound
  /// Mean rotation of the nodes (polar factor of the covariance).  A proxy with a bone uses the nodes that
  /// the bone carries.
  kRigid,
};

/// Options of a ProxySet.
struct ProxySetOptions {
  Follow follow = Follow::kAffine;
  /// Largest number of faces per patch of skin, which is the granularity of the pruned skin; 0: a 2000th of
  /// the skin's faces, clamped to 4..64.
  int patch_faces = 0;
};

/// Placement of a proxy: its rest hull, moved by X -> linear X + offset and grown by `inflation`, contains
/// all skin and tetrahedra of the proxy.
struct ProxyState {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
  double stretch = 1.0;  ///< spectral norm of `linear`
  /// Bound on the distance of the skin from its image under that map [m].
  double residual = 0.0;
  double inflation = 0.0;  ///< `residual`, and the distance of members outside the rest hull [m]
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< box around the inflated hull [m]
};

/// The convex proxies of one body at its present positions (docs/theory/proxies.md). The bounds are derived
/// in proxy_set.cpp.
///
/// After an update every vertex of the skin lies in the inflated hull of each proxy that it is a member of,
/// for any motion of the nodes, and so do its faces (hulls are convex) and the tetrahedra that the proxy
/// owns: together the inflated hulls cover the body.  An update visits the nodes once and the proxies' boxes;
/// a proxy's placement is computed on first use.  The skin is never visited, and nothing is allocated. Not
/// thread-safe, const members included, because placements are cached.
class ProxySet {
 public:
  /// Builds the proxies of a soft body (tets and embedding) or a rigid one (neither).
  /// @throws Error for a model without proxies, or whose proxies omit a vertex or a face
  explicit ProxySet(const LayeredModel& model, const ProxySetOptions& options = {});
  ~ProxySet();
  ProxySet(ProxySet&&) noexcept;

  /// Moves a soft body's proxies to the present positions of the tets' nodes [m], 3 x node count.
  /// @throws InternalError when a position is not finite
  void update(const Eigen::Ref<const Points>& nodes);
  void update(const Pose& pose);  ///< moves a rigid body's proxies to a pose

  /// Sets the motion of a soft body from here on; an update resets it to rest.  The bounds are derived in
  /// proxy_set_motion.cpp.
  /// @param velocities  per node [m/s], or displacements within a given time [m]
  void set_motion(const Eigen::Ref<const Points>& velocities);
  void set_motion(const Twist& twist);         ///< rigid: velocity of its frame
  void set_motion_from(const Pose& before);    ///< rigid: displacement from that pose to the present one [m]
  const ProxyMotion& motion(int proxy) const;  ///< bounds the motion of the proxy's skin and tetrahedra
  const ProxyMotion& motion() const;           ///< bounds the motion of the whole body
  /// Bounds every motion(proxy): a distance that is out of reach by this bound is out of reach by each
  /// proxy's bound, however the proxies are grouped into bodies.
  const ProxyMotion& widest_motion() const;

  int size() const;
  int face_count() const;  ///< faces of the whole skin
  const ProxyState& state(int proxy) const;
  /// Returns the bone that carries the proxy; -1 for none.
  int bone(int proxy) const;
  /// Copies the present corners, without inflation, into `out`, 3 x corner_count [m].
  void copy_corners(int proxy, Eigen::Ref<Points> out) const;
  int corner_count(int proxy) const;
  /// Returns the corner farthest along a direction, without inflation [m].
  Vec3 support(int proxy, const Vec3& direction) const;
  double most_along(int proxy, const Vec3& direction) const;  ///< direction . support
  /// Returns the least width of the proxy's corners at rest [m].
  double rest_thickness(int proxy) const;
  double rest_thickness() const;        ///< least over all proxies [m]
  const Vec3& centre(int proxy) const;  ///< mean of the corners [m]
  bool neighbours(int p, int q) const;  ///< whether p and q share a vertex of the skin, or are the same
  std::span<const SkinPatch> patches(int proxy) const;
  std::span<const SkinPatch> patches() const;  ///< all patches, proxy by proxy
  /// Returns a ball around the patch's present faces.  It uses the bound of the patch's nodes where that is
  /// much less than the proxy's bound.
  Ball ball(const SkinPatch& patch) const;
  /// Collects the patches of a proxy that may come within reach of an inflated hull of another set; a patch
  /// left out is proven out of reach.
  /// @param proxy   proxy of this set
  /// @param other   set of the other body
  /// @param hull    proxy of `other`
  /// @param reach   of this body relative to the other
  /// @param toward  unit, from that hull to this proxy: a direction to try first; zero for none
  /// @param known   per patch of this set: nonzero excludes the patch from the search
  /// @param out     indices into patches(), ascending
  void patches_near(int proxy, const ProxySet& other, int hull, const Reach& reach, const Vec3& toward,
                    std::span<const unsigned char> known, std::vector<int>& out) const;
  Vec3 area(const SkinPatch& patch) const;  ///< area vector, moved with its proxy [m^2]
  std::span<const int> faces(const SkinPatch& patch) const;
  /// Returns the tree over the proxies, by bone if the model has a skeleton, else by position.
  std::span<const ProxyBranch> tree() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::proxy
