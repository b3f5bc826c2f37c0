#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "contact/sources.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"

/// Shared by the contact tests: a State with nodes and a rigid body, a source of given samples, Taylor tests.
namespace contact_tests {

using namespace palpate;

inline double uniform(std::mt19937& random) {
  return std::uniform_real_distribution<double>(-1.0, 1.0)(random);
}
inline Vec3 vector(std::mt19937& random) { return {uniform(random), uniform(random), uniform(random)}; }
inline Quat rotation(std::mt19937& random) { return quaternion_of(2.0 * vector(random)); }

/// Returns the same samples at every query.
class ListSource final : public contact::SampleSource {
 public:
  explicit ListSource(std::vector<contact::ContactSample> samples)
      : SampleSource({.name = "list"}), samples_(std::move(samples)) {}
  void query(const dynamics::StateView&, std::vector<contact::ContactSample>& out) override {
    out.insert(out.end(), samples_.begin(), samples_.end());
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    for (const auto& s : samples_) {
      std::vector<int> nodes;
      for (const auto* p : {&s.a, &s.b})
        for (int i = 0; p->frame < 0 && i < p->count; ++i)
          nodes.push_back(p->node[static_cast<std::size_t>(i)]);
      pattern.add_clique(nodes.data(), static_cast<int>(nodes.size()));
    }
  }

 private:
  std::vector<contact::ContactSample> samples_;
};

/// A source whose samples do not follow the state between queries, as in an image: their tangent is exact.
class HeldSource final : public contact::SampleSource {
 public:
  explicit HeldSource(std::unique_ptr<contact::SampleSource> source)
      : SampleSource({.name = source->traits().name}), source_(std::move(source)) {}
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& out) override {
    source_->query(state, out);
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { source_->add_pattern(pattern); }

 private:
  std::unique_ptr<contact::SampleSource> source_;
};

/// Returns the State moved by h along u-directions, with quaternions on their geodesic.
inline dynamics::State moved(const dynamics::State& state, const VecX& direction, double h) {
  dynamics::State out = state;
  auto q = out.q();
  for (const auto& b : out.layout().blocks) {
    const auto d = direction.segment(b.u_offset, b.u_size);
    if (!b.kinematics) {
      q.segment(b.q_offset, b.q_size) += h * d;
      continue;
    }
    const Quat old(q[b.q_offset], q[b.q_offset + 1], q[b.q_offset + 2], q[b.q_offset + 3]);
    const Quat rotated = quaternion_of(h * d.head<3>()) * old;
    q.segment(b.q_offset, 4) << rotated.w(), rotated.x(), rotated.y(), rotated.z();
    q.segment<3>(b.q_offset + 4) += h * d.tail<3>();
  }
  return out;
}

inline dynamics::State pushed(const dynamics::State& state, const VecX& direction, double h) {
  dynamics::State out = state;
  out.u() += h * direction;
  return out;
}

/// Adds a free rigid body as a block of the State. Returns its id.
inline int add_rigid_body(dynamics::State& state, const Pose& pose, const Twist& twist) {
  const Quat r = pose.rotation;
  VecX q(7), u(6);
  q << r.w(), r.x(), r.y(), r.z(), pose.translation;
  u << twist.angular, twist.linear;
  dynamics::BlockSpec body;
  body.name = "body";
  body.kind = dynamics::BlockKind::kRigidBody;
  body.q_size = 7;
  body.u_size = 6;
  body.kinematics = dynamics::free_body_kinematics();
  return state.insert(body, q, u);
}

/// Nodes, and optionally a free rigid body, at random positions and velocities.
struct World {
  dynamics::State state;
  int nodes_id = -1, body_id = -1;

  World(int node_count, bool with_body, unsigned seed) {
    std::mt19937 random(seed);
    VecX q(3 * node_count), u(3 * node_count);
    for (auto& x : q) x = uniform(random);
    for (auto& x : u) x = uniform(random);
    dynamics::BlockSpec nodes;
    nodes.name = "nodes";
    nodes.q_size = nodes.u_size = 3 * node_count;
    nodes_id = state.insert(nodes, q, u);
    if (!with_body) return;
    Pose pose;
    pose.rotation = rotation(random);
    pose.translation = vector(random);
    Vec6 ub;
    for (auto& x : ub) x = uniform(random);
    body_id = add_rigid_body(state, pose, {ub.head<3>(), ub.tail<3>()});
  }

  dynamics::State moved(const VecX& direction, double h) const {
    return contact_tests::moved(state, direction, h);
  }
  dynamics::State pushed(const VecX& direction, double h) const {
    return contact_tests::pushed(state, direction, h);
  }
};

inline contact::SurfacePoint node_point(std::vector<int> nodes, std::vector<double> weights,
                                        const Vec3& offset = Vec3::Zero()) {
  contact::SurfacePoint p;
  p.count = static_cast<int>(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    p.node[i] = nodes[i];
    p.weight[i] = weights[i];
  }
  p.offset = offset;
  return p;
}

inline Vec3 position(const contact::SurfacePoint& p, const dynamics::State& state) {
  Vec3 x = p.offset;
  for (int i = 0; i < p.count; ++i)
    x += p.weight[static_cast<std::size_t>(i)] * state.view().position(p.node[static_cast<std::size_t>(i)]);
  return x;
}

/// A sample whose point b, fixed in a frame, lies `depth` above a along the normal.
inline contact::ContactSample on_frame(const contact::SurfacePoint& a, int frame, const Pose& pose,
                                       const Vec3& normal, double depth, double area,
                                       const dynamics::State& state) {
  contact::ContactSample s;
  s.a = a;
  s.b.frame = frame;
  s.normal = normal.normalized();
  s.b.offset = pose.inverse() * Vec3(position(a, state) + depth * s.normal);
  s.area = area;
  s.gap = -depth;
  return s;
}

/// A sample between two weighted sets of nodes; b's world offset moves it to the line through a.
inline contact::ContactSample on_nodes(const contact::SurfacePoint& a, contact::SurfacePoint b,
                                       const Vec3& normal, double depth, double area,
                                       const dynamics::State& state) {
  contact::ContactSample s;
  s.normal = normal.normalized();
  b.offset = Vec3::Zero();
  b.offset = position(a, state) + depth * s.normal - position(b, state);
  s.a = a;
  s.b = b;
  s.area = area;
  s.gap = -depth;
  return s;
}

inline VecX force(contact::ContactForce& term, const dynamics::State& state) {
  VecX f = VecX::Zero(state.layout().u_size);
  term.add_force(state.view(), f);
  return f;
}

inline dynamics::BorderedMatrix step_matrix(contact::ContactForce& term, const dynamics::State& state,
                                            double k_scale, double d_scale) {
  dynamics::PatternBuilder pattern(state.layout().node_count());
  term.add_pattern(pattern);
  dynamics::BorderedMatrix A;
  A.body = pattern.build();
  const int n = state.layout().nodal_size, m = state.layout().border_size();
  A.right = MatX::Zero(n, m);
  A.bottom = MatX::Zero(m, n);
  A.corner = MatX::Zero(m, m);
  term.add_tangent(state.view(), k_scale, d_scale, A);
  return A;
}

/// The residuals r(h) = |f(h) - f(0) - h df| for h = h0 2^-i must decrease with slope 2 over seven halvings,
/// or be at rounding level throughout (f linear).
template <class Function>
void expect_derivative(Function f, const VecX& df, double h0, const char* what) {
  const VecX f0 = f(0.0);
  const double scale = f0.norm() + h0 * df.norm();
  std::vector<double> residual;
  for (int i = 0; i < 7; ++i) {
    const double h = h0 * std::pow(0.5, i);
    residual.push_back((f(h) - f0 - h * df).norm());
  }
  if (residual.front() < 1e-13 * scale) return;
  for (std::size_t i = 1; i < residual.size(); ++i) {
    const double slope = std::log2(residual[i - 1] / residual[i]);
    EXPECT_NEAR(slope, 2.0, 0.15) << what << ", halving " << i << ", residual " << residual[i];
  }
}

}  // namespace contact_tests
