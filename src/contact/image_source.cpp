#include "contact/image_source.h"

#include "core/clock.h"
#include "core/counters.h"

namespace palpate::contact {

ImageSource::ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                         const ImageOptions& options) {
  context_.a = std::move(a);
  context_.b = std::move(b);
  context_.options = options;
  counters::count("contact.image_source");
}

void ImageSource::add_pattern(dynamics::PatternBuilder& pattern) const {
  for (const ImageSide* side : {context_.a.get(), context_.b.get()})
    if (side->soft()) side->soft()->add_face_pattern(pattern);
  coupled_.add_pattern(pattern);
}

std::uint64_t ImageSource::sides_version() const {
  std::uint64_t sum = 0;
  for (const ImageSide* side : {context_.a.get(), context_.b.get()})
    if (side->soft()) sum += side->soft()->pattern_version();
  return sum;
}

// Both counters increase only.
std::uint64_t ImageSource::pattern_version() const { return sides_version() + coupled_.version(); }

void ImageSource::archive(Archive& a) {
  tunnelling_.archive(a);
  a("fast", context_.fast_regions);
  a("near", context_.options.candidate_gap);  // Chosen from the skin at the first query.
  QueryStages& s = context_.stages;
  for (auto& [name, seconds] :
       std::initializer_list<std::pair<const char*, double&>>{{"positions_s", s.positions_s},
                                                              {"regions_s", s.regions_s},
                                                              {"patches_s", s.patches_s},
                                                              {"images_s", s.images_s},
                                                              {"upload_s", s.upload_s},
                                                              {"passes_s", s.passes_s},
                                                              {"gather_s", s.gather_s},
                                                              {"readback_s", s.readback_s},
                                                              {"gaps_s", s.gaps_s}})
    a(name, seconds);
  for (auto& [name, count] : std::initializer_list<std::pair<const char*, long&>>{{"images", s.images},
                                                                                  {"pairs", s.pairs},
                                                                                  {"pixels", s.pixels},
                                                                                  {"vertices", s.vertices},
                                                                                  {"faces", s.faces},
                                                                                  {"hits", s.hits}})
    a(name, count);
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
  const bool is_coupled = b.soft() != nullptr;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    ImageRegion& region = *regions_[i];
    if (!region.requested()) continue;
    region.see();
    region.append_samples(samples, is_coupled ? &joints_ : nullptr);
    if (region.presses()) take_pressing(i);
  }
  if (is_coupled) couple();
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

void ImageSource::couple() {
  const SurfaceState &a = *context_.a->soft(), &b = *context_.b->soft();
  if (const std::uint64_t now = sides_version(); now != counted_ || neighbours_a_.empty()) {
    neighbours_a_ = a.neighbours();
    neighbours_b_ = b.neighbours();
    coupled_.start(neighbours_a_, neighbours_b_);
    counted_ = now;
  }
  coupled_.take(joints_);
}

}  // namespace palpate::contact
