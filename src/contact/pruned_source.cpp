#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "contact/image_source.h"
#include "proxy/pruner.h"

namespace palpate::contact {
namespace {

/// Image-space contact whose regions are found by convex proxies that are close to each other.
class PrunedSource final : public ImageSource {
 public:
  PrunedSource(std::shared_ptr<ImageSide> a, std::shared_ptr<proxy::ProxySet> proxies_a,
               std::shared_ptr<ImageSide> b, std::shared_ptr<proxy::ProxySet> proxies_b,
               const ImageOptions& options)
      : ImageSource(std::move(a), std::move(b), options),
        proxies_a_(std::move(proxies_a)),
        proxies_b_(std::move(proxies_b)),
        pruner_(*proxies_a_, *proxies_b_) {
    context_.a->set_face_order(patch_by_patch(*proxies_a_));
    context_.b->set_face_order(patch_by_patch(*proxies_b_));
  }

  SourceReport report() const override {
    SourceReport out = ImageSource::report();
    out.normals_kept = pruner_.counts().normals_kept;
    out.pruning = &pruner_.counts();
    return out;
  }
  void archive(Archive& a) override {
    ImageSource::archive(a);
    a("pruner", pruner_);
  }

 protected:
  void find_regions(const dynamics::StateView& state, std::vector<RegionPlane>& out) override {
    if (!placed_) place();
    placed_ = false;
    kept_a_.clear();
    kept_b_.clear();
    const double time = context_.options.look_ahead;
    if (time > 0.0) {
      context_.a->set_motion(*proxies_a_, state);
      context_.b->set_motion(*proxies_b_, state);
    }
    found_ = pruner_.query(context_.options.candidate_gap, time);
    for (const proxy::ContactRegion& region : found_) {
      context_.take_speed(region.apart, region.approach, region.thickness);
      out.push_back(
          {region.region.origin, region.region.normal, region.gap, &region.faces_a, &region.faces_b});
    }
  }
  double collect_candidate_faces(std::vector<int>& faces_a, std::vector<int>& faces_b) override {
    place();
    context_.a->set_motion(*proxies_a_);
    context_.b->set_motion(*proxies_b_);
    pruner_.met_on_the_way(faces_a, faces_b);
    placed_ = context_.options.look_ahead > 0.0;  // Without look-ahead the proxies must be at rest.
    return std::min(proxies_a_->rest_thickness(), proxies_b_->rest_thickness());
  }
  /// Keeps the hulls of a region for pictures, each once even if it belongs to several regions.
  void take_pressing(std::size_t number) override {
    if (!context_.view) return;
    const auto keep = [](const proxy::ProxySet& set, int p, std::set<int>& kept, std::vector<Points>& out) {
      if (kept.insert(p).second) set.copy_corners(p, out.emplace_back(3, set.corner_count(p)));
    };
    for (const auto& [p, q] : found_[number].pairs) {
      keep(*proxies_a_, p, kept_a_, context_.view->proxies_a);
      keep(*proxies_b_, q, kept_b_, context_.view->proxies_b);
    }
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
    context_.a->update(*proxies_a_);
    context_.b->update(*proxies_b_);
    placed_ = true;
  }

  std::shared_ptr<proxy::ProxySet> proxies_a_, proxies_b_;
  proxy::Pruner pruner_;
  bool placed_ = false;                          ///< True: the proxies are at the configuration of the sides.
  std::span<const proxy::ContactRegion> found_;  ///< Regions of the last query.
  std::set<int> kept_a_, kept_b_;                ///< Proxies in the picture data of the present query.
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

}  // namespace palpate::contact
