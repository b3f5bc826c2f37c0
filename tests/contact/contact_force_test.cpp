#include "fixture.h"

#include "core/counters.h"
#include "palpate/contact/pressure.h"

using namespace contact_tests;

namespace {

ContactSpec spec(double friction = 0.0) {
  ContactSpec s;
  s.stiffness_pa_m = 1e5;
  s.damping_pa_s_m = 10.0;
  s.friction = friction;
  return s;
}

/// Sum of forces and of moments about the world's origin on all bodies, including prescribed frames, relative
/// to the sum of magnitudes.
struct Balance {
  double force, moment;
};
Balance balance(contact::ContactForce& term, const World& world, const std::vector<Pose>& frame_poses) {
  const auto view = world.state.view();
  const VecX f = force(term, world.state);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  double size = 0.0, reach = 0.0;
  for (int i = 0; i < world.state.layout().node_count(); ++i) {
    const Vec3 fi = f.segment<3>(3 * i);
    sum += fi;
    moment += view.position(i).cross(fi);
    size += fi.norm();
    reach = std::max(reach, view.position(i).norm());
  }
  for (std::size_t k = 0; k < frame_poses.size(); ++k) {
    const Wrench w = term.frame_wrench(view, static_cast<int>(k));
    sum += w.force;
    moment += w.moment + frame_poses[k].translation.cross(w.force);
    size += w.force.norm();
  }
  return {sum.norm() / size, moment.norm() / (size * reach)};
}

}  // namespace

TEST(ContactForce, BalanceOfForceAndMomentForRandomPoses) {
  int checked = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(100 + seed);
    World world(8, true, seed);
    contact::ContactForce term;
    const Pose given{rotation(random), vector(random)};
    const auto body = contact::block_frame(world.body_id);
    const std::vector<Pose> poses{given, body->pose(world.state.view())};
    term.add_frame(contact::fixed_frame(given));
    term.add_frame(body);
    std::vector<contact::ContactSample> samples;
    const double w = uniform(random), v = uniform(random);
    const auto a = node_point({0, 1, 2}, {w, v, 1 - w - v}),
               b = node_point({3, 4, 5, 6}, {0.1, 0.2, 0.3, 0.4});
    samples.push_back(on_frame(a, 0, poses[0], vector(random), 0.01, 0.3, world.state));
    samples.push_back(on_frame(b, 1, poses[1], vector(random), 0.02, 0.2, world.state));
    // Node against node without an offset: b's first node is moved to the line through a.
    auto s = on_nodes(node_point({7}, {1.0}), node_point({0}, {1.0}), vector(random), 0.01, 0.1, world.state);
    world.state.q().segment<3>(0) += s.b.offset;
    s.b.offset.setZero();
    samples.push_back(s);
    samples[0] = on_frame(a, 0, poses[0], vector(random), 0.01, 0.3, world.state);  // node 0 was moved
    term.add_pair(std::make_unique<ListSource>(samples), spec());
    term.refresh(world.state.view());
    const Balance result = balance(term, world, poses);
    EXPECT_LT(result.force, 1e-12);
    EXPECT_LT(result.moment, 1e-12);
    ++checked;
  }
  EXPECT_EQ(checked, 50);
}

// Friction acts at the two surface points, which are a depth apart: its moments balance up to depth x
// friction.
TEST(ContactForce, FrictionBalancesUpToItsDepth) {
  World world(3, false, 5);
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  const double depth = 0.01, mu = 0.5;
  const auto s =
      on_frame(node_point({0, 1, 2}, {0.3, 0.3, 0.4}), 0, Pose{}, {0, 0, 1}, depth, 0.3, world.state);
  term.add_pair(std::make_unique<ListSource>(std::vector{s}), spec(mu));
  term.refresh(world.state.view());
  const auto view = world.state.view();
  const VecX f = force(term, world.state);
  const Wrench w = term.frame_wrench(view, 0);
  Vec3 sum = w.force, moment = w.moment;
  for (int i = 0; i < 3; ++i) {
    sum += f.segment<3>(3 * i);
    moment += view.position(i).cross(Vec3(f.segment<3>(3 * i)));
  }
  const double normal = std::abs(w.force.z()), tangential = w.force.head<2>().norm();
  EXPECT_NEAR(tangential, mu * normal, 1e-12 * normal);  // sliding at about 1 m/s, far above v_r
  EXPECT_LT(sum.norm(), 1e-13 * normal);
  EXPECT_NEAR(moment.norm(), depth * tangential, 1e-12 * normal);
}

// Below the regularisation speed the law is viscous: f = mu N v / v_r.
TEST(ContactForce, FrictionCreepsBelowTheRegularisationSpeed) {
  World world(1, false, 6);
  world.state.u() << 2e-4, 0.0, 0.0;
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  const auto s = on_frame(node_point({0}, {1.0}), 0, Pose{}, {0, 0, 1}, 0.01, 0.3, world.state);
  ContactSpec law = spec(0.5);
  law.friction_regularisation_m_s = 1e-3;
  term.add_pair(std::make_unique<ListSource>(std::vector{s}), law);
  term.refresh(world.state.view());
  const VecX f = force(term, world.state);
  const double normal = 1e5 * 0.01 * 0.3;
  EXPECT_NEAR(f[2], normal, 1e-9);
  EXPECT_NEAR(f[0], -0.5 * normal * 0.2, 1e-9);
  EXPECT_NEAR(term.dissipated_power(world.state.view()), 0.5 * normal * 0.2 * 2e-4, 1e-12);
}

TEST(ContactForce, RefreshReportsWhetherTheForceChanged) {
  World world(3, false, 7);
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  const auto point = node_point({0}, {1.0});
  const auto pressed = on_frame(point, 0, Pose{}, {0, 0, 1}, 0.01, 0.3, world.state);
  const auto apart = on_frame(point, 0, Pose{}, {0, 0, 1}, -0.01, 0.3, world.state);
  contact::ContactForce near;
  near.add_frame(contact::fixed_frame());
  near.add_pair(std::make_unique<ListSource>(std::vector{apart}), spec());
  EXPECT_FALSE(near.refresh(world.state.view()));  // candidates only: the force is zero before and after
  ContactSpec undamped = spec();
  undamped.damping_pa_s_m = 0.0;
  term.add_pair(std::make_unique<ListSource>(std::vector{pressed}), undamped);
  EXPECT_TRUE(term.refresh(world.state.view()));
  EXPECT_FALSE(term.refresh(world.state.view()));
  EXPECT_EQ(term.statistics().queries, 2);
  EXPECT_GE(term.statistics().query_seconds, 0.0);
}

// One root function per sample: its sign tells whether the sample presses, for any gap and rate, also where
// the damper is cut off while the gap is still closed.
TEST(ContactForce, EventsChangeSignExactlyWhereASampleOpensOrCloses) {
  int pressing = 0, parting = 0, apart = 0;
  for (const char* law : {"kelvin_voigt", "hunt_crossley"})
    for (const double damping : {0.0, 5e3}) {
      ContactSpec contact_spec = spec();
      contact_spec.law = law;
      contact_spec.damping_pa_s_m = contact_spec.law == "kelvin_voigt" ? damping : 0.0;
      contact_spec.hunt_crossley_s_m = contact_spec.law == "hunt_crossley" ? damping / 1e3 : 0.0;
      World world(2, false, 8);
      contact::ContactForce term;
      term.add_frame(contact::fixed_frame());
      const auto sample = [&](int node) {
        return on_frame(node_point({node}, {1.0}), 0, Pose{}, {0, 0, 1}, -0.1, 0.1, world.state);
      };
      term.add_pair(std::make_unique<ListSource>(std::vector{sample(0), sample(1)}), contact_spec);
      term.add_pair(std::make_unique<ListSource>(std::vector<contact::ContactSample>{}), contact_spec);
      term.refresh(world.state.view());
      ASSERT_EQ(term.event_count(), 2) << "one a sample, none for a pair without";
      const double z0 = world.state.q()[2], z1 = world.state.q()[5];
      double g[2];
      for (int i = -10; i <= 10; ++i)
        for (int j = -10; j <= 10; ++j) {
          const double gap = 0.011 * i + 1e-4, rate = 0.2 * j + 0.01;
          world.state.q()[2] = z0 - 0.1 + gap;
          world.state.q()[5] = z1 - 0.1 - gap;  // the other sample faces the opposite way
          world.state.u()[2] = world.state.u()[5] = rate;
          term.events(world.state.view(), g);
          for (int k = 0; k < 2; ++k) {
            const double own = k == 0 ? gap : -gap, p = contact::pressure(contact_spec, own, rate).p;
            EXPECT_EQ(g[k]<0.0, p> 0.0) << law << " gap " << own << " rate " << rate;
            (p > 0.0 ? pressing : own < 0.0 ? parting : apart) += 1;
          }
        }
    }
  EXPECT_GT(pressing, 300);
  EXPECT_GT(parting, 50) << "cut off with the gap closed";
  EXPECT_GT(apart, 300);
}

TEST(ContactForce, EventsAreContinuousAndStandForTheSamplesBetweenTwoQueries) {
  ContactSpec contact_spec = spec();
  World world(1, false, 8);
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  term.add_pair(std::make_unique<ListSource>(std::vector{
                    on_frame(node_point({0}, {1.0}), 0, Pose{}, {0, 0, 1}, -0.1, 0.1, world.state)}),
                contact_spec);
  EXPECT_EQ(term.event_count(), 0) << "before the first query";
  term.refresh(world.state.view());
  EXPECT_EQ(term.event_count(), 1);
  const double z0 = world.state.q()[2];
  double before = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    world.state.q()[2] = z0 - 1e-4 * i;  // from 0.1 above to 0.1 below
    world.state.u()[2] = std::sin(0.01 * i);
    double g;
    term.events(world.state.view(), &g);
    if (i == 0) before = g;
    EXPECT_LT(std::abs(g - before), 1e-3 + 0.01 * contact_spec.damping_pa_s_m / contact_spec.stiffness_pa_m);
    before = g;
  }
  EXPECT_EQ(term.event_count(), 1) << "constant between two queries";
}

TEST(ContactForce, AnOnsetLeavesNothingToFind) {
  ContactSpec smooth = spec();
  smooth.onset_width_m = 1e-3;
  World world(1, false, 8);
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  term.add_pair(std::make_unique<ListSource>(std::vector{
                    on_frame(node_point({0}, {1.0}), 0, Pose{}, {0, 0, 1}, -0.1, 0.1, world.state)}),
                smooth);
  term.refresh(world.state.view());
  EXPECT_EQ(term.event_count(), 0);
}

TEST(ContactForce, FrameGivenByTimeMovesTheGapAndItsRate) {
  World world(1, false, 9);
  world.state.u().setZero();
  auto frame = std::make_shared<contact::TrajectoryFrame>();
  frame->append(0.0, {}, {Vec3::Zero(), Vec3(0, 0, 0.5)});
  contact::ContactForce term;
  term.add_frame(frame);
  const auto s = on_frame(node_point({0}, {1.0}), 0, Pose{}, {0, 0, 1}, 0.0, 1.0, world.state);
  term.add_pair(std::make_unique<ListSource>(std::vector{s}), spec());
  term.refresh(world.state.view());
  world.state.set_time(0.02);  // the frame has risen by 10 mm, and rises at 0.5 m/s
  EXPECT_NEAR(force(term, world.state)[2], 1e5 * 0.01 + 10.0 * 0.5, 1e-9);
}

TEST(ContactForce, OwnMistakesAreCaught) {
  World world(2, false, 10);
  const auto refused = [&](contact::ContactSample s, const std::string& expected) {
    contact::ContactForce term;
    term.add_frame(contact::fixed_frame());
    term.add_pair(std::make_unique<ListSource>(std::vector{s}), spec());
    try {
      term.refresh(world.state.view());
      ADD_FAILURE() << expected;
    } catch (const InternalError& e) {
      EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
    }
  };
  const auto good = on_frame(node_point({0}, {1.0}), 0, Pose{}, {0, 0, 1}, 0.1, 1.0, world.state);
  auto s = good;
  s.b.frame = 3;
  refused(s, "frame 3 of 1");
  s = good;
  s.a.node[0] = 9;
  refused(s, "node 9 of 2");
  s = good;
  s.area = -1.0;
  refused(s, "area -1");
  contact::ContactForce term;
  EXPECT_THROW(term.add_frame(nullptr), InternalError);
  EXPECT_THROW(term.add_pair(nullptr, ContactSpec{}), InternalError);
}

TEST(ContactForce, IsCounted) {
  const long before = counters::counter("contact.force").load();
  contact::ContactForce term;
  EXPECT_EQ(counters::counter("contact.force").load(), before + 1);
}
