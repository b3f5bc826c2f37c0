#include <algorithm>
#include <cmath>

#include "contact/surface_state.h"
#include "palpate/contact/sources.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

/// Nearest point of a shape to x, from outside: signed distance and outward normal there, world axes.
struct Nearest {
  double gap;
  Vec3 normal;
};

/// Vertices of a surface against an exact shape.  `Shape` gives `Nearest at(x)` for the frame's pose of this query.
template <class Shape>
class AnalyticSource final : public SampleSource {
 public:
  AnalyticSource(NodeSurface surface, int frame, std::shared_ptr<MovingFrame> motion, Shape shape, double candidate_gap, double look_ahead)
      : surface_(std::move(surface)), frame_(frame), motion_(std::move(motion)), shape_(shape), candidate_gap_(candidate_gap), look_ahead_(look_ahead) {
    PALPATE_CHECK(motion_, "a {} source needs a frame", Shape::kName);
    PALPATE_CHECK(candidate_gap >= 0.0, "candidate gap {} must not be negative", candidate_gap);
    PALPATE_CHECK(look_ahead >= 0.0, "look-ahead {} must not be negative", look_ahead);
    counters::count(std::string("contact.") + Shape::kName + "_source");
  }

  std::string_view name() const override { return Shape::kName; }
  void add_pattern(dynamics::PatternBuilder&) const override {}  // one node a sample: diagonal blocks only

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    surface_.update(state);
    if (candidate_gap_ == 0.0) candidate_gap_ = surface_.mean_edge();
    const Pose pose = motion_->pose(state), inverse = pose.inverse();
    shape_.place(pose);
    if (!find_candidates(state, pose)) return;
    surface_.area_vectors(wanted_, areas_);
    for (int v = 0; v < surface_.vertex_count(); ++v) {
      if (!wanted_[static_cast<std::size_t>(v)]) continue;
      const Vec3 x = surface_.positions().col(v);
      const Nearest nearest = shape_.at(x);
      const double area = -nearest.normal.dot(areas_.col(v));
      if (area <= 0.0) continue;  // turned away: pressure there would pull
      ContactSample sample;
      sample.a = vertex_point(surface_.node(v));
      sample.b = frame_point(frame_, inverse, x - nearest.gap * nearest.normal);
      sample.normal = nearest.normal;
      sample.area = area;
      sample.gap = nearest.gap;
      samples.push_back(sample);
    }
  }

 private:
  /// Near, or near at the next query: gap + look_ahead gap' < candidate_gap, with the frame's own motion in gap'.
  bool find_candidates(const dynamics::StateView& state, const Pose& pose) {
    bool any = false;
    const Twist twist = motion_->twist(state);
    wanted_.assign(static_cast<std::size_t>(surface_.vertex_count()), 0);
    for (int v = 0; v < surface_.vertex_count(); ++v) {
      const Vec3 x = surface_.positions().col(v);
      const Nearest nearest = shape_.at(x);
      const double rate = nearest.normal.dot(state.velocity(surface_.node(v)) - twist.at(x - nearest.gap * nearest.normal - pose.translation));
      if (nearest.gap + look_ahead_ * std::min(rate, 0.0) < candidate_gap_) {
        wanted_[static_cast<std::size_t>(v)] = 1;
        any = true;
      }
    }
    return any;
  }

  SurfaceState surface_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  Shape shape_;
  double candidate_gap_, look_ahead_;
  std::vector<char> wanted_;
  Points areas_;
};

class Plane {
 public:
  static constexpr const char* kName = "plane";
  Plane(const Vec3& point, const Vec3& normal) : point_(point), normal_(normal.normalized()) {}
  void place(const Pose& pose) {
    world_normal_ = pose.rotation * normal_;
    world_point_ = pose * point_;
  }
  Nearest at(const Vec3& x) const { return {world_normal_.dot(x - world_point_), world_normal_}; }

 private:
  Vec3 point_, normal_;
  Vec3 world_point_ = Vec3::Zero(), world_normal_ = Vec3::UnitZ();
};

class Sphere {
 public:
  static constexpr const char* kName = "sphere";
  Sphere(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
  void place(const Pose& pose) { world_centre_ = pose * centre_; }
  // At the centre itself every direction is as near; one is taken.
  Nearest at(const Vec3& x) const {
    const Vec3 from_centre = x - world_centre_;
    const double distance = from_centre.norm();
    return {distance - radius_, distance > 0.0 ? Vec3(from_centre / distance) : Vec3(Vec3::UnitZ())};
  }

 private:
  Vec3 centre_;
  double radius_;
  Vec3 world_centre_ = Vec3::Zero();
};

}  // namespace

std::unique_ptr<SampleSource> make_plane_source(NodeSurface surface, int frame, std::shared_ptr<MovingFrame> motion, const Vec3& point,
                                                const Vec3& normal, double candidate_gap, double look_ahead) {
  if (!(normal.norm() > 0.0) || !normal.allFinite()) fail("plane: normal = ({}, {}, {}) has no direction", normal.x(), normal.y(), normal.z());
  return std::make_unique<AnalyticSource<Plane>>(std::move(surface), frame, std::move(motion), Plane(point, normal), candidate_gap,
                                                 look_ahead);
}

std::unique_ptr<SampleSource> make_sphere_source(NodeSurface surface, int frame, std::shared_ptr<MovingFrame> motion, const Vec3& centre,
                                                 double radius, double candidate_gap, double look_ahead) {
  if (!(radius > 0.0) || !std::isfinite(radius)) fail("sphere: radius = {} must be positive", radius);
  return std::make_unique<AnalyticSource<Sphere>>(std::move(surface), frame, std::move(motion), Sphere(centre, radius), candidate_gap,
                                                  look_ahead);
}

}  // namespace palpate::contact
