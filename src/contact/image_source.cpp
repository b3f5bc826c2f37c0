#include "contact/image_source.h"

#include <algorithm>
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
void ImageSource::archive(Archive& a) {
  look_back_.archive(a);
  a("fast", context_.fast_regions);
  a("near", context_.options.candidate_gap);  // of the skin as it was at the first query
  std::string fallback = fallback_;
  a("fallback", fallback);
  if (a.gives_back() && !fallback.empty()) fall_back(fallback);
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
  a("sum_error", context_.sum_error);
  for (auto& [name, count] : std::initializer_list<std::pair<const char*, long&>>{{"images", s.images},
                                                                                  {"pairs", s.pairs},
                                                                                  {"pixels", s.pixels},
                                                                                  {"vertices", s.vertices},
                                                                                  {"faces", s.faces},
                                                                                  {"hits", s.hits},
                                                                                  {"unaligned", s.unaligned},
                                                                                  {"lines", s.lines}})
    a(name, count);
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
  {
    const ScopedTimer timer(context_.stages.regions_s);
    look_back_.look(
        a, context_.of_one_body() ? a : b, [&](LookBack::Met& met) { return find_met(met.a, met.b); },
        [&](int f, int g) { return may_meet(f, g); }, state.time);
  }
  context_.safe_time = HUGE_VAL;
  context_.volume = context_.variance = 0.0;
  if (context_.view) *context_.view = {};
  return find_regions(state);
}

void ImageSource::end(const SampleCells& samples, std::size_t first_cell) {
  if (context_.volume > 0.0) context_.sum_error.take({context_.volume, std::sqrt(context_.variance), 0.0});
  if (!context_.b->soft()) return;
  if (const std::uint64_t now = sides_version(); now != counted_ || neighbours_a_.empty()) {
    neighbours_a_ = context_.a->soft()->neighbours();
    neighbours_b_ = context_.of_one_body() ? neighbours_a_ : context_.b->soft()->neighbours();
    coupled_.start(neighbours_a_, neighbours_b_);
    counted_ = now;
  }
  coupled_.take(samples, first_cell);
}

void ImageSource::query(const dynamics::StateView& state, std::vector<ContactSample>& samples) {
  cells_.clear();
  query(state, cells_);
  cells_.append_to(samples);
}

void ImageSource::query(const dynamics::StateView& state, SampleCells& samples) {
  if (ImageSource* self = this; asks_together() || settles()) {
    open(state);
    answer_together({&self, 1});
    return close(samples);
  }
  const std::size_t first = samples.cells.size(), count = begin(state);
  if (count > 0) image().start_query();
  ImageRegion& one = region(0);
  for (std::size_t i = 0; i < count; ++i) {
    start(one, i);
    while (DepthRequest* request = one.wanted()) {
      double seconds = 0.0;
      {
        const ScopedTimer timer(seconds);
        image().answer({&request, 1});
      }
      add_image_times(seconds, image().times(), 1.0);
      one.take();
    }
    one.append_samples(samples);
  }
  end(samples, first);
}

void ImageSource::prepare(DepthImage& image) {
  image.prepare(*context_.a, *context_.b);
  prepared_ = true;
}

void ImageSource::add_image_times(double seconds, const ImageTimes& times, double share) {
  QueryStages& stages = context_.stages;
  stages.images_s += share * seconds;
  stages.upload_s += share * times.upload;
  stages.passes_s += share * times.passes;
  stages.gather_s += share * times.gather;
  stages.readback_s += share * times.readback;
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

void ImageSource::close(SampleCells& samples) {
  const std::size_t first = samples.cells.size();
  for (std::size_t i = 0; i < open_; ++i) regions_[i]->append_samples(samples);
  open_ = 0;
  end(samples, first);
}

namespace {

/// Has the image of the first source work; where that fails and all of them may, the processor from now on: a
/// request says all that any backend needs.
template <class Work>
void ask(std::span<ImageSource* const> sources, const Work& work) {
  ImageSource& asked = *sources[0];
  try {
    work(asked.image());
  } catch (const Error& error) {
    for (const ImageSource* source : sources)
      if (!source->may_fall_back()) throw;
    log::warn("contact: the processor makes the images from now on, for the GPU cannot: {}", error.what());
    counters::count("contact.gpu_fallback");
    for (ImageSource* source : sources) source->fall_back(error.what());
    work(asked.image());
  }
}

}  // namespace

void answer_together(std::span<ImageSource* const> sources) {
  if (sources.empty()) return;
  auto& [requests, counts] = sources[0]->asked_together();
  for (ImageSource* source : sources)
    if (source->comes_new()) ask(sources, [&](DepthImage& image) { source->prepare(image); });
  bool started = false;
  counts.resize(sources.size());
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
      ask(sources, [&](DepthImage& image) {
        if (!started) image.start_query();
        image.answer(requests);
      });
      started = true;
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
      sources[i]->add_image_times(seconds, sources[0]->image().times(),
                                  static_cast<double>(counts[i]) / static_cast<double>(requests.size()));
      sources[i]->take();
    }
  }
}

}  // namespace palpate::contact
