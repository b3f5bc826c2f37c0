#include "contact/image_source.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/proxy/region.h"

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
                         const ImageOptions& options)
    : a_(std::move(a)), b_(std::move(b)), options_(options) {
  counters::count("contact.image_source");
}

void ImageSource::see(const Patch& a, const Patch& b, const ContactCamera& camera) {
  {
    const ScopedTimer timer(stages_.images_s);
    if (!image_)
      image_ = options_.backend == DepthBackend::kGpu   ? make_gpu_image(options_.pixels)
               : options_.backend == DepthBackend::kCpu ? make_cpu_image()
                                                        : make_exact_image();
    image_->find_pairs(a, b, camera, candidate_gap_, pairs_, layered_);
    ++stages_.images;
    stages_.pairs += static_cast<long>(pairs_.size());
  }
  const ScopedTimer timer(stages_.gaps_s);
  hits_.clear();
  estimate_.reset();
  planes_a_.start(a);
  planes_b_.start(b);
  doubtful_.clear();
  std::size_t next_layered = 0;
  for (const FacePair& pair : pairs_) {
    while (next_layered < layered_.size() && layered_[next_layered] < pair.at) ++next_layered;
    const bool layers = next_layered < layered_.size() && layered_[next_layered] == pair.at;
    if (!take_pair(pair, a, b, camera) || layers) doubtful_.push_back(pair.at);
  }
}

/// False where an image is not enough and exact lines have to tell: on walls, and where the pixel's middle
/// lies outside of a triangle by the rounding of the image, so that its neighbour is the one.
bool ImageSource::take_pair(const FacePair& pair, const Patch& a, const Patch& b,
                            const ContactCamera& camera) {
  constexpr double kOutside = -1e-7;
  Hit hit;
  hit.at.u = camera.u(static_cast<int>(pair.at) % camera.width);
  hit.at.v = camera.v(static_cast<int>(pair.at) / camera.width);
  if (!facing_at(pair, planes_a_, planes_b_, hit.at)) return false;
  if (hit.at.gap() < candidate_gap_) {
    hit.pixel = pair.at;
    hit.face_a = a.visible[pair.a];
    hit.face_b = b.visible[pair.b];
    hit.area = camera.pixel * camera.pixel;
    hits_.push_back(hit);
  }
  return std::min(hit.at.weights_a.minCoeff(), hit.at.weights_b.minCoeff()) >= kOutside &&
         !planes_a_.is_wall(static_cast<int>(pair.a)) && !planes_b_.is_wall(static_cast<int>(pair.b));
}

void ImageSource::ask_lines(const Patch& a, const Patch& b, const ContactCamera& camera) {
  middles_.clear();
  for (const std::uint32_t pixel : doubtful_)
    middles_.emplace_back(camera.u(static_cast<int>(pixel) % camera.width),
                          camera.v(static_cast<int>(pixel) / camera.width));
  lines_.through(middles_, a, b, camera, candidate_gap_, by_lines_);
  stages_.lines += static_cast<long>(doubtful_.size());
  estimate_.reset();
  std::erase_if(hits_, [&](const Hit& hit) {
    return std::binary_search(doubtful_.begin(), doubtful_.end(), hit.pixel);
  });
  const auto certain = static_cast<std::ptrdiff_t>(hits_.size());
  for (FacePair pair : by_lines_) {
    pair.at = doubtful_[pair.at];
    take_pair(pair, a, b, camera);
  }
  std::inplace_merge(hits_.begin(), hits_.begin() + certain, hits_.end(),
                     [](const Hit& p, const Hit& q) { return p.pixel < q.pixel; });
}

void ImageSource::finish(const Patch& a, const Patch& b, const ContactCamera& camera) {
  if (options_.backend != DepthBackend::kExact && !doubtful_.empty()) {
    const ScopedTimer timer(stages_.gaps_s);
    ask_lines(a, b, camera);
  }
  if (!samples_vertices()) return count_error(camera);
  const ScopedTimer timer(stages_.gaps_s);
  const VertexRule::Region region{.a = a,
                                  .b = b,
                                  .camera = camera,
                                  .planes_a = planes_a_,
                                  .planes_b = planes_b_,
                                  .candidate_gap = candidate_gap_,
                                  .lines_only = options_.backend == DepthBackend::kExact,
                                  .both_sides = b_->soft() != nullptr,
                                  .depths = options_.depths};
  vertices_.find(region, pairs_, doubtful_, hits_, lines_, hits_);
}

namespace {

constexpr int kFirstPixels = 64;   // a first image tells normal, overlap and creases
constexpr int kFewestPixels = 16;  // along the part where something was seen: moments need some, too

/// Mean edge of the squares that two triangles of a patch fill, seen along the normal [m].
double mean_face_edge(const Patch& patch) {
  double area = 0.0;
  for (const int f : patch.visible) {
    const auto p = [&](int k) { return patch.uvw.col((*patch.faces)(k, f)).head<2>(); };
    const Eigen::Vector2d e = p(1) - p(0), g = p(2) - p(0);
    area += std::abs(e.x() * g.y() - e.y() * g.x());
  }
  return patch.visible.empty() ? 0.0 : std::sqrt(area / static_cast<double>(patch.visible.size()));
}

}  // namespace

const QuadratureEstimate& ImageSource::estimate_of(const ContactCamera& camera) {
  if (!estimate_) {
    grid_.start(camera);
    for (const Hit& hit : hits_) grid_.add(hit.pixel, hit.at.gap());
    estimate_ = grid_.estimate();
  }
  return *estimate_;
}

int ImageSource::first_pixels() const {
  return options_.quadrature_error > 0.0 ? std::min(options_.pixels, kFirstPixels) : options_.pixels;
}

bool ImageSource::needs_finer(const Patch& a, const Patch& b, const ContactWindow& window,
                              const ContactCamera& camera, ContactCamera& finer) {
  if (hits_.empty() || !(options_.quadrature_error > 0.0)) return false;
  ContactWindow part = window;
  Eigen::Vector2d low = window.high, high = window.low;
  for (const Hit& hit : hits_) {
    low = low.cwiseMin(Eigen::Vector2d(hit.at.u, hit.at.v));
    high = high.cwiseMax(Eigen::Vector2d(hit.at.u, hit.at.v));
  }
  part.low = part.low.cwiseMax((low.array() - camera.pixel).matrix());
  part.high = part.high.cwiseMin((high.array() + camera.pixel).matrix());
  if (part.is_empty()) return false;
  const double edge = part.longer_edge();
  double pixel;
  if (options_.depths == DepthReading::kInterpolated) {
    pixel = edge / (options_.pixels - 1);
  } else if (samples_vertices()) {
    pixel = 0.5 * std::min(mean_face_edge(a), mean_face_edge(b));
  } else {
    pixel = estimate_of(camera).pixel_for(options_.quadrature_error);
    pixel = std::min(pixel > 0.0 ? pixel : edge, edge / (kFewestPixels - 1));
  }
  if (camera.pixel <= pixel) return false;
  finer = camera_of(part, std::max(pixel, edge / (options_.pixels - 1)), shift());
  finer.width = std::min(finer.width, options_.pixels);  // rounding of the edge
  finer.height = std::min(finer.height, options_.pixels);
  return finer.pixel < camera.pixel;
}

void ImageSource::count_error(const ContactCamera& camera) {
  const QuadratureEstimate& estimate = estimate_of(camera);
  const double error = estimate.standard_error(camera.pixel);
  volume_ += estimate.volume;
  variance_ += error * error;
}

void ImageSource::add_pattern(dynamics::PatternBuilder& pattern) const {
  a_->soft()->add_face_pattern(pattern);
  if (b_->soft() && !of_one_body()) b_->soft()->add_face_pattern(pattern);
  coupled_.add_pattern(pattern);
}

std::uint64_t ImageSource::sides_version() const {
  return a_->soft()->pattern_version() + (b_->soft() ? b_->soft()->pattern_version() : 0);
}
// each grows only
std::uint64_t ImageSource::pattern_version() const { return sides_version() + coupled_.version(); }

void ImageSource::query(const dynamics::StateView& state, std::vector<ContactSample>& samples) {
  {
    const ScopedTimer timer(stages_.positions_s);
    a_->update(state);
    if (!of_one_body()) b_->update(state);
  }
  if (options_.candidate_gap == 0.0) options_.candidate_gap = 0.25 * a_->soft()->mean_edge();
  candidate_gap_ = options_.candidate_gap;
  if (options_.look_ahead > 0.0 && !of_one_body()) {
    const SurfaceMotion a = a_->motion(state), b = b_->motion(state);
    const double approach = (a.mean - b.mean).norm() + a.spread + b.spread;  // no faster than that
    candidate_gap_ = std::max(candidate_gap_, options_.look_ahead * approach);
  }
  const std::size_t first = samples.size();
  volume_ = variance_ = 0.0;
  look(samples);
  if (volume_ > 0.0) {
    stages_.quadrature_error = std::sqrt(variance_) / volume_;
    stages_.largest_quadrature_error = std::max(stages_.largest_quadrature_error, stages_.quadrature_error);
  }
  if (!b_->soft()) return;
  if (const std::uint64_t now = sides_version(); now != counted_ || neighbours_a_.empty()) {
    coupled_.forget();
    neighbours_a_ = a_->soft()->neighbours();
    neighbours_b_ = of_one_body() ? neighbours_a_ : b_->soft()->neighbours();
    counted_ = now;
  }
  coupled_.take(std::span(samples).subspan(first), neighbours_a_, neighbours_b_);
}

namespace {

/// One image of both surfaces whole.
class WholeSource final : public ImageSource {
 public:
  using ImageSource::ImageSource;

 protected:
  void look(std::vector<ContactSample>& samples) override {
    const Points &above = a_->positions(), &below = b_->positions();
    const auto region = [&] {
      const ScopedTimer timer(stages_.regions_s);
      return regions_.find(above, below, candidate_gap_);
    }();
    if (!region.found) return;
    const ContactAxes axes(region.origin, region.normal);
    const ContactWindow window = [&] {
      const ScopedTimer timer(stages_.patches_s);
      axes.to_axes(above, patch_a_.uvw);
      axes.to_axes(below, patch_b_.uvw);
      patch_a_.faces = &a_->faces();
      patch_b_.faces = &b_->faces();
      return fit_window(patch_a_, patch_b_, candidate_gap_);
    }();
    ContactCamera camera = camera_of(window, first_pixels(), shift());
    if (!camera.sees_something()) return;
    see(patch_a_, patch_b_, camera);
    if (ContactCamera finer; needs_finer(patch_a_, patch_b_, window, camera, finer))
      see(patch_a_, patch_b_, camera = finer);
    finish(patch_a_, patch_b_, camera);
    const ScopedTimer timer(stages_.gaps_s);
    for (const Hit& hit : hits_)
      samples.push_back(sample_of(hit.at, hit.area, *a_, hit.face_a, *b_, hit.face_b, axes));
  }

 private:
  proxy::RegionFinder regions_;
  Patch patch_a_, patch_b_;
};

void check_arguments(const NodeSurface& surface, Eigen::Index other_faces, const ImageOptions& options) {
  if (!ContactRanges::pixels.holds(options.pixels))
    fail("contact in image space: pixels = {} {}", options.pixels, ContactRanges::pixels.demand());
  if (!(options.candidate_gap >= 0.0))
    fail("contact in image space: candidate gap = {} must not be negative", options.candidate_gap);
  if (!(options.look_ahead >= 0.0))
    fail("contact in image space: look-ahead = {} must not be negative", options.look_ahead);
  if (!ContactRanges::quadrature_error.holds(options.quadrature_error))
    fail("contact in image space: quadrature error = {} {}", options.quadrature_error,
         ContactRanges::quadrature_error.demand());
  if (options.depths == DepthReading::kInterpolated && options.samples != SampleRule::kVertex)
    fail("contact in image space: depths are interpolated at vertices alone; a pixel has its own");
  for (const double shift : {options.shift_u, options.shift_v})
    if (!(shift >= 0.0 && shift < 1.0))
      fail("contact in image space: grid shift = {} must lie in [0, 1)", shift);
  if (surface.faces.cols() == 0 || other_faces == 0)
    fail("contact in image space needs two surfaces with faces, got {} and {}", surface.faces.cols(),
         other_faces);
}

void check_arguments(const NodeSurface& surface, const TriMesh& rigid, const ImageOptions& options) {
  check_arguments(surface, rigid.faces.cols(), options);
  for (Eigen::Index f = 0; f < rigid.faces.cols(); ++f)
    PALPATE_CHECK(rigid.faces.col(f).minCoeff() >= 0 && rigid.faces.col(f).maxCoeff() < rigid.vertices.cols(),
                  "rigid surface: face {} names a vertex that is not there", f);
}

void check_proxies(const Faces& faces, const std::shared_ptr<proxy::ProxySet>& proxies) {
  PALPATE_CHECK(proxies, "a pruned image source needs proxies on both sides");
  PALPATE_CHECK(proxies->face_count() == faces.cols(), "proxies of {} faces for a surface of {}",
                proxies->face_count(), faces.cols());
}

void check_proxies(const NodeSurface& surface, const std::shared_ptr<proxy::ProxySet>& proxies) {
  PALPATE_CHECK(surface.node_of_vertex.empty(), "a pruned image source needs a skin");
  check_proxies(surface.faces, proxies);
}

}  // namespace

std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, TriMesh rigid, int frame,
                                                std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options) {
  check_arguments(surface, rigid, options);
  return std::make_unique<WholeSource>(soft_side(std::move(surface)),
                                       rigid_side(std::move(rigid), frame, std::move(motion)), options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies,
                                                TriMesh rigid, std::shared_ptr<proxy::ProxySet> proxies_rigid,
                                                int frame, std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options) {
  check_arguments(surface, rigid, options);
  check_proxies(surface, proxies);
  check_proxies(rigid.faces, proxies_rigid);
  return make_pruned_source(soft_side(std::move(surface)), std::move(proxies),
                            rigid_side(std::move(rigid), frame, std::move(motion)), std::move(proxies_rigid),
                            options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface a, NodeSurface b, const ImageOptions& options) {
  check_arguments(a, b.faces.cols(), options);
  PALPATE_CHECK(a.block_id != b.block_id, "contact between two soft bodies has block {} on both sides",
                a.block_id);
  return std::make_unique<WholeSource>(soft_side(std::move(a)), soft_side(std::move(b)), options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface a, std::shared_ptr<proxy::ProxySet> proxies_a,
                                                NodeSurface b, std::shared_ptr<proxy::ProxySet> proxies_b,
                                                const ImageOptions& options) {
  check_arguments(a, b.faces.cols(), options);
  PALPATE_CHECK(a.block_id != b.block_id, "contact between two soft bodies has block {} on both sides",
                a.block_id);
  check_proxies(a, proxies_a);
  check_proxies(b, proxies_b);
  return make_pruned_source(soft_side(std::move(a)), std::move(proxies_a), soft_side(std::move(b)),
                            std::move(proxies_b), options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies,
                                                const Points& rest_nodes, const ImageOptions& options) {
  check_arguments(surface, surface.faces.cols(), options);
  check_proxies(surface, proxies);
  return make_pruned_source(soft_side(std::move(surface)), std::move(proxies), rest_nodes, options);
}

}  // namespace palpate::contact
