#include "contact/image_source.h"

#include <cmath>

#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"

namespace palpate::contact {

std::string_view backend_name(DepthBackend backend) {
  switch (backend) {
    case DepthBackend::kGpu: return "gpu";
    case DepthBackend::kCpu: return "cpu";
    case DepthBackend::kExact: return "exact";
  }
  return {};
}

ImageSource::ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                         const ImageOptions& options) {
  context_.a = std::move(a);
  context_.b = std::move(b);
  context_.options = options;
  counters::count("contact.image_source");
}

MakeImage& gpu_image_maker() {
  static MakeImage make = make_gpu_image;
  return make;
}

void ImageSource::fall_back(const std::string& why) {
  context_.options.backend = DepthBackend::kCpu;
  image_.reset();
  fallback_ = why;
}

DepthImage& ImageSource::image() {
  const ImageOptions& options = context_.options;
  if (!image_)
    image_ = options.backend == DepthBackend::kGpu   ? gpu_image_maker()()
             : options.backend == DepthBackend::kCpu ? make_cpu_image()
                                                     : make_exact_image();
  return *image_;
}

void ImageSource::add_pattern(dynamics::PatternBuilder& pattern) const {
  context_.a->soft()->add_face_pattern(pattern);
  if (context_.b->soft() && !context_.of_one_body()) context_.b->soft()->add_face_pattern(pattern);
  coupled_.add_pattern(pattern);
}

std::uint64_t ImageSource::sides_version() const {
  return context_.a->soft()->pattern_version() +
         (context_.b->soft() ? context_.b->soft()->pattern_version() : 0);
}
// each grows only
std::uint64_t ImageSource::pattern_version() const { return sides_version() + coupled_.version(); }

ImageRegion& ImageSource::region(std::size_t place) {
  while (regions_.size() <= place) regions_.push_back(make_region());
  return *regions_[place];
}

std::size_t ImageSource::begin(const dynamics::StateView& state) {
  ImageSide &a = *context_.a, &b = *context_.b;
  {
    const ScopedTimer timer(context_.stages.positions_s);
    a.update(state);
    if (!context_.of_one_body()) b.update(state);
  }
  ImageOptions& options = context_.options;
  if (options.candidate_gap == 0.0) options.candidate_gap = 0.25 * a.soft()->mean_edge();
  context_.candidate_gap = options.candidate_gap;
  if (options.look_ahead > 0.0 && !context_.of_one_body()) {
    const SurfaceMotion of_a = a.motion(state), of_b = b.motion(state);
    const double approach =
        (of_a.mean - of_b.mean).norm() + of_a.spread + of_b.spread;  // no faster than that
    context_.candidate_gap = std::max(context_.candidate_gap, options.look_ahead * approach);
  }
  context_.volume = context_.variance = 0.0;
  return find_regions();
}

void ImageSource::end(std::span<const ContactSample> samples) {
  if (context_.volume > 0.0) {
    QueryStages& stages = context_.stages;
    stages.quadrature_error = std::sqrt(context_.variance) / context_.volume;
    stages.largest_quadrature_error = std::max(stages.largest_quadrature_error, stages.quadrature_error);
  }
  if (!context_.b->soft()) return;
  if (const std::uint64_t now = sides_version(); now != counted_ || neighbours_a_.empty()) {
    coupled_.forget();
    neighbours_a_ = context_.a->soft()->neighbours();
    neighbours_b_ = context_.of_one_body() ? neighbours_a_ : context_.b->soft()->neighbours();
    counted_ = now;
  }
  coupled_.take(samples, neighbours_a_, neighbours_b_);
}

void ImageSource::query(const dynamics::StateView& state, std::vector<ContactSample>& samples) {
  if (ImageSource* self = this; asks_together() || settles()) {
    open(state);
    answer_together({&self, 1});
    return close(samples);
  }
  const std::size_t first = samples.size(), count = begin(state);
  if (count > 0) image().start_query();
  ImageRegion& one = region(0);
  for (std::size_t i = 0; i < count; ++i) {
    start(one, i);
    while (DepthRequest* request = one.wanted()) {
      {
        const ScopedTimer timer(context_.stages.images_s);
        image().answer({&request, 1});
      }
      one.take();
    }
    one.append_samples(samples);
  }
  end(std::span(samples).subspan(first));
}

void ImageSource::open(const dynamics::StateView& state) {
  open_ = begin(state);
  for (std::size_t i = 0; i < open_; ++i) start(region(i), i);
}

void ImageSource::collect(std::vector<DepthRequest*>& requests) const {
  for (std::size_t i = 0; i < open_; ++i)
    if (DepthRequest* request = regions_[i]->wanted()) requests.push_back(request);
}

void ImageSource::take() {
  for (std::size_t i = 0; i < open_; ++i)
    if (regions_[i]->wanted()) regions_[i]->take();
  settle(open_);
}

void ImageSource::close(std::vector<ContactSample>& samples) {
  const std::size_t first = samples.size();
  for (std::size_t i = 0; i < open_; ++i) regions_[i]->append_samples(samples);
  open_ = 0;
  end(std::span(samples).subspan(first));
}

namespace {

/// By the image of the first source; where that fails and all of them may, by the processor from now on: a
/// request says all that any backend needs.
void answer(std::span<ImageSource* const> sources, std::span<DepthRequest* const> requests, bool first) {
  ImageSource& asked = *sources[0];
  try {
    if (first) asked.image().start_query();
    asked.image().answer(requests);
  } catch (const Error& error) {
    for (const ImageSource* source : sources)
      if (!source->may_fall_back()) throw;
    log::warn("contact: the processor makes the images from now on, for the GPU cannot: {}", error.what());
    counters::count("contact.gpu_fallback");
    for (ImageSource* source : sources) source->fall_back(error.what());
    asked.image().answer(requests);
  }
}

}  // namespace

void answer_together(std::span<ImageSource* const> sources) {
  std::vector<DepthRequest*> requests;
  bool started = false;
  std::vector<std::size_t> counts(sources.size());
  for (;;) {
    requests.clear();
    for (std::size_t i = 0; i < sources.size(); ++i) {
      counts[i] = requests.size();
      sources[i]->collect(requests);
      counts[i] = requests.size() - counts[i];
    }
    if (requests.empty()) return;
    double seconds = 0.0;
    {
      const ScopedTimer timer(seconds);
      answer(sources, requests, !started);
      started = true;
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
      sources[i]->add_image_time(seconds * static_cast<double>(counts[i]) /
                                 static_cast<double>(requests.size()));
      sources[i]->take();
    }
  }
}

}  // namespace palpate::contact
