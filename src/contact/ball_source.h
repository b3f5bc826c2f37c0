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

// Consider a ball of radius R with its centre at c, and a shape whose point nearest to c lies along -n. Along
// n, at the distance rho from the axis through c, the ball begins at the height -sqrt(R^2 - rho^2) above c,
// and the shape ends at the height t:
//
//     depth = t + sqrt(R^2 - rho^2),      force = k sum of depth dA = k x overlap volume.
//
// The samples are rings of equal area around the axis, each with the mean height of the ball over the ring,
//     mean of sqrt(R^2 - rho^2) = 2/3 (p^2 + p q + q^2)/(p + q),    p, q = sqrt(R^2 - rho^2) at its two rims,
// so that a ring in full contact has its volume exactly. The rings divide the pressed patch into equal areas
// at every state.
//
// Integrated over the ball's surface (FrameBall::by_surface), as with material points, a ring between p and q
// has the area 2 pi R (p - q) and the mean height (p + q)/2, both exactly; on a plane the integral is pi R
// depth^2.
//
// All samples lie on the axis. A ball without friction has no contact moment about its centre, and its
// contact does not change when the ball rotates about its centre. Both hold exactly here, because the arm of
// each force is along n. The friction torque against spin about n, of the order of friction times the patch's
// radius, is neglected.

/// Returns the squared radius of the circle in which a ball of radius R and a shape with radius of curvature
/// r (0: flat) intersect when they overlap by `depth` [m^2].
inline double patch_radius2(double R, double r, double depth) {
  if (r == 0.0) return depth < R ? depth * (2.0 * R - depth) : R * R;
  const double d = R + r - depth, from_ball = (d * d + R * R - r * r) / (2.0 * d);
  if (d <= std::abs(R - r) || from_ball <= 0.0 || from_ball >= d) return std::min(R * R, r * r);
  return R * R - from_ball * from_ball;
}

/// Returns whether a point that moved straight from a to b, in the frame of a convex shape, tunnelled:
/// outside at both ends, and deeper than an eighth of the shape's thickness in between. Shallower paths
/// grazed an edge or a rim. @pre the shape is at `pose`
template <class Shape>
bool goes_through(const Shape& shape, const Pose& pose, const Vec3& a, const Vec3& b) {
  if (!shape.is_crossed(a, b)) return false;
  // The signed distance from a convex set is convex along a line.
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

/// Contact source of a ball with an exact shape (requirements on Shape: analytic_source.h).
template <class Shape>
class BallSource final : public SampleSource {
 public:
  BallSource(FrameBall ball, int frame, std::shared_ptr<MovingFrame> motion, Shape shape,
             double candidate_gap, double look_ahead)
      // Force and stiffness set in continuously from zero: no events.
      : SampleSource({.name = Shape::kName, .follows = true, .has_events = false}),
        ball_(std::move(ball)),
        frame_(frame),
        motion_(std::move(motion)),
        shape_(shape),
        candidate_gap_(candidate_gap > 0.0 ? candidate_gap : ball_.radius / 8.0),
        look_ahead_(look_ahead) {
    PALPATE_CHECK(ball_.motion, "a ball in contact needs a frame");
    PALPATE_CHECK(ball_.radius > 0.0, "ball in contact: radius {} must be positive", ball_.radius);
  }

  SourceReport report() const override {
    return {.tunnelled = tunnelled_, .safe_time = safe_time_, .fast_regions = fast_};
  }
  void archive(Archive& a) override {
    a("tunnelled", tunnelled_);
    a("fast", fast_);
  }
  void add_pattern(dynamics::PatternBuilder&) const override {}

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    const double rate = place(state);
    find_tunnelled(inverse_ * c_, state.time);
    const double gap = nearest_.gap - ball_.radius,
                 margin = candidate_gap_ - look_ahead_ * std::min(rate, 0.0);
    safe_time_ = time_to_middle(gap, rate, shape_.lengths().width);
    fast_ += safe_time_ < look_ahead_;
    if (gap < margin) sample(gap, samples);
  }

  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    if (samples.empty()) return;
    place(state);
    followed_.clear();
    sample(nearest_.gap - ball_.radius, followed_);
    PALPATE_CHECK(samples.size() == followed_.size(),
                  "ball on {}: follow() yields {} samples, but the query made {}", Shape::kName,
                  followed_.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) followed_[i].source = samples[i].source;
    std::copy(followed_.begin(), followed_.end(), samples.begin());
  }

 private:
  static constexpr int kSectors = Shape::kRound ? 1 : 40;  ///< Sectors per ring.

  /// Evaluates ball and shape at a state. Returns the rate of the gap between them [m/s].
  double place(const dynamics::StateView& state) {
    const Pose own = ball_.motion->pose(state), shape_pose = motion_->pose(state);
    c_ = own * ball_.centre;
    PALPATE_CHECK(c_.allFinite(), "contact query at t = {}: the position of a ball is not finite",
                  state.time);
    inverse_ = shape_pose.inverse();
    shape_.move_to(shape_pose);
    nearest_ = shape_.at(c_);
    n_ = nearest_.normal;
    const Vec3 foot = c_ - nearest_.gap * n_;
    return n_.dot(ball_.motion->twist(state).at(c_ - own.translation) -
                  motion_->twist(state).at(foot - shape_pose.translation));
  }

  /// Returns the height of the shape along the normal, relative to the centre, at the distance sqrt(a) from
  /// the axis.
  double height(double a, double phi) const {
    const Vec3 e = n_.unitOrthogonal(), f = n_.cross(e);
    return shape_.height(c_ + std::sqrt(a) * (std::cos(phi) * e + std::sin(phi) * f), n_);
  }

  /// Returns the squared distance from the axis up to which the ball is pressed. The gap increases with the
  /// distance: the shape is convex, and lies below the plane that is normal to n at its highest point.
  double rim(double phi) const {
    const double R2 = ball_.radius * ball_.radius;
    double low = 0.0, high = R2;
    for (int i = 0; i < 50; ++i) {
      const double a = 0.5 * (low + high);
      (-std::sqrt(R2 - a) - height(a, phi) < 0.0 ? low : high) = a;
    }
    return low;
  }

  /// Appends rings of equal area within the patch; on a shape that is not rotationally symmetric, in sectors
  /// with separate rims. The number of samples is constant: without a patch they have no area.
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

  /// Appends the sample of a sector of the ring between the squared distances a0 and a1 from the axis.
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

  /// Checks the centre's path since the last query for tunnelling, as AnalyticSource does for vertices.
  void find_tunnelled(const Vec3& now, double t) {
    const bool crossed = seen_before_ && goes_through(shape_, inverse_.inverse(), seen_, now);
    seen_ = now;
    seen_before_ = true;
    tunnelled_ += crossed;
    if (!crossed || tunnelled_ > 1) return;
    log::warn(
        "contact at t = {:.6g} s: the centre of a ball tunnelled through the {} between two queries. "
        "Decrease exchange.contact_refresh_s, increase the contact stiffness, or make the {} thicker",
        t, Shape::kName, Shape::kName);
  }

  FrameBall ball_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  Shape shape_;
  double candidate_gap_, look_ahead_;
  Nearest nearest_{};  ///< Nearest point to the centre at the state of the present query or evaluation.
  Vec3 c_, n_;         ///< Centre of the ball and normal of the shape at that state.
  Pose inverse_;       ///< Inverse pose of the shape's frame at that state.
  std::vector<ContactSample> followed_;  ///< Scratch.
  Vec3 seen_ = Vec3::Zero();             ///< Centre at the last query, in the shape's frame.
  bool seen_before_ = false;
  long tunnelled_ = 0, fast_ = 0;
  double safe_time_ = HUGE_VAL;  ///< As SourceReport::safe_time.
};

}  // namespace palpate::contact
