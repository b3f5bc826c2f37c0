#include "contact/image_region.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "contact/safe_time.h"
#include "palpate/core/clock.h"

namespace palpate::contact {
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

int RegionContext::first_pixels() const {
  return options.quadrature_error > 0.0 ? std::min(options.pixels, kFirstPixels) : options.pixels;
}

void RegionContext::take_speed(double apart, double approach, double thickness) {
  const double time = time_to_middle(apart, -approach, thickness);
  safe_time = std::min(safe_time, time);
  fast_regions += time < options.look_ahead;
}

void ImageRegion::forget() {
  asks_ = false;
  hits_.clear();
  doubtful_.clear();
  estimate_.reset();
}

bool ImageRegion::ask(const ContactCamera& camera) {
  request_.camera = camera;
  request_.a = &a_;
  request_.b = &b_;
  request_.candidate_gap = candidate_gap_;
  request_.axes = axes_;
  asks_ = camera.sees_something();
  if (!asks_) forget();
  return asks_;
}

void ImageRegion::see() {
  ++context_.stages.images;
  context_.stages.pixels += static_cast<long>(camera().width) * camera().height;
  context_.stages.pairs += static_cast<long>(request_.pairs.size());
  const ScopedTimer timer(context_.stages.gaps_s);
  forget();
  planes_a_.start(a_);
  planes_b_.start(b_);
  const std::vector<std::uint32_t>& layered = request_.layered;
  std::size_t next_layered = 0;
  for (const FacePair& pair : request_.pairs) {
    while (next_layered < layered.size() && layered[next_layered] < pair.at) ++next_layered;
    const bool layers = next_layered < layered.size() && layered[next_layered] == pair.at;
    if (!take_pair(pair) || layers) doubtful_.push_back(pair.at);
  }
  // In first images too: the axes, the window and the pixels that follow are then the same whoever draws.
  if (context_.options.backend != DepthBackend::kExact && !doubtful_.empty()) ask_lines();
}

/// False where an image is not enough and exact lines have to tell: on walls, and where the pixel's middle
/// lies outside of a triangle by the rounding of the image, so that its neighbour is the one.
bool ImageRegion::take_pair(const FacePair& pair) {
  constexpr double kOutside = -1e-7;
  const ContactCamera& camera = request_.camera;
  Hit hit;
  hit.at.u = camera.u(static_cast<int>(pair.at) % camera.width);
  hit.at.v = camera.v(static_cast<int>(pair.at) / camera.width);
  if (!facing_at(pair, planes_a_, planes_b_, hit.at)) return false;
  if (hit.at.gap() < candidate_gap_) {
    hit.pixel = pair.at;
    hit.face_a = a_.visible[pair.a];
    hit.face_b = b_.visible[pair.b];
    hit.area = camera.pixel * camera.pixel;
    hits_.push_back(hit);
  }
  return std::min(hit.at.weights_a.minCoeff(), hit.at.weights_b.minCoeff()) >= kOutside &&
         !planes_a_.is_wall(static_cast<int>(pair.a)) && !planes_b_.is_wall(static_cast<int>(pair.b));
}

void ImageRegion::ask_lines() {
  std::vector<Eigen::Vector2d>& middles = context_.middles;
  middles.clear();
  for (const std::uint32_t pixel : doubtful_)
    middles.emplace_back(camera().u(static_cast<int>(pixel) % camera().width),
                         camera().v(static_cast<int>(pixel) / camera().width));
  context_.lines.through(middles, a_, b_, camera(), candidate_gap_, context_.by_lines);
  context_.stages.lines += static_cast<long>(doubtful_.size());
  estimate_.reset();
  auto next = doubtful_.begin();  // both ascend
  std::erase_if(hits_, [&](const Hit& hit) {
    while (next != doubtful_.end() && *next < hit.pixel) ++next;
    return next != doubtful_.end() && *next == hit.pixel;
  });
  const auto certain = static_cast<std::ptrdiff_t>(hits_.size());
  for (FacePair pair : context_.by_lines) {
    pair.at = doubtful_[pair.at];
    take_pair(pair);
  }
  // std::inplace_merge would take memory at every query
  context_.merged.clear();
  std::merge(hits_.begin(), hits_.begin() + certain, hits_.begin() + certain, hits_.end(),
             std::back_inserter(context_.merged),
             [](const Hit& p, const Hit& q) { return p.pixel < q.pixel; });
  std::swap(hits_, context_.merged);
}

void ImageRegion::finish() {
  if (!context_.samples_vertices()) return count_error();
  const ScopedTimer timer(context_.stages.gaps_s);
  const VertexRule::Region region{.a = a_,
                                  .b = b_,
                                  .camera = camera(),
                                  .planes_a = planes_a_,
                                  .planes_b = planes_b_,
                                  .candidate_gap = candidate_gap_,
                                  .lines_only = context_.options.backend == DepthBackend::kExact,
                                  .both_sides = context_.b->soft() != nullptr,
                                  .depths = context_.options.depths};
  context_.vertices.find(region, request_.pairs, doubtful_, hits_, context_.lines, hits_);
}

void ImageRegion::keep_view() {
  if (!context_.view || context_.samples_vertices()) return;
  const auto pixels = static_cast<std::size_t>(camera().width) * static_cast<std::size_t>(camera().height);
  RegionView& region = context_.view->regions.emplace_back();
  region.axes = axes_.to_world;
  region.origin = axes_.origin;
  region.u0 = camera().u0;
  region.v0 = camera().v0;
  region.pixel = camera().pixel;
  region.width = camera().width;
  region.height = camera().height;
  region.gap.assign(pixels, std::nan(""));
  region.height_a.assign(pixels, std::nan(""));
  for (const Hit& hit : hits_)
    if (!(region.gap[hit.pixel] <= hit.at.gap())) {
      region.gap[hit.pixel] = hit.at.gap();
      region.height_a[hit.pixel] = hit.at.w_a;
    }
}

const QuadratureEstimate& ImageRegion::estimate() {
  if (!estimate_) {
    context_.grid.start(camera());
    for (const Hit& hit : hits_) context_.grid.add(hit.pixel, hit.at.gap());
    estimate_ = context_.grid.estimate();
  }
  return *estimate_;
}

bool ImageRegion::ask_finer(const ContactWindow& window) {
  const ImageOptions& options = context_.options;
  if (hits_.empty() || !(options.quadrature_error > 0.0)) return false;
  ContactWindow part = window;
  Eigen::Vector2d low = window.high, high = window.low;
  for (const Hit& hit : hits_) {
    low = low.cwiseMin(Eigen::Vector2d(hit.at.u, hit.at.v));
    high = high.cwiseMax(Eigen::Vector2d(hit.at.u, hit.at.v));
  }
  part.low = part.low.cwiseMax((low.array() - camera().pixel).matrix());
  part.high = part.high.cwiseMin((high.array() + camera().pixel).matrix());
  if (part.is_empty()) return false;
  const double edge = part.longer_edge();
  double pixel;
  if (options.depths == DepthReading::kInterpolated) {
    pixel = edge / (options.pixels - 1);
  } else if (context_.samples_vertices()) {
    pixel = 0.5 * std::min(mean_face_edge(a_), mean_face_edge(b_));
  } else {
    pixel = estimate().pixel_for(options.quadrature_error);
    pixel = std::min(pixel > 0.0 ? pixel : edge, edge / (kFewestPixels - 1));
  }
  if (camera().pixel <= pixel) return false;
  ContactCamera finer = camera_of(part, std::max(pixel, edge / (options.pixels - 1)), context_.shift());
  finer.width = std::min(finer.width, options.pixels);  // rounding of the edge
  finer.height = std::min(finer.height, options.pixels);
  return finer.pixel < camera().pixel && ask(finer);
}

void ImageRegion::count_error() {
  const double error = estimate().standard_error(camera().pixel);
  context_.volume += estimate().volume;
  context_.variance += error * error;
}

}  // namespace palpate::contact
