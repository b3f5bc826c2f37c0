#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "contact/image_source.h"
#include "contact/overlap_push.h"
#include "contact/region_parts.h"
#include "contact/region_piece.h"
#include "contact/self_contact_filter.h"
#include "palpate/core/clock.h"
#include "palpate/proxy/pruner.h"

namespace palpate::contact {
namespace {

constexpr double kAligned = 1e-3;  // [rad]: an image along such a normal is one along the overlap's own
// How far the second look turns a normal that is decided, and one that is not.
constexpr double kEnough = 0.02;  // [rad]
constexpr double kTooFar = 0.06;  // [rad]
constexpr double kCloser = 0.05;  // of the candidate gap: see overlap_push.cpp
constexpr int kLooks = 6;         // along a region's axes, until they settle

/// What the regions of a source with proxies share beside the context.
struct PrunedContext {
  std::shared_ptr<proxy::ProxySet> proxies_a, proxies_b;
  proxy::Pruner pruner;
  std::vector<int> proxy_of_a = {}, proxy_of_b = {};   ///< by face
  std::optional<SelfContactFilter> self_contact = {};  ///< of a body with itself, else empty
  std::vector<int> local_a = {}, local_b = {};         ///< scratch of pieces
  std::set<int> kept_a = {}, kept_b = {};              ///< proxies in the view of the query under way
  OverlapPush push = {};

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

std::vector<int> proxy_of_face(const proxy::ProxySet& proxies) {
  std::vector<int> out(static_cast<std::size_t>(proxies.face_count()));
  for (const proxy::SkinPatch& patch : proxies.patches())
    for (const int face : proxies.faces(patch)) out[static_cast<std::size_t>(face)] = patch.proxy;
  return out;
}

/// A region where proxies come near, or a part of one that has a plane of its own.
///
/// The pruner's normal came from patches, which reach beyond the overlap, more or less as the body is cut.
/// It is where the region is first looked at along.  Then the overlap says what its plane is
/// (region_planes.cpp): a coarse image of all regions measures what the proxies' overlaps push, the source
/// finds their normals, and the image that counts is taken along these.
///
/// How many looks.  A look along n finds n' = P(n).  Of a thin lens P knows n only to second order (its
/// thickness grows by 1 / cos, its middle surface stays where it is); in general a look leaves a part r of
/// the error, measured as 0.05 to 0.2 on the paper's scenes.  Two looks leave r^2.  Jumps of the pruner's
/// normal by phi are thus jumps by r^2 phi of the force, below a hundredth for phi = 0.2 rad.
///
/// Where the second look still turns the normal, r is near 1: an overlap as deep as it is wide pushes along
/// whatever it is seen along.  There are more looks then, each along what the last one found.  None comes or
/// goes at once: look k + 1 moves the normal by W_k (n_k+1 - n_k), W_k the product of weights that rise
/// smoothly with the turn of each look before it.  The normal is a function of the pose alone; what the last
/// query found would make it smoother along a slow path, and wrong on a fast one.
class PrunedRegion final : public ImageRegion {
 public:
  PrunedRegion(RegionContext& context, PrunedContext& pruned) : ImageRegion(context), pruned_(pruned) {}

  void start(const proxy::ContactRegion& region) {
    proxies_ = &region.pairs;
    candidate_gap_ = region.gap;
    faces_a_ = region.faces_a;
    faces_b_ = region.faces_b;
    others_a_.clear();
    looks_ = 0;
    share_ = 1.0;
    start(region.region.origin, region.region.normal);
  }
  /// Some faces of a of a region, along a normal of their own; `whole` may be this one.
  /// @param share  of the volume of the whole
  void start_part(const PrunedRegion& whole, std::span<const std::vector<int>> faces_of_parts,
                  std::size_t part, double share, const Vec3& normal) {
    share_ = whole.share_ * share;
    proxies_ = whole.proxies_;
    candidate_gap_ = whole.candidate_gap_;
    others_a_ = whole.others_a_;
    for (std::size_t i = 0; i < faces_of_parts.size(); ++i)
      if (i != part) others_a_.insert(others_a_.end(), faces_of_parts[i].begin(), faces_of_parts[i].end());
    faces_a_ = faces_of_parts[part];
    faces_b_ = whole.faces_b_;
    looks_ = whole.looks_;
    start(whole.axes_.origin, normal);
  }

  void take() override {
    see();
    leave_own_tissue();
    if (looking_for_ == Image::kAxes) return measure();
    if (looking_for_ == Image::kFirst) return refine();
  }

  /// It was looked at along its axes, and waits for what its plane is to be.
  bool waits() const { return waits_; }
  std::span<const PairOverlap> overlaps() const { return overlaps_; }
  Vec3 normal() const { return axes_.normal(); }
  const std::vector<int>& faces_a() const { return faces_a_; }
  bool may_look_again() const { return looks_ < kLooks; }
  /// The last look was too far from the normal that it found.
  bool wants_another() const { return next_weight_ > 0.0; }

  /// What the planes of all regions say about its normal.
  void take_normal(const Vec3& normal) {
    if (fresh_) weight_ = next_weight_;
    final_ = first_ ? normal : Vec3(final_ + weight_ * (normal - found_));
    found_ = normal;
    first_ = false;
    if (!std::exchange(fresh_, false)) return;
    const double turn = (normal - axes_.normal()).norm();
    if (overlaps_.empty()) next_weight_ = 0.0;
    if (looks_ > 1) next_weight_ *= smooth_step((turn - kEnough) / (kTooFar - kEnough));
  }
  void look_again() {
    const ContactAxes axes(axes_.origin, found_);
    std::optional<Extent> seen;
    if (!hits_.empty()) seen = seen_along(axes);
    axes_ = axes;
    look_along_axes(seen);
  }
  /// To the image that counts.
  void go_on() {
    waits_ = false;
    const Vec3 normal = final_.normalized();
    const bool turns = (normal - axes_.normal()).norm() > kAligned;
    if (!(context_.options.quadrature_error > 0.0)) {
      looking_for_ = Image::kFirst;
      if (turns) turn_to(ContactAxes(axes_.origin, normal));
      seen_ = ask(camera_of(window_, context_.first_pixels(), context_.shift()));
    } else if (turns) {
      looking_for_ = Image::kFiner;
      const ContactAxes axes(axes_.origin, normal);
      const NextImage next = next_along(axes);
      turn_to(axes);
      seen_ = ask_next(window_, next);
    } else {
      refine();  // that image is the first
    }
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
  void start(const Vec3& origin, const Vec3& normal) {
    forget();
    axes_ = ContactAxes(origin, normal);
    first_ = true;
    weight_ = next_weight_ = 1.0;
    {
      const ScopedTimer timer(context_.stages.patches_s);
      piece_a_.take(*context_.a, faces_a_, pruned_.local_a, others_a_);
      piece_b_.take(*context_.b, faces_b_, pruned_.local_b);
    }
    look_along_axes();
  }

  /// What an overlap pushes needs few pixels: those of a first image, or a quarter of the image's edge; as
  /// many again where it was seen to be a part of the region.
  void look_along_axes(const std::optional<Extent>& seen = {}) {
    constexpr double kFiner = 0.5;  // of the pixels' edge, at least
    const ImageOptions& options = context_.options;
    const int coarse = std::min(context_.first_pixels(), std::max(64, options.pixels / 4));
    looking_for_ = Image::kAxes;
    waits_ = false;
    ++looks_;
    overlaps_.clear();
    fit_pieces();
    double pixel = window_.longer_edge() / (coarse - 1);
    if (seen) pixel *= std::clamp((seen->high - seen->low).maxCoeff() / window_.longer_edge(), kFiner, 1.0);
    seen_ = ask(camera_of(window_, pixel, context_.shift()));
  }

  void measure() {
    const ScopedTimer timer(context_.stages.gaps_s);
    const double candidate_gap = context_.options.candidate_gap;  // without what the velocity adds to it
    const std::span<const PixelPush> push =
        pruned_.push.find(hits_, camera(), candidate_gap, kCloser * candidate_gap);
    pushes_.clear();
    for (std::size_t i = 0; i < hits_.size(); ++i)
      if (push[i].sum.z() > 0.0)
        push_of(pruned_.of_a(piece_a_.face_of(hits_[i].face_a)),
                pruned_.of_b(piece_b_.face_of(hits_[i].face_b)))
            .add(push[i]);
    for (std::size_t i = 0; i < overlaps_.size(); ++i) {
      overlaps_[i].push = axes_.to_world * pushes_[i].integral();
      overlaps_[i].volume = pushes_[i].sum.z();
    }
    waits_ = fresh_ = true;
  }
  PixelPush& push_of(int a, int b) {
    for (std::size_t i = overlaps_.size(); i-- > 0;)
      if (overlaps_[i].a == a && overlaps_[i].b == b) return pushes_[i];
    overlaps_.push_back({.a = a, .b = b});
    return pushes_.emplace_back();
  }

  void turn_to(const ContactAxes& axes) {
    axes_ = axes;
    fit_pieces();
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
  std::vector<int> faces_a_, faces_b_;
  std::vector<int> others_a_;  ///< of the pruner's region, in its other parts
  enum class Image { kAxes, kFirst, kFiner } looking_for_ = Image::kAxes;
  std::vector<PairOverlap> overlaps_;  ///< of the last look along the axes
  std::vector<PixelPush> pushes_;      ///< theirs
  int looks_ = 0;
  bool waits_ = false, fresh_ = false, first_ = true;
  Vec3 found_ = Vec3::Zero(), final_ = Vec3::Zero();  ///< normal by the last look, by all
  double weight_ = 1.0, next_weight_ = 1.0;           ///< of the last look and of the next one
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
                proxy::Pruner(*proxies_a, *proxies_b, {.between_bones = context_.of_one_body()}),
                proxy_of_face(*proxies_a), proxy_of_face(*proxies_b)},
        parts_(*proxies_a, *proxies_b) {
    context_.a->set_face_order(patch_by_patch(*proxies_a));
    if (!context_.of_one_body()) context_.b->set_face_order(patch_by_patch(*proxies_b));
  }
  /// A body with itself: the skin of its bones.
  PrunedSource(std::shared_ptr<ImageSide> side, std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
               const ImageOptions& options)
      : PrunedSource(side, proxies, side, proxies, options) {
    pruned_.self_contact.emplace(*side->soft(), std::move(rest_nodes));
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
    const int p = pruned_.of_a(face), q = pruned_.of_a(other);
    return pruned_.pruner.is_pair(p, q) || pruned_.pruner.is_pair(q, p);
  }
  std::unique_ptr<ImageRegion> make_region() override {
    return std::make_unique<PrunedRegion>(context_, pruned_);
  }
  void start(ImageRegion& region, std::size_t index) override {
    static_cast<PrunedRegion&>(region).start(found_[index]);
  }
  bool settles() const override { return true; }
  void settle(std::size_t count) override;

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

  PrunedRegion& at(std::size_t place) { return static_cast<PrunedRegion&>(region(place)); }
  bool plan(std::size_t count);
  void split(PrunedRegion& whole, std::span<const RegionPart> parts);

  PrunedContext pruned_;
  bool placed_ = false;                          ///< the proxies are where the sides are
  std::span<const proxy::ContactRegion> found_;  ///< of the query under way
  RegionParts parts_;
  struct Plan {
    std::size_t region;
    bool one_plane;
  };
  std::vector<Plan> plans_;
  std::vector<std::vector<int>> faces_of_parts_;
};

/// After a round in which regions were looked at along their axes: their planes.  All wait for all: a normal
/// depends on what pushes beside it, in whichever region that is.
void PrunedSource::settle(std::size_t count) {
  parts_.start();
  bool waiting = false;
  for (std::size_t i = 0; i < count; ++i)
    if (at(i).waits()) {
      waiting = true;
      parts_.add(at(i).overlaps());
    }
  if (!waiting) return;
  const bool done = plan(count);
  for (const Plan& plan : plans_) {
    PrunedRegion& region = at(plan.region);
    const bool unfinished = !plan.one_plane || region.wants_another();
    if (done) {
      context_.stages.unaligned += unfinished;
      region.go_on();
    } else if (unfinished && region.may_look_again()) {
      plan.one_plane ? region.look_again() : split(region, parts_.of(region.overlaps()));
    }
  }
}

/// The normals of regions that wait; whether all are settled, or may not be looked at again.
bool PrunedSource::plan(std::size_t count) {
  const ScopedTimer timer(context_.stages.regions_s);
  parts_.find_planes();
  plans_.clear();
  bool done = true;
  for (std::size_t i = 0; i < count; ++i) {
    PrunedRegion& region = at(i);
    if (!region.waits()) continue;
    Vec3 force = Vec3::Zero();
    const std::span<const RegionPart> parts = parts_.of(region.overlaps());
    for (const RegionPart& part : parts) force += part.force;
    region.take_normal(parts.empty() ? region.normal() : Vec3(force.normalized()));
    const Plan plan{i, parts.size() <= 1};
    done &= (plan.one_plane && !region.wants_another()) || !region.may_look_again();
    plans_.push_back(plan);
  }
  return done;
}

/// Each part in a region of its own; what presses nowhere stays with the largest.
void PrunedSource::split(PrunedRegion& whole, std::span<const RegionPart> parts) {
  faces_of_parts_.resize(std::max(faces_of_parts_.size(), parts.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) faces_of_parts_[i].clear();
  for (const int face : whole.faces_a()) {
    const int proxy = pruned_.of_a(face);
    std::size_t i = parts.size();
    while (--i > 0)
      if (std::find(parts[i].proxies.begin(), parts[i].proxies.end(), proxy) != parts[i].proxies.end()) break;
    faces_of_parts_[i].push_back(face);
  }
  const std::span<const std::vector<int>> faces(faces_of_parts_.data(), parts.size());
  double volume = 0.0;
  for (const RegionPart& part : parts) volume += part.volume;
  const auto start = [&](PrunedRegion& region, std::size_t i) {
    region.start_part(whole, faces, i, parts[i].volume / volume, parts[i].normal());
  };
  for (std::size_t i = 1; i < parts.size(); ++i) start(static_cast<PrunedRegion&>(add_region()), i);
  start(whole, 0);  // last: the others are parts of it as it was
}

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
