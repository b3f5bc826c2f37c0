// Contact by nearest points: material points of both skins, each tied to the nearest point of the other one.
//
// The samples are the springs of distance::SkinContact: x a point of a skin, y(x) the nearest point of the
// other one, normal along x - y.  With A' the area of the point's hat that overlaps and V the integral of
// overlap times hat, the sample has area A' and the gap -V/A': for a pressure k |gap| its force is the exact
// gradient of the contact's energy.  Where nothing overlaps it has all of its hat, and its own gap.  Force
// and opposite force have one line.  What the nodes get of them is exact where vertices are nodes; on a skin
// in tetrahedra a point hangs on one tetrahedron (surface_state.cpp).
//
// Samples follow the state with gaps = "exact": the query only says which points can be near.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "contact/coupled_nodes.h"
#include "contact/image_side.h"
#include "contact/safe_time.h"
#include "palpate/contact/sources.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/distance/skin_contact.h"
#include "palpate/proxy/reach.h"

namespace palpate::contact {
namespace {

class DistanceSource final : public SampleSource {
 public:
  DistanceSource(std::unique_ptr<ImageSide> a, distance::Skin skin_a, std::unique_ptr<ImageSide> b,
                 distance::Skin skin_b, const std::array<double, 2>& spacing, double thickness,
                 const DistanceOptions& options)
      : a_(std::move(a)),
        b_(std::move(b)),
        skins_{std::move(skin_a), std::move(skin_b)},
        contact_(skins_[0], skins_[1], {.stiffness_pa_m = 1.0, .spacing_m = spacing}),
        options_(options),
        thickness_(thickness) {
    counters::count("contact.distance_source");
  }

  std::string_view name() const override { return "distance"; }

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    update(state);
    const proxy::ProxyMotion of_a = motion(0, state), of_b = motion(1, state);
    contact_.find(carrying(*a_), carrying(*b_),
                  proxy::Reach(options_.candidate_gap, options_.look_ahead, of_a, of_b).in_any_direction());
    joints_.clear();
    safe_time_ = HUGE_VAL;
    const double speed = (of_a.velocity - of_b.velocity).norm() + of_a.spread + of_b.spread;
    for (const distance::Spring& spring : contact_.springs()) {
      const Pair pair = pair_of(spring);
      samples.push_back(sample_of(spring, pair));
      if (is_coupled()) joints_.push_back(joint_of(pair));
      if (spring.is_placed) safe_time_ = std::min(safe_time_, time_to_middle(spring.gap, -speed, thickness_));
    }
    if (is_coupled()) couple();
    fast_ += safe_time_ < options_.look_ahead;
    sum_error_.take({contact_.force_sum(), contact_.quadrature_error(), contact_.largest_force()});
  }
  const SumError* sum_error() const override { return &sum_error_; }

  bool start_following() override { return true; }
  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    const std::vector<distance::Spring>& springs = contact_.springs();
    PALPATE_CHECK(samples.size() == springs.size(), "distance: {} samples follow, {} were found",
                  samples.size(), springs.size());
    if (samples.empty()) return;
    update(state);
    contact_.follow(carrying(*a_), carrying(*b_));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!springs[i].is_placed) {
        samples[i].area = 0.0;  // its points are not where they were nearest: no force, whatever they do
        continue;
      }
      Pair pair = pair_of(springs[i]);
      if (is_coupled()) keep_in_pattern(joints_[i], pair);
      const int source = samples[i].source;
      samples[i] = sample_of(springs[i], pair);
      samples[i].source = source;
    }
  }

  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    for (const ImageSide* side : {a_.get(), b_.get()})
      if (side->soft()) side->soft()->add_face_pattern(pattern);
    coupled_.add_pattern(pattern);
  }
  std::uint64_t pattern_version() const override {
    std::uint64_t sum = coupled_.version();
    for (const ImageSide* side : {a_.get(), b_.get()})
      if (side->soft()) sum += side->soft()->pattern_version();
    return sum;
  }
  double safe_time() const override { return safe_time_; }
  long fast_regions() const override { return fast_; }
  void archive(Archive& a) override {
    a("fast", fast_);
    a("sum_error", sum_error_);
  }

 private:
  void update(const dynamics::StateView& state) {
    a_->update(state);
    b_->update(state);
  }
  /// Positions of the nodes of a side's distance::Skin: the body's nodes, or the vertices.
  static const double* carrying(ImageSide& side) {
    return (side.soft() ? side.points() : side.positions()).data();
  }

  /// Velocities of the skin's vertices, which bound those of all its points.
  proxy::ProxyMotion motion(int side, const dynamics::StateView& state) {
    const ImageSide& of = side == 0 ? *a_ : *b_;
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
  Pair pair_of(const distance::Spring& spring) const {
    const distance::ContactPoint& point =
        contact_.points(spring.side)[static_cast<std::size_t>(spring.point)];
    const Vec3 x = contact_.position(spring), y = x + spring.reach;
    const Vec3 out = contact_.outward(spring);  // of b where the point is a's
    Pair pair;
    const bool is_of_a = spring.side == 0;
    pair.normal = is_of_a ? out : Vec3(-out);
    pair.at_a = is_of_a ? x : y;
    pair.at_b = is_of_a ? y : x;
    const auto carried = [&](int side, int face, const Vec3& weights, const Vec3& at) {
      const int given = skins_[static_cast<std::size_t>(side)].given_face[static_cast<std::size_t>(face)];
      return (side == 0 ? *a_ : *b_).carried(given, weights, at, pair.normal);
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
    out.area = spring.is_placed ? spring.stiffness : 0.0;  // of 1 Pa/m: half of the hat's area
    out.gap = spring.gap;
    if (spring.force > 0.0) {
      out.gap = -spring.force / spring.stiffness;
      out.stored = spring.gap / out.gap;
      const Vec3 end = pair.at_a - out.gap * pair.normal;  // on the same line
      if (b_->soft())
        out.b.offset += end - pair.at_b;
      else
        out.b = b_->carried(0, Vec3::Zero(), end, pair.normal).point;
    }
    return out;
  }

  /// Blocks between the nodes of two soft bodies.
  bool is_coupled() const { return a_->soft() && b_->soft(); }
  static CoupledNodes::Joint joint_of(const Pair& pair) {
    return {CoupledNodes::key_of(pair.a.number, pair.b.number), pair.a.point.count, pair.b.point.count,
            pair.a.point.node, pair.b.point.node};
  }
  void couple() {
    const std::uint64_t layout = a_->soft()->pattern_version() + b_->soft()->pattern_version();
    if (!neighbours_ || layout != counted_in_) {
      neighbours_ = {a_->soft()->neighbours(), b_->soft()->neighbours()};
      coupled_.start((*neighbours_)[0], (*neighbours_)[1]);
      counted_in_ = layout;
    }
    coupled_.take(joints_);
  }
  /// The blocks between two bodies are those of the query's carriers and of all that these share nodes with
  /// (CoupledNodes).  A point that has gone farther hangs on what carried it at the query.
  void keep_in_pattern(const CoupledNodes::Joint& then, Pair& now) const {
    const auto keep = [&](const ImageSide& side, int number, const std::array<int, 4>& nodes, int count,
                          const Vec3& x, CarriedPoint& point) {
      const auto end = point.point.node.begin() + point.point.count;
      const auto is_shared = [&](int node) { return std::find(point.point.node.begin(), end, node) != end; };
      if (number != point.number && std::none_of(nodes.begin(), nodes.begin() + count, is_shared))
        point = side.carried_by(number, x, now.normal);
    };
    keep(*a_, static_cast<int>(then.key >> 32), then.a, then.count_a, now.at_a, now.a);
    keep(*b_, static_cast<int>(then.key & 0xffffffffu), then.b, then.count_b, now.at_b, now.b);
  }

  std::unique_ptr<ImageSide> a_, b_;
  std::array<distance::Skin, 2> skins_;
  distance::SkinContact contact_;
  DistanceOptions options_;
  double thickness_;                         ///< of the thinner side [m]
  std::vector<CoupledNodes::Joint> joints_;  ///< of two soft bodies: what carried the samples at the query
  mutable CoupledNodes coupled_;
  std::optional<std::array<NodeNeighbours, 2>> neighbours_;
  std::uint64_t counted_in_ = 0;
  double safe_time_ = HUGE_VAL;
  long fast_ = 0;
  SumError sum_error_;
};

distance::Skin skin_of(const NodeSurface& surface, const Points& rest) {
  const TriMesh mesh{rest, surface.faces};
  const bool is_embedded = surface.node_of_vertex.empty();
  return is_embedded ? distance::make_skin(mesh, surface.embedding, surface.tets, surface.tets.maxCoeff() + 1)
                     : distance::make_skin(mesh);
}

/// @param mesh_a, mesh_b  at rest
std::unique_ptr<SampleSource> make(std::unique_ptr<ImageSide> a, distance::Skin skin_a, const TriMesh& mesh_a,
                                   std::unique_ptr<ImageSide> b, distance::Skin skin_b, const TriMesh& mesh_b,
                                   const DistanceOptions& options) {
  const CharacteristicLengths of_a = lengths_of(mesh_a), of_b = lengths_of(mesh_b);
  const std::array<double, 2> spacing = {point_spacing(of_a, of_b, options.quadrature_error),
                                         point_spacing(of_b, of_a, options.quadrature_error)};
  return std::make_unique<DistanceSource>(std::move(a), std::move(skin_a), std::move(b), std::move(skin_b),
                                          spacing, std::min(of_a.width, of_b.width), options);
}

}  // namespace

std::unique_ptr<SampleSource> make_distance_source(NodeSurface a, const Points& rest_a, NodeSurface b,
                                                   const Points& rest_b, const DistanceOptions& options) {
  distance::Skin skin_a = skin_of(a, rest_a), skin_b = skin_of(b, rest_b);
  const TriMesh mesh_a{rest_a, a.faces}, mesh_b{rest_b, b.faces};
  return make(soft_side(std::move(a)), std::move(skin_a), mesh_a, soft_side(std::move(b)), std::move(skin_b),
              mesh_b, options);
}

std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest, TriMesh rigid,
                                                   int frame, std::shared_ptr<MovingFrame> motion,
                                                   const DistanceOptions& options) {
  distance::Skin skin = skin_of(surface, rest), rigid_skin = distance::make_skin(rigid);
  const TriMesh mesh{rest, surface.faces}, rigid_mesh = rigid;
  return make(soft_side(std::move(surface)), std::move(skin), mesh,
              rigid_side(std::move(rigid), frame, std::move(motion)), std::move(rigid_skin), rigid_mesh,
              options);
}

}  // namespace palpate::contact
