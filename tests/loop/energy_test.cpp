#include "loop/energy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"

using namespace palpate;

// The trapezoidal rule for sin^2 has a second-order error, which the estimate reproduces.
TEST(PowerIntegral, KnowsItsError) {
  for (const int n : {40, 80}) {
    loop::PowerIntegral integral;
    integral.start(0.0, 0.0);
    for (int i = 1; i <= n; ++i) integral.add(1.0 * i / n, std::pow(std::sin(1.0 * i / n), 2));
    const double exact = 0.5 - 0.25 * std::sin(2.0), error = std::abs(integral.value() - exact);
    EXPECT_GT(error, 1e-6);
    EXPECT_NEAR(integral.error() / error, 1.0, 0.02) << n;
  }
}

namespace {

struct Rows final : loop::Observer {
  std::vector<loop::EnergyBalance> rows;
  bool requested = true;
  bool wants_energy() const override { return requested; }
  void energy(const loop::EnergyBalance& balance) override { rows.push_back(balance); }
};

std::vector<loop::EnergyBalance> balance_of(scene::Description d) {
  const auto world = loop::assemble(d);
  Rows keep;
  loop::RunOptions options;
  options.observers = {&keep};
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_TRUE(result.energy);
  return keep.rows;
}

/// The free block falls on the floor.
scene::Description dropped(const char* integrator, double setting) {
  scene::Description d = small_scenes::held_block();
  d.bodies[0].attachments.clear();
  d.bodies[0].position_m = Vec3(0, 0, 0.012);
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  ContactSpec law;
  law.first = "block";
  law.stiffness_pa_m = 1e6;
  small_scenes::add_floor(d, law);
  d.integrator.name = integrator;
  d.integrator.rtol = setting;
  d.exchange.contact_refresh_s = 5e-4;
  d.duration_s = 0.1;
  return d;
}

}  // namespace

// m g h is converted to each form of energy in the block, and only its damping removes energy.
TEST(EnergyLedger, ADroppedBlock) {
  const auto rows = balance_of(dropped("cvode-bdf", 1e-7));
  ASSERT_EQ(rows.size(), 200u);
  const double weight = 1000.0 * 0.04 * 0.04 * 0.02 * 9.81, scale = weight * 0.002;
  double elastic = 0.0, contact = 0.0, kinetic = 0.0;
  for (const auto& row : rows) {
    EXPECT_LT(std::abs(row.unaccounted), 5e-3 * scale + 2.0 * row.quadrature_error) << row.time;
    EXPECT_EQ(row.hand, 0.0);
    EXPECT_EQ(row.supports, 0.0);
    elastic = std::max(elastic, row.elastic);
    contact = std::max(contact, row.contact);
    kinetic = std::max(kinetic, row.kinetic);
  }
  EXPECT_GT(kinetic, 0.9 * scale);
  EXPECT_GT(elastic, 0.1 * scale);
  EXPECT_GT(contact, 0.01 * scale);
  EXPECT_GT(rows.back().dissipated, 0.1 * scale);
  EXPECT_EQ(rows.back().dissipated_by_contact, 0.0) << "its law has no damper: all is the block's";
  EXPECT_EQ(rows.back().kinetic_of_tools, 0.0);
  EXPECT_LT(rows.back().other, 0.0) << "it lies lower";
  EXPECT_LT(rows.back().quadrature_error, 0.02 * scale);
}

// The same block with almost no material damping: the lost energy is dissipated by contact's damper.
TEST(EnergyLedger, NamesWhatContactDissipates) {
  scene::Description d = dropped("cvode-bdf", 1e-7);
  d.bodies[0].stiffness_damping_s = 1e-7;
  d.contacts[0].damping_pa_s_m = 1e4;
  const loop::EnergyBalance last = balance_of(d).back();
  EXPECT_GT(last.dissipated_by_contact, 1e-4);
  EXPECT_NEAR(last.dissipated_by_contact, last.dissipated, 0.02 * last.dissipated);
  EXPECT_EQ(last.dissipated_by_coupling, 0.0);
}

namespace {

/// Held nodes that are moved: the block is stretched slowly along a path.
scene::Description stretched() {
  scene::Description d = small_scenes::held_block();
  AttachmentSpec top;
  top.box_min_m = Vec3(-1, -1, 0.02 - 1e-6);
  top.box_max_m = Vec3(1, 1, 1);
  KeyframeSpec start, end;
  end.time_s = 0.1;
  end.position_m = Vec3(0, 0, 0.002);
  top.keyframes = {start, end};
  d.bodies[0].attachments.push_back(top);
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-7;
  d.record.emplace();
  d.record->state_period_s = 1e-3;  // period of the loop
  d.duration_s = 0.1;
  return d;
}

}  // namespace

TEST(EnergyLedger, SupportsDoWork) {
  const auto rows = balance_of(stretched());
  const loop::EnergyBalance& last = rows.back();
  EXPECT_EQ(last.materials, 0.0);
  EXPECT_GT(last.elastic, 1e-5);
  EXPECT_GT(last.supports, last.elastic);
  EXPECT_NEAR((last.stored() + last.dissipated) / last.supports, 1.0, 2e-3);
  EXPECT_LT(std::abs(last.unaccounted), 1e-3 * last.supports + 2.0 * last.quadrature_error);
}

// At twice Young's modulus the same deformation stores twice the energy, which no external work supplied.
TEST(EnergyLedger, AChangeOfMaterialIsNamed) {
  scene::Description d = stretched();
  const double before = d.bodies[0].youngs_modulus_pa;
  d.bodies[0].changes = {{0.09, 2.0 * before, ""}};
  const auto rows = balance_of(d);
  ASSERT_EQ(rows.size(), 100u);
  const loop::EnergyBalance &then = rows[88], &last = rows.back();
  EXPECT_NEAR(then.time, 0.089, 1e-9);
  EXPECT_EQ(then.materials, 0.0);
  EXPECT_NEAR(last.materials / then.elastic, 1.0, 0.05) << "stretched a little more by then";
  EXPECT_LT(std::abs(last.unaccounted), 1e-3 * last.supports + 2.0 * last.quadrature_error);
}

#ifdef PALPATE_HAS_TOOL
namespace {

/// The hand presses the block with the tool and retreats.
scene::Description pressed_and_let_go(const char* scheme) {
  scene::Description d = small_scenes::pressed_block(-1e-4);
  KeyframeSpec pressed = d.device->keyframes[0];
  pressed.time_s = 0.05;
  pressed.position_m.z() -= 0.004;
  KeyframeSpec up = d.device->keyframes[0];
  up.time_s = 0.1;
  d.device->keyframes = {d.device->keyframes[0], pressed, up};
  d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 1e-3;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-7;
  d.duration_s = 0.15;
  return d;
}

struct Worst {
  double hand = 0.0, quadrature = 0.0, unaccounted = 0.0;
  explicit Worst(const std::vector<loop::EnergyBalance>& rows) {
    for (const auto& row : rows) {
      hand = std::max(hand, row.hand);
      quadrature = std::max(quadrature, row.quadrature_error);
      unaccounted = std::max(unaccounted, std::abs(row.unaccounted));
    }
  }
};

}  // namespace

// The hand's work equals the stored plus the dissipated energy.
TEST(EnergyLedger, TheHandsWork) {
  const auto rows = balance_of(pressed_and_let_go("monolithic"));
  const Worst worst(rows);
  EXPECT_GT(worst.hand, 1e-4);
  EXPECT_LT(worst.unaccounted, 5e-3 * worst.hand + 2.0 * worst.quadrature);
  EXPECT_LT(worst.quadrature, 0.02 * worst.hand);
  EXPECT_NEAR(rows.back().hand, rows.back().dissipated, 0.05 * worst.hand) << "nothing is left in the block";
}

// A free tool swings about a handle that has jumped aside: m x'' = -k x - b x'. The spring's energy k x_0^2 /
// 2 oscillates, and is dissipated only by the coupling's damper.
TEST(EnergyLedger, NamesTheToolsParts) {
  for (const char* scheme : {"monolithic", "partitioned", "single_rate"}) {
    scene::Description d = small_scenes::pressed_block(-0.01);
    const double aside = 0.002, mass = d.tool->mass_kg, k = d.tool->coupling.stiffness_n_m,
                 b = d.tool->coupling.damping_n_s_m;
    d.device->keyframes[0].position_m.x() += aside;
    d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 1e-3;
    d.tool->tick_s = 1e-4;
    d.integrator.name = "cvode-bdf";
    d.integrator.rtol = 1e-8;
    d.duration_s = 0.05;
    const double start = 0.5 * k * aside * aside, decay = b / (2.0 * mass),
                 w = std::sqrt(k / mass - decay * decay);
    const auto rows = balance_of(d);
    ASSERT_GT(rows.size(), 40u) << scheme;
    for (const auto& row : rows) {
      const double t = row.time,
                   x = aside * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)),
                   v = -aside * std::exp(-decay * t) * (k / mass) / w * std::sin(w * t);
      EXPECT_NEAR(row.coupling, 0.5 * k * x * x, 0.02 * start) << scheme << ", t = " << t;
      EXPECT_NEAR(row.kinetic_of_tools, 0.5 * mass * v * v, 0.02 * start) << scheme << ", t = " << t;
      EXPECT_NEAR(row.dissipated_by_coupling, start - 0.5 * k * x * x - 0.5 * mass * v * v, 0.04 * start)
          << scheme << ", t = " << t;
      EXPECT_EQ(row.dissipated_by_contact, 0.0);
      EXPECT_LE(row.kinetic_of_tools, row.kinetic + 1e-12 * start);
    }
    EXPECT_GT(rows.back().dissipated_by_coupling, 0.5 * start) << scheme;
  }
}

// A tool in ticks is not part of the system, and its energies are accounted separately. The remainder is the
// error of the exchange, of first order in period and tick.
TEST(EnergyLedger, TheHandsWorkByTicks) {
  double unaccounted[2];
  for (const int fine : {0, 1}) {
    scene::Description d = pressed_and_let_go("partitioned");
    d.exchange.linearisation = "condensed";
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = fine ? 1e-3 : 2e-3;
    d.tool->tick_s = fine ? 1e-4 : 2e-4;
    const Worst worst(balance_of(d));
    unaccounted[fine] = worst.unaccounted / worst.hand;
    EXPECT_LT(worst.quadrature, 0.3 * worst.unaccounted);
  }
  EXPECT_LT(unaccounted[0], 0.02);
  EXPECT_LT(unaccounted[1], 0.75 * unaccounted[0]);
}

// Contact points over reduced bodies: tool and bodies do nearly the same work on each other. The remainder is
// the dissipation of Euler's method per tick, which decreases with the tick; the error of the exchange is a
// fifth of the linear model's, which makes 1.3 % of energy at these periods for any tick.
TEST(EnergyLedger, ContactPointsLeaveTheTicksOwnLossAlone) {
  double unaccounted[2];
  for (const int fine : {0, 1}) {
    scene::Description d = pressed_and_let_go("partitioned");
    d.exchange.linearisation = "points";
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 2e-3;
    d.tool->tick_s = fine ? 2e-5 : 2e-4;
    const Worst worst(balance_of(d));
    unaccounted[fine] = worst.unaccounted / worst.hand;
  }
  EXPECT_LT(unaccounted[0], 0.03);
  EXPECT_LT(unaccounted[1], 0.004);
}
#endif

TEST(EnergyLedger, ARunThatDoesNotAskHasNone) {
  const auto world = loop::assemble(dropped("cvode-bdf", 1e-3));
  Rows keep;
  keep.requested = false;
  loop::RunOptions options;
  options.observers = {&keep};
  EXPECT_FALSE(loop::run(*world, options).energy);
  EXPECT_TRUE(keep.rows.empty());
}
