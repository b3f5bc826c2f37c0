#pragma once
#include <memory>
#include <span>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/mesh/layered_model.h"
#include "palpate/proxy/reach.h"

namespace palpate::proxy {

/// How a hull goes with its nodes.
enum class Follow {
  kAffine,  ///< by the affine map that fits them best (least squares): the tightest bound
  /// by their mean rotation (polar factor of the covariance);
  /// with a bone, by that of the nodes which the bone carries
  kRigid,
};

struct ProxySetOptions {
  Follow follow = Follow::kAffine;
  /// faces in a patch of skin, at most: the grain of what pruning hands on; 0: a 2000th of the skin, 4 to 64
  int patch_faces = 0;
};

/// Where a proxy is: its hull at rest moved by X -> linear X + offset, and grown by `inflation`, holds all
/// that it stands for.
struct ProxyState {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
  double stretch = 1.0;  ///< spectral norm of `linear`
  /// how far skin may be from where that map takes it [m]
  double residual = 0.0;
  double inflation = 0.0;                        ///< that, and what lies outside the hull at rest [m]
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< box around the inflated hull [m]
};

/// A few neighbouring faces of one proxy's skin, at rest in a ball.
struct SkinPatch {
  int proxy = 0;
  int first_face = 0, face_count = 0;  ///< in ProxySet::faces
  int first_slot = 0, slot_count = 0;  ///< its nodes, among those of the proxy
  double weight_sum = 1.0;             ///< largest sum |w| of its vertices
  Vec3 centre = Vec3::Zero();          ///< [m]
  double radius = 0.0;                 ///< [m]
  Vec3 area = Vec3::Zero();            ///< sum of the faces' area vectors, outward [m^2]
};
struct Ball {
  Vec3 centre;
  double radius;
};

/// A branch of the tree over a body's proxies, in preorder: its first child follows it, `after` is the next
/// that is none of its own.  Its box holds all skin and tetrahedra of its proxies, not closely
/// (proxy_set.cpp).
struct ProxyBranch {
  int parent = -1, after = 0;
  int proxy = -1;  ///< of a leaf
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
};

/// The convex proxies of one body at its present positions (docs/design.md, 4.2).
/// The derivation of the bounds stands in proxy_set.cpp.
///
/// After update every vertex of the skin lies in the inflated hull of each proxy that it is a member of,
/// whatever the nodes did, and so do its faces (hulls are convex) and the tetrahedra that the proxy owns:
/// together the inflated hulls cover the body.  An update visits the nodes once and the proxies' boxes; where
/// a proxy is, is found when it is first asked for.  The skin is never visited, and nothing is allocated.
/// Not for two threads at once, questions included.
class ProxySet {
 public:
  /// A soft body (tets and embedding), or a rigid one (neither).
  /// @throws Error for a model without proxies, or whose proxies leave out a vertex or a face
  explicit ProxySet(const LayeredModel& model, const ProxySetOptions& options = {});
  ~ProxySet();
  ProxySet(ProxySet&&) noexcept;

  /// soft: positions of the tets' nodes [m].  @throws InternalError when one is not finite
  void update(const Eigen::Ref<const Points>& nodes);
  void update(const Pose& pose);  ///< rigid

  /// How the body moves from here on; an update puts it to rest.  The bounds stand in proxy_motion.cpp.
  /// @param velocities  of the nodes [m/s], or their ways within some time [m]
  void set_motion(const Eigen::Ref<const Points>& velocities);
  void set_motion(const Twist& twist);         ///< rigid, of its frame
  void set_motion_from(const Pose& before);    ///< rigid: its way from there to here [m]
  const ProxyMotion& motion(int proxy) const;  ///< of its skin and its tetrahedra
  const ProxyMotion& motion() const;           ///< of all of the body
  /// Holds what motion(proxy) allows any of them: what is out of reach by this is so by theirs, however the
  /// proxies are grouped into bodies.
  const ProxyMotion& widest_motion() const;

  int size() const;
  int face_count() const;  ///< of the whole skin
  const ProxyState& state(int proxy) const;
  int bone(int proxy) const;
  /// present corners, without inflation, 3 x corner_count
  void copy_corners(int proxy, Eigen::Ref<Points> out) const;
  int corner_count(int proxy) const;
  /// The corner farthest along a direction, without inflation.
  Vec3 support(int proxy, const Vec3& direction) const;
  double most_along(int proxy, const Vec3& direction) const;  ///< direction . support
  /// Least width of its corners at rest [m].
  double rest_thickness(int proxy) const;
  double rest_thickness() const;        ///< of the thinnest [m]
  const Vec3& centre(int proxy) const;  ///< mean of the corners
  bool neighbours(int p, int q) const;  ///< they share a vertex of the skin, or are the same
  std::span<const SkinPatch> patches(int proxy) const;
  std::span<const SkinPatch> patches() const;  ///< all, proxy by proxy
  /// around its faces now, by the bound of its own nodes where that is much less than the proxy's
  Ball ball(const SkinPatch& patch) const;
  /// The patches of a proxy, among all patches and ascending, that may come within reach of an inflated hull
  /// of a set; those left out do not, proven.
  /// @param reach   of this body against the other
  /// @param toward  unit, from that hull to this proxy: a direction to try first, zero for none
  /// @param known   by patch, all patches: not 0 for those that nobody asks for
  void patches_near(int proxy, const ProxySet& other, int hull, const Reach& reach, const Vec3& toward,
                    std::span<const unsigned char> known, std::vector<int>& out) const;
  Vec3 area(const SkinPatch& patch) const;  ///< its area vector, moved with its proxy [m^2]
  std::span<const int> faces(const SkinPatch& patch) const;
  /// by bone where the model has a skeleton, else by place
  std::span<const ProxyBranch> tree() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::proxy
