#include "contact/image_source.h"

#include "core/clock.h"
#include "core/counters.h"

namespace palpate::contact {

ImageSource::ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                         const ImageOptions& options)
    : SampleSource({.name = "image"}),
      context_{.a = std::move(a), .b = std::move(b), .options = options},
      coupled_(*context_.a, *context_.b) {
  counters::count("contact.image_source");
}

SourceReport ImageSource::report() const {
  return {.tunnelled = tunnelling_.count(),
          .safe_time = context_.safe_time,
          .fast_regions = context_.fast_regions,
          .stages = &context_.stages,
          .view = context_.view ? &*context_.view : nullptr};
}

void ImageSource::archive(Archive& a) {
  tunnelling_.archive(a);
  a("fast", context_.fast_regions);
  a("near", context_.options.candidate_gap);  // Chosen from the skin at the first query.
  visit_counters([&](const char* name, auto& value) { a(name, value); }, context_.stages);
}

void ImageSource::query(const dynamics::StateView& state, std::vector<ContactSample>& samples) {
  ImageSide &a = *context_.a, &b = *context_.b;
  {
    const ScopedTimer timer(context_.stages.positions_s);
    a.update(state);
    b.update(state);
  }
  ImageOptions& options = context_.options;
  if (options.candidate_gap == 0.0) options.candidate_gap = 0.25 * a.soft()->mean_edge();
  {
    const ScopedTimer timer(context_.stages.regions_s);
    tunnelling_.check(
        a, b, [&](TunnellingMonitor::Met& met) { return collect_candidate_faces(met.a, met.b); }, state.time);
    context_.safe_time = HUGE_VAL;
    if (context_.view) *context_.view = {};
    planes_.clear();
    find_regions(state, planes_);
  }
  while (regions_.size() < planes_.size()) regions_.push_back(std::make_unique<ImageRegion>(context_));
  for (std::size_t i = 0; i < planes_.size(); ++i) regions_[i]->start(planes_[i]);
  answer();
  joints_.clear();
  const bool is_coupled = coupled_.are_soft();
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    ImageRegion& region = *regions_[i];
    if (!region.requested()) continue;
    region.see();
    region.append_samples(samples, is_coupled ? &joints_ : nullptr);
    if (region.presses()) take_pressing(i);
  }
  if (is_coupled) coupled_.take(joints_);
}

void ImageSource::answer() {
  QueryStages& stages = context_.stages;
  const ScopedTimer timer(stages.images_s);
  // Created in the first query, in contact or not, so that first touch does not delay the loop.
  if (!image_) {
    image_ = make_depth_image();
    image_->prepare(*context_.a, *context_.b);
  }
  requests_.clear();
  for (std::size_t i = 0; i < planes_.size(); ++i)
    if (DepthRequest* request = regions_[i]->requested()) requests_.push_back(request);
  if (requests_.empty()) return;
  image_->start_query();
  image_->answer(requests_);
  stages.upload_s += image_->times().upload;
  stages.passes_s += image_->times().passes;
  stages.gather_s += image_->times().gather;
  stages.readback_s += image_->times().readback;
}

}  // namespace palpate::contact
