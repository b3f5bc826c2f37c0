// Samples in groups give what they give one by one.  Friction keeps a pair's samples apart; a coefficient of
// 1e-14 changes nothing else that could be seen.
#include "fixture.h"
#include "node_couplings.h"

using namespace contact_tests;

namespace {

constexpr double kNoFriction = 0.0, kNextToNone = 1e-14;

/// Forty samples on shared nodes: against a body of the State, a frame that is given, and other nodes;
/// several normals; some are apart.
struct Scene {
  World world{8, true, 21};
  std::shared_ptr<contact::TrajectoryFrame> given = std::make_shared<contact::TrajectoryFrame>();
  Pose given_pose{quaternion_of(Vec3(0.3, -0.5, 0.2)), Vec3(0.1, 0.2, -0.4)};
  contact::ContactForce term;

  explicit Scene(double friction) {
    given->append(0.0, given_pose, {Vec3(0.4, 0.2, -0.7), Vec3(-0.3, 0.5, 0.1)});
    const auto body = contact::block_frame(world.body_id);
    const int given_index = term.add_frame(given), body_index = term.add_frame(body);
    const Pose body_pose = body->pose(world.state.view());
    std::mt19937 random(5);
    const Vec3 normals[] = {vector(random), vector(random), vector(random)};
    std::vector<contact::ContactSample> samples;
    for (int i = 0; i < 40; ++i) {
      const double x = uniform(random), y = uniform(random), depth = i % 7 == 6 ? -0.1 : 0.4 + 0.1 * x;
      const auto tri = node_point({0, 1, 2}, {x, y, 1.0 - x - y}),
                 tet = node_point({2, 3, 4, 5}, {0.2, 0.3 * x, 0.3 * y, 0.8 - 0.3 * (x + y)});
      const auto& a = i % 2 ? tri : tet;
      const Vec3& n = normals[i / 14];
      contact::ContactSample s =
          i % 3 == 0   ? on_frame(a, body_index, body_pose, n, depth, 0.3, world.state)
          : i % 3 == 1 ? on_frame(a, given_index, given_pose, n, depth, 0.2, world.state)
                       : on_nodes(a, node_point({5, 6, 7}, {y, x, 1.0 - x - y}), n, depth, 0.25, world.state);
      if (i % 6 == 0) {  // round: part of its arm does not rotate
        s.b.slide = 0.3 * s.normal;
        s.b.offset -= body_pose.rotation.conjugate() * s.b.slide;
      }
      samples.push_back(s);
    }
    ContactSpec law;
    law.stiffness_pa_m = 20.0;
    law.damping_pa_s_m = 0.3;
    law.onset_width_m = 0.05;
    law.friction = friction;
    term.add_pair(std::make_unique<ListSource>(samples), law);
    term.refresh(world.state.view());
  }
};

double apart(const MatX& a, const MatX& b) { return (a - b).norm() / b.norm(); }

}  // namespace

TEST(SampleGroups, AreWhatTheirSamplesAre) {
  Scene grouped(kNoFriction), single(kNextToNone);
  const dynamics::State &state = grouped.world.state, &same = single.world.state;
  EXPECT_GT(force(single.term, same).norm(), 1.0);
  EXPECT_LT(apart(force(grouped.term, state), force(single.term, same)), 1e-12);
  for (const auto& [k, d] : {std::pair(1.0, 0.0), std::pair(0.0, 1.0), std::pair(0.7, 0.3)}) {
    const auto A = step_matrix(grouped.term, state, k, d), B = step_matrix(single.term, same, k, d);
    EXPECT_LT(apart(A.corner, B.corner), 1e-12) << k << " " << d;
    EXPECT_LT(apart(A.right, B.right), 1e-12) << k << " " << d;
    EXPECT_LT(apart(A.bottom, B.bottom), 1e-12) << k << " " << d;
    const VecX x = VecX::LinSpaced(state.layout().u_size, -1.0, 2.0).array().sin();
    VecX y = VecX::Zero(x.size()), z = y;
    grouped.term.apply_tangent(state.view(), k, d, x, y);
    single.term.apply_tangent(same.view(), k, d, x, z);
    EXPECT_LT(apart(y, z), 1e-12) << k << " " << d;
    EXPECT_LT(apart(A.to_dense() * x, y), 1e-12) << k << " " << d;
    EXPECT_LT(apart(A.to_dense(), B.to_dense()), 1e-12) << k << " " << d;
  }
}

TEST(SampleGroups, LinearisedAreWhatTheirSamplesAre) {
  Scene grouped(kNoFriction), single(kNextToNone);
  for (const int frame : {0, 1}) {
    contact::FrameLinearisation a, b;
    grouped.term.linearise(grouped.world.state.view(), frame, a);
    single.term.linearise(single.world.state.view(), frame, b);
    EXPECT_GT(b.active, 5);
    EXPECT_EQ(a.active, b.active);
    EXPECT_LT((a.wrench.force - b.wrench.force).norm(), 1e-12 * b.wrench.force.norm());
    EXPECT_LT((a.wrench.moment - b.wrench.moment).norm(), 1e-12 * b.wrench.moment.norm());
    EXPECT_LT(apart(a.K, b.K), 1e-12);
    EXPECT_LT(apart(a.B, b.B), 1e-12);
    EXPECT_LT(apart(a.geometric, b.geometric), 1e-12);
    const Eigen::Index nodal = grouped.world.state.layout().nodal_size;
    using Coupling = contact::NodeCoupling;
    for (const auto which : {&Coupling::K_body, &Coupling::B_body})
      EXPECT_LT(apart(columns_of(a, which, nodal), columns_of(b, which, nodal)), 1e-12);
    for (const auto which : {&Coupling::K_frame, &Coupling::B_frame})
      EXPECT_LT(apart(rows_of(a, which, nodal), rows_of(b, which, nodal)), 1e-12);
  }
}
