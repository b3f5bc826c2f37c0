// Self-contact by nearest points: two parts of a body interact as two bodies of the same shape would, the
// thickness of the body is no contact, and the force is the gradient of the energy.
#include "bent_bar.h"
#include "contact/sources.h"
#include "fixture.h"
#include "palpate/mesh/generators.h"
#include "surfaces.h"
#include "together.h"

using namespace contact_tests;

namespace {

int add_block(dynamics::State& state, const Points& positions) {
  dynamics::BlockSpec nodes;
  nodes.name = "nodes";
  nodes.q_size = nodes.u_size = static_cast<int>(positions.size());
  VecX speeds(nodes.u_size);
  for (Eigen::Index i = 0; i < speeds.size(); ++i) speeds[i] = 0.1 * std::sin(1.0 + static_cast<double>(i));
  return state.insert(nodes, Eigen::Map<const VecX>(positions.data(), nodes.q_size), speeds);
}

contact::NodeSurface surface_of(const LayeredModel& model, int block_id) {
  contact::NodeSurface out;
  out.block_id = block_id;
  out.faces = model.skin.faces;
  out.embedding = model.embedding;
  out.tets = model.tets.tets;
  return out;
}

LayeredModel ball(const Pose& pose, double scale) {
  LayeredModel out;
  out.name = "ball";
  out.tets = mesh::ball(1.0, 0.45);
  out.skin = mesh::sphere(1.0, 12);
  for (Points* points : {&out.tets.nodes, &out.skin.vertices})
    for (auto x : points->colwise()) x = pose * Vec3(scale * x);
  out.embedding = mesh::embed(out.tets, out.skin.vertices);
  return out;
}

ContactSpec law() {
  ContactSpec out;
  out.first = out.second = "body";
  out.stiffness_pa_m = 1e6;
  return out;
}

/// Options in which every vertex is a point and no triangle is subdivided.
contact::DistanceOptions coarse(double gap = 0.02) { return {.quadrature_error = 1.0, .candidate_gap = gap}; }

/// The bar in contact with itself.
struct Bar {
  LayeredModel model = bent_bar::model();
  dynamics::State state;
  contact::NodeSurface surface = surface_of(model, add_block(state, model.tets.nodes));

  void bend(double angle) {
    const Points bent = bent_bar::bend(model.tets.nodes, angle);
    state.q() = Eigen::Map<const VecX>(bent.data(), bent.size());
  }
  std::unique_ptr<contact::SampleSource> source(const contact::DistanceOptions& options = coarse()) const {
    return contact::make_own_distance_source(surface, model.skin.vertices, model.tets.nodes, options);
  }
  bool is_left(int node) const { return model.tets.nodes(0, node) < 0.0; }
  Vec3 force_on_left(contact::ContactForce& term) const {
    const VecX f = force(term, state);
    Vec3 left = Vec3::Zero();
    for (int i = 0; i < state.layout().node_count(); ++i)
      if (is_left(i)) left += f.segment<3>(3 * i);
    return left;
  }
};

}  // namespace

// Two bodies, and one body with the same nodes in two shells: equal forces and tangents, to rounding.
TEST(OwnDistance, IsThatOfTwoBodiesOfTheSameShape) {
  const LayeredModel a = ball(Pose{}, 1.0),
                     b = ball({quaternion_of(Vec3(0.4, -0.7, 0.2)), Vec3(0.35, -0.2, -1.95)}, 1.2),
                     both = together(a, b);
  dynamics::State two, one;
  const int block_a = add_block(two, a.tets.nodes), block_b = add_block(two, b.tets.nodes),
            block = add_block(one, both.tets.nodes);
  one.u() = two.u();
  ASSERT_EQ(one.q(), two.q());
  Points rest = both.tets.nodes, skin = both.skin.vertices;  // overlaps at rest do not count as contact
  rest.rightCols(b.tets.nodes.cols()).row(2).array() -= 1.0;
  skin.rightCols(b.skin.vertices.cols()).row(2).array() -= 1.0;
  ContactSpec with_all = law();
  with_all.damping_pa_s_m = 1e5;
  with_all.friction = 0.4;
  contact::ContactForce between, within;
  between.add_pair(contact::make_distance_source(surface_of(a, block_a), a.skin.vertices,
                                                 surface_of(b, block_b), b.skin.vertices, coarse()),
                   with_all);
  within.add_pair(contact::make_own_distance_source(surface_of(both, block), skin, rest, coarse()), with_all);
  const int n = static_cast<int>(a.tets.nodes.size());
  for (const double shift : {0.0, 0.1, 0.1}) {
    for (dynamics::State* state : {&two, &one})
      for (int i = 0; i < n; i += 3) state->q()[i] += shift;
    between.refresh(two.view());
    within.refresh(one.view());
    ASSERT_GT(between.samples().size(), 50u);
    EXPECT_EQ(between.samples().size(), within.samples().size());
    const VecX f = force(between, two), g = force(within, one);
    EXPECT_GT(f.norm(), 100.0);
    EXPECT_LT((f - g).norm(), 1e-12 * f.norm());
    const MatX A = step_matrix(between, two, 1.0, 0.3).to_dense(),
               B = step_matrix(within, one, 1.0, 0.3).to_dense();
    EXPECT_GT(A.topRightCorner(n, A.cols() - n).norm(), 0.1 * A.topLeftCorner(n, n).norm());
    EXPECT_LT((A - B).norm(), 1e-12 * A.norm());
    EXPECT_NEAR(within.energy(one.view()) / between.energy(two.view()), 1.0, 1e-12);
  }
}

// A part that passes through another part between two queries is counted as with two bodies; grazing, common
// motion and bending are not counted.
TEST(OwnDistance, WhatGoesThroughAnotherPartIsCounted) {
  const LayeredModel a = ball(Pose{}, 1.0), b = ball({Quat::Identity(), Vec3(0, 0, -2.4)}, 1.2),
                     both = together(a, b);
  dynamics::State two, one;
  const int block_a = add_block(two, a.tets.nodes), block_b = add_block(two, b.tets.nodes),
            block = add_block(one, both.tets.nodes);
  contact::ContactForce between, within;
  between.add_pair(contact::make_distance_source(surface_of(a, block_a), a.skin.vertices,
                                                 surface_of(b, block_b), b.skin.vertices, coarse()),
                   law());
  within.add_pair(contact::make_own_distance_source(surface_of(both, block), both.skin.vertices,
                                                    both.tets.nodes, coarse()),
                  law());
  const int n = static_cast<int>(a.tets.nodes.size());
  const auto counted = [&](const Vec3& way, bool of_all) {
    const long before[] = {between.pairs()[0].tunnelled, within.pairs()[0].tunnelled};
    for (dynamics::State* state : {&two, &one})
      for (int i = 0; i < (of_all ? state->q().size() : n); ++i) state->q()[i] += way[i % 3];
    between.refresh(two.view());
    within.refresh(one.view());
    const long of_two = between.pairs()[0].tunnelled - before[0],
               of_one = within.pairs()[0].tunnelled - before[1];
    // grazing is measured by the thickness of the thinner body, and for one body by its self-contact depth
    EXPECT_NEAR(static_cast<double>(of_one), static_cast<double>(of_two), 0.03 * static_cast<double>(of_two));
    return of_one;
  };
  EXPECT_EQ(counted(Vec3::Zero(), false), 0);
  EXPECT_GT(counted(Vec3(0, 0, -5.2), false), 200) << "through";
  EXPECT_GT(counted(Vec3(0, 0, 5.2), false), 200) << "and back";
  EXPECT_EQ(counted(Vec3(5, 0, 0), false), 0) << "away";
  EXPECT_EQ(counted(Vec3(0, 0, -5.2), false), 0) << "beside it";
  EXPECT_EQ(counted(Vec3(7, 8, 9), true), 0) << "both together";
  Bar bar;
  contact::ContactForce of_bar;
  of_bar.add_pair(bar.source(), law());
  for (const double angle : {0.0, 1.5, 0.0}) {
    bar.bend(angle);
    of_bar.refresh(bar.state.view());
    EXPECT_EQ(of_bar.pairs()[0].tunnelled, 0) << "bends";
  }
}

// The candidate gap exceeds the thickness of the bar.
TEST(OwnDistance, WhereABodyIsThickItFeelsNothing) {
  Bar bar;
  contact::ContactForce term;
  term.add_pair(bar.source(coarse(1.5 * bent_bar::kHeight)), law());
  for (const double angle : {0.0, 1.0, 2.0, M_PI}) {
    bar.bend(angle);
    term.refresh(bar.state.view());
    for (const auto& s : term.samples()) EXPECT_GE(s.gap, 0.0) << "bent by " << angle;
    EXPECT_EQ(force(term, bar.state).norm(), 0.0) << "bent by " << angle;
  }
  // squeezed to a tenth of its height, half of the depth up to which overlaps are detected
  bar.bend(0.0);
  for (Eigen::Index i = 2; i < bar.state.q().size(); i += 3) bar.state.q()[i] *= 0.1;
  term.refresh(bar.state.view());
  EXPECT_EQ(force(term, bar.state).norm(), 0.0);
}

// Arms pressed together: equal and opposite forces on both, along the line between the tips; none on the
// middle.
TEST(OwnDistance, ArmsThatMeetPushEachOtherApart) {
  Bar bar;
  bar.bend(bent_bar::closing_angle(0.03));
  contact::ContactForce term;
  term.add_pair(bar.source(), law());
  EXPECT_TRUE(term.refresh(bar.state.view()));
  const VecX f = force(term, bar.state);
  Vec3 left = Vec3::Zero(), right = Vec3::Zero(), moment = Vec3::Zero();
  for (int i = 0; i < bar.state.layout().node_count(); ++i) {
    const Vec3 one = f.segment<3>(3 * i);
    (bar.is_left(i) ? left : right) += one;
    moment += bar.state.view().position(i).cross(one);
    const bool of_middle = std::abs(bar.model.tets.nodes(0, i)) < bent_bar::kMiddle;
    EXPECT_TRUE(!of_middle || one.isZero(0.0)) << i;
  }
  EXPECT_GT(-left.x(), 1.0);
  EXPECT_LT((left + right).norm(), 1e-12 * left.norm());
  EXPECT_LT(moment.norm(), 1e-11 * left.norm());
  EXPECT_LT(left.tail<2>().norm(), 1e-10 * left.norm());
}

// As the arms close, no part of the force appears or vanishes abruptly: following the query's points and a
// new query give the same force.
TEST(OwnDistance, FollowsAsItFinds) {
  Bar bar;
  contact::ContactForce follows, asks;
  follows.add_pair(bar.source(coarse(0.05)), law());
  asks.add_pair(bar.source(), law());
  bar.bend(bent_bar::closing_angle(0.0));
  follows.refresh(bar.state.view());
  double last = 0.0;
  for (double depth = 0.0; depth < 0.0305; depth += 0.001) {
    bar.bend(bent_bar::closing_angle(depth));
    asks.refresh(bar.state.view());
    const VecX found = force(asks, bar.state), followed = force(follows, bar.state);
    EXPECT_LT((found - followed).norm(), 1e-9 * found.norm() + 1e-12) << depth;
    EXPECT_GE(found.norm(), last) << depth;
    last = found.norm();
  }
  EXPECT_GT(last, 1.0);
}

// Taylor tests between the energy and its gradient, and between force and tangent.
TEST(OwnDistance, TheForceIsTheGradient) {
  Bar bar;
  bar.bend(bent_bar::closing_angle(0.03));
  contact::ContactForce term;
  term.add_pair(bar.source(), law());
  const auto before = term.pattern_version();
  term.refresh(bar.state.view());
  EXPECT_GT(term.pattern_version(), before);
  const int size = bar.state.layout().u_size;
  std::mt19937 random(8);
  VecX direction(size);
  for (auto& x : direction) x = uniform(random);
  const auto energy_at = [&](double h) {
    dynamics::State moved = bar.state;
    moved.q() += h * direction;
    return term.energy(moved.view());
  };
  const double h = 1e-6, slope = (energy_at(h) - energy_at(-h)) / (2.0 * h);
  const double expected = -force(term, bar.state).dot(direction);
  // a skin point is carried by one tetrahedron, while its triangle may be carried by three
  EXPECT_NEAR(slope, expected, 1e-2 * std::abs(expected));
  const MatX dense = step_matrix(term, bar.state, 1.0, 0.0).to_dense();
  EXPECT_LT((dense - dense.transpose()).norm(), 1e-12 * dense.norm());
  double across = 0.0;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      if (bar.is_left(i / 3) && !bar.is_left(j / 3)) across += dense(i, j) * dense(i, j);
  EXPECT_GT(std::sqrt(across), 0.1 * dense.norm());
}
