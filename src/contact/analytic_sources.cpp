#include <algorithm>
#include <cmath>

#include "contact/surface_state.h"
#include "palpate/contact/sources.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"

namespace palpate::contact {
namespace {

/// Nearest point of a shape to x, from outside: signed distance and outward normal there, world axes.
struct Nearest {
  double gap;
  Vec3 normal;
  /// of a sphere or cylinder there [m]: its centre lies that far within; 0 of faces and edges, which turn
  /// with the shape
  double radius = 0.0;
};

/// Vertices of a surface against an exact shape.  `Shape` gives `Nearest at(x)` for the frame's pose of this
/// query.
template <class Shape>
class AnalyticSource final : public SampleSource {
 public:
  AnalyticSource(NodeSurface surface, int frame, std::shared_ptr<MovingFrame> motion, Shape shape,
                 double candidate_gap, double look_ahead)
      : surface_(std::move(surface)),
        frame_(frame),
        motion_(std::move(motion)),
        shape_(shape),
        candidate_gap_(candidate_gap),
        look_ahead_(look_ahead) {
    PALPATE_CHECK(motion_, "a {} source needs a frame", Shape::kName);
    PALPATE_CHECK(candidate_gap >= 0.0, "candidate gap {} must not be negative", candidate_gap);
    PALPATE_CHECK(look_ahead >= 0.0, "look-ahead {} must not be negative", look_ahead);
    counters::count(std::string("contact.") + Shape::kName + "_source");
  }

  std::string_view name() const override { return Shape::kName; }
  long tunnelled() const override { return tunnelled_; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { surface_.add_vertex_pattern(pattern); }
  std::uint64_t pattern_version() const override { return surface_.vertex_pattern_version(); }

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    surface_.update(state);
    if (candidate_gap_ == 0.0) candidate_gap_ = surface_.mean_edge();
    const Pose pose = motion_->pose(state), inverse = pose.inverse();
    shape_.place(pose);
    find_tunnelled(inverse, state.time);
    if (!find_candidates(state, pose)) return;
    surface_.area_vectors(wanted_, areas_);
    for (int v = 0; v < surface_.vertex_count(); ++v) {
      if (!wanted_[static_cast<std::size_t>(v)]) continue;
      const Vec3 x = surface_.positions().col(v);
      const Nearest nearest = shape_.at(x);
      const double area = -nearest.normal.dot(areas_.col(v));
      if (area <= 0.0) continue;  // turned away: pressure there would pull
      ContactSample sample;
      sample.a = surface_.vertex_point(v);
      sample.b = frame_point(frame_, inverse, x - (nearest.gap + nearest.radius) * nearest.normal);
      sample.b.slide = nearest.radius * nearest.normal;
      sample.normal = nearest.normal;
      sample.area = area;
      sample.gap = nearest.gap;
      samples.push_back(sample);
    }
  }

 private:
  /// Near, or near at the next query: gap + look_ahead gap' < candidate_gap, with the frame's own motion in
  /// gap'.
  bool find_candidates(const dynamics::StateView& state, const Pose& pose) {
    bool any = false;
    const Twist twist = motion_->twist(state);
    wanted_.assign(static_cast<std::size_t>(surface_.vertex_count()), 0);
    for (int v = 0; v < surface_.vertex_count(); ++v) {
      const Vec3 x = surface_.positions().col(v);
      const Nearest nearest = shape_.at(x);
      const double rate = nearest.normal.dot(surface_.velocity(v, state) -
                                             twist.at(x - nearest.gap * nearest.normal - pose.translation));
      if (nearest.gap + look_ahead_ * std::min(rate, 0.0) < candidate_gap_) {
        wanted_[static_cast<std::size_t>(v)] = 1;
        any = true;
      }
    }
    return any;
  }

  /// A vertex's way since the last query, seen from the frame, as a straight line: outside at both ends, but
  /// through the shape in between. Nothing pushed it back; it is on the wrong side, or inside a body that is.
  void find_tunnelled(const Pose& inverse, double t) {
    const Points& world = surface_.positions();
    seen_.resize(3, world.cols());
    for (Eigen::Index v = 0; v < world.cols(); ++v) {
      const Vec3 now = inverse * Vec3(world.col(v));
      if (seen_before_ && shape_.is_crossed(seen_.col(v), now)) ++tunnelled_;
      seen_.col(v) = now;
    }
    seen_before_ = true;
    if (tunnelled_ == 0 || warned_) return;
    warned_ = true;
    log::warn(
        "contact at t = {:.6g} s: {} vertices went through the {} between two queries, unseen; refresh "
        "contact more often (contact_refresh_s), make the contact stiffer, or the {} thicker",
        t, tunnelled_, Shape::kName, Shape::kName);
  }

  SurfaceState surface_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  Shape shape_;
  double candidate_gap_, look_ahead_;
  std::vector<char> wanted_;
  Points areas_;
  Points seen_;  ///< vertices at the last query, in the frame
  bool seen_before_ = false, warned_ = false;
  long tunnelled_ = 0;
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
  bool is_crossed(const Vec3&, const Vec3&) const { return false; }  // whatever is through is inside

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
    return {distance - radius_, distance > 0.0 ? Vec3(from_centre / distance) : Vec3(Vec3::UnitZ()), radius_};
  }
  // The point of the segment nearest to the centre.
  bool is_crossed(const Vec3& a, const Vec3& b) const {
    const Vec3 d = b - a, from_a = centre_ - a;
    const double length2 = d.squaredNorm(),
                 s = length2 > 0.0 ? std::clamp(from_a.dot(d) / length2, 0.0, 1.0) : 0.0;
    const double r2 = radius_ * radius_;
    return from_a.squaredNorm() > r2 && (centre_ - b).squaredNorm() > r2 &&
           (from_a - s * d).squaredNorm() < r2;
  }

 private:
  Vec3 centre_;
  double radius_;
  Vec3 world_centre_ = Vec3::Zero();
};

/// Part [s0, s1] of a segment; empty where s0 > s1.
struct Part {
  double s0 = 0.0, s1 = 1.0;
  /// Cut to where low <= a + s d <= high.
  void cut(double a, double d, double low, double high) {
    if (d == 0.0) {
      if (a < low || a > high) s1 = -1.0;
      return;
    }
    const double one = (low - a) / d, two = (high - a) / d;
    s0 = std::max(s0, std::min(one, two));
    s1 = std::min(s1, std::max(one, two));
  }
};

/// |x_i| <= h_i in its own axes.  Outside, e_i = max(|x_i| - h_i, 0) is the way from the nearest point, signs
/// left out.
class Box {
 public:
  static constexpr const char* kName = "box";
  Box(const Pose& place, const Vec3& size) : place_(place), inverse_(place.inverse()), half_(0.5 * size) {}
  void place(const Pose& pose) { world_ = pose * place_; }
  Nearest at(const Vec3& world) const {
    const Vec3 x = world_.inverse() * world, beyond = x.cwiseAbs() - half_, out = beyond.cwiseMax(0.0);
    const double distance = out.norm();
    Vec3 normal;
    if (distance > 0.0) {
      normal = out / distance;
    } else {
      Eigen::Index face;
      beyond.maxCoeff(&face);
      normal = Vec3::Unit(face);
    }
    for (int i = 0; i < 3; ++i)
      if (x[i] < 0.0) normal[i] = -normal[i];
    return {distance > 0.0 ? distance : beyond.maxCoeff(), world_.rotation * normal};
  }
  bool is_crossed(const Vec3& a_frame, const Vec3& b_frame) const {
    const Vec3 a = inverse_ * a_frame, b = inverse_ * b_frame;
    if (!outside(a) || !outside(b)) return false;
    Part part;
    for (int i = 0; i < 3; ++i) part.cut(a[i], b[i] - a[i], -half_[i], half_[i]);
    return part.s0 < part.s1;
  }

 private:
  bool outside(const Vec3& x) const { return ((x.cwiseAbs() - half_).array() > 0.0).any(); }
  Pose place_, inverse_;
  Vec3 half_;
  Pose world_;
};

/// x^2 + y^2 <= r^2, |z| <= h in its own axes: in the plane of (radius, |z|) a box of two directions.
class Cylinder {
 public:
  static constexpr const char* kName = "cylinder";
  Cylinder(const Pose& place, double radius, double length)
      : place_(place), inverse_(place.inverse()), radius_(radius), half_(0.5 * length) {}
  void place(const Pose& pose) { world_ = pose * place_; }
  // On the axis every radial direction is as near; one is taken.
  Nearest at(const Vec3& world) const {
    const Vec3 x = world_.inverse() * world;
    const double r = std::hypot(x.x(), x.y()), side = r - radius_, end = std::abs(x.z()) - half_;
    const Vec3 radial = r > 0.0 ? Vec3(x.x() / r, x.y() / r, 0.0) : Vec3(Vec3::UnitX()),
               axial = std::copysign(1.0, x.z()) * Vec3::UnitZ();
    const double out_side = std::max(side, 0.0), out_end = std::max(end, 0.0),
                 distance = std::hypot(out_side, out_end);
    if (out_end == 0.0 && (side > 0.0 || side > end)) return {side, world_.rotation * radial, radius_};
    if (distance > 0.0)
      return {distance, world_.rotation * Vec3((out_side * radial + out_end * axial) / distance)};
    return {end, world_.rotation * axial};
  }
  // |a + s d|^2 = r^2 in x and y: A s^2 + 2 B s + C = 0.
  bool is_crossed(const Vec3& a_frame, const Vec3& b_frame) const {
    const Vec3 a = inverse_ * a_frame, b = inverse_ * b_frame, d = b - a;
    if (!outside(a) || !outside(b)) return false;
    Part part;
    part.cut(a.z(), d.z(), -half_, half_);
    const double A = d.head<2>().squaredNorm(), B = a.head<2>().dot(d.head<2>()),
                 C = a.head<2>().squaredNorm() - radius_ * radius_;
    if (A == 0.0) return C < 0.0 && part.s0 < part.s1;
    const double root2 = B * B - A * C;
    if (root2 <= 0.0) return false;
    const double root = std::sqrt(root2);
    part.s0 = std::max(part.s0, (-B - root) / A);
    part.s1 = std::min(part.s1, (-B + root) / A);
    return part.s0 < part.s1;
  }

 private:
  bool outside(const Vec3& x) const {
    return std::abs(x.z()) > half_ || x.head<2>().squaredNorm() > radius_ * radius_;
  }
  Pose place_, inverse_;
  double radius_, half_;
  Pose world_;
};

}  // namespace

std::unique_ptr<SampleSource> make_plane_source(NodeSurface surface, int frame,
                                                std::shared_ptr<MovingFrame> motion, const Vec3& point,
                                                const Vec3& normal, double candidate_gap, double look_ahead) {
  if (!(normal.norm() > 0.0) || !normal.allFinite())
    fail("plane: normal = ({}, {}, {}) has no direction", normal.x(), normal.y(), normal.z());
  return std::make_unique<AnalyticSource<Plane>>(std::move(surface), frame, std::move(motion),
                                                 Plane(point, normal), candidate_gap, look_ahead);
}

std::unique_ptr<SampleSource> make_sphere_source(NodeSurface surface, int frame,
                                                 std::shared_ptr<MovingFrame> motion, const Vec3& centre,
                                                 double radius, double candidate_gap, double look_ahead) {
  if (!(radius > 0.0) || !std::isfinite(radius)) fail("sphere: radius = {} must be positive", radius);
  return std::make_unique<AnalyticSource<Sphere>>(std::move(surface), frame, std::move(motion),
                                                  Sphere(centre, radius), candidate_gap, look_ahead);
}

std::unique_ptr<SampleSource> make_box_source(NodeSurface surface, int frame,
                                              std::shared_ptr<MovingFrame> motion, const Pose& place,
                                              const Vec3& size, double candidate_gap, double look_ahead) {
  if (!(size.minCoeff() > 0.0) || !size.allFinite())
    fail("box: size = ({}, {}, {}) must be positive", size.x(), size.y(), size.z());
  return std::make_unique<AnalyticSource<Box>>(std::move(surface), frame, std::move(motion), Box(place, size),
                                               candidate_gap, look_ahead);
}

std::unique_ptr<SampleSource> make_cylinder_source(NodeSurface surface, int frame,
                                                   std::shared_ptr<MovingFrame> motion, const Pose& place,
                                                   double radius, double length, double candidate_gap,
                                                   double look_ahead) {
  if (!(radius > 0.0) || !std::isfinite(radius)) fail("cylinder: radius = {} must be positive", radius);
  if (!(length > 0.0) || !std::isfinite(length)) fail("cylinder: length = {} must be positive", length);
  return std::make_unique<AnalyticSource<Cylinder>>(std::move(surface), frame, std::move(motion),
                                                    Cylinder(place, radius, length), candidate_gap,
                                                    look_ahead);
}

}  // namespace palpate::contact
