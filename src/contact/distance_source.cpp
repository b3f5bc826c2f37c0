// Contact by nearest points: material points of both skins, each paired with the nearest point of the other
// skin.
//
// The samples are the springs of distance::SkinContact: x a point of a skin, y(x) the nearest point of the
// other skin, normal along x - y. With A' the overlapping area of the point's hat and V the integral of
// overlap times hat, the sample has area A' and gap -V/A': for a pressure k |gap| its force is the exact
// gradient of the contact's energy. Where nothing overlaps, the sample has the area of the whole hat and the
// gap at the point. Force and opposite force act along one line. The distribution to nodes is exact where
// vertices are nodes; on a skin embedded in tetrahedra a point is carried by one tetrahedron
// (surface_state.cpp).
//
// A source with points on an exact shape (ShapePoints) has points on that side only, and those of a ball have
// no moment about its centre: see on_ball(). Samples follow the state: the query determines only which points
// can be near.
#include "contact/distance_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "contact/coupled_sides.h"
#include "contact/material_points.h"
#include "contact/safe_time.h"
#include "contact/self_contact_filter.h"
#include "contact/tunnelling_monitor.h"
#include "core/counters.h"
#include "distance/skin_contact.h"
#include "palpate/core/error.h"
#include "proxy/least_width.h"
#include "proxy/reach.h"

namespace palpate::contact {
namespace {

/// One side of the contact.
struct SkinSide {
  std::unique_ptr<ImageSide> surface;
  distance::Skin skin;
  /// Rigid side: corners of the tetrahedron that carries the skin, in its frame [m]; else empty.
  Points corners;
  TriMesh rest;  ///< Surface at rest [m].
};

class DistanceSource final : public SampleSource {
 public:
  DistanceSource(SkinSide a, SkinSide b, std::array<distance::ContactMesh, 2> meshes, double thickness,
                 const DistanceOptions& options, const std::optional<SurfacePoint>& centre = {})
      : SampleSource(kTraits),
        a_(std::move(a.surface)),
        b_(std::move(b.surface)),
        skins_{std::move(a.skin), std::move(b.skin)},
        corners_{std::move(a.corners), std::move(b.corners)},
        contact_(skins_[0], skins_[1], 1.0, std::move(meshes)),
        options_(options),
        thickness_(thickness),
        centre_(centre),
        coupled_(*a_, *b_) {
    if (options_.candidate_gap == 0.0) options_.candidate_gap = std::min(mean_edge(0), mean_edge(1));
    counters::count("contact.distance_source");
  }
  /// Creates self-contact of a skin.
  DistanceSource(SkinSide side, distance::ContactMesh mesh, double radius, const Points& rest_nodes,
                 const DistanceOptions& options)
      : SampleSource(kTraits),
        a_(std::move(side.surface)),
        skins_{std::move(side.skin), {}},
        own_(std::make_unique<SelfContactFilter>(*a_->soft(), rest_nodes)),
        contact_(skins_[0], 1.0, std::move(mesh),
                 {distance::OwnNeighbourhood(skins_[0], side.rest.vertices, radius),
                  [this](const distance::ContactPoint& point, const Vec3& x, const distance::Foot& foot) {
                    return own_->in_contact(skin_point(point.face, point.weights, x),
                                            skin_point(foot.face, foot.at.weights, x - foot.at.away));
                  }}),
        options_(options),
        thickness_(radius),
        coupled_(*a_, *a_) {
    if (options_.candidate_gap == 0.0) options_.candidate_gap = mean_edge(0);
    counters::count("contact.distance_source");
  }

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    update(state);
    if (own_)
      tunnelling_.check_self(
          *a_, thickness_, [this](int vertex, int face) { return may_collide(vertex, face); }, state.time);
    // Otherwise the source of the other surface's points checks for tunnelling.
    else if (!contact_.points(0).empty())
      tunnelling_.check(
          *a_, b(),
          [&](TunnellingMonitor::Met& met) {
            find_all_met(*a_, b(), thickness_, met.a, met.b);
            return thickness_;
          },
          state.time);
    const proxy::ProxyMotion of_a = motion(0, state), of_b = motion(1, state);
    const double near =
        proxy::Reach(options_.candidate_gap, options_.look_ahead, of_a, of_b).in_any_direction();
    if (own_) {
      const auto velocities = a_->soft()->node_velocities(state);
      contact_.find_own(carrying(0), near, {velocities.data(), options_.candidate_gap, options_.look_ahead});
    } else {
      contact_.find(carrying(0), carrying(1), near);
    }
    joints_.clear();
    points_.clear();
    safe_time_ = HUGE_VAL;
    const double speed = (of_a.velocity - of_b.velocity).norm() + of_a.spread + of_b.spread;
    for (const distance::Spring& spring : contact_.springs()) {
      const Pair pair = pair_of(spring, contact_.position(spring), contact_.outward(spring));
      samples.push_back(sample_of(spring, pair));
      points_.push_back(spring.side == 0 ? spring.point
                                         : spring.point + static_cast<int>(contact_.points(0).size()));
      if (coupled_.are_soft()) joints_.push_back(CoupledNodes::joint_of(pair.a, pair.b));
      if (spring.is_placed) safe_time_ = std::min(safe_time_, time_to_middle(spring.gap, -speed, thickness_));
    }
    if (coupled_.are_soft()) coupled_.take(joints_);
    fast_ += safe_time_ < options_.look_ahead;
    sum_error_.take({contact_.force_sum(), contact_.quadrature_error(), contact_.largest_force()});
  }
  std::span<const int> material_points() const override { return points_; }
  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    const std::vector<distance::Spring>& springs = contact_.springs();
    PALPATE_CHECK(samples.size() == springs.size(),
                  "distance: {} samples passed to follow(), but the query found {}", samples.size(),
                  springs.size());
    if (samples.empty()) return;
    update(state);
    contact_.follow(carrying(0), carrying(1));
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (!springs[i].is_placed) samples[i].area = 0.0;  // Not a nearest point at this state: no force.
    contact_.for_each_placed([&](std::size_t i, const Vec3& x, const Vec3& outward) {
      Pair pair = pair_of(springs[i], x, outward);
      if (coupled_.are_soft()) keep_in_pattern(joints_[i], pair);
      const int source = samples[i].source;
      samples[i] = sample_of(springs[i], pair);
      samples[i].source = source;
    });
  }

  void add_pattern(dynamics::PatternBuilder& pattern) const override { coupled_.add_pattern(pattern); }
  std::uint64_t pattern_version() const override { return coupled_.version(); }
  SourceReport report() const override {
    return {.tunnelled = tunnelling_.count(),
            .safe_time = safe_time_,
            .fast_regions = fast_,
            .sum_error = &sum_error_};
  }
  void archive(Archive& a) override {
    tunnelling_.archive(a);
    a("fast", fast_);
    a("sum_error", sum_error_);
  }

 private:
  inline static const SourceTraits kTraits = {.name = "distance", .follows = true};
  /// Returns whether a vertex and a face of a skin in self-contact, in the original numbering, are not
  /// neighbours.
  bool may_collide(int vertex, int face) const {
    const distance::Skin& skin = skins_[0];
    const auto around = [&](int v) {
      const auto at = static_cast<std::size_t>(v);
      return std::span(skin.fan.begin() + skin.fan_begin[at], skin.fan.begin() + skin.fan_begin[at + 1]);
    };
    const auto faces = around(a_->faces()(0, face));
    const auto found = std::find_if(faces.begin(), faces.end(), [&](int f) {
      return skin.given_face[static_cast<std::size_t>(f)] == face;
    });
    PALPATE_CHECK(found != faces.end(), "face {} is missing from the faces around its first vertex", face);
    const auto cluster = [](int f) { return f / distance::kClusterFaces; };
    return contact_.may_touch(cluster(around(vertex).front()), cluster(*found));
  }
  void update(const dynamics::StateView& state) {
    a_->update(state);
    if (b_) b_->update(state);
  }
  /// Returns the positions of the nodes of a side's distance::Skin: the body's nodes, its vertices, or the
  /// corners of the tetrahedron that carries a rigid skin.
  const double* carrying(std::size_t side) {
    ImageSide& surface = side == 0 ? *a_ : b();
    if (surface.soft()) return surface.points().data();
    const Pose pose = surface.frame();
    if (side == 1 && centre_)
      placed_[side] = corners_[side].colwise() - centre_->offset;
    else
      placed_[side].noalias() = pose.rotation.toRotationMatrix() * corners_[side];
    placed_[side].colwise() += side == 1 && centre_ ? pose * centre_->offset : pose.translation;
    return placed_[side].data();
  }

  /// As MaterialPointState::mean_edge(); infinite for a side without points.
  double mean_edge(int side) const {
    double area = 0.0;
    for (const distance::ContactPoint& point : contact_.points(side)) area += point.area;
    return area > 0.0 ? std::sqrt(area / static_cast<double>(contact_.points(side).size())) : HUGE_VAL;
  }

  proxy::ProxyMotion motion(int side, const dynamics::StateView& state) const {
    const ImageSide& of = side == 0 ? *a_ : b();
    proxy::ProxyMotion out = of.motion(state);
    if (of.soft() && of.soft()->is_skin())
      out.spread = contact_.spread(side, of.soft()->node_velocities(state).data(), out.velocity);
    return out;
  }

  /// Both points of a spring and the normal, from b to a.
  struct Pair {
    CarriedPoint a, b;
    Vec3 at_a, at_b, normal;
  };
  /// @param x  the spring's point [m]  @param out  outward direction of the other side at its foot
  Pair pair_of(const distance::Spring& spring, const Vec3& x, const Vec3& out) const {
    const distance::ContactPoint& point =
        contact_.points(spring.side)[static_cast<std::size_t>(spring.point)];
    const Vec3 y = x + spring.reach;
    Pair pair;
    const bool is_of_a = spring.side == 0;
    pair.normal = is_of_a ? out : Vec3(-out);
    pair.at_a = is_of_a ? x : y;
    pair.at_b = is_of_a ? y : x;
    const auto carried = [&](int side, int face, const Vec3& weights, const Vec3& at) -> CarriedPoint {
      if (side == 1 && centre_) return {on_ball(at, pair.normal), 0};
      const int given = skin(side).given_face[static_cast<std::size_t>(face)];
      return (side == 0 ? *a_ : b()).carried(given, weights, at, pair.normal);
    };
    (is_of_a ? pair.a : pair.b) = carried(spring.side, point.face, point.weights, x);
    (is_of_a ? pair.b : pair.a) = carried(1 - spring.side, spring.face, spring.weights, y);
    return pair;
  }
  ContactSample sample_of(const distance::Spring& spring, const Pair& pair) const {
    ContactSample out;
    out.a = pair.a.point;
    out.b = pair.b.point;
    out.normal = pair.normal;
    out.area = spring.is_placed ? spring.stiffness : 0.0;  // Stiffness at 1 Pa/m: half of the hat's area.
    out.gap = spring.gap;
    if (spring.force > 0.0) {
      out.gap = -spring.force / spring.stiffness;
      out.stored = 2.0 * spring.energy * spring.stiffness / (spring.force * spring.force);
      const Vec3 end = pair.at_a - out.gap * pair.normal;  // On the same line.
      if (b().soft())
        out.b.offset += end - pair.at_b;
      else
        out.b = centre_ ? on_ball(end, pair.normal) : b().carried(0, Vec3::Zero(), end, pair.normal).point;
    }
    return out;
  }
  // The points of a ball do not rotate with it: no force depends on its rotation, so that the gradient has no
  // moment about its centre. Each force acts along the line through the centre.
  SurfacePoint on_ball(const Vec3& x, const Vec3& normal) const {
    SurfacePoint point = *centre_;
    point.slide = normal.dot(x - b_->frame() * centre_->offset) * normal;
    return point;
  }

  /// Keeps one sample within the pattern, which has the blocks of the query's carriers and of all carriers
  /// that share nodes with these (CoupledNodes). A point that has moved farther stays attached to its carrier
  /// at the query.
  void keep_in_pattern(const CoupledNodes::Joint& then, Pair& now) const {
    const auto keep = [&](const ImageSide& side, int number, const std::array<int, 4>& nodes, int count,
                          const Vec3& x, CarriedPoint& point) {
      const auto end = point.point.node.begin() + point.point.count;
      const auto is_shared = [&](int node) { return std::find(point.point.node.begin(), end, node) != end; };
      if (number != point.number && std::none_of(nodes.begin(), nodes.begin() + count, is_shared))
        point = side.carried_by(number, x, now.normal);
    };
    keep(*a_, static_cast<int>(then.key >> 32), then.a, then.count_a, now.at_a, now.a);
    keep(b(), static_cast<int>(then.key & 0xffffffffu), then.b, then.count_b, now.at_b, now.b);
  }

  ImageSide& b() const { return b_ ? *b_ : *a_; }
  const distance::Skin& skin(int side) const { return skins_[b_ ? static_cast<std::size_t>(side) : 0]; }
  SkinPoint skin_point(int face, const Vec3& weights, const Vec3& at) const {
    return own_->point(skins_[0].given_face[static_cast<std::size_t>(face)], weights, at);
  }

  std::unique_ptr<ImageSide> a_, b_;  ///< Sides; b is null for self-contact.
  std::array<distance::Skin, 2> skins_;
  std::unique_ptr<SelfContactFilter> own_;  ///< Self-contact only.
  /// Rigid sides: carrying corners in their frames and in the world [m].
  std::array<Points, 2> corners_, placed_;
  distance::SkinContact contact_;
  DistanceOptions options_;
  double thickness_;                    ///< Thickness of the thinner side [m].
  std::optional<SurfacePoint> centre_;  ///< Centre of a ball, side b, in its frame.
  std::vector<int> points_;  ///< Indices of the last query's samples; those of b follow those of a.
  std::vector<CoupledNodes::Joint> joints_;  ///< Two soft bodies: carriers of the samples at the query.
  CoupledSides coupled_;
  double safe_time_ = HUGE_VAL;
  long fast_ = 0;
  TunnellingMonitor tunnelling_;
  SumError sum_error_;
};

SkinSide soft(NodeSurface surface, const Points& rest,
              distance::Clusters clusters = distance::Clusters::kAny) {
  SkinSide side;
  side.rest = {rest, surface.faces};
  const bool is_embedded = surface.node_of_vertex.empty();
  side.skin = is_embedded ? distance::make_skin(side.rest, surface.embedding, surface.tets,
                                                surface.tets.maxCoeff() + 1, clusters)
                          : distance::make_skin(side.rest);
  side.surface = soft_side(std::move(surface));
  return side;
}

SkinSide rigid(const FrameSurface& surface) {
  SkinSide side;
  side.rest = surface.mesh;
  side.skin = distance::make_rigid_skin(side.rest, side.corners);
  side.surface = rigid_side(surface.mesh, surface.frame, surface.motion);
  return side;
}

/// Makes a source with points of both sides.
std::unique_ptr<SampleSource> make(SkinSide a, SkinSide b, const DistanceOptions& options) {
  const CharacteristicLengths of_a = lengths_of(a.rest), of_b = lengths_of(b.rest);
  const auto spacing = [&](const CharacteristicLengths& own, const CharacteristicLengths& other) {
    return options.spacing > 0.0 ? options.spacing : point_spacing(own, other, options.quadrature_error);
  };
  std::array<distance::ContactMesh, 2> meshes = {distance::contact_mesh(a.skin, spacing(of_a, of_b)),
                                                 distance::contact_mesh(b.skin, spacing(of_b, of_a))};
  return std::make_unique<DistanceSource>(std::move(a), std::move(b), std::move(meshes),
                                          std::min(of_a.width, of_b.width), options);
}

/// Makes a source with points of the shape only.
std::unique_ptr<SampleSource> make(SkinSide other, const ShapePoints& shape, const DistanceOptions& options) {
  SkinSide own = rigid(shape.surface);
  distance::ContactMesh mesh = distance::contact_mesh(own.skin, shape.spacing);
  Points at(3, static_cast<Eigen::Index>(mesh.points.size()));
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    const distance::ContactPoint& point = mesh.points[static_cast<std::size_t>(i)];
    at.col(i) = own.rest.vertices(Eigen::all, own.skin.faces.col(point.face)) * point.weights;
  }
  distance::fit_to_surface(mesh, at, shape.onto);
  std::optional<SurfacePoint> centre;
  if (shape.centre) {
    centre.emplace();
    centre->frame = shape.surface.frame;
    centre->offset = *shape.centre;
  }
  const double thickness = std::min(lengths_of(other.rest).width, proxy::least_width(own.rest.vertices));
  return std::make_unique<DistanceSource>(std::move(other), std::move(own),
                                          std::array{distance::ContactMesh{}, std::move(mesh)}, thickness,
                                          options, centre);
}

}  // namespace

std::unique_ptr<SampleSource> make_distance_source(NodeSurface a, const Points& rest_a, NodeSurface b,
                                                   const Points& rest_b, const DistanceOptions& options) {
  return make(soft(std::move(a), rest_a), soft(std::move(b), rest_b), options);
}

std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest,
                                                   const FrameSurface& other,
                                                   const DistanceOptions& options) {
  return make(soft(std::move(surface), rest), rigid(other), options);
}

std::unique_ptr<SampleSource> make_distance_source(const FrameSurface& a, const FrameSurface& b,
                                                   const DistanceOptions& options) {
  return make(rigid(a), rigid(b), options);
}

std::unique_ptr<SampleSource> make_own_distance_source(NodeSurface surface, const Points& rest,
                                                       const Points& rest_nodes,
                                                       const DistanceOptions& options) {
  SkinSide side = soft(std::move(surface), rest, distance::Clusters::kConnected);
  const CharacteristicLengths lengths = lengths_of(side.rest);
  distance::ContactMesh mesh =
      distance::contact_mesh(side.skin, point_spacing(lengths, lengths, options.quadrature_error));
  return std::make_unique<DistanceSource>(std::move(side), std::move(mesh), 2.0 * own_contact_depth(lengths),
                                          rest_nodes, options);
}

std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest,
                                                   const ShapePoints& shape, const DistanceOptions& options) {
  return make(soft(std::move(surface), rest), shape, options);
}

std::unique_ptr<SampleSource> make_distance_source(const FrameSurface& surface, const ShapePoints& shape,
                                                   const DistanceOptions& options) {
  return make(rigid(surface), shape, options);
}

}  // namespace palpate::contact
