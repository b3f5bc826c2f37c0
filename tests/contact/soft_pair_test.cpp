// Two soft skins in image space: forces on both bodies are equal and opposite, and the tangent couples them.
#include "two_balls.h"

using namespace contact_tests;

namespace {

ContactSpec law() {
  ContactSpec out;
  out.stiffness_pa_m = 1e6;
  return out;
}

}  // namespace

// Samples at the vertices of both skins: a sample's gap is the distance between its two points, and the force
// does not depend on the order of the bodies.
TEST(SoftPair, VerticesOfBothSkins) {
  TwoBalls balls;
  double force[2];
  for (const bool swapped : {false, true}) {
    std::vector<contact::ContactSample> samples;
    (swapped ? balls.swapped() : balls.source(true))->query(balls.state.view(), samples);
    Vec3 sum = Vec3::Zero();
    for (const auto& s : samples) {
      const Vec3 xa = point_on_nodes(s.a, balls.state.view()), xb = point_on_nodes(s.b, balls.state.view());
      EXPECT_NEAR(s.normal.dot(xa - xb), s.gap, 1e-12);
      EXPECT_LT((xa - xb).cross(s.normal).norm(), 1e-12);
      if (s.gap < 0.0) sum -= s.gap * s.area * s.normal;
    }
    EXPECT_GT(samples.size(), 40u);
    force[swapped] = sum.norm();
  }
  EXPECT_EQ(force[1], force[0]);
}

// Third law: resultant and moment of both bodies' forces vanish to rounding, and each alone does not; the
// force pushes a up, away from b.
TEST(SoftPair, ActionIsReaction) {
  TwoBalls balls;
  Vec3 whole = Vec3::Zero();
  for (const bool pruned : {false, true}) {
    SCOPED_TRACE(pruned);
    contact::ContactForce term;
    ContactSpec with_all = law();
    with_all.damping_pa_s_m = 1e5;
    with_all.friction = 0.4;
    term.add_pair(balls.source(pruned), with_all);
    EXPECT_TRUE(term.refresh(balls.state.view()));
    const VecX f = force(term, balls.state);
    Vec3 on_a = Vec3::Zero(), sum = Vec3::Zero(), moment = Vec3::Zero();
    for (int i = 0; i < balls.state.layout().node_count(); ++i) {
      const Vec3 one = f.segment<3>(3 * i);
      sum += one;
      moment += balls.state.view().position(i).cross(one);
      if (i < balls.nodes_of_a()) on_a += one;
    }
    EXPECT_GT(on_a.z(), 100.0);
    EXPECT_LT(sum.norm(), 1e-12 * on_a.norm());
    int sliding = 0;
    // friction acts at both points, which are up to the depth apart along the normal: its moment is at most
    // friction x depth
    double arm = 0.0;
    for (const auto& s : term.samples()) {
      EXPECT_GE(s.b.count, 4);
      arm = std::max(arm, -s.gap);
      ++sliding;
    }
    EXPECT_GT(sliding, 40);
    EXPECT_LT(moment.norm(), with_all.friction * arm * on_a.norm() + 1e-11 * on_a.norm());
    if (pruned)
      EXPECT_LT((on_a - whole).norm(), 0.1 * whole.norm());  // separate planes: 96 pixels, coarse skins
    else
      whole = on_a;
    contact::ContactForce smooth;
    smooth.add_pair(balls.source(pruned), law());
    smooth.refresh(balls.state.view());
    const VecX g = force(smooth, balls.state);
    moment.setZero();
    for (int i = 0; i < balls.state.layout().node_count(); ++i)
      moment += balls.state.view().position(i).cross(Vec3(g.segment<3>(3 * i)));
    EXPECT_LT(moment.norm(), 1e-11 * on_a.norm())
        << "both points of a sample lie on one line along the normal";
  }
}

// With the smooth onset the force is C1, so that the Taylor residual decreases with slope 2; the assembled
// tangent equals the applied one, and is symmetric.
TEST(SoftPair, TheTangentCouplesBothBodies) {
  for (const bool per_point : {false, true}) {
    SCOPED_TRACE(per_point ? "per point" : "per area");
    TwoBalls balls;
    ContactSpec smooth = law();
    if (per_point) {
      smooth.spring = "per_point";
      smooth.stiffness_n_m = 1e4;
    }
    smooth.onset_width_m = 0.5;
    smooth.hunt_crossley_s_m = 0.2;
    smooth.law = "hunt_crossley";
    contact::ContactForce term;
    term.add_pair(balls.source(true), smooth);
    term.refresh(balls.state.view());
    const int size = balls.state.layout().u_size;
    std::mt19937 random(8);
    VecX direction(size);
    for (auto& x : direction) x = uniform(random);
    const auto moved = [&](double h) {
      dynamics::State out = balls.state;
      out.q() += h * direction;
      return force(term, out);
    };
    const auto pushed = [&](double h) {
      dynamics::State out = balls.state;
      out.u() += h * direction;
      return force(term, out);
    };
    VecX K = VecX::Zero(size), D = VecX::Zero(size);
    term.apply_tangent(balls.state.view(), 1.0, 0.0, direction, K);
    term.apply_tangent(balls.state.view(), 0.0, 1.0, direction, D);
    expect_derivative(moved, -K, 1e-3, "by position");
    expect_derivative(pushed, -D, 1e-3, "by velocity");

    const dynamics::BorderedMatrix A = step_matrix(term, balls.state, 1.0, 0.7);
    VecX assembled;
    A.multiply(direction, assembled);
    EXPECT_LT((assembled - K - 0.7 * D).norm(), 1e-12 * assembled.norm());
    const MatX dense = A.to_dense();
    EXPECT_LT((dense - dense.transpose()).norm(), 1e-12 * dense.norm());
    const int n = 3 * balls.nodes_of_a();
    EXPECT_GT(dense.topRightCorner(n, size - n).norm(), 0.1 * dense.topLeftCorner(n, n).norm());
    // A common translation of both bodies changes no force.
    VecX shifted = VecX::Zero(size), together(size);
    for (int i = 0; i < size; ++i) together[i] = i % 3 == 1 ? 1.0 : 0.3;
    term.apply_tangent(balls.state.view(), 1.0, 0.0, together, shifted);
    EXPECT_LT(shifted.norm(), 1e-11 * K.norm());
  }
}

// The point stiffness of a fused step is the assembled tangent, with and without friction; its force is the
// term's force minus the tangent times the step's shift.
TEST(SoftPair, PointStiffnessIsTheTangent) {
  for (const double friction : {0.0, 0.4}) {
    TwoBalls balls;
    contact::ContactForce term;
    ContactSpec with_all = law();
    with_all.damping_pa_s_m = 1e5;
    with_all.friction = friction;
    with_all.friction_tangent = FrictionTangent::kFull;
    contact::ContactForce full;
    full.add_pair(balls.source(true), with_all);
    EXPECT_EQ(full.is_point_stiffness(), friction == 0.0);
    with_all.friction_tangent = FrictionTangent::kSymmetric;
    term.add_pair(balls.source(true), with_all);
    ASSERT_TRUE(term.is_point_stiffness());
    term.refresh(balls.state.view());
    const int size = 3 * balls.state.layout().node_count();
    constexpr double kK = 0.3, kD = 0.7;
    VecX shift(size), change(size);
    for (int i = 0; i < size; ++i) shift[i] = 1e-3 * std::sin(3.0 * i), change[i] = std::cos(2.0 * i);
    dynamics::PointStiffness C;
    VecX f = VecX::Zero(size), g = VecX::Zero(size);
    dynamics::SparseBorder none;
    term.add_step(balls.state.view(), shift, kK, kD, f, C, none);
    EXPECT_FALSE(C.points.empty());
    MatX dense = MatX::Zero(size, size);
    const auto add = [&](const dynamics::PointStiffness::Nodes& nodes, auto block) {
      EXPECT_TRUE(nodes.relative);
      for (int i = 0; i < nodes.count; ++i)
        for (int j = 0; j < nodes.count; ++j)
          dense.block<3, 3>(3 * nodes.node[static_cast<std::size_t>(i)],
                            3 * nodes.node[static_cast<std::size_t>(j)]) += block(i, j);
    };
    for (const auto& a : C.points)
      add(a.nodes, [&](int i, int j) { return Mat3(a.weight[i] * a.weight[j] * a.C); });
    const MatX exact = step_matrix(term, balls.state, kK, kD).to_dense();
    EXPECT_GT(exact.norm(), 1.0);
    EXPECT_LT((dense - exact).norm(), 1e-12 * exact.norm()) << friction;
    VecX K = VecX::Zero(size), D = VecX::Zero(size);
    term.apply_tangent(balls.state.view(), 1.0, 0.0, shift, K);
    term.apply_tangent(balls.state.view(), 0.0, 1.0, change, D);
    const VecX at_rest = force(term, balls.state);
    EXPECT_LT((f - (at_rest - K)).norm(), 1e-12 * at_rest.norm());
    term.add_step_force(balls.state.view(), shift, change, g);
    EXPECT_LT((g - (at_rest - K - D)).norm(), 1e-12 * (at_rest.norm() + D.norm()));
  }
}

// The pattern contains the current contact and its neighbourhood: it is constant while contact stays within
// it, and includes all that the tangent couples as one ball rolls off the other (see coupled_nodes_test.cpp
// for its rules).
TEST(SoftPair, ThePatternHoldsTheContact) {
  TwoBalls balls;
  contact::ContactForce term;
  term.add_pair(balls.source(true), law());
  const auto before = term.pattern_version();
  term.refresh(balls.state.view());
  const auto touched = term.pattern_version();
  EXPECT_GT(touched, before);
  term.refresh(balls.state.view());
  EXPECT_EQ(term.pattern_version(), touched);
  int pressed = 0;
  for (int i = 0; i < 8; ++i) {
    for (int n = 0; n < balls.nodes_of_a(); ++n) balls.state.q()[3 * n] += 0.1;  // a rolls off
    term.refresh(balls.state.view());
    // throws for a block that was not announced
    pressed += step_matrix(term, balls.state, 1.0, 0.0).to_dense().norm() > 0.0;
  }
  EXPECT_GT(pressed, 2) << "or there is nothing to announce";
}

TEST(SoftPair, RefusesOneBodyTwice) {
  TwoBalls balls;
  EXPECT_THROW(contact::make_image_source(balls.a.surface, balls.a.surface, balls.options()), InternalError);
  EXPECT_THROW(
      contact::make_image_source(balls.a.surface, balls.a.proxies, balls.b.surface, nullptr, balls.options()),
      InternalError);
}
