// A region where proxies come near, or a part of one that has a plane of its own.
//
// The pruner's normal came from patches, which reach beyond the overlap, more or less as the body is cut.
// It is where the region is first looked at along.  Then the overlap says what its plane is
// (region_planes.cpp): a coarse image of all regions measures what the proxies' overlaps push, the source
// finds their normals, and the image that counts is taken along these.
//
// How many looks.  A look along n finds n' = P(n).  Of a thin lens P knows n only to second order (its
// thickness grows by 1 / cos, its middle surface stays where it is); in general a look leaves a part r of
// the error, measured as 0.05 to 0.2 on the paper's scenes.  Two looks leave r^2.  Jumps of the pruner's
// normal by phi are thus jumps by r^2 phi of the force, below a hundredth for phi = 0.2 rad.
//
// Where the second look still turns the normal, r is not small.  It is near 1 where an overlap is as deep as
// it is wide: that pushes along whatever it is seen along.  It is negative where two flanks press, as those
// of a nose on a ball: seen from nearer to one, the other pushes more, -tan^2(a) of the error where both
// stand at an angle a from the normal.  From 45 degrees on looks along what the last one found would go to
// and fro for ever, and where they end would be chance.  So a look goes a part s of the way to what it has
// found,
//     n_k+1 = n_k + s (P(n_k) - n_k),    s = 1 / (1 - r),    r = (P(n_k) - P(n_k-1)) . e / |e|^2,
// e = n_k - n_k-1: the secant's zero of P(n) - n, exact where P is linear.  s is never more than 1, nor more
// than it was at the last look: P is bent where skin comes into view, and the next secant may tell of one
// side alone.  An |e| of a few hundredths of a radian tells of pixels and triangles more than of r, so its
// square is taken to be larger than it is by kBlur^2.
//
// Where r is more than 1, at the edge of a ridge between two ways out, looks drive apart what is near, and
// none of them says more than the one before: they end to count as r goes there.
//
// More looks than two do not come or go at once: look k + 1 moves the normal by W_k (n_k+2 - n_k+1), W_k the
// product of weights that rise smoothly with the turn of each look before it.  The normal is a function of
// the pose alone: what the last query found would make it smoother along a slow path, and wrong on a fast
// path.
#include "contact/pruned_region.h"

#include <algorithm>

#include "palpate/core/clock.h"

namespace palpate::contact {
namespace {

constexpr double kAligned = 1e-3;  // [rad]: an image along such a normal is one along the overlap's own
// How far the second look turns a normal that is decided, and one that is not.
constexpr double kEnough = 0.02;    // [rad]
constexpr double kTooFar = 0.06;    // [rad]
constexpr double kCloser = 0.05;    // of the candidate gap: see overlap_push.cpp
constexpr int kLooks = 6;           // along a region's axes, until they settle
constexpr double kBlur = 0.02;      // [rad]: of what looks find
constexpr double kLeastStep = 0.1;  // of the way to what a look has found
// Of r: looks that lead somewhere, and such as only drive apart what is near.
constexpr double kLeads = 0.7, kDrivesAway = 1.2;

/// The part r of the way between two looks that comes back in what they find.
/// @param way  between their normals  @param found  between what they found
double part_that_comes_back(const Vec3& way, const Vec3& found) {
  return found.dot(way) / (way.squaredNorm() + kBlur * kBlur);
}

}  // namespace

void PrunedRegion::start(const proxy::ContactRegion& region) {
  proxies_ = &region.pairs;
  candidate_gap_ = region.gap;
  looks_ = 0;
  step_ = share_ = 1.0;
  {
    const ScopedTimer timer(context_.stages.positions_s);
    RegionMesh &a = pruned_.next_mesh(), &b = pruned_.next_mesh();
    a.take(*context_.a, region.faces_a, pruned_.proxy_of_a, pruned_.local_a);
    b.take(*context_.b, region.faces_b, pruned_.proxy_of_b, pruned_.local_b);
    piece_a_.take(a);
    piece_b_.take(b);
  }
  start(region.region.origin, region.region.normal);
}

void PrunedRegion::start(const Vec3& origin, const Vec3& normal) {
  forget();
  axes_ = ContactAxes(origin, normal);
  first_ = true;
  weight_ = next_weight_ = 1.0;
  look_along_axes();
}

bool PrunedRegion::may_look_again() const { return looks_ < kLooks; }

void PrunedRegion::take() {
  see();
  leave_own_tissue();
  if (looking_for_ == Image::kAxes) return measure();
  if (looking_for_ == Image::kFirst) return refine();
}

void PrunedRegion::take_normal(const Vec3& normal) {
  const Vec3 along = axes_.normal();
  if (fresh_) {
    if (!first_) {
      const double r = part_that_comes_back(along - last_along_, normal - last_found_);
      step_ = std::clamp(1.0 / (1.0 + std::max(0.0, -r)), kLeastStep, step_);
      next_weight_ *= smooth_step((kDrivesAway - r) / (kDrivesAway - kLeads));
    }
    weight_ = next_weight_;
    last_along_ = along;
  }
  last_found_ = normal;
  const Vec3 next = (along + step_ * (normal - along)).normalized();
  final_ = first_ ? next : Vec3(final_ + weight_ * (next - next_));
  next_ = next;
  first_ = false;
  if (!std::exchange(fresh_, false)) return;
  const double turn = (normal - along).norm();
  unaligned_ = !overlaps_.empty() && turn > kEnough;
  if (overlaps_.empty()) next_weight_ = 0.0;
  if (looks_ > 1) next_weight_ *= smooth_step((turn - kEnough) / (kTooFar - kEnough));
}

void PrunedRegion::look_again() {
  const ContactAxes axes(axes_.origin, next_);
  std::optional<Extent> seen;
  if (!hits_.empty()) seen = seen_along(axes);
  axes_ = axes;
  look_along_axes(seen);
}

void PrunedRegion::go_on() {
  waits_ = false;
  const Vec3 normal = final_.normalized();
  const bool turns = (normal - axes_.normal()).norm() > kAligned;
  if (!(context_.options.quadrature_error > 0.0)) {
    looking_for_ = Image::kFirst;
    if (turns) turn_to(ContactAxes(axes_.origin, normal));
    seen_ = ask(camera_of(window_, context_.first_pixels(), context_.shift()));
  } else if (turns) {
    looking_for_ = Image::kFiner;
    const ContactAxes axes(axes_.origin, normal);
    const NextImage next = next_along(axes);
    turn_to(axes);
    seen_ = ask_next(window_, next);
  } else {
    refine();  // that image is the first
  }
}

void PrunedRegion::append_samples(SampleCells& samples) {
  if (!seen_) return;
  finish();
  leave_own_tissue();  // what finish() has found besides
  keep_view();
  keep_proxies();
  const ScopedTimer timer(context_.stages.gaps_s);
  append_hits(
      samples, [&](int face) { return piece_a_.face_of(face); },
      [&](int face) { return piece_b_.face_of(face); });
}

/// What an overlap pushes needs few pixels: those of a first image, or a quarter of the image's edge; as
/// many again where it was seen to be a part of the region.
void PrunedRegion::look_along_axes(const std::optional<Extent>& seen) {
  constexpr double kFiner = 0.5;  // of the pixels' edge, at least
  const ImageOptions& options = context_.options;
  const int coarse = std::min(context_.first_pixels(), std::max(64, options.pixels / 4));
  looking_for_ = Image::kAxes;
  waits_ = false;
  ++looks_;
  overlaps_.clear();
  fit_pieces();
  double pixel = window_.longer_edge() / (coarse - 1);
  if (seen) pixel *= std::clamp((seen->high - seen->low).maxCoeff() / window_.longer_edge(), kFiner, 1.0);
  seen_ = ask(camera_of(window_, pixel, context_.shift()));
}

void PrunedRegion::measure() {
  const ScopedTimer timer(context_.stages.gaps_s);
  const double candidate_gap = context_.options.candidate_gap;  // without what the velocity adds to it
  const std::span<const PixelPush> push =
      pruned_.push.find(hits_, camera(), candidate_gap, kCloser * candidate_gap);
  pushes_.clear();
  for (std::size_t i = 0; i < hits_.size(); ++i)
    if (push[i].sum.z() > 0.0)
      push_of(pruned_.of_a(piece_a_.face_of(hits_[i].face_a)),
              pruned_.of_b(piece_b_.face_of(hits_[i].face_b)))
          .add(push[i]);
  for (std::size_t i = 0; i < overlaps_.size(); ++i) {
    overlaps_[i].push = axes_.to_world * pushes_[i].integral();
    overlaps_[i].volume = pushes_[i].sum.z();
  }
  waits_ = fresh_ = true;
}

PixelPush& PrunedRegion::push_of(int a, int b) {
  for (std::size_t i = overlaps_.size(); i-- > 0;)
    if (overlaps_[i].a == a && overlaps_[i].b == b) return pushes_[i];
  overlaps_.push_back({.a = a, .b = b});
  return pushes_.emplace_back();
}

void PrunedRegion::turn_to(const ContactAxes& axes) {
  axes_ = axes;
  fit_pieces();
}

void PrunedRegion::refine() {
  looking_for_ = Image::kFiner;
  ask_finer(window_);
}

void PrunedRegion::fit_pieces() {
  const ScopedTimer timer(context_.stages.patches_s);
  window_ = fit_window(piece_a_, piece_b_, axes_, candidate_gap_, a_, b_);
  set_sources(piece_a_.source(*context_.a), piece_b_.source(*context_.b));
}

void PrunedRegion::leave_own_tissue() {
  if (pruned_.self_contact)
    std::erase_if(hits_, [&](const Hit& h) {
      return !pruned_.may_touch(h.at, piece_a_.face_of(h.face_a), piece_b_.face_of(h.face_b), axes_);
    });
}

/// The hulls of a region where something presses, for pictures: each once, whatever regions it is in.
void PrunedRegion::keep_proxies() {
  if (!context_.view ||
      std::none_of(hits_.begin(), hits_.end(), [](const Hit& h) { return h.at.gap() < 0.0; }))
    return;
  const auto keep = [](const proxy::ProxySet& set, int p, std::set<int>& kept, std::vector<Points>& out) {
    if (kept.insert(p).second) set.copy_corners(p, out.emplace_back(3, set.corner_count(p)));
  };
  for (const auto& [p, q] : *proxies_) {
    keep(*pruned_.proxies_a, p, pruned_.kept_a, context_.view->proxies_a);
    keep(*pruned_.proxies_b, q, pruned_.kept_b, context_.view->proxies_b);
  }
}

}  // namespace palpate::contact
