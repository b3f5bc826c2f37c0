#include <algorithm>
#include <span>

#include "contact/image_source.h"
#include "contact/overlap_push.h"
#include "contact/region_piece.h"
#include "contact/region_planes.h"
#include "contact/self_contact_filter.h"
#include "palpate/core/clock.h"
#include "palpate/proxy/pruner.h"

namespace palpate::contact {
namespace {

// Normals within this angle are one plane, and a plane that is as near to its overlap's normal is aligned.
constexpr double kOnePlane = 1e-3;  // [rad]
constexpr int kLooks = 6;           // along a region's axes, until they are aligned

/// What the regions of a source with proxies share beside the context.
struct PrunedContext {
  std::shared_ptr<proxy::ProxySet> proxies_a, proxies_b;
  proxy::Pruner pruner;
  std::vector<int> proxy_of_a = {}, proxy_of_b = {};   ///< by face
  std::optional<SelfContactFilter> self_contact = {};  ///< of a body with itself, else empty
  std::vector<int> local_a = {}, local_b = {};         ///< scratch of pieces
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
/// finds their normals, and what has another normal than it was seen along is looked at again.
class PrunedRegion final : public ImageRegion {
 public:
  PrunedRegion(RegionContext& context, PrunedContext& pruned) : ImageRegion(context), pruned_(pruned) {}

  void start(const proxy::ContactRegion& region) {
    faces_a_ = region.faces_a;
    faces_b_ = region.faces_b;
    looks_ = 0;
    start(region.region.origin, region.region.normal);
  }
  /// Some faces of a of a region, along a normal of their own; `whole` may be this one.
  void start_part(const PrunedRegion& whole, const std::vector<int>& faces_a, const Vec3& normal) {
    faces_a_ = faces_a;
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

  void look_along(const Vec3& normal) {
    axes_ = ContactAxes(axes_.origin, normal);
    look_along_axes();
  }
  /// The last plane: aligned, or there are no more looks.
  void go_on(const Vec3& normal, bool aligned) {
    waits_ = false;
    if (aligned && context_.options.quadrature_error > 0.0) return refine();  // that image is the first
    looking_for_ = Image::kFirst;
    if (!aligned) {
      axes_ = ContactAxes(axes_.origin, normal);
      fit_pieces();
    }
    seen_ = ask(camera_of(window_, context_.first_pixels(), context_.shift()));
  }

  void append_samples(std::vector<ContactSample>& samples) override {
    if (!seen_) return;
    finish();
    leave_own_tissue();  // what finish() has found besides
    const ScopedTimer timer(context_.stages.gaps_s);
    for (const Hit& hit : hits_)
      samples.push_back(sample_of(hit.at, hit.area, *context_.a, piece_a_.face_of(hit.face_a), *context_.b,
                                  piece_b_.face_of(hit.face_b), axes_));
  }

 private:
  void start(const Vec3& origin, const Vec3& normal) {
    forget();
    axes_ = ContactAxes(origin, normal);
    {
      const ScopedTimer timer(context_.stages.patches_s);
      piece_a_.take(*context_.a, faces_a_, pruned_.local_a);
      piece_b_.take(*context_.b, faces_b_, pruned_.local_b);
    }
    look_along_axes();
  }

  void look_along_axes() {
    const ImageOptions& options = context_.options;
    const int coarse = std::min(context_.first_pixels(), std::max(64, options.pixels / 4));
    looking_for_ = Image::kAxes;
    waits_ = false;
    ++looks_;
    fit_pieces();
    seen_ = ask(camera_of(window_, coarse, context_.shift()));
    if (!seen_) overlaps_.clear();
  }

  void measure() {
    const ScopedTimer timer(context_.stages.gaps_s);
    overlaps_.clear();
    const std::span<const Vec3> push = pruned_.push.find(hits_, camera(), context_.candidate_gap);
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      if (!(push[i].z() > 0.0)) continue;
      PairOverlap& overlap = overlap_of(pruned_.of_a(piece_a_.face_of(hits_[i].face_a)),
                                        pruned_.of_b(piece_b_.face_of(hits_[i].face_b)));
      overlap.push += push[i];
      overlap.volume += push[i].z();
    }
    for (PairOverlap& overlap : overlaps_) overlap.push = axes_.to_world * overlap.push;
    waits_ = true;
  }
  PairOverlap& overlap_of(int a, int b) {
    for (std::size_t i = overlaps_.size(); i-- > 0;)
      if (overlaps_[i].a == a && overlaps_[i].b == b) return overlaps_[i];
    return overlaps_.emplace_back(PairOverlap{.a = a, .b = b});
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
                                                                 : fit_window(a_, b_, context_.candidate_gap);
  }

  void leave_own_tissue() {
    if (pruned_.self_contact)
      std::erase_if(hits_, [&](const Hit& h) {
        return !pruned_.may_touch(h.at, piece_a_.face_of(h.face_a), piece_b_.face_of(h.face_b), axes_);
      });
  }

  PrunedContext& pruned_;
  std::vector<int> faces_a_, faces_b_;
  RegionPiece piece_a_, piece_b_;
  ContactWindow window_;
  enum class Image { kAxes, kFirst, kFiner } looking_for_ = Image::kAxes;
  std::vector<PairOverlap> overlaps_;  ///< of the last look along the axes
  int looks_ = 0;
  bool waits_ = false;
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
                proxy_of_face(*proxies_a), proxy_of_face(*proxies_b)} {
    context_.a->set_face_order(patch_by_patch(*proxies_a));
    if (!context_.of_one_body()) context_.b->set_face_order(patch_by_patch(*proxies_b));
  }
  /// A body with itself: the skin of its bones.
  PrunedSource(std::shared_ptr<ImageSide> side, std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
               const ImageOptions& options)
      : PrunedSource(side, proxies, side, proxies, options) {
    pruned_.self_contact.emplace(*side->soft(), std::move(rest_nodes));
  }

  const proxy::PruneCounts* pruning() const override { return &pruned_.pruner.counts(); }

 protected:
  std::size_t find_regions() override {
    const ScopedTimer timer(context_.stages.regions_s);
    context_.a->update(*pruned_.proxies_a);
    if (!context_.of_one_body()) context_.b->update(*pruned_.proxies_b);
    found_ = pruned_.pruner.query(context_.candidate_gap);
    return found_.size();
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
  PrunedRegion& at(std::size_t place) { return static_cast<PrunedRegion&>(region(place)); }
  /// The proxies of a region whose overlaps push along one normal.
  struct Part {
    Vec3 first;  ///< normal of the first of them
    Vec3 force;  ///< over the stiffness [m^3]
    double volume;
    std::vector<int> proxies, faces;
  };
  struct Plan {
    std::size_t region;
    Vec3 normal;
    bool aligned;
  };
  void find_planes(std::size_t count);
  void find_parts(const PrunedRegion& region);
  Vec3 mean_normal() const;
  void split(PrunedRegion& whole);

  PrunedContext pruned_;
  std::span<const proxy::ContactRegion> found_;  ///< of the query under way
  RegionPlanes planes_;
  std::span<const PlaneUnit> units_;
  std::vector<PairOverlap> overlaps_;
  std::vector<Part> parts_;
  std::size_t part_count_ = 0;
  std::vector<Plan> plans_;
};

/// After a round in which regions were looked at along their axes: their planes.  All wait for all: a normal
/// depends on what pushes beside it, in whichever region that is.
void PrunedSource::settle(std::size_t count) {
  bool waiting = false, done = true;
  for (std::size_t i = 0; i < count; ++i) waiting |= at(i).waits();
  if (!waiting) return;
  const ScopedTimer timer(context_.stages.patches_s);
  find_planes(count);
  plans_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    PrunedRegion& region = at(i);
    if (!region.waits()) continue;
    find_parts(region);
    const Vec3 normal = part_count_ > 0 ? mean_normal() : region.normal();
    const bool aligned = part_count_ <= 1 && (normal - region.normal()).norm() <= kOnePlane;
    plans_.push_back({i, normal, aligned});
    done &= aligned || !region.may_look_again();
  }
  for (const Plan& plan : plans_) {
    PrunedRegion& region = at(plan.region);
    if (done) {
      context_.stages.unaligned += !plan.aligned;
      region.go_on(plan.normal, plan.aligned);
    } else if (!plan.aligned && region.may_look_again()) {
      find_parts(region);
      part_count_ > 1 ? split(region) : region.look_along(plan.normal);
    }
  }
}

void PrunedSource::find_planes(std::size_t count) {
  overlaps_.clear();
  for (std::size_t i = 0; i < count; ++i)
    if (at(i).waits()) overlaps_.insert(overlaps_.end(), at(i).overlaps().begin(), at(i).overlaps().end());
  const auto key = [](const PairOverlap& overlap) { return std::pair(overlap.a, overlap.b); };
  std::sort(overlaps_.begin(), overlaps_.end(),
            [&](const PairOverlap& x, const PairOverlap& y) { return key(x) < key(y); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < overlaps_.size(); ++i) {
    if (kept > 0 && key(overlaps_[kept - 1]) == key(overlaps_[i])) {
      overlaps_[kept - 1].push += overlaps_[i].push;
      overlaps_[kept - 1].volume += overlaps_[i].volume;
    } else {
      overlaps_[kept++] = overlaps_[i];
    }
  }
  overlaps_.resize(kept);
  units_ = planes_.find(
      overlaps_, [&](int p, int q) { return pruned_.proxies_a->neighbours(p, q); },
      [&](int p, int q) { return pruned_.proxies_b->neighbours(p, q); });
}

/// The largest first.
void PrunedSource::find_parts(const PrunedRegion& region) {
  part_count_ = 0;
  for (const PairOverlap& overlap : region.overlaps()) {
    const auto unit = std::lower_bound(units_.begin(), units_.end(), overlap.a,
                                       [](const PlaneUnit& u, int proxy) { return u.proxy < proxy; });
    std::size_t i = 0;
    while (i < part_count_ && (parts_[i].first - unit->normal).norm() > kOnePlane) ++i;
    if (i == part_count_) {
      if (parts_.size() == part_count_) parts_.emplace_back();
      Part& part = parts_[part_count_++];
      part.first = unit->normal;
      part.force.setZero();
      part.volume = 0.0;
      part.proxies.clear();
    }
    parts_[i].force += overlap.volume * unit->normal;
    parts_[i].volume += overlap.volume;
    parts_[i].proxies.push_back(overlap.a);
  }
  std::sort(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(part_count_),
            [](const Part& x, const Part& y) { return x.volume > y.volume; });
}

Vec3 PrunedSource::mean_normal() const {
  Vec3 force = Vec3::Zero();
  for (std::size_t i = 0; i < part_count_; ++i) force += parts_[i].force;
  return force.normalized();
}

/// Each part in a region of its own; what presses nowhere stays with the largest.
void PrunedSource::split(PrunedRegion& whole) {
  for (std::size_t i = 0; i < part_count_; ++i) parts_[i].faces.clear();
  for (const int face : whole.faces_a()) {
    const int proxy = pruned_.of_a(face);
    std::size_t i = part_count_;
    while (--i > 0)
      if (std::find(parts_[i].proxies.begin(), parts_[i].proxies.end(), proxy) != parts_[i].proxies.end())
        break;
    parts_[i].faces.push_back(face);
  }
  for (std::size_t i = 1; i < part_count_; ++i)
    static_cast<PrunedRegion&>(add_region()).start_part(whole, parts_[i].faces, parts_[i].force.normalized());
  whole.start_part(whole, parts_[0].faces, parts_[0].force.normalized());
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
