// Contact by nearest points: material points of both skins, each tied to the nearest point of the other one.
//
// With x the points of a skin, y(x) their nearest points on the other and a their areas at rest, the samples
// are the pairs (x, y): gap the signed distance of x, normal along x - y.  For a pressure k |gap| their
// forces are those of the energy
//
//     U = 1/2 sum_A k/2 a |x - y|^2 + 1/2 sum_B k/2 a |x - y|^2        (over the points inside),
//
// exactly, for |x - y|^2 is least at y and its derivative leaves y's weights alone; force and opposite force
// have one line.  What the nodes get of them is exact where vertices are nodes; on a skin in tetrahedra a
// point hangs on one tetrahedron (surface_state.cpp).
//
// Samples follow the state with gaps = "exact": the query only says which points can be near.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "contact/coupled_nodes.h"
#include "contact/image_side.h"
#include "contact/safe_time.h"
#include "contact/sample_cells.h"
#include "palpate/contact/sources.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/distance/skin_contact.h"
#include "palpate/mesh/embedding.h"
#include "palpate/proxy/reach.h"
#include "palpate/proxy/region.h"

namespace palpate::contact {
namespace {

class DistanceSource final : public SampleSource {
 public:
  DistanceSource(std::unique_ptr<ImageSide> a, const TriMesh& rest_a, std::unique_ptr<ImageSide> b,
                 const TriMesh& rest_b, const DistanceOptions& options)
      : a_(std::move(a)),
        b_(std::move(b)),
        skins_{distance::make_skin(rest_a), distance::make_skin(rest_b)},
        options_(options) {
    const double width_a = proxy::least_width(rest_a.vertices), width_b = proxy::least_width(rest_b.vertices),
                 spacing = point_spacing(width_a, width_b, options.quadrature_error);
    thickness_ = std::min(width_a, width_b);
    contact_.emplace(skins_[0], skins_[1],
                     distance::SkinContactSpec{.stiffness_pa_m = 1.0, .spacing_m = {spacing, spacing}});
    counters::count("contact.distance_source");
  }

  std::string_view name() const override { return "distance"; }

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    update(state);
    const proxy::ProxyMotion of_a = a_->motion(state), of_b = b_->motion(state);
    contact_->find(a_->positions().data(), b_->positions().data(),
                   proxy::Reach(options_.candidate_gap, options_.look_ahead, of_a, of_b).in_any_direction());
    cells_.clear();
    follows_now_ = false;
    for (const distance::Spring& spring : contact_->springs()) add(spring);
    couple();
    safe_time_ = HUGE_VAL;
    const double speed = (of_a.velocity - of_b.velocity).norm() + of_a.spread + of_b.spread;
    for (const distance::Spring& spring : contact_->springs())
      safe_time_ = std::min(safe_time_, time_to_middle(spring.gap, -speed, thickness_));
    fast_ += safe_time_ < options_.look_ahead;
    const distance::ForceSum of = contact_->force_sum();
    sum_error_.take({of.sum, of.error, of.largest_term});
    cells_.append_to(samples);
  }
  const SumError* sum_error() const override { return &sum_error_; }

  bool start_following() override { return true; }
  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    PALPATE_CHECK(samples.size() == cells_.cells.size(), "distance: {} samples follow, {} were found",
                  samples.size(), cells_.cells.size());
    if (samples.empty()) return;
    update(state);
    contact_->follow(a_->positions().data(), b_->positions().data());
    follows_now_ = true;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      place(contact_->springs()[i], i);
      const int source = samples[i].source;
      samples[i] = cells_.sample(cells_.cells[i], static_cast<int>(i));
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
  /// What carries a point.
  struct Joint {
    int number, count;
    std::array<int, 4> node;
  };

  void update(const dynamics::StateView& state) {
    a_->update(state);
    b_->update(state);
  }

  /// A cell of its own for each sample: the carriers of both points, and where they are.
  void add(const distance::Spring& spring) {
    const int i = static_cast<int>(cells_.cells.size());
    cells_.cells.push_back({.a = 2 * i, .b = 2 * i + 1, .first = i, .last = i + 1});
    cells_.cells.back().area = spring.stiffness;  // of 1 Pa/m: half of the point's area
    cells_.places.emplace_back();
    cells_.carriers.resize(cells_.carriers.size() + 2);
    place(spring, static_cast<std::size_t>(i));
  }

  /// Both points of a spring, and axes along its normal.
  struct Ends {
    int face_a, face_b;
    Vec3 weights_a, weights_b, a, b;
    ContactAxes axes;
  };
  Ends ends_of(const distance::Spring& spring) const {
    const distance::ContactPoint& point =
        contact_->points(spring.side)[static_cast<std::size_t>(spring.point)];
    const Vec3 x = contact_->position(spring), y = x + spring.reach;
    const Vec3 out = contact_->outward(spring);  // of b where the point is a's
    if (spring.side == 0)
      return {point.face, spring.face, point.weights, spring.weights, x, y, ContactAxes(x, out)};
    return {spring.face, point.face, spring.weights, point.weights, y, x, ContactAxes(y, -out)};
  }

  /// The first choice whose weights are bounded, or the last one: see SurfaceState::carrier_choice.
  static Carrier choose(const ImageSide& side, const distance::Skin& skin, int face, const Vec3& weights,
                        const Vec3& x, const ContactAxes& axes) {
    constexpr double kRounding = 1e-9;
    Eigen::Index corner = 0;
    weights.maxCoeff(&corner);
    const int given = skin.given_face[static_cast<std::size_t>(face)];
    Carrier out;
    for (int c = 0; c < side.carrier_choices(); ++c) {
      const int number = side.carrier_choice(given, static_cast<int>(corner), c);
      out = side.carrier(number, axes);
      out.number = number;
      const double sum = (out.by_place * (axes.in_axes(x) - out.at).homogeneous()).cwiseAbs().sum();
      if (out.frame >= 0 || sum <= (1.0 + kRounding) * mesh::kLargestWeightSum) break;
    }
    return out;
  }

  /// Brings cell i, its carriers and its place to where they are now.
  void place(const distance::Spring& spring, std::size_t i) {
    const Ends ends = ends_of(spring);
    Carrier &a = cells_.carriers[2 * i], &b = cells_.carriers[2 * i + 1];
    a = choose(*a_, skins_[0], ends.face_a, ends.weights_a, ends.a, ends.axes);
    b = choose(*b_, skins_[1], ends.face_b, ends.weights_b, ends.b, ends.axes);
    if (follows_now_ && is_coupled()) {
      keep_in_pattern(*a_, ends.axes, at_query_[2 * i], a);
      keep_in_pattern(*b_, ends.axes, at_query_[2 * i + 1], b);
    }
    const Vec3 from_a = ends.axes.in_axes(ends.a) - a.at;
    cells_.places[i] = {from_a[0], from_a[1], from_a[2], from_a[2] - spring.gap};
    cells_.cells[i].normal = ends.axes.normal();
  }

  /// The blocks between two bodies are those of the query's carriers and of all that these share nodes with
  /// (CoupledNodes).  A point that has gone farther hangs on what carried it at the query.
  static void keep_in_pattern(const ImageSide& side, const ContactAxes& axes, const Joint& then,
                              Carrier& now) {
    const auto shares = [&](int node) {
      return std::find(now.node.begin(), now.node.begin() + now.count, node) != now.node.begin() + now.count;
    };
    if (now.number == then.number || std::any_of(then.node.begin(), then.node.begin() + then.count, shares))
      return;
    now = side.carrier(then.number, axes);
    now.number = then.number;
  }

  /// Blocks between the nodes of two soft bodies.
  bool is_coupled() const { return a_->soft() && b_->soft(); }
  void couple() {
    if (!is_coupled()) return;
    const std::uint64_t layout = a_->soft()->pattern_version() + b_->soft()->pattern_version();
    if (!neighbours_ || layout != counted_in_) {
      neighbours_ = {a_->soft()->neighbours(), b_->soft()->neighbours()};
      coupled_.start((*neighbours_)[0], (*neighbours_)[1]);
      counted_in_ = layout;
    }
    coupled_.take(cells_, 0);
    at_query_.clear();
    for (const Carrier& carrier : cells_.carriers)
      at_query_.push_back({carrier.number, carrier.count, carrier.node});
  }

  std::unique_ptr<ImageSide> a_, b_;
  std::array<distance::Skin, 2> skins_;
  std::optional<distance::SkinContact> contact_;  ///< there once the widths are known
  DistanceOptions options_;
  double thickness_ = 0.0;
  SampleCells cells_;            ///< one a sample
  std::vector<Joint> at_query_;  ///< of two soft bodies: the carriers of `cells_` at the query
  bool follows_now_ = false;
  mutable CoupledNodes coupled_;
  std::optional<std::array<NodeNeighbours, 2>> neighbours_;
  std::uint64_t counted_in_ = 0;
  double safe_time_ = HUGE_VAL;
  long fast_ = 0;
  SumError sum_error_;
};

}  // namespace

std::unique_ptr<SampleSource> make_distance_source(NodeSurface a, const Points& rest_a, NodeSurface b,
                                                   const Points& rest_b, const DistanceOptions& options) {
  const TriMesh mesh_a{rest_a, a.faces}, mesh_b{rest_b, b.faces};
  return std::make_unique<DistanceSource>(soft_side(std::move(a)), mesh_a, soft_side(std::move(b)), mesh_b,
                                          options);
}

std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest, TriMesh rigid,
                                                   int frame, std::shared_ptr<MovingFrame> motion,
                                                   const DistanceOptions& options) {
  const TriMesh mesh{rest, surface.faces}, rigid_mesh = rigid;
  return std::make_unique<DistanceSource>(soft_side(std::move(surface)), mesh,
                                          rigid_side(std::move(rigid), frame, std::move(motion)), rigid_mesh,
                                          options);
}

}  // namespace palpate::contact
