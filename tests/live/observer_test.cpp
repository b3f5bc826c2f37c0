#include <gtest/gtest.h>

#include "live/world_observer.h"
#include "malloc_count.h"
#include "palpate/loop/run.h"
#include "small_scene.h"

namespace palpate::live {
namespace {

/// Passes calls to a WorldObserver, and counts the memory that it requests meanwhile.
class Counted : public loop::Observer {
 public:
  explicit Counted(WorldObserver& observer) : observer_(observer) {}
  void period(loop::World& world, double t) override {
    count([&] { observer_.period(world, t); });
    ++periods;
  }
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override {
    count([&] { observer_.tick_of(hand, tick); });
    last = tick;
  }
  long periods = 0, allocations = 0;
  loop::TickRecord last;

 private:
  template <class Call>
  void count(const Call& call) {
#if PALPATE_CAN_COUNT
    const long before = malloc_calls.load();
    call();
    allocations += malloc_calls.load() - before;
#else
    call();
#endif
  }
  WorldObserver& observer_;
};

struct Session {
  explicit Session(const std::vector<std::string>& overrides) : description(small_scene(overrides)) {
    std::vector<std::unique_ptr<device::Device>> hands;
    hands.push_back(
        std::make_unique<PageDevice>(mailbox, Pose{Quat::Identity(), description.tool->position_m}));
    world = loop::assemble(description, std::move(hands));
    scene =
        std::make_shared<LiveScene>(*world, "small", sliders_of(description, {}), HandleMailboxes{mailbox});
    scene->watched = true;
    observer.attach(scene, *world);
  }
  scene::Description description;
  std::shared_ptr<HandleMailbox> mailbox = std::make_shared<HandleMailbox>();
  std::unique_ptr<loop::World> world;
  std::shared_ptr<LiveScene> scene;
  WorldObserver observer;
};

class Observed : public testing::TestWithParam<const char*> {};

TEST_P(Observed, ARunIsFollowedWithoutAllocation) {
#if !PALPATE_CAN_COUNT
  GTEST_SKIP() << "this build's malloc cannot be counted";
#endif
  Session session({fmt::format("exchange.scheme=\"{}\"", GetParam())});
  session.mailbox->publish(HandleTarget::of({Quat::Identity(), {0.0, 0.0, 0.030}}, 0));
  Counted counted(session.observer);
  loop::RunOptions options;
  options.duration_s = 0.5;
  options.real_time = true;
  options.observers = {&counted};
  const loop::RunResult result = loop::run(*session.world, options);
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_GT(counted.periods, 2);
  // The partitioned scheme computes the energy in the thread of the bodies, five times per second.
  const long energies = std::string(GetParam()) == "partitioned" ? 4 : 0;
  EXPECT_LE(counted.allocations, 64 * energies);
  ASSERT_TRUE(session.scene->frames.take());
  const Frame& frame = session.scene->frames.front();
  const loop::Body& body = session.world->bodies[0];
  const auto nodes = 3 * static_cast<std::size_t>(body.placed.cols());
  ASSERT_EQ(frame.values.size(), nodes + 7 + 14);
  EXPECT_NEAR(frame.time_s, 0.5, 0.011);
  EXPECT_NEAR(frame.values[nodes + 7 + 2], 0.030F, 1e-4F) << "the handle is at its target";
  EXPECT_GT(frame.values[nodes + 7 + 9], 0.05F) << "a force pushes the hand up";
  EXPECT_EQ(frame.values[nodes + 7 + 9], static_cast<float>(counted.last.device.force.z()));
  float lowest = 0.0F;
  for (std::size_t i = 0; i < nodes; ++i)
    lowest = std::max(lowest, std::abs(frame.values[i] - static_cast<float>(body.placed.data()[i])));
  EXPECT_GT(lowest, 1e-3F) << "the ball is dented";
}

INSTANTIATE_TEST_SUITE_P(Schemes, Observed, testing::Values("partitioned", "single_rate"));

TEST(WorldObserver, TheEnergyThatHandsPutInIsTheirSum) {
  Session session({});
  WorldObserver observer;
  scene::Description two = small_scene(kSecondHand);
  const auto world = loop::assemble(two);
  const auto scene = std::make_shared<LiveScene>(*world, "two", sliders_of(two, {}), HandleMailboxes{});
  observer.attach(scene, *world);
  // one hand puts 0.3 J in and the other takes 0.1 J out in the same tick
  const auto tick = [&](std::size_t hand, double time, double z, double force) {
    loop::TickRecord record;
    record.time = time;
    record.handle.translation = {0.0, 0.0, z};
    record.motors.force = {0.0, 0.0, force};
    observer.tick_of(hand, record);
  };
  for (std::size_t hand : {0, 1}) tick(hand, 0.0, 0.0, 0.0);
  tick(0, 1e-3, -0.1, 3.0);
  tick(1, 1e-3, 0.05, 2.0);
  observer.period(*world, 0.0);
  EXPECT_NEAR(scene->status.latest().port_energy_j, 0.3 - 0.1, 1e-12);
  EXPECT_EQ(scene->status.latest().least_port_energy_j, 0.0);
}

TEST(WorldObserver, WithoutViewersOnlyTheFirstFrameIsWritten) {
  Session session({});
  session.scene->watched = false;
  loop::RunOptions options;
  options.real_time = true;
  options.observers = {&session.observer};
  ASSERT_TRUE(loop::run(*session.world, options).status.ok());
  ASSERT_TRUE(session.scene->frames.take());
  EXPECT_EQ(session.scene->frames.front().time_s, 0.0);
  EXPECT_GT(session.scene->status.latest().time_s, 0.05) << "figures are kept";
}

TEST(WorldObserver, YoungsModulusChangesAtTheNextPeriod) {
  Session session({});
  session.scene->moduli[0] = 3e4;
  loop::RunOptions options;
  options.real_time = true;
  options.observers = {&session.observer};
  ASSERT_TRUE(loop::run(*session.world, options).status.ok());
  EXPECT_EQ(session.world->bodies[0].term->materials()[0].youngs_modulus, 3e4);
  EXPECT_EQ(session.scene->moduli[0].load(), 0.0);
}

}  // namespace
}  // namespace palpate::live
