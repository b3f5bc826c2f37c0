#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "contact/safe_time.h"
#include "contact/surface_state.h"
#include "palpate/contact/obstacle.h"
#include "palpate/contact/side.h"
#include "palpate/core/log.h"

namespace palpate::contact {

// A ball of radius R, its centre at c, over a shape whose point nearest to c lies along -n.  Along n, at the
// distance rho from the axis through c, the ball begins at the height -sqrt(R^2 - rho^2) over c, and the
// shape ends at the height t:
//
//     depth = t + sqrt(R^2 - rho^2),      force = k sum of depth dA = k x overlap volume.
//
// Rings of equal area around the axis are samples, each with the mean of the ball's heights in it,
//     mean of sqrt(R^2 - rho^2) = 2/3 (p^2 + p q + q^2)/(p + q),    p, q = sqrt(R^2 - rho^2) at its two rims,
// so that a ring pressed as a whole has its volume exactly.  The rings within the patch that is pressed have
// equal areas, at every state.
//
// By its own surface (FrameBall::by_surface), as material points have it, a ring between p and q has the area
// 2 pi R (p - q) and the mean height (p + q)/2, both exactly; on a plane that is pi R depth^2.
//
// All samples stand on the axis.  A ball without friction feels no moment about its centre, and a ball that
// rotates about it feels no change; both are so here, exactly, for the arm of each force is along n.  The
// torque of friction against spin about n, of the order of friction times the patch's radius, is left out.

/// What a ball of radius R and a shape with the radius of curvature r (0: flat) have in common when they
/// overlap by `depth`: the radius squared of the circle where they meet [m^2].
inline double patch_radius2(double R, double r, double depth) {
  if (r == 0.0) return depth < R ? depth * (2.0 * R - depth) : R * R;
  const double d = R + r - depth, from_ball = (d * d + R * R - r * r) / (2.0 * d);
  if (d <= std::abs(R - r) || from_ball <= 0.0 || from_ball >= d) return std::min(R * R, r * r);
  return R * R - from_ball * from_ball;
}

/// Whether what went straight from a to b, in the frame of a convex shape, went through it: outside at both,
/// and in between deeper than an eighth of its thickness.  What was less deep grazed an edge or a rim.
/// @pre the shape is at `pose`
template <class Shape>
bool goes_through(const Shape& shape, const Pose& pose, const Vec3& a, const Vec3& b) {
  if (!shape.is_crossed(a, b)) return false;
  // the signed distance from a convex set is convex along a line
  const auto gap = [&](double s) { return shape.at(pose * (a + s * (b - a))).gap; };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double p = low + (high - low) / 3.0, q = high - (high - low) / 3.0;
    if (gap(p) < gap(q))
      high = q;
    else
      low = p;
  }
  return -gap(0.5 * (low + high)) > shape.lengths().width / 8.0;
}

/// A ball against an exact shape (analytic_source.h says what a Shape has).
template <class Shape>
class BallSource final : public SampleSource {
 public:
  BallSource(FrameBall ball, int frame, std::shared_ptr<MovingFrame> motion, Shape shape,
             double candidate_gap, double look_ahead)
      : ball_(std::move(ball)),
        frame_(frame),
        motion_(std::move(motion)),
        shape_(shape),
        candidate_gap_(candidate_gap > 0.0 ? candidate_gap : ball_.radius / 8.0),
        look_ahead_(look_ahead) {
    PALPATE_CHECK(ball_.motion, "a ball in contact needs a frame");
    PALPATE_CHECK(ball_.radius > 0.0, "ball in contact: radius {} must be positive", ball_.radius);
  }

  std::string_view name() const override { return Shape::kName; }
  long tunnelled() const override { return tunnelled_; }
  double safe_time() const override { return safe_time_; }
  long fast_regions() const override { return fast_; }
  void archive(Archive& a) override {
    a("tunnelled", tunnelled_);
    a("fast", fast_);
  }
  void add_pattern(dynamics::PatternBuilder&) const override {}
  bool has_events() const override { return false; }  // force and stiffness set in from zero

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    const double rate = place(state);
    find_tunnelled(inverse_ * c_, state.time);
    const double gap = nearest_.gap - ball_.radius,
                 margin = candidate_gap_ - look_ahead_ * std::min(rate, 0.0);
    safe_time_ = time_to_middle(gap, rate, shape_.lengths().width);
    fast_ += safe_time_ < look_ahead_;
    if (gap < margin) sample(gap, samples);
  }

  bool follows() const override { return true; }
  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    if (samples.empty()) return;
    place(state);
    followed_.clear();
    sample(nearest_.gap - ball_.radius, followed_);
    PALPATE_CHECK(samples.size() == followed_.size(), "ball on {}: {} samples follow, the query made {}",
                  Shape::kName, followed_.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) followed_[i].source = samples[i].source;
    std::copy(followed_.begin(), followed_.end(), samples.begin());
  }

 private:
  static constexpr int kSectors = Shape::kRound ? 1 : 40;  ///< parts of a ring

  /// Ball and shape at a state, and the speed at which their nearest points part [m/s].
  double place(const dynamics::StateView& state) {
    const Pose own = ball_.motion->pose(state), shape_pose = motion_->pose(state);
    c_ = own * ball_.centre;
    PALPATE_CHECK(c_.allFinite(), "contact query at t = {}: a ball's position is not finite", state.time);
    inverse_ = shape_pose.inverse();
    shape_.move_to(shape_pose);
    nearest_ = shape_.at(c_);
    n_ = nearest_.normal;
    const Vec3 foot = c_ - nearest_.gap * n_;
    return n_.dot(ball_.motion->twist(state).at(c_ - own.translation) -
                  motion_->twist(state).at(foot - shape_pose.translation));
  }

  /// The shape at the distance sqrt(a) from the axis, as a height along the normal over the centre.
  double height(double a, double phi) const {
    const Vec3 e = n_.unitOrthogonal(), f = n_.cross(e);
    return shape_.height(c_ + std::sqrt(a) * (std::cos(phi) * e + std::sin(phi) * f), n_);
  }

  /// How far from the axis, squared, the ball is pressed.  The gap grows with the distance: the shape is
  /// convex, and lies below the plane through its highest point that n stands on.
  double rim(double phi) const {
    const double R2 = ball_.radius * ball_.radius;
    double low = 0.0, high = R2;
    for (int i = 0; i < 50; ++i) {
      const double a = 0.5 * (low + high);
      (-std::sqrt(R2 - a) - height(a, phi) < 0.0 ? low : high) = a;
    }
    return low;
  }

  /// Rings of equal area within the patch; on a shape that does not look the same all around, in sectors with
  /// rims of their own.  Always as many: without a patch they have no area.
  void sample(double gap, std::vector<ContactSample>& samples) {
    constexpr int kRings = Shape::kRound ? 48 : 24;
    for (int k = 0; k < kSectors; ++k) {
      const double phi = 2.0 * std::numbers::pi * (k + 0.5) / kSectors;
      const double pressed = gap >= 0.0      ? 0.0
                             : Shape::kRound ? patch_radius2(ball_.radius, nearest_.radius, -gap)
                                             : rim(phi);
      for (int i = 0; i < kRings; ++i)
        add_cell(pressed * i / kRings, pressed * (i + 1) / kRings, phi, samples);
    }
  }

  /// A sector of the ring between the squared distances a0 and a1 from the axis.
  void add_cell(double a0, double a1, double phi, std::vector<ContactSample>& samples) {
    const double R2 = ball_.radius * ball_.radius, p = std::sqrt(std::max(R2 - a0, 0.0)),
                 q = std::sqrt(std::max(R2 - a1, 0.0)),
                 below = ball_.by_surface ? 0.5 * (p + q) : 2.0 / 3.0 * (p * p + p * q + q * q) / (p + q),
                 top = height(0.5 * (a0 + a1), phi), gap = -below - top;
    ContactSample sample;
    sample.a.frame = ball_.frame;
    sample.a.offset = ball_.centre;
    sample.a.slide = -below * n_;
    sample.b = frame_point(frame_, inverse_, c_ + top * n_);
    sample.normal = n_;
    sample.area = std::numbers::pi / kSectors * (ball_.by_surface ? 2.0 * ball_.radius * (p - q) : a1 - a0);
    sample.gap = gap;
    samples.push_back(sample);
  }

  /// The centre's way since the last query, as AnalyticSource sees a vertex's.
  void find_tunnelled(const Vec3& now, double t) {
    const bool crossed = seen_before_ && goes_through(shape_, inverse_.inverse(), seen_, now);
    seen_ = now;
    seen_before_ = true;
    tunnelled_ += crossed;
    if (!crossed || tunnelled_ > 1) return;
    log::warn(
        "contact at t = {:.6g} s: a ball's centre went through the {} between two queries, unseen; refresh "
        "contact more often (contact_refresh_s), make the contact stiffer, or the {} thicker",
        t, Shape::kName, Shape::kName);
  }

  FrameBall ball_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  Shape shape_;
  double candidate_gap_, look_ahead_;
  Nearest nearest_{};                    ///< to the centre, at the state of the query or evaluation under way
  Vec3 c_, n_;                           ///< the centre then, and the shape's normal nearest to it
  Pose inverse_;                         ///< of the shape's frame then
  std::vector<ContactSample> followed_;  ///< scratch
  Vec3 seen_ = Vec3::Zero();             ///< the centre at the last query, in the shape's frame
  bool seen_before_ = false;
  long tunnelled_ = 0, fast_ = 0;
  double safe_time_ = HUGE_VAL;  ///< as SampleSource::safe_time
};

}  // namespace palpate::contact
