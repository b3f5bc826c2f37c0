// Fast motion between two queries: detected before it touches, and counted where it tunnelled.
#include "ball_and_slab.h"
#include "contact/image_side.h"

using namespace contact_tests;
using namespace contact_tests::ball_and_slab;

namespace {

template <class Check>
void for_each_pair(Check check) {
  for (const bool soft : {false, true})
    for (const bool pruned : {false, true}) {
      SCOPED_TRACE(std::string(soft ? "soft" : "rigid") + (pruned ? ", proxies" : ", whole"));
      check(soft, pruned);
    }
}

}  // namespace

// Two gaps between ball and slab, slightly smaller and slightly larger than the distance covered until the
// next query, which is due when the ball is half of the slab's thickness deep.
TEST(SweptContact, ABallIsSeenBeforeItTouchesIffItGetsThere) {
  for_each_pair([](bool soft, bool pruned) {
    Pair pair;
    for (const double speed : {0.1, 1.0, 10.0, 100.0})
      for (const double part : {0.85, 1.2}) {
        const double time = 0.01, way = speed * time;
        const auto source = pair.source(soft, pruned, time);
        const double gap = std::max(way, 1e-3) * part;
        pair.thrown.move(pair.state, Vec3(0, 0, -speed));
        const Vec3 at(0.003, 0.002, 0.5 * kThickness + kRadius + gap);
        const auto samples = pair.query(*source, at);
        EXPECT_EQ(!samples.empty(), part < 1.0) << speed << " m/s";
        for (const auto& s : samples) EXPECT_GT(s.gap, 0.9 * gap);
        if (part > 1.0) continue;
        EXPECT_GE(source->report().safe_time, 0.4 * kThickness / speed);
        EXPECT_LT(source->report().safe_time, 1.1 * (gap + 0.5 * kThickness) / speed);
        if (speed != 1.0) { EXPECT_EQ(source->report().fast_regions, speed > 1.0 ? 1 : 0) << speed; }
        pair.thrown.move(pair.state, Vec3(0, 0, speed));
        if (way > 5e-3) {
          EXPECT_TRUE(pair.query(*pair.source(soft, pruned, time), at).empty()) << "it flies away";
        }
      }
  });
}

// A ball moves from above the slab to below: each of its vertices passed through the slab, and the slab's
// vertices under it through the ball.
TEST(SweptContact, WhatWentThroughIsCountedAndNothingElse) {
  for_each_pair([](bool soft, bool pruned) {
    Pair pair;
    const auto source = pair.source(soft, pruned, 0.01);
    const auto counted = [&](const Vec3& from, const Vec3& to) {
      pair.query(*source, from);
      const long before = source->report().tunnelled;
      pair.query(*source, to);
      return source->report().tunnelled - before;
    };
    const Vec3 above(0.025, 0.025, 0.2), below(0.025, 0.025, -0.2);
    const long vertices = pair.thrown.model.skin.vertices.cols();
    // the slab's vertices are 0.05 apart: on either face, four are 0.035 away from the ball's axis
    EXPECT_EQ(counted(above, below), vertices + 8);
    EXPECT_EQ(counted(below, above), vertices + 8) << "and back";
    const long beyond = (pair.thrown.model.skin.vertices.row(2).array() < -0.5 * kThickness).count();
    EXPECT_EQ(counted(above, Vec3(0.025, 0.025, 0.0)), beyond) << "the others are in the slab or above it";
    EXPECT_EQ(counted(above, Vec3(0.025, 0.025, 0.06)), 0);
    EXPECT_EQ(counted(above, Vec3(1.5, 0.025, -0.2)), 0) << "past it";
    EXPECT_EQ(counted(above, above), 0);
    // down through the slab in steps shorter than its thickness: always detected inside
    long slowly = 0;
    for (double z = 0.08; z > -0.08; z -= 0.009)
      slowly += counted(Vec3(0.025, 0.025, z + 0.009), Vec3(0.025, 0.025, z));
    EXPECT_EQ(slowly, 0);
  });
}

// The rigid slab moves, the ball is at rest.
TEST(SweptContact, ARigidBodyMayBeTheOneThatGoesThrough) {
  for (const bool pruned : {false, true}) {
    Pair pair;
    const auto source = pair.source(false, pruned, 0.01);
    pair.frame->clear();
    pair.frame->append(0.0, {Quat::Identity(), Vec3(0, 0, -0.2)}, {Vec3::Zero(), Vec3(0, 0, 40.0)});
    pair.query(*source, Vec3(0.025, 0.025, 0));
    pair.state.set_time(0.01);
    pair.query(*source, Vec3(0.025, 0.025, 0));
    EXPECT_EQ(source->report().tunnelled, pair.thrown.model.skin.vertices.cols() + 8);
  }
}

// The slab turns over: in its frame, the ball passes through its centre. Vertices on straight paths in the
// world would miss the ball.
TEST(SweptContact, ARigidBodyMayTurnOver) {
  for (const bool pruned : {false, true}) {
    Pair pair;
    const auto source = pair.source(false, pruned, 0.01);
    const Vec3 at(0.1, 0.025, 0.1);
    for (const double angle : {0.0, M_PI}) {
      pair.frame->clear();
      pair.frame->append(0.0, {quaternion_of(Vec3(0, angle, 0)), Vec3::Zero()}, {});
      pair.query(*source, at);
    }
    EXPECT_GE(source->report().tunnelled, pair.thrown.model.skin.vertices.cols()) << pruned;
  }
}

// The velocity and displacement of every skin vertex are within the bounds of the whole side; the skin is
// outside its tetrahedra, where weights are negative.
TEST(SweptSide, ABoundHoldsAllOfTheSkin) {
  Pair pair;
  const Body& body = pair.thrown;
  EXPECT_LT(body.model.embedding.weights.minCoeff(), -0.01) << "the case is one";
  const auto side = contact::soft_side(body.surface);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  side->update(pair.state.view());
  side->keep();
  Eigen::Index worst = 0;
  body.model.embedding.weights.cwiseAbs().colwise().sum().maxCoeff(&worst);
  for (int i = 0; i < 20; ++i) {
    Points v = Points::NullaryExpr(3, body.model.tets.nodes.cols(), [&] { return normal(random); });
    if (i == 0) {  // the vertex with the largest weights reaches the bound on the velocity
      const auto nodes = body.model.tets.tets.col(body.model.embedding.tet[static_cast<std::size_t>(worst)]);
      v.setZero();
      for (int k = 0; k < 4; ++k) v(0, nodes[k]) = body.model.embedding.weights(k, worst) < 0.0 ? -1.0 : 1.0;
      v.row(0).array() -= v.row(0).mean();
    }
    pair.state.u().segment(body.u_offset, v.size()) = Eigen::Map<const VecX>(v.data(), v.size());
    const Points x = body.model.tets.nodes + v;
    pair.state.q().segment(body.u_offset, v.size()) = Eigen::Map<const VecX>(x.data(), x.size());
    side->update(pair.state.view());
    Points of_skin;
    mesh::evaluate(body.model.embedding, body.model.tets.tets, v, of_skin);
    for (const proxy::ProxyMotion& bound : {side->motion(pair.state.view()), side->way()})
      EXPECT_LE((of_skin.colwise() - bound.velocity).colwise().norm().maxCoeff(), bound.spread);
    for (const int vertex : {0, 7})
      EXPECT_LT((side->vertex(vertex) - side->kept_vertex(vertex) - of_skin.col(vertex)).norm(), 1e-14);
  }
}
