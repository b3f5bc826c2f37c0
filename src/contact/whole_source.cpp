#include <numeric>

#include "contact/image_source.h"
#include "palpate/core/clock.h"
#include "palpate/proxy/region.h"

namespace palpate::contact {
namespace {

/// Both surfaces whole.
class WholeRegion final : public ImageRegion {
 public:
  using ImageRegion::ImageRegion;

  void start(const proxy::Region& plane) {
    forget();
    axes_ = ContactAxes(plane.origin, plane.normal);
    {
      const ScopedTimer timer(context_.stages.patches_s);
      axes_.to_axes(context_.a->positions(), a_.uvw);
      axes_.to_axes(context_.b->positions(), b_.uvw);
      a_.faces = &context_.a->faces();
      b_.faces = &context_.b->faces();
      set_sources({context_.a.get(), all(faces_a_, a_)}, {context_.b.get(), all(faces_b_, b_)});
      window_ = fit_window(a_, b_, context_.candidate_gap);
    }
    finest_ = false;
    seen_ = ask(camera_of(window_, context_.first_pixels(), context_.shift()));
  }
  void take() override {
    see();
    if (!finest_) finest_ = ask_finer(window_);
  }
  void append_samples(std::vector<ContactSample>& samples) override {
    if (!seen_) return;
    finish();
    keep_view();
    const ScopedTimer timer(context_.stages.gaps_s);
    for (const Hit& hit : hits_)
      samples.push_back(sample_of(hit.at, hit.area, *context_.a, hit.face_a, *context_.b, hit.face_b, axes_));
  }

 private:
  static std::span<const int> all(std::vector<int>& faces, const Patch& patch) {
    if (faces.empty()) {
      faces.resize(static_cast<std::size_t>(patch.faces->cols()));
      std::iota(faces.begin(), faces.end(), 0);
    }
    return faces;
  }

  std::vector<int> faces_a_, faces_b_;
  ContactWindow window_;
  bool finest_ = false, seen_ = false;
};

/// One region.
class WholeSource final : public ImageSource {
 public:
  using ImageSource::ImageSource;

 protected:
  std::size_t find_regions() override {
    const ScopedTimer timer(context_.stages.regions_s);
    plane_ = finder_.find(context_.a->positions(), context_.b->positions(), context_.candidate_gap);
    return plane_.found ? 1 : 0;
  }
  std::unique_ptr<ImageRegion> make_region() override { return std::make_unique<WholeRegion>(context_); }
  void start(ImageRegion& region, std::size_t) override { static_cast<WholeRegion&>(region).start(plane_); }

 private:
  proxy::RegionFinder finder_;
  proxy::Region plane_;
};

}  // namespace

std::unique_ptr<SampleSource> make_whole_source(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                                                const ImageOptions& options) {
  return std::make_unique<WholeSource>(std::move(a), std::move(b), options);
}

}  // namespace palpate::contact
