// Samples of an image, kept in cells, give what they give one by one.  A source that does not say that it is
// an image hands its samples out in full; friction of 1e-14 keeps these apart from each other, and changes
// nothing else that could be seen.
#include "contact/sample_cells.h"

#include <functional>

#include "contact/image_source.h"
#include "palpate/contact/touch_model.h"
#include "two_balls.h"

using namespace contact_tests;

namespace {

class InFull final : public contact::SampleSource {
 public:
  explicit InFull(std::unique_ptr<contact::SampleSource> source) : source_(std::move(source)) {}
  std::string_view name() const override { return "in full"; }
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& samples) override {
    source_->query(state, samples);
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { source_->add_pattern(pattern); }

 private:
  std::unique_ptr<contact::SampleSource> source_;
};

/// A scene, at its query and a little later, by one of the ways to keep samples.
struct Scene {
  dynamics::State at_query, later;
  contact::ContactForce term;
  int frames = 0;

  Scene(const dynamics::State& state, std::unique_ptr<contact::SampleSource> source,
        std::vector<std::shared_ptr<contact::MovingFrame>> of, ContactSpec law, bool in_cells)
      : at_query(state), later(state) {
    for (const auto& frame : of) term.add_frame(frame);
    frames = static_cast<int>(of.size());
    if (!in_cells) {
      source = std::make_unique<InFull>(std::move(source));
      if (law.friction == 0.0) law.friction = 1e-14;
    }
    term.add_pair(std::move(source), law);
    term.refresh(at_query.view());
    std::mt19937 random(3);
    VecX direction(state.layout().u_size);
    for (auto& x : direction) x = uniform(random);
    later = moved(state, direction, 2e-3);
  }
};

ContactSpec law(bool hunt_crossley, double friction = 0.0) {
  ContactSpec out;
  out.friction = friction;
  if (friction > 0.0) out.friction_tangent = "secant";
  out.stiffness_pa_m = 1e5;
  out.onset_width_m = 0.01;
  out.damping_pa_s_m = 2e3;
  if (hunt_crossley) {
    out.law = "hunt_crossley";
    out.hunt_crossley_s_m = 0.5;
  }
  return out;
}

/// Makes the scene with the samples in cells, or one by one.
using MakeScene = std::function<std::unique_ptr<Scene>(bool in_cells)>;

MakeScene two_balls(contact::SampleRule rule, bool hunt_crossley, double friction = 0.0) {
  return [=](bool in_cells) {
    TwoBalls balls;
    balls.samples = rule;
    return std::make_unique<Scene>(balls.state, balls.source(true),
                                   std::vector<std::shared_ptr<contact::MovingFrame>>{},
                                   law(hunt_crossley, friction), in_cells);
  };
}

/// Two surfaces whose vertices are nodes, with depths read from the image: what its faces carry lies beside
/// them.
MakeScene two_shells() {
  return [](bool in_cells) {
    SurfaceWorld world(sphere(Vec3::Zero(), 1.0, 12));
    SurfaceWorld other(sphere(Vec3(0.2, -0.1, -1.9), 1.0, 11));
    dynamics::BlockSpec nodes;
    nodes.name = "other surface";
    const VecX x = other.state.q().tail(other.state.q().size() - 6);
    nodes.q_size = nodes.u_size = static_cast<int>(x.size());
    other.surface.block_id = world.state.insert(nodes, x, VecX::Constant(x.size(), 0.1));
    contact::ImageOptions options = image_options(64, 0.02);
    options.samples = contact::SampleRule::kVertex;
    if (backend() != contact::DepthBackend::kExact) options.depths = contact::DepthReading::kInterpolated;
    return std::make_unique<Scene>(
        world.state, contact::make_image_source(world.surface, other.surface, options),
        std::vector<std::shared_ptr<contact::MovingFrame>>{}, law(false), in_cells);
  };
}

/// A skin, or nodes in its places, under a ball that turns: in a frame that is given, or a body of the State.
MakeScene under_a_ball(bool skin, bool in_state, contact::SampleRule rule, double friction = 0.0) {
  return [=](bool in_cells) {
    SkinWorld on_tets;
    SurfaceWorld on_nodes({on_tets.vertices, on_tets.skin.faces});
    dynamics::State& state = skin ? on_tets.state : on_nodes.state;
    const Pose pose{quaternion_of(Vec3(0.2, -0.4, 0.3)),
                    Vec3(0.1, -0.1, on_tets.vertices.row(2).maxCoeff() + 0.4)};
    const Twist twist{Vec3(0.7, -0.3, 0.4), Vec3(0.2, 0.1, -0.3)};
    std::shared_ptr<contact::MovingFrame> frame;
    if (in_state) {
      frame = contact::block_frame(add_rigid_body(state, pose, twist));
    } else {
      const auto given = std::make_shared<contact::TrajectoryFrame>();
      given->append(0.0, pose, twist);
      frame = given;
    }
    contact::ImageOptions options = image_options(64, 0.02);
    options.samples = rule;
    return std::make_unique<Scene>(
        state,
        contact::make_image_source(skin ? on_tets.surface : on_nodes.surface, sphere(Vec3::Zero(), 0.5, 30),
                                   0, frame, options),
        std::vector{frame}, law(false, friction), in_cells);
  };
}

double apart(const MatX& a, const MatX& b) { return (a - b).norm() / b.norm(); }

void expect_the_same(const MakeScene& make) {
  const auto cells = make(true), single = make(false);
  ASSERT_EQ(cells->term.samples().size(), single->term.samples().size());
  EXPECT_GT(cells->term.samples().size(), 20u);
  for (const bool now : {true, false}) {
    SCOPED_TRACE(now ? "at the query" : "later");
    const dynamics::State &state = now ? cells->at_query : cells->later,
                          &same = now ? single->at_query : single->later;
    contact::ContactForce &a = cells->term, &b = single->term;
    EXPECT_GT(force(b, same).norm(), 1.0);
    EXPECT_LT(apart(force(a, state), force(b, same)), 1e-11);
    EXPECT_NEAR(a.energy(state.view()) / b.energy(same.view()), 1.0, 1e-11);
    EXPECT_NEAR(a.dissipated_power(state.view()) / b.dissipated_power(same.view()), 1.0, 1e-11);
    VecX x = VecX::LinSpaced(state.layout().u_size, -1.0, 2.0).array().sin();
    for (const auto& [k, d] : {std::pair(1.0, 0.0), std::pair(0.7, 0.3)}) {
      const MatX A = step_matrix(a, state, k, d).to_dense(), B = step_matrix(b, same, k, d).to_dense();
      EXPECT_LT(apart(A, B), 1e-11) << k << " " << d;
      VecX y = VecX::Zero(x.size());
      a.apply_tangent(state.view(), k, d, x, y);
      EXPECT_LT(apart(A * x, y), 1e-11) << k << " " << d;
    }
    for (int frame = 0; frame < cells->frames; ++frame) {
      const Wrench p = a.frame_wrench(state.view(), frame), q = b.frame_wrench(same.view(), frame);
      EXPECT_LT((p.force - q.force).norm() + (p.moment - q.moment).norm(), 1e-11 * q.force.norm());
      contact::FrameLinearisation of_cells, of_single;
      a.linearise(state.view(), frame, of_cells);
      b.linearise(same.view(), frame, of_single);
      EXPECT_EQ(of_cells.active, of_single.active);
      EXPECT_LT(apart(of_cells.K, of_single.K), 1e-11);
      EXPECT_LT(apart(of_cells.B, of_single.B), 1e-11);
      EXPECT_LT(apart(of_cells.geometric, of_single.geometric), 1e-10);
      EXPECT_LT(apart(of_cells.K_body, of_single.K_body), 1e-11);
      EXPECT_LT(apart(of_cells.B_body, of_single.B_body), 1e-11);
      EXPECT_LT(apart(of_cells.K_frame, of_single.K_frame), 1e-11);
      EXPECT_LT(apart(of_cells.B_frame, of_single.B_frame), 1e-11);
    }
    // a step's force and matrix, in one pass
    if (!a.is_point_stiffness()) continue;
    dynamics::PointStiffness C;
    VecX f = VecX::Zero(x.size()), g = f, product = f;
    a.add_step(state.view(), x, 0.7, 0.3, f, C);
    b.add_force(same.view(), g);
    b.apply_tangent(same.view(), 1.0, 0.0, x, product);
    EXPECT_LT(apart(f, g - product), 1e-11);
    EXPECT_FALSE(C.along.empty());
    f.setZero();
    a.add_step_force(state.view(), x, 0.5 * x, f);
    b.apply_tangent(same.view(), 0.0, 1.0, 0.5 * x, product);
    EXPECT_LT(apart(f, g - product), 1e-11);
  }
}

MatX dense(const dynamics::PointStiffness& C, Eigen::Index size) {
  MatX out = MatX::Zero(size, size);
  const auto add = [&](const dynamics::PointStiffness::Nodes& nodes, const auto& block) {
    for (int i = 0; i < nodes.count; ++i)
      for (int j = 0; j < nodes.count; ++j)
        out.block<3, 3>(3 * nodes.node[static_cast<std::size_t>(i)],
                        3 * nodes.node[static_cast<std::size_t>(j)]) += block(i, j);
  };
  for (const auto& one : C.along)
    add(one.nodes, [&](int i, int j) { return Mat3(one.G(i, j) * one.normal * one.normal.transpose()); });
  for (const auto& one : C.points)
    add(one.nodes, [&](int i, int j) { return Mat3(one.weight[i] * one.weight[j] * one.C); });
  return out;
}

/// What a tool's reduction asks of the samples, within a step as well.
void expect_the_same_touch(contact::ContactForce& a, const dynamics::State& state, contact::ContactForce& b,
                           const dynamics::State& same) {
  std::vector<contact::TouchTangent> of_a, of_b;
  const auto touch_a = a.touch_samples(state.view(), 0, &of_a),
             touch_b = b.touch_samples(same.view(), 0, &of_b);
  ASSERT_EQ(touch_a.size(), touch_b.size());
  double largest = 0.0, apart_by = 0.0;
  for (std::size_t i = 0; i < touch_a.size(); ++i) {
    largest = std::max({largest, touch_b[i].force.norm(), of_b[i].D.norm()});
    apart_by =
        std::max({apart_by, (touch_a[i].force - touch_b[i].force).norm(), (of_a[i].D - of_b[i].D).norm()});
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(apart_by, 1e-10 * largest);
}

/// Forces and matrices of a step whose friction is that of its end, from solve to solve.
void expect_the_same_steps(const MakeScene& make, bool by_frame) {
  const auto cells = make(true), single = make(false);
  contact::ContactForce &a = cells->term, &b = single->term;
  EXPECT_NEAR(a.largest_resultant().force / b.largest_resultant().force, 1.0, 1e-11);
  EXPECT_NEAR(a.largest_resultant().moment / b.largest_resultant().moment, 1.0, 1e-9);
  for (const bool now : {true, false}) {
    SCOPED_TRACE(now ? "at the query" : "later");
    const dynamics::State &state = now ? cells->at_query : cells->later,
                          &same = now ? single->at_query : single->later;
    EXPECT_EQ(a.bends_at(state.view()), b.bends_at(same.view()));
    ASSERT_TRUE(a.begin_step(state.view()));
    ASSERT_TRUE(b.begin_step(same.view()));
    const Eigen::Index size = state.layout().u_size;
    std::mt19937 random(7);
    bool done = false;
    for (int solve = 0; solve < 5 && !done; ++solve) {
      SCOPED_TRACE(solve);
      EXPECT_LT(apart(force(a, state), force(b, same)), 1e-10);
      const VecX x = VecX::LinSpaced(size, -1.0, 2.0).array().sin();
      const MatX A = step_matrix(a, state, 0.7, 0.3).to_dense(),
                 B = step_matrix(b, same, 0.7, 0.3).to_dense();
      EXPECT_LT(apart(A, B), 1e-10);
      VecX y = VecX::Zero(size);
      a.apply_tangent(state.view(), 0.7, 0.3, x, y);
      EXPECT_LT(apart(y, B * x), 1e-10);
      dynamics::PointStiffness C;
      VecX f = VecX::Zero(size), g = f;
      a.add_step(state.view(), x, 0.7, 0.3, f, C);
      EXPECT_FALSE(C.along.empty());
      EXPECT_LT(apart(dense(C, size), B), 1e-10);
      C.clear();
      b.add_step(same.view(), x, 0.7, 0.3, g, C);
      EXPECT_LT(apart(f, g), 1e-10);
      if (by_frame) expect_the_same_touch(a, state, b, same);
      VecX moved(size), change(size);
      for (Eigen::Index i = 0; i < size; ++i) {
        moved[i] = 1e-3 * uniform(random);
        change[i] = 0.1 * uniform(random);
      }
      contact::FrameStep given;
      if (by_frame) given = {0, 2.0 * moved.tail<6>(), 2.0 * change.tail<6>()};
      done = a.improve_step(state.view(), moved, change, given);
      EXPECT_EQ(done, b.improve_step(same.view(), moved, change, given));
    }
    a.end_step();
    b.end_step();
    EXPECT_NEAR(a.largest_friction_lag(), b.largest_friction_lag(), 1e-9 * b.largest_lagged_friction());
    EXPECT_NEAR(a.largest_lagged_friction() / b.largest_lagged_friction(), 1.0, 1e-10);
    EXPECT_LT(apart(force(a, state), force(b, same)), 1e-11);
  }
}

}  // namespace

ON_EACH_BACKEND(SampleCells);

TEST_P(SampleCells, RubWithinAStepAsTheirSamplesDo) {
  for (const double friction : {0.05, 0.8}) {
    for (const auto rule : {contact::SampleRule::kPixel, contact::SampleRule::kVertex}) {
      SCOPED_TRACE(friction);
      expect_the_same_steps(two_balls(rule, false, friction), false);
      expect_the_same_steps(under_a_ball(true, false, rule, friction), false);
    }
    SCOPED_TRACE("a frame moves");
    expect_the_same_steps(under_a_ball(true, false, contact::SampleRule::kPixel, friction), true);
  }
}

TEST_P(SampleCells, OfTwoSoftBodies) {
  for (const auto rule : {contact::SampleRule::kPixel, contact::SampleRule::kVertex})
    for (const bool hunt_crossley : {false, true}) {
      SCOPED_TRACE(hunt_crossley);
      expect_the_same(two_balls(rule, hunt_crossley));
    }
  SCOPED_TRACE("shells");
  expect_the_same(two_shells());
}

TEST_P(SampleCells, OfASoftAndARigidBody) {
  for (const bool skin : {true, false})
    for (const bool in_state : {false, true})
      for (const auto rule : {contact::SampleRule::kPixel, contact::SampleRule::kVertex}) {
        if (!skin && rule == contact::SampleRule::kVertex) continue;
        SCOPED_TRACE(testing::Message() << skin << in_state << static_cast<int>(rule));
        expect_the_same(under_a_ball(skin, in_state, rule));
      }
}

// The events of a query are those of its samples, in one order, and a query that finds the same is no news.
TEST_P(SampleCells, EventsAreThoseOfTheSamples) {
  TwoBalls balls;
  contact::ContactForce term;
  ContactSpec sharp;
  sharp.stiffness_pa_m = 1e5;
  term.add_pair(balls.source(true), sharp);
  term.refresh(balls.state.view());
  ASSERT_EQ(term.event_count(), static_cast<int>(term.samples().size()));
  VecX g(term.event_count());
  term.events(balls.state.view(), g.data());
  for (Eigen::Index i = 0; i < g.size(); ++i)
    EXPECT_NEAR(g[i], term.samples()[static_cast<std::size_t>(i)].gap, 1e-12);
  const auto version = term.events_version();
  term.refresh(balls.state.view());
  EXPECT_EQ(term.events_version(), version);
  VecX push = VecX::Zero(balls.state.layout().u_size);
  push.head(3 * balls.nodes_of_a()).array() += 1.0;
  const dynamics::State later = moved(balls.state, push, 0.02);
  term.refresh(later.view());
  EXPECT_NE(term.events_version(), version);
  ASSERT_EQ(term.sample_count(), static_cast<int>(term.samples().size()));
  for (const auto& s : term.samples())
    EXPECT_NEAR(s.normal.dot(point_on_nodes(s.a, later.view()) - point_on_nodes(s.b, later.view())), s.gap,
                1e-12);
}

// What a query hands on: a place each, and an area only where it differs.
TEST_P(SampleCells, ASampleIsThirtyTwoBytes) {
  static_assert(sizeof(contact::SamplePlace) == 32);
  TwoBalls balls;
  for (const auto rule : {contact::SampleRule::kPixel, contact::SampleRule::kVertex}) {
    balls.samples = rule;
    contact::SampleCells cells;
    const auto source = balls.source(true);
    source->in_images()->query(balls.state.view(), cells);
    EXPECT_GT(cells.count(), 40);
    EXPECT_EQ(cells.areas.size(), rule == contact::SampleRule::kPixel ? 0u : cells.places.size());
    EXPECT_LT(cells.cells.size(), cells.places.size());
    for (const contact::ContactCell& cell : cells.cells) EXPECT_LT(cell.first, cell.last);
  }
}

// Springs of points stay springs of points.
TEST_P(SampleCells, ASpringPerPointCountsEachOnce) {
  TwoBalls balls;
  balls.samples = contact::SampleRule::kVertex;
  ContactSpec per_point;
  per_point.spring = "per_point";
  per_point.stiffness_n_m = 40.0;
  contact::ContactForce term;
  term.add_pair(balls.source(true), per_point);
  term.refresh(balls.state.view());
  double energy = 0.0;
  int touching = 0;
  for (const auto& s : term.samples())
    if (s.gap < 0.0 && s.area > 0.0) {
      energy += 0.5 * 40.0 * s.gap * s.gap;
      ++touching;
      EXPECT_EQ(s.area, 1.0);
    }
  EXPECT_GT(touching, 10);
  EXPECT_NEAR(term.energy(balls.state.view()), energy, 1e-11 * energy);
}
