#include <gtest/gtest.h>

#include <algorithm>

#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"
#include "summary_rows.h"

using namespace palpate;

namespace {

/// A free block, 20 mm thick, thrown at a plane `height` below its lower face.
scene::Description thrown_block(double speed, double height) {
  scene::Description d = small_scenes::held_block();
  d.bodies[0].attachments.clear();
  d.bodies[0].position_m = Vec3(0, 0, 0.01 + height);
  d.bodies[0].velocity_m_s = Vec3(0, 0, -speed);
  ContactSpec contact;
  contact.first = "block";
  contact.stiffness_pa_m = 1e7;
  small_scenes::add_floor(d, contact);
  d.exchange.contact_refresh_s = 0.01;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-4;
  d.duration_s = 0.06;
  return d;
}

class Energies : public loop::Observer {
 public:
  void period(loop::World& world, double) override { values.push_back(world.mechanical_energy()); }
  double worst_gain() const { return *std::max_element(values.begin(), values.end()) / values.front() - 1.0; }
  std::vector<double> values;
};

}  // namespace

// Between two queries, 10 ms apart, the block moves farther than the candidate gap (its mean edge, 11 mm).
// Without look-ahead it was found 5 to 25 mm deep in the plane and expelled with many times its energy by
// springs that no work had compressed; with look-ahead contact starts at the plane.
TEST(Impact, AFastBlockIsCaughtByThePlaneAndGainsNoEnergy) {
  for (const double speed : {0.5, 1.5, 3.0}) {
    const auto world = loop::assemble(thrown_block(speed, 0.0125));
    Energies energies;
    loop::RunOptions options;
    options.observers = {&energies};
    const loop::RunResult result = loop::run(*world, options);
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_LT(energies.worst_gain(), 1e-3) << "at " << speed << " m/s";
    EXPECT_LT(energies.values.back(), 0.9 * energies.values.front())
        << "it was damped while it was squashed, at " << speed << " m/s";
  }
}

// 20 m/s through a plate of 1 mm, between queries 10 ms apart, with a contact far too soft to stop it. A
// stiff plate is not passed, and nothing is counted.
TEST(Impact, AFastBlockThatGoesThroughAThinPlateIsCounted) {
  const auto through_plate = [](double speed, double stiffness) {
    scene::Description d = thrown_block(speed, 0.005);
    d.obstacles[0].type = "box";
    d.obstacles[0].shape["size_m"] = Vec3(0.2, 0.2, 0.001);
    d.contacts[0].method = "analytic";
    d.contacts[0].stiffness_pa_m = stiffness;
    d.duration_s = 0.03;
    return d;
  };
  const auto fast = loop::assemble(through_plate(20.0, 1e3));
  const loop::RunResult result = loop::run(*fast, {});
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  ASSERT_EQ(result.tunnelled.size(), 1u);
  EXPECT_EQ(result.tunnelled[0], fast->bodies[0].boundary.surface.vertices.cols())
      << "every vertex of its surface";
  EXPECT_LT(fast->positions(fast->bodies[0]).row(2).maxCoeff(), -0.001) << "it is through";
  store::Summary summary = loop::summarise(*fast, result, 0.0);
  ASSERT_EQ(summary.list("contacts").size(), 1u);
  EXPECT_EQ(summary_rows::count(summary.list("contacts")[0], "tunnelled"), result.tunnelled[0]);
  const auto caught = loop::assemble(through_plate(0.5, 1e7));
  const loop::RunResult stopped = loop::run(*caught, {});
  ASSERT_TRUE(stopped.status.ok()) << stopped.status.message;
  EXPECT_EQ(stopped.tunnelled, std::vector<long>{0});
}

// A tumbling block approaches the plane vertex by vertex: at a query the list of candidates changes while
// nothing presses yet, and the force does not. The root finder's values for the old list must still be
// discarded.
TEST(Impact, RootsAreFoundWhileTheListOfCandidatesChanges) {
  const auto landed = [](const std::string& integrator, KinkTreatment events) {
    scene::Description d = thrown_block(0.5, 0.0125);
    d.bodies[0].angular_velocity_rad_s = Vec3(9.0, 4.0, 0.0);
    d.exchange.contact_refresh_s = 0.002;
    d.exchange.exchange_period_s = 0.002;
    d.integrator.name = integrator;
    d.integrator.rtol = 1e-6;
    d.integrator.events = events;
    const auto world = loop::assemble(d);
    const loop::RunResult result = loop::run(*world, {});
    EXPECT_TRUE(result.status.ok()) << integrator << ", " << name_of(events) << ": " << result.status.message;
    if (events == KinkTreatment::kRootFinding) { EXPECT_GT(result.counters.events, 3) << integrator; }
    return VecX(world->state.q());
  };
  for (const char* integrator : {"cvode-bdf", "ida", "ark-dirk-esdirk437", "ark-erk-3"})
    EXPECT_LT(
        (landed(integrator, KinkTreatment::kRootFinding) - landed(integrator, KinkTreatment::kErrorControl))
            .cwiseAbs()
            .maxCoeff(),
        1e-6)
        << integrator;
}
