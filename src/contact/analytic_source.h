#pragma once
#include <algorithm>
#include <optional>
#include <type_traits>

#include "contact/ball_source.h"
#include "contact/frame_vertices.h"
#include "contact/material_gaps.h"
#include "contact/material_points.h"
#include "contact/safe_time.h"
#include "contact/surface_state.h"
#include "core/counters.h"
#include "palpate/contact/obstacle.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"

namespace palpate::contact {

/// Contact source of the vertices of a surface (SurfaceState or FrameVertices), or of material points
/// (MaterialPointState), with an exact shape. A vertex represents its present area, projected on the normal.
/// A material point represents the integrals of its hat function (MaterialGaps), so that with a pressure k
/// |gap| its force is the gradient of an energy: the sample has the area A' of the overlapping part of the
/// hat and the gap -V/A', with V the integral of overlap times hat.
///
/// A Shape provides
///   kName                    for messages and counters
///   move_to(pose of its frame), before each query
///   Nearest at(x)            nearest point to x; argument and result in world axes
///   is_crossed(a, b)         whether the segment from a to b, in the frame, crosses the shape and both ends
///                            are outside
///   lengths()                its CharacteristicLengths
///   curvature()              mean curvature where it is uniform, else 0 [1/m]
/// and, for balls (ball_source.h),
///   kRound                   whether it is rotationally symmetric about each normal
///   height(x, n)             distance along the unit vector n from x at which the line leaves the shape,
///                            -infinity where the line misses it; world axes
template <class Surface, class Shape>
class AnalyticSource final : public SampleSource {
 public:
  AnalyticSource(Surface surface, int frame, std::shared_ptr<MovingFrame> motion, Shape shape,
                 double candidate_gap, double look_ahead)
      // Vertex samples do not follow: their areas are those of the query, so that at another state the force
      // would not be a gradient.
      : SampleSource({.name = Shape::kName, .follows = kMaterial}),
        surface_(std::move(surface)),
        frame_(frame),
        motion_(std::move(motion)),
        shape_(shape),
        thickness_(shape.lengths().width),
        candidate_gap_(candidate_gap),
        look_ahead_(look_ahead) {
    if constexpr (kMaterial) gaps_.emplace(surface_.points(), shape_.curvature());
  }

  SourceReport report() const override {
    return {.tunnelled = tunnelled_,
            .safe_time = safe_time_,
            .fast_regions = fast_,
            .sum_error = kMaterial ? &sum_error_ : nullptr};
  }
  void archive(Archive& a) override {
    a("tunnelled", tunnelled_);
    a("fast", fast_);
    a("warned", warned_);
    if constexpr (kMaterial) a("sum_error", sum_error_);
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { surface_.add_vertex_pattern(pattern); }
  std::uint64_t pattern_version() const override { return surface_.vertex_pattern_version(); }

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    surface_.update(state);
    if (candidate_gap_ == 0.0) candidate_gap_ = surface_.mean_edge();
    if constexpr (kMaterial) near_ = candidate_gap_ + gaps_->largest_lowering();
    const Pose pose = motion_->pose(state), inverse = pose.inverse();
    shape_.move_to(pose);
    if constexpr (kMaterial) open_runs(state, pose);
    find_tunnelled(pose, inverse, state.time);
    kept_.clear();
    const bool any = find_candidates(state, pose);
    if constexpr (kMaterial) {
      if (any) take_points(inverse, samples);
      sum_error_.take(any ? gaps_->sum_error(places_, nearest_) : SumError::Query{});
    } else if (any) {
      take_samples(inverse, samples);
    }
  }

  std::span<const int> material_points() const override {
    if constexpr (kMaterial) return kept_;
    return {};
  }
  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    if constexpr (kMaterial) {
      PALPATE_CHECK(samples.size() == kept_.size(),
                    "{}: {} samples passed to follow(), but the query kept {} points", Shape::kName,
                    samples.size(), kept_.size());
      if (samples.empty()) return;
      surface_.update(state, kept_);
      const Pose pose = motion_->pose(state), inverse = pose.inverse();
      shape_.move_to(pose);
      place_points();
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const int source = samples[i].source;
        samples[i] = sample_of_point(i, inverse);
        samples[i].source = source;
      }
    }
  }

 private:
  static constexpr bool kMaterial = std::is_same_v<Surface, MaterialPointState>;

  void take_samples(const Pose& inverse, std::vector<ContactSample>& samples) {
    surface_.area_vectors(requested_, areas_);
    for (int v = 0; v < surface_.vertex_count(); ++v) {
      if (!requested_[static_cast<std::size_t>(v)]) continue;
      const ContactSample sample = sample_at(v, inverse);
      if (sample.area > 0.0) samples.push_back(sample);
    }
  }

  void take_points(const Pose& inverse, std::vector<ContactSample>& samples) {
    gaps_->start(requested_);
    kept_ = gaps_->points();
    place_points();
    for (std::size_t i = 0; i < kept_.size(); ++i) samples.push_back(sample_of_point(i, inverse));
  }
  void place_points() {
    places_.clear();
    nearest_.clear();
    for (const int v : kept_) {
      places_.push_back(surface_.position(v));
      nearest_.push_back(shape_.at(places_.back()));
    }
    gaps_->integrate(nearest_);
  }
  /// Returns the sample of one kept material point. @param i  index into kept_
  ContactSample sample_of_point(std::size_t i, const Pose& inverse) const {
    const double area = gaps_->area(i);
    if (gaps_->overlap(i) == 0.0)
      return sample_of(kept_[i], places_[i], nearest_[i], area, nearest_[i].gap, inverse);
    ContactSample sample =
        sample_of(kept_[i], places_[i], nearest_[i], area, -gaps_->overlap(i) / area, inverse);
    sample.stored = gaps_->stored(i);
    return sample;
  }

  // Material points are stored in runs of neighbours. A signed distance is 1-Lipschitz, so a run with
  // smallest gap g stays outside until its points have moved by g, and it needs a query only where the
  // displacement so far and the displacement until the next query, at the speed of the fastest point, exceed
  // g. Points in skipped runs would have produced no sample and no crossing, and their safe time exceeds the
  // look-ahead: skipping them changes only the time of a query.
  static constexpr int kRun = 64;
  void open_runs(const dynamics::StateView& state, const Pose& pose) {
    constexpr double kRounding = 1e-12;
    const auto count = static_cast<std::size_t>((surface_.vertex_count() + kRun - 1) / kRun);
    // Displacement of a point at distance r from the frame's origin, relative to the frame: the point's
    // displacement, the origin's, and 2 r sin(theta/2).
    const double farthest = surface_.farthest_from(pose.translation);
    const double angle = rotation_vector(pose.rotation * shape_pose_.rotation.conjugate()).norm();
    const double way = (surface_.way() + (pose.translation - shape_pose_.translation).norm() +
                        2.0 * std::sin(0.5 * angle) * farthest) *
                       (1.0 + kRounding);
    shape_pose_ = pose;
    if (clear_.size() != count || !std::isfinite(way)) {
      clear_.assign(count, -1.0);
      gone_ = 0.0;
    } else {
      gone_ += way;
    }
    const Twist twist = motion_->twist(state);
    const double near = near_ + look_ahead_ * (surface_.fastest(state) + twist.linear.norm() +
                                               twist.angular.norm() * farthest);
    open_.clear();
    for (std::size_t r = 0; r < count; ++r)
      if (!(clear_[r] > gone_ + near)) open_.push_back(static_cast<int>(r));
  }
  /// Calls visit(v) for all points that may be near, in ascending order.
  template <class Visit>
  void for_each_near(const Visit& visit) const {
    if constexpr (kMaterial) {
      for (const int run : open_)
        for (int v = kRun * run; v < std::min(kRun * (run + 1), surface_.vertex_count()); ++v) visit(v);
    } else {
      for (int v = 0; v < surface_.vertex_count(); ++v) visit(v);
    }
  }

  /// Returns the sample of one vertex. A vertex that faces away has no area: pressure there would pull.
  ContactSample sample_at(int v, const Pose& inverse) const {
    const Vec3 x = surface_.position(v);
    const Nearest nearest = shape_.at(x);
    return sample_of(v, x, nearest, std::max(0.0, -nearest.normal.dot(areas_.col(v))), nearest.gap, inverse);
  }
  ContactSample sample_of(int v, const Vec3& x, const Nearest& at, double area, double gap,
                          const Pose& inverse) const {
    ContactSample sample;
    sample.a = surface_.vertex_point(v);
    sample.b = frame_point(frame_, inverse, x - (at.gap + at.radius) * at.normal);
    sample.b.slide = (at.radius + (at.gap - gap)) * at.normal;
    sample.normal = at.normal;
    sample.area = area;
    sample.gap = gap;
    return sample;
  }

  /// Marks candidates: points that are near, or will be at the next query: gap + look_ahead gap' <
  /// candidate_gap, with the motion of the shape's frame included in gap'.
  bool find_candidates(const dynamics::StateView& state, const Pose& pose) {
    bool any = false;
    safe_time_ = HUGE_VAL;
    const Twist twist = motion_->twist(state);
    requested_.assign(static_cast<std::size_t>(surface_.vertex_count()), 0);
    if constexpr (kMaterial)
      for (const int run : open_) clear_[static_cast<std::size_t>(run)] = HUGE_VAL;
    for_each_near([&](int v) {
      const Vec3 x = surface_.position(v);
      const Nearest nearest = shape_.at(x);
      if constexpr (kMaterial) {
        double& clear = clear_[static_cast<std::size_t>(v / kRun)];
        clear = std::min(clear, gone_ + nearest.gap);
      }
      const double rate = nearest.normal.dot(surface_.velocity(v, state) -
                                             twist.at(x - nearest.gap * nearest.normal - pose.translation));
      safe_time_ = std::min(safe_time_, time_to_middle(nearest.gap, rate, thickness_));
      if (nearest.gap + look_ahead_ * std::min(rate, 0.0) < (kMaterial ? near_ : candidate_gap_)) {
        requested_[static_cast<std::size_t>(v)] = 1;
        any = true;
      }
    });
    fast_ += safe_time_ < look_ahead_;
    return any;
  }

  /// Counts the points that tunnelled. The path of a point since the last query, relative to the shape's
  /// frame, is taken as a straight line: outside at both ends, but through the shape in between. No contact
  /// force acted on such a point; it is on the wrong side, or part of a body that is.
  void find_tunnelled(const Pose& pose, const Pose& inverse, double t) {
    if constexpr (kMaterial) {
      for_each_near([&](int v) {
        const Vec3 now = inverse * surface_.position(v);
        if (seen_before_ && goes_through(shape_, pose, seen_from_ * surface_.kept_position(v), now))
          ++tunnelled_;
      });
      surface_.keep();
      seen_from_ = inverse;
    } else {
      seen_.resize(3, surface_.vertex_count());
      for (int v = 0; v < surface_.vertex_count(); ++v) {
        const Vec3 now = inverse * surface_.position(v);
        if (seen_before_ && goes_through(shape_, pose, seen_.col(v), now)) ++tunnelled_;
        seen_.col(v) = now;
      }
    }
    seen_before_ = true;
    if (tunnelled_ == 0 || warned_) return;
    warned_ = true;
    log::warn(
        "contact at t = {:.6g} s: {} {} tunnelled through the {} between two queries. Decrease "
        "exchange.contact_refresh_s, increase the contact stiffness, or make the {} thicker",
        t, tunnelled_, kMaterial ? "points" : "vertices", Shape::kName, Shape::kName);
  }

  Surface surface_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  Shape shape_;
  double thickness_, candidate_gap_, look_ahead_;
  /// candidate_gap_, for material points increased by the largest lowering of their gaps.
  double near_ = 0.0;
  std::vector<char> requested_;
  Points areas_;
  Points seen_;                ///< Vertices at the last query, in the frame.
  Pose seen_from_;             ///< Material points: pose that maps into the frame, at the last query.
  std::vector<double> clear_;  ///< Value of `gone_` up to which each run of material points lies outside.
  std::vector<int> open_;      ///< Runs that may be near.
  double gone_ = 0.0;          ///< Upper bound on the points' accumulated displacement [m].
  Pose shape_pose_;
  std::vector<int> kept_;             ///< Material points of the last query's samples.
  std::optional<MaterialGaps> gaps_;  ///< Material points only.
  std::vector<Vec3> places_;          ///< Positions of the kept points.
  std::vector<Nearest> nearest_;
  bool seen_before_ = false, warned_ = false;
  long tunnelled_ = 0, fast_ = 0;
  double safe_time_ = HUGE_VAL;  ///< As SourceReport::safe_time.
  SumError sum_error_;
};

/// Makes the contact of a soft or rigid surface, or of a ball, with an exact shape in a frame.
///
/// For a surface each vertex is one sample: gap = signed distance, normal = outward normal of the shape at
/// the closest point, area = area vector of the vertex projected on that normal (one third of each adjacent
/// triangle, deformed). Vertices that face away from the shape, where pressure would pull, make no sample.
/// Outside a shape the normal points from the nearest point of the surface (at edges and corners a direction
/// between the faces' normals); inside, the nearest face is used.
/// For a ball the samples are rings around the shape's normal at the point nearest to the centre
/// (ball_source.h): force = k x overlap volume, without moment about the centre unless there is friction.
/// @param candidate_gap  vertices nearer than this are kept as candidates [m]; 0: the surface's mean edge at
///   the first query, for a ball an eighth of its radius
/// @param look_ahead     time to the next query [s]: vertices that come nearer than candidate_gap in this
///   time, at their present speed, are kept as well. Without it a fast body penetrates undetected and is
///   thrown back with spurious energy.
template <class Shape>
std::unique_ptr<SampleSource> make_analytic_source(ContactSide side, int frame,
                                                   std::shared_ptr<MovingFrame> motion, const Shape& shape,
                                                   double candidate_gap, double look_ahead) {
  PALPATE_CHECK(motion, "a {} source needs a frame", Shape::kName);
  PALPATE_CHECK(candidate_gap >= 0.0, "candidate gap {} must not be negative", candidate_gap);
  PALPATE_CHECK(look_ahead >= 0.0, "look-ahead {} must not be negative", look_ahead);
  counters::count(fmt::format("contact.{}_source", Shape::kName));
  if (auto* soft = std::get_if<NodeSurface>(&side))
    return std::make_unique<AnalyticSource<SurfaceState, Shape>>(
        SurfaceState(std::move(*soft)), frame, std::move(motion), shape, candidate_gap, look_ahead);
  if (auto* rigid = std::get_if<FrameSurface>(&side))
    return std::make_unique<AnalyticSource<FrameVertices, Shape>>(
        FrameVertices(std::move(*rigid)), frame, std::move(motion), shape, candidate_gap, look_ahead);
  if (auto* points = std::get_if<MaterialPoints>(&side))
    return std::make_unique<AnalyticSource<MaterialPointState, Shape>>(
        MaterialPointState(std::move(*points)), frame, std::move(motion), shape, candidate_gap, look_ahead);
  return std::make_unique<BallSource<Shape>>(std::get<FrameBall>(std::move(side)), frame, std::move(motion),
                                             shape, candidate_gap, look_ahead);
}

/// Returns the nearest point on a shape at rest: for ObstacleEntry::nearest, without a source.
template <class Shape>
Nearest nearest_to(Shape shape, const Vec3& x) {
  shape.move_to(Pose{});
  return shape.at(x);
}

}  // namespace palpate::contact
