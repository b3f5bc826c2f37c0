// Changes of the resultants at a refresh: force and moment of each pair on its bodies.
#include "fixture.h"

using namespace contact_tests;

namespace {

/// Returns another list of samples at every query, and the last one repeatedly.
class ListsSource final : public contact::SampleSource {
 public:
  explicit ListsSource(std::vector<std::vector<contact::ContactSample>> lists)
      : SampleSource({.name = "lists"}), lists_(std::move(lists)) {}
  void query(const dynamics::StateView&, std::vector<contact::ContactSample>& out) override {
    out.insert(out.end(), lists_[at_].begin(), lists_[at_].end());
    at_ = std::min(at_ + 1, lists_.size() - 1);
  }
  void add_pattern(dynamics::PatternBuilder&) const override {}

 private:
  std::vector<std::vector<contact::ContactSample>> lists_;
  std::size_t at_ = 0;
};

ContactSpec spring(double friction = 0.0) {
  ContactSpec out;
  out.stiffness_pa_m = 1e5;
  out.friction = friction;
  return out;
}

constexpr double kForce = 300.0;  // 1e5 Pa/m x 0.01 m x 0.3 m^2
contact::ContactSample above(const contact::SurfacePoint& point, int frame, const Pose& pose,
                             const World& world, double share = 1.0) {
  return on_frame(point, frame, pose, {0, 0, 1}, 0.01, 0.3 * share, world.state);
}

/// Nodes at the corners of a square of edge 2 about `middle`, at rest.
World square(const Vec3& middle, bool with_body = false) {
  World world(4, with_body, 7);
  for (int i = 0; i < 4; ++i)
    world.state.q().segment<3>(3 * i) = middle + Vec3(i % 2 ? 1 : -1, i < 2 ? 1 : -1, 0);
  world.state.u().setZero();
  return world;
}

}  // namespace

// One corner of a square is pressed: the whole force, and its arm from the square's centre, wherever the
// square is.
TEST(Resultants, ForceAndMomentOfOneNodeByHand) {
  for (const double friction : {0.0, 0.3})  // summed in groups, and sample by sample
    for (const Vec3& middle : {Vec3(0, 0, 0), Vec3(1e3, -2e3, 50)}) {
      World world = square(middle);
      contact::ContactForce term;
      term.add_frame(contact::fixed_frame());
      term.add_pair(
          std::make_unique<ListSource>(std::vector{above(node_point({1}, {1.0}), 0, Pose{}, world)}),
          spring(friction));
      EXPECT_TRUE(term.refresh(world.state.view()));
      EXPECT_NEAR(term.statistics().refresh_jump.force, kForce, 1e-6);
      EXPECT_NEAR(term.statistics().refresh_jump.moment, std::sqrt(2.0) * kForce, 1e-5);
      EXPECT_FALSE(term.refresh(world.state.view()));
      EXPECT_EQ(term.statistics().refresh_jump.force, 0.0);
      EXPECT_EQ(term.statistics().refresh_jump.moment, 0.0);
      EXPECT_NEAR(term.statistics().largest_jump.force, kForce, 1e-6) << "of all refreshes";
      EXPECT_NEAR(term.statistics().largest_jump.moment, std::sqrt(2.0) * kForce, 1e-5);
      EXPECT_NEAR(term.statistics().largest_resultant.force, kForce, 1e-6) << "from nothing to all";
      EXPECT_NEAR(term.statistics().largest_resultant.moment, std::sqrt(2.0) * kForce, 1e-5);
    }
}

// The same load on other nodes: the forces on nodes change, which an integrator must detect; the resultant
// does not.
TEST(Resultants, TheSameLoadOnOtherNodesIsNoJump) {
  for (const double friction : {0.0, 0.3}) {
    World world = square(Vec3(3, 2, 1));
    // the centre of the upper edge, in three ways
    const auto sample = [&](std::vector<int> nodes, std::vector<double> weights, double share) {
      return above(node_point(std::move(nodes), std::move(weights)), 0, Pose{}, world, share);
    };
    contact::ContactForce term;
    term.add_frame(contact::fixed_frame());
    term.add_pair(std::make_unique<ListsSource>(std::vector<std::vector<contact::ContactSample>>{
                      {sample({0, 1}, {0.5, 0.5}, 1.0)},
                      {sample({0}, {1.0}, 0.5), sample({1}, {1.0}, 0.5)},
                      {sample({0, 1, 2, 3}, {0.7, 0.3, -0.2, 0.2}, 1.0)}}),
                  spring(friction));
    EXPECT_TRUE(term.refresh(world.state.view()));
    VecX before = force(term, world.state);
    bool nodes_changed = false;
    for (int i = 0; i < 2; ++i) {
      term.refresh(world.state.view());
      EXPECT_LT(term.statistics().refresh_jump.force, 1e-10 * kForce);
      EXPECT_LT(term.statistics().refresh_jump.moment, 1e-10 * kForce);
      const VecX after = force(term, world.state);
      nodes_changed = nodes_changed || (after - before).norm() > 0.1 * kForce;
      before = after;
    }
    EXPECT_TRUE(nodes_changed) << "or there was nothing to see";
  }
}

// A load that moves from the right edge to the left one: no force change, and a moment change of twice its
// arm.
TEST(Resultants, ALoadThatMovesIsAMoment) {
  World world = square(Vec3(3, 2, 1));
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  term.add_pair(std::make_unique<ListsSource>(std::vector<std::vector<contact::ContactSample>>{
                    {above(node_point({1, 3}, {0.5, 0.5}), 0, Pose{}, world)},
                    {above(node_point({0, 2}, {0.5, 0.5}), 0, Pose{}, world)}}),
                spring());
  term.refresh(world.state.view());
  EXPECT_TRUE(term.refresh(world.state.view())) << "the forces on the nodes have changed";
  EXPECT_LT(term.statistics().refresh_jump.force, 1e-10);
  EXPECT_NEAR(term.statistics().refresh_jump.moment, 2.0 * kForce, 1e-9);
}

// Both bodies of a pair have a moment, each about its centre: the larger one counts. Pairs count separately,
// so that the forces of two pairs do not cancel.
TEST(Resultants, EveryBodyOfEveryPairCounts) {
  World world = square(Vec3::Zero(), true);
  const auto body = contact::block_frame(world.body_id);
  const Pose pose = body->pose(world.state.view());
  int farthest = 0;  // farthest from the body, so that the body's moment is the larger one
  const auto arm = [&](int i) {
    return (world.state.view().position(i) - pose.translation).head<2>().norm();
  };
  for (int i = 1; i < 4; ++i)
    if (arm(i) > arm(farthest)) farthest = i;
  const auto node = node_point({farthest}, {1.0});
  for (const bool on_body : {true, false}) {
    contact::ContactForce term;
    const int given = term.add_frame(contact::fixed_frame()), moving = term.add_frame(body);
    const int frame = on_body ? moving : given;
    term.add_pair(
        std::make_unique<ListSource>(std::vector{above(node, frame, on_body ? pose : Pose{}, world)}),
        spring());
    term.add_pair(std::make_unique<ListSource>(
                      std::vector{on_frame(node, given, Pose{}, {0, 0, -1}, 0.01, 0.3, world.state)}),
                  spring());
    term.refresh(world.state.view());
    EXPECT_NEAR(term.statistics().refresh_jump.force, kForce, 1e-9) << "on the node both cancel";
    const double arm_of_nodes = std::sqrt(2.0), arm_of_body = arm(farthest);
    ASSERT_GT(arm_of_body, arm_of_nodes + 0.05) << "else the body's is not seen";
    EXPECT_NEAR(term.statistics().refresh_jump.moment, (on_body ? arm_of_body : arm_of_nodes) * kForce, 1e-9)
        << "an obstacle feels nothing";
  }
}
