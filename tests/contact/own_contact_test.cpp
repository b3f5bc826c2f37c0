// A body against itself: what two of its parts feel is what two bodies of the same shape would, and at rest
// it feels nothing.
#include "backends.h"
#include "bent_bar.h"
#include "grid_proxies.h"
#include "palpate/proxy/pruner.h"
#include "surfaces.h"
#include "together.h"

using namespace contact_tests;

namespace {

int add_block(dynamics::State& state, const Points& positions, double phase) {
  dynamics::BlockSpec nodes;
  nodes.name = "nodes";
  nodes.q_size = nodes.u_size = static_cast<int>(positions.size());
  VecX speeds(nodes.u_size);
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    speeds[i] = 0.1 * std::sin(1.0 + static_cast<double>(i) + phase);
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
  out.proxies = grid_proxies(out.skin, 3);
  return out;
}

contact::ImageOptions options(double gap, int pixels = 96) { return image_options(pixels, gap); }

/// The bar against itself.
struct Bar {
  LayeredModel model;
  dynamics::State state;
  contact::NodeSurface surface;
  std::shared_ptr<proxy::ProxySet> proxies;

  explicit Bar(int count = 24)
      : model(bent_bar::model(count)),
        surface(surface_of(model, add_block(state, model.tets.nodes, 0.0))),
        proxies(std::make_shared<proxy::ProxySet>(model)) {}
  void bend(double angle) {
    const Points bent = bent_bar::bend(model.tets.nodes, angle);
    state.q() = Eigen::Map<const VecX>(bent.data(), bent.size());
  }
  std::unique_ptr<contact::SampleSource> source(double gap, int pixels = 96) const {
    return contact::make_image_source(surface, proxies, model.tets.nodes, options(gap, pixels));
  }
  bool is_left(int node) const { return model.tets.nodes(0, node) < 0.0; }
};

ContactSpec law() {
  ContactSpec out;
  out.first = out.second = "bar";
  out.stiffness_pa_m = 1e6;
  return out;
}

/// k times the volume of the overlap.  The arms lean against each other by the angle alpha each, and meet in
/// the plane x = 0; what of an arm is beyond it is a wedge between its inner side and its end, right-angled,
/// its corner depth / 2 away from the plane: of legs (depth / 2) / sin(alpha) and (depth / 2) / cos(alpha).
/// There are two.
double overlap_force(double depth) {
  const double alpha = 0.5 * (bent_bar::closing_angle(depth) - M_PI), half = 0.5 * depth;
  return 1e6 * bent_bar::kWidth * half * half / (std::sin(alpha) * std::cos(alpha));
}

Vec3 force_on_left(const Bar& bar, contact::ContactForce& term) {
  const VecX f = force(term, bar.state);
  Vec3 left = Vec3::Zero();
  for (int i = 0; i < bar.state.layout().node_count(); ++i)
    if (bar.is_left(i)) left += f.segment<3>(3 * i);
  return left;
}

void expect_that_of_two_bodies(double look_ahead) {
  const LayeredModel a = ball(Pose{}, 1.0),
                     b = ball({quaternion_of(Vec3(0.4, -0.7, 0.2)), Vec3(0.35, -0.2, -1.95)}, 1.2),
                     both = together(a, b);
  dynamics::State two, one;
  const int block_a = add_block(two, a.tets.nodes, 0.0), block_b = add_block(two, b.tets.nodes, 1.0),
            block = add_block(one, both.tets.nodes, 0.0);
  one.u() = two.u();
  ASSERT_EQ(one.q(), two.q());
  Points rest = both.tets.nodes;  // what overlaps at rest is no contact: there they stand apart
  rest.rightCols(b.tets.nodes.cols()).row(2).array() -= 1.0;
  ContactSpec with_all = law();
  with_all.damping_pa_s_m = 1e5;
  with_all.friction = 0.4;
  contact::ImageOptions with = options(0.02);
  with.look_ahead = look_ahead;
  contact::ContactForce between, within;
  between.add_pair(
      contact::make_image_source(surface_of(a, block_a), std::make_shared<proxy::ProxySet>(a),
                                 surface_of(b, block_b), std::make_shared<proxy::ProxySet>(b), with),
      with_all);
  within.add_pair(contact::make_image_source(surface_of(both, block), std::make_shared<proxy::ProxySet>(both),
                                             rest, with),
                  with_all);
  const int n = static_cast<int>(a.tets.nodes.size());
  for (const double shift : {0.0, 0.1, 0.1}) {  // and again, a rolling off: normals are remembered alike
    for (dynamics::State* state : {&two, &one})
      for (int i = 0; i < n; i += 3) state->q()[i] += shift;
    between.refresh(two.view());
    within.refresh(one.view());
    ASSERT_GT(between.samples().size(), 500u);
    ASSERT_EQ(between.samples().size(), within.samples().size());
    int deep = 0;
    for (std::size_t i = 0; i < within.samples().size(); ++i) {
      const contact::ContactSample &s = between.samples()[i], &t = within.samples()[i];
      ASSERT_EQ(s.a.node, t.a.node);
      ASSERT_EQ(s.b.node, t.b.node);
      EXPECT_NEAR(s.gap, t.gap, 1e-14);
      EXPECT_NEAR(s.area, t.area, 1e-14);
      EXPECT_LT((s.normal - t.normal).norm(), 1e-13);
      deep += s.gap < 0.0;
    }
    EXPECT_GT(deep, 300);
    const auto farthest = std::max_element(within.samples().begin(), within.samples().end(),
                                           [](const auto& s, const auto& t) { return s.gap < t.gap; });
    EXPECT_EQ(farthest->gap > 0.02, look_ahead > 0.0);
    const VecX f = force(between, two), g = force(within, one);
    EXPECT_GT(f.norm(), 100.0);
    EXPECT_LT((f - g).norm(), 1e-12 * f.norm());
    const MatX A = step_matrix(between, two, 1.0, 0.3).to_dense(),
               B = step_matrix(within, one, 1.0, 0.3).to_dense();
    EXPECT_GT(A.topRightCorner(n, A.cols() - n).norm(), 0.1 * A.topLeftCorner(n, n).norm());
    EXPECT_LT((A - B).norm(), 1e-12 * A.norm());
  }
  const proxy::PruneCounts &of_two = *between.pruning()[0], &of_one = *within.pruning()[0];
  EXPECT_EQ(of_two.pairs, of_one.pairs);
  EXPECT_EQ(of_two.after_hulls, of_one.after_hulls);
  EXPECT_EQ(of_two.regions, of_one.regions);
  EXPECT_EQ(of_two.faces_a, of_one.faces_a);
  EXPECT_EQ(of_two.faces_b, of_one.faces_b);
}

}  // namespace

ON_EACH_BACKEND(OwnContact);

// Two bodies, and one body of the same nodes in two shells: the same samples, forces and tangent, to
// rounding.
TEST_P(OwnContact, IsThatOfTwoBodiesOfTheSameShape) { expect_that_of_two_bodies(0.0); }

// Candidates that are looked ahead for go with the region that they are in, so they are the same, too.
TEST_P(OwnContact, LooksAheadAsTwoBodiesDo) { expect_that_of_two_bodies(0.3); }

// The gap that is looked into is larger than the bar is thick, and its proxies are so few that their hulls
// reach across each other.
TEST_P(OwnContact, AtRestABodyFeelsNothing) {
  for (const int count : {3, 9, 24}) {
    Bar bar(count);
    contact::ContactForce term;
    term.add_pair(bar.source(1.5 * bent_bar::kHeight), law());
    for (const double angle : {0.0, 1.0, 2.0, M_PI}) {
      bar.bend(angle);
      term.refresh(bar.state.view());
      for (const auto& s : term.samples()) EXPECT_GE(s.gap, 0.0) << count << " proxies, bent by " << angle;
      EXPECT_EQ(force(term, bar.state).norm(), 0.0) << count << " proxies, bent by " << angle;
    }
    EXPECT_GT(term.pruning()[0]->regions + (count == 3), 0) << "something was looked at";
  }
}

// Bones that lie across from themselves: bone 1 is the left arm's tip and the right arm's lower part, between
// bone 0 and bone 2.  One region holds them all, bone 1 on both sides; in its image bone 1 faces itself.
TEST_P(OwnContact, NoBoneMeetsItself) {
  Bar bar(48);
  for (ProxyHull& hull : bar.model.proxies) {
    const double x = hull.corners.row(0).mean();
    hull.bone = x < -0.6 || (x > 0.0 && x < 0.8) ? 1 : x < 0.0 ? 0 : 2;
  }
  bar.proxies = std::make_shared<proxy::ProxySet>(bar.model);
  std::vector<std::set<int>> bones(static_cast<std::size_t>(bar.model.skin.vertices.cols()));
  for (const ProxyHull& hull : bar.model.proxies)
    for (const int v : hull.members) bones[static_cast<std::size_t>(v)].insert(hull.bone);
  // of the nearest vertex; -1 where two share it
  const auto bone_of = [&](const contact::SurfacePoint& point) {
    Vec3 x = Vec3::Zero();
    for (std::size_t i = 0; i < 4; ++i) x += point.weight[i] * bar.model.tets.nodes.col(point.node[i]);
    Eigen::Index nearest = 0;
    (bar.model.skin.vertices.colwise() - x).colwise().squaredNorm().minCoeff(&nearest);
    const auto& all = bones[static_cast<std::size_t>(nearest)];
    return all.size() == 1 ? *all.begin() : -1;
  };
  contact::ContactForce term;
  term.add_pair(bar.source(0.3), law());
  bar.bend(bent_bar::closing_angle(-0.05));
  term.refresh(bar.state.view());
  int met = 0;
  for (const auto& s : term.samples()) {
    const int a = bone_of(s.a), b = bone_of(s.b);
    ASSERT_TRUE(a < b || a < 0 || b < 0) << "bone " << a << " meets bone " << b;
    met += a >= 0 && b >= 0;
  }
  EXPECT_GT(met, 1000);
}

// Arms pressed together: equal and opposite on both, along the line of the tips; none on the middle.  The
// overlap is symmetric, so is the force.
TEST_P(OwnContact, ArmsThatMeetPushEachOtherApart) {
  Bar bar;
  bar.bend(bent_bar::closing_angle(0.03));
  constexpr int kPixels = 512;
  contact::ContactForce term;
  term.add_pair(bar.source(0.02, kPixels), law());
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
  EXPECT_NEAR(-left.x() / overlap_force(0.03), 1.0, 0.02);
  EXPECT_LT((left + right).norm(), 1e-12 * left.norm());
  EXPECT_LT(moment.norm(), 1e-11 * left.norm());
  // The normal is the mean slope of the skin in the overlap: tan(alpha) along the inner side, -1 / tan(alpha)
  // across the end, which cancel but for a row of pixels.
  const double alpha = 0.5 * (bent_bar::closing_angle(0.03) - M_PI),
               height = 0.015 / std::tan(alpha) + 0.015 * std::tan(alpha);
  EXPECT_LT(left.tail<2>().norm(), bent_bar::kWidth / (kPixels - 1) / height / std::tan(alpha) * left.norm());
}

// Between two queries the force is minus the gradient of the contact's energy, and the tangent its
// derivative: symmetric, with blocks between the arms.
TEST_P(OwnContact, TheTangentCouplesTheBodysParts) {
  Bar bar;
  bar.bend(bent_bar::closing_angle(0.04));
  ContactSpec smooth = law();
  smooth.onset_width_m = 0.5;
  contact::ContactForce term;
  term.add_pair(bar.source(0.02), smooth);
  const auto before = term.pattern_version();
  term.refresh(bar.state.view());
  EXPECT_GT(term.pattern_version(), before);
  const int size = bar.state.layout().u_size;
  std::mt19937 random(8);
  VecX direction(size);
  for (auto& x : direction) x = uniform(random);
  const auto moved = [&](double h) {
    dynamics::State out = bar.state;
    out.q() += h * direction;
    return out;
  };
  VecX K = VecX::Zero(size);
  term.apply_tangent(bar.state.view(), 1.0, 0.0, direction, K);
  expect_derivative([&](double h) { return force(term, moved(h)); }, -K, 1e-3, "by position");
  expect_derivative([&](double h) { return VecX::Constant(1, term.energy(moved(h).view())).eval(); },
                    VecX::Constant(1, -force(term, bar.state).dot(direction)), 1e-3, "energy");

  const dynamics::BorderedMatrix A = step_matrix(term, bar.state, 1.0, 0.7);
  VecX assembled;
  A.multiply(direction, assembled);
  EXPECT_LT((assembled - K).norm(), 1e-12 * assembled.norm());
  const MatX dense = A.to_dense();
  EXPECT_LT((dense - dense.transpose()).norm(), 1e-12 * dense.norm());
  double across = 0.0;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      if (bar.is_left(i / 3) && !bar.is_left(j / 3)) across += dense(i, j) * dense(i, j);
  EXPECT_GT(std::sqrt(across), 0.1 * dense.norm());
  EXPECT_TRUE(term.traits().symmetric_tangent && term.traits().conservative);
}

// k times the volume of the overlap as the arms close: no part of the force comes or goes at once.
TEST_P(OwnContact, SetsInWithoutAJump) {
  Bar bar;
  contact::ContactForce term;
  term.add_pair(bar.source(0.02), law());
  const double whole = overlap_force(0.03);
  int steps = 0;
  for (double depth = -0.01; depth < 0.0305; depth += 0.001) {
    bar.bend(bent_bar::closing_angle(depth));
    term.refresh(bar.state.view());
    const double now = force_on_left(bar, term).norm();
    if (depth < -1e-9)
      EXPECT_EQ(now, 0.0) << depth;
    else
      EXPECT_NEAR(now, overlap_force(depth), 0.05 * overlap_force(depth) + 0.01 * whole) << depth;
    ++steps;
  }
  EXPECT_EQ(steps, 41);
}

TEST_P(OwnContact, RefusesWhatHasNoBones) {
  Bar bar;
  EXPECT_THROW(contact::make_image_source(bar.surface, nullptr, bar.model.tets.nodes, options(0.1)),
               InternalError);
  EXPECT_THROW(contact::make_image_source(bar.surface, bar.proxies, Points(bar.model.tets.nodes.leftCols(3)),
                                          options(0.1)),
               InternalError);
}
