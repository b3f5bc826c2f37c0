#pragma once
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "contact/image_region.h"
#include "contact/overlap_push.h"
#include "contact/region_mesh.h"
#include "contact/region_parts.h"
#include "contact/region_piece.h"
#include "contact/self_contact_filter.h"
#include "palpate/proxy/pruner.h"

namespace palpate::contact {

/// What the regions of a source with proxies share beside the context.
struct PrunedContext {
  std::shared_ptr<proxy::ProxySet> proxies_a, proxies_b;
  proxy::Pruner pruner;
  std::vector<int> proxy_of_a = {}, proxy_of_b = {};     ///< by face
  std::optional<SelfContactFilter> self_contact = {};    ///< of a body with itself, else empty
  std::vector<int> local_a = {}, local_b = {};           ///< scratch of pieces
  std::set<int> kept_a = {}, kept_b = {};                ///< proxies in the view of the query under way
  std::vector<std::unique_ptr<RegionMesh>> meshes = {};  ///< the first `meshes_in_use` are of this query
  std::size_t meshes_in_use = 0;
  OverlapPush push = {};

  RegionMesh& next_mesh() {
    if (meshes.size() == meshes_in_use) meshes.push_back(std::make_unique<RegionMesh>());
    return *meshes[meshes_in_use++];
  }
  int of_a(int face) const { return proxy_of_a[static_cast<std::size_t>(face)]; }
  int of_b(int face) const { return proxy_of_b[static_cast<std::size_t>(face)]; }
  /// For contact of a body with itself: a pair of proxies, each of which is looked at once, and not the far
  /// side of its own tissue.
  bool may_touch(const Facing& at, int face_a, int face_b, const ContactAxes& axes) const {
    if (!pruner.is_pair(of_a(face_a), of_b(face_b))) return false;
    return at.gap() >= 0.0 ||
           self_contact->in_contact(
               self_contact->point(face_a, at.weights_a, axes.world(Vec3(at.u, at.v, at.w_a))),
               self_contact->point(face_b, at.weights_b, axes.world(Vec3(at.u, at.v, at.w_b))));
  }
};

/// A region where proxies come near, or a part of one that has a plane of its own (pruned_region.cpp).
class PrunedRegion final : public ImageRegion {
 public:
  PrunedRegion(RegionContext& context, PrunedContext& pruned) : ImageRegion(context), pruned_(pruned) {}

  void start(const proxy::ContactRegion& region);
  /// The faces of some proxies of a of a region, along a normal of their own; `whole` may be this one.
  /// @param belongs  whether a proxy is one of them  @param share  of the volume of the whole
  template <class Belongs>
  void start_part(const PrunedRegion& whole, Belongs belongs, double share, const Vec3& normal) {
    share_ = whole.share_ * share;
    proxies_ = whole.proxies_;
    candidate_gap_ = whole.candidate_gap_;
    piece_a_.take_part(whole.piece_a_, belongs);
    piece_b_.take_part(whole.piece_b_, [](int) { return true; });
    looks_ = whole.looks_;
    step_ = whole.step_;
    const Vec3 along = whole.axes_.normal();
    start(whole.axes_.origin, (along + step_ * (normal - along)).normalized());
  }

  void take() override;
  void append_samples(SampleCells& samples) override;

  /// It was looked at along its axes, and waits for what its plane is to be.
  bool waits() const { return waits_; }
  std::span<const PairOverlap> overlaps() const { return overlaps_; }
  Vec3 normal() const { return axes_.normal(); }
  bool may_look_again() const;
  /// Another look would bring its normal nearer to what the overlap's is.
  bool wants_another() const { return next_weight_ > 0.0; }
  /// The last look was too far from the normal that it found.
  bool is_unaligned() const { return unaligned_; }

  /// What the planes of all regions say about its normal.
  void take_normal(const Vec3& normal);
  void look_again();
  void go_on();  ///< to the image that counts

 private:
  void start(const Vec3& origin, const Vec3& normal);
  void look_along_axes(const std::optional<Extent>& seen = {});
  void measure();
  PixelPush& push_of(int a, int b);
  void turn_to(const ContactAxes& axes);
  void refine();
  void fit_pieces();
  void leave_own_tissue();
  void keep_proxies();

  PrunedContext& pruned_;
  const std::vector<std::pair<int, int>>* proxies_ = nullptr;  ///< of the region
  RegionPiece piece_a_, piece_b_;
  ContactWindow window_;
  enum class Image { kAxes, kFirst, kFiner } looking_for_ = Image::kAxes;
  std::vector<PairOverlap> overlaps_;  ///< of the last look along the axes
  std::vector<PixelPush> pushes_;      ///< theirs
  int looks_ = 0;
  bool waits_ = false, fresh_ = false, first_ = true, unaligned_ = false;
  Vec3 last_along_ = Vec3::Zero(), last_found_ = Vec3::Zero();  ///< the last look's normal, and what it saw
  double step_ = 1.0;  ///< the part of the way that is gone from one to the other
  Vec3 next_ = Vec3::Zero(), final_ = Vec3::Zero();  ///< normal by the last look, by all
  double weight_ = 1.0, next_weight_ = 1.0;          ///< of the last look and of the next one
  bool seen_ = false;
};

}  // namespace palpate::contact
