#include <algorithm>
#include <set>
#include <span>

#include "contact/image_source.h"
#include "contact/region_piece.h"
#include "contact/self_contact_filter.h"
#include "palpate/core/clock.h"
#include "palpate/proxy/pruner.h"

namespace palpate::contact {
namespace {

/// What the regions of a source with proxies share beside the context.
struct PrunedContext {
  std::shared_ptr<proxy::ProxySet> proxies_a, proxies_b;
  proxy::Pruner pruner;
  std::optional<SelfContactFilter> self_contact = {};  ///< of a body with itself, else empty
  std::vector<int> proxy_of_face = {};
  std::vector<int> local_a = {}, local_b = {};  ///< scratch of pieces
  std::set<int> kept_a = {}, kept_b = {};       ///< proxies in the view of the query under way

  /// For contact of a body with itself: a pair of proxies, each of which is looked at once, and not the far
  /// side of its own tissue.
  bool may_touch(const Facing& at, int face_a, int face_b, const ContactAxes& axes) const {
    if (!pruner.is_pair(proxy_of_face[static_cast<std::size_t>(face_a)],
                        proxy_of_face[static_cast<std::size_t>(face_b)]))
      return false;
    return at.gap() >= 0.0 ||
           self_contact->in_contact(
               self_contact->point(face_a, at.weights_a, axes.world(Vec3(at.u, at.v, at.w_a))),
               self_contact->point(face_b, at.weights_b, axes.world(Vec3(at.u, at.v, at.w_b))));
  }
};

/// A region where proxies come near.
///
/// The region's normal came from patches, which reach beyond the overlap, more or less as the body is cut.
/// The overlap itself has one: its boundary is closed, so the area vectors of a's skin in b and of b's in a
/// are opposite, and their common direction pushes the bodies apart.  Seen along n, a pixel of area dA shows
/// (s, 1) dA of each, s the slope of -a's or of b's skin: n is tilted by the mean slope of both, and kept
/// where that is zero.  It depends on the pose alone.
/// A mean over the overlap needs few pixels: those of a first image, or a quarter of the image's edge.
class PrunedRegion final : public ImageRegion {
 public:
  PrunedRegion(RegionContext& context, PrunedContext& pruned) : ImageRegion(context), pruned_(pruned) {}

  void start(const proxy::ContactRegion& region) {
    forget();
    proxies_ = &region.pairs;
    candidate_gap_ = region.gap;
    axes_ = ContactAxes(region.region.origin, region.region.normal);
    {
      const ScopedTimer timer(context_.stages.patches_s);
      piece_a_.take(*context_.a, region.faces_a, pruned_.local_a);
      piece_b_.take(*context_.b, region.faces_b, pruned_.local_b);
    }
    alignments_ = 0;
    look_along_axes();
  }

  void take() override {
    see();
    leave_own_tissue();
    if (looking_for_ == Image::kAxes) return align();
    if (looking_for_ == Image::kFirst) return refine();
  }

  void append_samples(SampleCells& samples) override {
    if (!seen_) return;
    finish();
    leave_own_tissue();  // what finish() has found besides
    keep_view();
    keep_proxies();
    const ScopedTimer timer(context_.stages.gaps_s);
    append_hits(
        samples, [&](int face) { return piece_a_.face_of(face); },
        [&](int face) { return piece_b_.face_of(face); });
  }

 private:
  static constexpr int kAlignments = 3;

  void look_along_axes() {
    const ImageOptions& options = context_.options;
    const int coarse = std::min(context_.first_pixels(), std::max(64, options.pixels / 4));
    looking_for_ = Image::kAxes;
    fit_pieces();
    seen_ = ask(camera_of(window_, coarse, context_.shift()));
  }

  void align() {
    OverlapSlope slope;
    for (const Hit& hit : hits_)
      if (hit.at.gap() < 0.0) slope.add(piece_a_.slope_of(a_, hit.face_a), piece_b_.slope_of(b_, hit.face_b));
    const bool aligned = !align_with_overlap(slope, axes_);
    if (!aligned && ++alignments_ < kAlignments) return look_along_axes();
    context_.stages.unaligned += !aligned;
    if (aligned && context_.options.quadrature_error > 0.0) return refine();  // that image is the first
    looking_for_ = Image::kFirst;
    if (!aligned) fit_pieces();
    seen_ = ask(camera_of(window_, context_.first_pixels(), context_.shift()));
  }

  void refine() {
    looking_for_ = Image::kFiner;
    ask_finer(window_);
  }

  void fit_pieces() {
    const ScopedTimer timer(context_.stages.patches_s);
    piece_a_.see(axes_, -1.0, a_);
    piece_b_.see(axes_, 1.0, b_);
    set_sources(piece_a_.source(*context_.a), piece_b_.source(*context_.b));
    window_ = piece_a_.sees_nothing() || piece_b_.sees_nothing() ? ContactWindow{}
                                                                 : fit_window(a_, b_, candidate_gap_);
  }

  void leave_own_tissue() {
    if (pruned_.self_contact)
      std::erase_if(hits_, [&](const Hit& h) {
        return !pruned_.may_touch(h.at, piece_a_.face_of(h.face_a), piece_b_.face_of(h.face_b), axes_);
      });
  }

  struct OverlapSlope {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    long pressed = 0;
    void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      sum += 0.5 * (a + b);
      ++pressed;
    }
  };
  /// False where the axes are aligned already, or nothing overlaps.
  static bool align_with_overlap(const OverlapSlope& slope, ContactAxes& axes) {
    constexpr double kAligned = 1e-3;  // [rad]
    if (slope.pressed == 0) return false;
    const Eigen::Vector2d mean = slope.sum / static_cast<double>(slope.pressed);
    if (!(mean.norm() > kAligned)) return false;
    axes = ContactAxes(axes.origin, (axes.to_world * Vec3(mean.x(), mean.y(), 1.0)).normalized());
    return true;
  }

  /// The hulls of a region where something presses, for pictures: each once, whatever regions it is in.
  void keep_proxies() {
    if (!context_.view ||
        std::none_of(hits_.begin(), hits_.end(), [](const Hit& h) { return h.at.gap() < 0.0; }))
      return;
    const auto keep = [](const proxy::ProxySet& set, int p, std::set<int>& kept, std::vector<Points>& out) {
      if (kept.insert(p).second) set.copy_corners(p, out.emplace_back(3, set.corner_count(p)));
    };
    for (const auto& [p, q] : *proxies_) {
      keep(*pruned_.proxies_a, p, pruned_.kept_a, context_.view->proxies_a);
      keep(*pruned_.proxies_b, q, pruned_.kept_b, context_.view->proxies_b);
    }
  }

  PrunedContext& pruned_;
  const std::vector<std::pair<int, int>>* proxies_ = nullptr;  ///< of the region
  RegionPiece piece_a_, piece_b_;
  ContactWindow window_;
  enum class Image { kAxes, kFirst, kFiner } looking_for_ = Image::kAxes;
  int alignments_ = 0;
  bool seen_ = false;
};

/// The regions where proxies come near.
class PrunedSource final : public ImageSource {
 public:
  PrunedSource(std::shared_ptr<ImageSide> a, std::shared_ptr<proxy::ProxySet> proxies_a,
               std::shared_ptr<ImageSide> b, std::shared_ptr<proxy::ProxySet> proxies_b,
               const ImageOptions& options)
      : ImageSource(std::move(a), std::move(b), options),
        pruned_{proxies_a, proxies_b,
                proxy::Pruner(*proxies_a, *proxies_b, {.between_bones = context_.of_one_body()})} {
    context_.a->set_face_order(patch_by_patch(*proxies_a));
    if (!context_.of_one_body()) context_.b->set_face_order(patch_by_patch(*proxies_b));
  }
  /// A body with itself: the skin of its bones.
  PrunedSource(std::shared_ptr<ImageSide> side, std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
               const ImageOptions& options)
      : PrunedSource(side, proxies, side, proxies, options) {
    pruned_.self_contact.emplace(*side->soft(), std::move(rest_nodes));
    pruned_.proxy_of_face.resize(static_cast<std::size_t>(proxies->face_count()));
    for (const proxy::SkinPatch& patch : proxies->patches())
      for (const int face : proxies->faces(patch))
        pruned_.proxy_of_face[static_cast<std::size_t>(face)] = patch.proxy;
  }

  long normals_kept() const override { return pruned_.pruner.counts().normals_kept; }
  const proxy::PruneCounts* pruning() const override { return &pruned_.pruner.counts(); }

 protected:
  std::size_t find_regions(const dynamics::StateView& state) override {
    const ScopedTimer timer(context_.stages.regions_s);
    pruned_.kept_a.clear();
    pruned_.kept_b.clear();
    if (!placed_) place();
    placed_ = false;
    const double time = context_.options.look_ahead;
    if (time > 0.0) {
      context_.a->set_motion(*pruned_.proxies_a, state);
      if (!context_.of_one_body()) context_.b->set_motion(*pruned_.proxies_b, state);
    }
    found_ = pruned_.pruner.query(context_.candidate_gap, time);
    for (const proxy::ContactRegion& region : found_)
      context_.take_speed(region.apart, region.approach, region.thickness);
    return found_.size();
  }
  double find_met(std::vector<int>& faces_a, std::vector<int>& faces_b) override {
    place();
    context_.a->set_way(*pruned_.proxies_a);
    if (!context_.of_one_body()) context_.b->set_way(*pruned_.proxies_b);
    pruned_.pruner.met_on_the_way(faces_a, faces_b);
    placed_ = context_.options.look_ahead > 0.0;  // else they rest
    return std::min(pruned_.proxies_a->rest_thickness(), pruned_.proxies_b->rest_thickness());
  }
  bool may_meet(int face, int other) const override {
    if (!context_.of_one_body()) return true;
    const int p = pruned_.proxy_of_face[static_cast<std::size_t>(face)],
              q = pruned_.proxy_of_face[static_cast<std::size_t>(other)];
    return pruned_.pruner.is_pair(p, q) || pruned_.pruner.is_pair(q, p);
  }
  std::unique_ptr<ImageRegion> make_region() override {
    return std::make_unique<PrunedRegion>(context_, pruned_);
  }
  void start(ImageRegion& region, std::size_t index) override {
    static_cast<PrunedRegion&>(region).start(found_[index]);
  }

 private:
  static std::vector<int> patch_by_patch(const proxy::ProxySet& proxies) {
    std::vector<int> faces;
    for (const proxy::SkinPatch& patch : proxies.patches()) {
      const auto of_patch = proxies.faces(patch);
      faces.insert(faces.end(), of_patch.begin(), of_patch.end());
    }
    return faces;
  }
  void place() {
    context_.a->update(*pruned_.proxies_a);
    if (!context_.of_one_body()) context_.b->update(*pruned_.proxies_b);
    placed_ = true;
  }

  PrunedContext pruned_;
  bool placed_ = false;                          ///< the proxies are where the sides are
  std::span<const proxy::ContactRegion> found_;  ///< of the query under way
};

}  // namespace

std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> a,
                                                 std::shared_ptr<proxy::ProxySet> proxies_a,
                                                 std::shared_ptr<ImageSide> b,
                                                 std::shared_ptr<proxy::ProxySet> proxies_b,
                                                 const ImageOptions& options) {
  return std::make_unique<PrunedSource>(std::move(a), std::move(proxies_a), std::move(b),
                                        std::move(proxies_b), options);
}

std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> side,
                                                 std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
                                                 const ImageOptions& options) {
  return std::make_unique<PrunedSource>(std::move(side), std::move(proxies), std::move(rest_nodes), options);
}

}  // namespace palpate::contact
