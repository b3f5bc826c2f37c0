#include "contact/image_region.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

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

/// Bounds of a patch's faces that are turned away from the camera and reach into a box.
/// @param side  of the area that such a face has along the normal: 1 of a, -1 of b
AxisBox turned_away(const Patch& patch, double side, const AxisBox& within) {
  AxisBox bounds;
  const auto take = [&](const AxisBox& box) {
    if ((box.low.array() > within.high.array()).any() || (box.high.array() < within.low.array()).any())
      return;
    bounds.low = bounds.low.cwiseMin(box.low);
    bounds.high = bounds.high.cwiseMax(box.high);
  };
  if (patch.away) {
    for (const int face : *patch.away) take(box_of(patch, face));
    return bounds;
  }
  for (std::size_t f = 0; f < patch.visible.size(); ++f) {
    const auto p = [&](int k) { return patch.uvw.col((*patch.faces)(k, patch.visible[f])).head<2>(); };
    const Eigen::Vector2d e = p(1) - p(0), g = p(2) - p(0);
    if (side * (e.x() * g.y() - e.y() * g.x()) > 0.0) take(patch.boxes[f]);
  }
  return bounds;
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
  context_.stages.vertices += static_cast<long>(a_.uvw.cols() + b_.uvw.cols());
  context_.stages.faces += static_cast<long>(a_.visible.size() + b_.visible.size());
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
  context_.stages.hits += static_cast<long>(hits_.size());
  // In first images too: the axes, the window and the pixels that follow are then the same whoever draws.
  if (context_.options.backend == DepthBackend::kExact) return;
  doubt_layers();
  if (!doubtful_.empty()) ask_lines();
}

/// What an image cannot tell: whether a is left and then b entered between the two skins that a pixel shows,
/// so that it shows two teeth that do not touch (exact_lines.cpp).  That can be where skin of both sides is
/// turned away from the camera inside of what seems to overlap, and is left to exact lines.
void ImageRegion::doubt_layers() {
  AxisBox pressed;
  for (const Hit& hit : hits_)
    if (hit.at.gap() < 0.0) {
      pressed.low = pressed.low.cwiseMin(Vec3(hit.at.u, hit.at.v, hit.at.w_a));
      pressed.high = pressed.high.cwiseMax(Vec3(hit.at.u, hit.at.v, hit.at.w_b));
    }
  const AxisBox left = turned_away(a_, 1.0, pressed), entered = turned_away(b_, -1.0, pressed);
  const Vec3 low = left.low.cwiseMax(entered.low), high = left.high.cwiseMin(entered.high);
  layers_.clear();
  for (const Hit& hit : hits_)
    if (hit.at.u >= low.x() && hit.at.u <= high.x() && hit.at.v >= low.y() && hit.at.v <= high.y() &&
        std::max(hit.at.w_a, left.low.z()) < std::min(hit.at.w_b, entered.high.z()) &&
        (layers_.empty() || layers_.back() != hit.pixel))
      layers_.push_back(hit.pixel);
  if (layers_.empty()) return;
  // std::inplace_merge would take memory at every query
  context_.united.clear();
  std::set_union(doubtful_.begin(), doubtful_.end(), layers_.begin(), layers_.end(),
                 std::back_inserter(context_.united));
  std::swap(doubtful_, context_.united);
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

/// Edge of the pixels of the next image, which shows `part`; `by_hits` is what the estimate asks for.
double ImageRegion::pixel_for(const ContactWindow& part, double by_hits) const {
  const double edge = part.longer_edge();
  if (context_.options.depths == DepthReading::kInterpolated) return edge / (context_.options.pixels - 1);
  if (context_.samples_vertices()) return 0.5 * std::min(mean_face_edge(a_), mean_face_edge(b_));
  return std::min(by_hits > 0.0 ? by_hits : edge, edge / (kFewestPixels - 1));
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
  const double pixel = pixel_for(part, wanted_pixel());
  if (camera().pixel <= pixel) return false;
  const ContactCamera finer = camera_of_at_most(part, pixel);
  return finer.pixel < camera().pixel && ask(finer);
}

ContactCamera ImageRegion::camera_of_at_most(const ContactWindow& part, double pixel) const {
  const int pixels = context_.options.pixels;
  ContactCamera camera =
      camera_of(part, std::max(pixel, part.longer_edge() / (pixels - 1)), context_.shift());
  camera.width = std::min(camera.width, pixels);  // rounding of the edge
  camera.height = std::min(camera.height, pixels);
  return camera;
}

// A contact region of volume V that is seen in parts, V_i along normals of their own, wants the standard
// error e V of its force.  Errors of different images are independent, so their variances add up:
//     sum s_i^2 = (e V)^2     by     s_i^2 = e^2 V V_i,     s_i / V_i = e / sqrt(V_i / V).
// Relative to itself each part may err more than the whole may, and all together err as much.  Where a part
// is divided again, shares V_i / V multiply, and still add up to 1.  Of n equal parts with the depth of a cap
// each takes n^-0.4 of the pixels that it would take by itself, for its error grows as (h / a)^2.5.
double ImageRegion::wanted_pixel() {
  return context_.samples_vertices() || context_.options.depths == DepthReading::kInterpolated
             ? 0.0
             : estimate().pixel_for(context_.options.quadrature_error / std::sqrt(share_));
}

// Both ends of a line that was seen are points of the skins, which stay where they are; what lies between two
// lines is within a pixel of one.  Two pixels of room are for the turn.
ImageRegion::Extent ImageRegion::seen_along(const ContactAxes& axes) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent seen{Eigen::Vector2d::Constant(kInfinity), Eigen::Vector2d::Constant(-kInfinity)};
  for (const Hit& hit : hits_)
    for (const double w : {hit.at.w_a, hit.at.w_b}) {
      const Vec3 there = axes.in_axes(axes_.world(Vec3(hit.at.u, hit.at.v, w)));
      seen.low = seen.low.cwiseMin(there.head<2>());
      seen.high = seen.high.cwiseMax(there.head<2>());
    }
  seen.low.array() -= 2.0 * camera().pixel;
  seen.high.array() += 2.0 * camera().pixel;
  return seen;
}

ImageRegion::NextImage ImageRegion::next_along(const ContactAxes& axes) {
  return {seen_along(axes), wanted_pixel()};
}

bool ImageRegion::ask_next(const ContactWindow& window, const NextImage& next) {
  ContactWindow part = window;
  part.low = part.low.cwiseMax(next.seen.low);
  part.high = part.high.cwiseMin(next.seen.high);
  if (part.is_empty()) return ask({});
  const double first = window.longer_edge() / (context_.first_pixels() - 1);
  return ask(camera_of_at_most(part, std::min(first, pixel_for(part, next.pixel))));
}

void ImageRegion::count_error() {
  const double error = estimate().standard_error(camera().pixel);
  context_.volume += estimate().volume;
  context_.variance += error * error;
}

}  // namespace palpate::contact
