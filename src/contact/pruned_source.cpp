#include <algorithm>
#include <span>
#include <utility>

#include "contact/image_source.h"
#include "contact/pruned_region.h"
#include "contact/region_parts.h"
#include "palpate/core/clock.h"

namespace palpate::contact {
namespace {

std::vector<int> proxy_of_face(const proxy::ProxySet& proxies) {
  std::vector<int> out(static_cast<std::size_t>(proxies.face_count()));
  for (const proxy::SkinPatch& patch : proxies.patches())
    for (const int face : proxies.faces(patch)) out[static_cast<std::size_t>(face)] = patch.proxy;
  return out;
}

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
  void archive(Archive& a) override {
    ImageSource::archive(a);
    a("pruner", pruned_.pruner);
  }

 protected:
  std::size_t find_regions(const dynamics::StateView& state) override {
    const ScopedTimer timer(context_.stages.regions_s);
    pruned_.kept_a.clear();
    pruned_.kept_b.clear();
    pruned_.meshes_in_use = 0;
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
    if (done) {
      context_.stages.unaligned += !plan.one_plane || region.is_unaligned();
      region.go_on();
    } else if ((!plan.one_plane || region.wants_another()) && region.may_look_again()) {
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
  double volume = 0.0;
  for (const RegionPart& part : parts) volume += part.volume;
  const auto part_of = [&](int proxy) {
    std::size_t i = parts.size();
    while (--i > 0)
      if (std::find(parts[i].proxies.begin(), parts[i].proxies.end(), proxy) != parts[i].proxies.end()) break;
    return i;
  };
  const auto start = [&](PrunedRegion& region, std::size_t i) {
    region.start_part(
        whole, [&](int proxy) { return part_of(proxy) == i; }, parts[i].volume / volume, parts[i].normal());
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
