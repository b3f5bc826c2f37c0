// Tests the results of one run with contact: stages, devices, costs.
#include <gtest/gtest.h>
#include "contact/gpu_device.h"
#include "core/instructions.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "product/contact.h"

namespace palpate::bench {
namespace {

/// Returns a block held at its foot, and another held at its top, which is pushed into it and then sideways.
scene::Description rubbing_blocks(double step_s = 0.01) {
  constexpr double kLength = 0.02, kPressed = 1e-3;
  scene::Description d = small_scenes::held_block();
  d.name = "rubbing blocks";
  d.duration_s = 0.1;
  d.bodies.push_back(d.bodies[0]);
  SoftBodySpec& upper = d.bodies[1];
  upper.name = "upper";
  upper.position_m.z() = 1.5 * kLength - kPressed;
  upper.attachments[0].box_min_m.z() = 2 * kLength - kPressed - 1e-6;
  upper.attachments[0].box_max_m.z() = 2 * kLength - kPressed + 1e-6;
  upper.attachments[0].keyframes = {{.time_s = 0.0}, {.time_s = 0.1, .position_m = Vec3(0.005, 0, 0)}};
  ContactSpec contact;
  contact.first = "block";
  contact.second = "upper";
  contact.stiffness_pa_m = 1e6;
  d.contacts = {contact};
  d.gravity_m_s2 = Vec3::Zero();
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = step_s;
  d.integrator.linear_rtol = 1e-6;
  return d;
}

std::vector<std::string> methods() {
  std::vector<std::string> out = {"distance"};
  if (contact::gpu_available()) out.emplace_back("image");
  return out;
}

// In every period the stages make up the query, so the sum of the least stage times is no more than the least
// query, and the sum of the largest no less than the largest query: p99 of a few periods is the largest.
TEST(ContactRun, StagesMakeUpTheQuery) {
  for (const std::string& method : methods()) {
    SCOPED_TRACE(method);
    const ContactBenchRow r = bench_contact(rubbing_blocks(), {.method = method});
    EXPECT_TRUE(r.touches);
    EXPECT_EQ(r.periods, 10);
    EXPECT_EQ(r.forces.size(), 10u);
    EXPECT_GT(r.samples, 10);
    double least = 0.0, most = 0.0;
    for (int s = 0; s < kQueryStages; ++s) {
      const Spread& stage = r.of(static_cast<ContactStage>(s));
      least += stage.least;
      most += stage.p99;
    }
    constexpr double kRounding = 1e-9;
    EXPECT_LE(least, r.query.least + kRounding);
    EXPECT_GE(most, r.query.p99 - kRounding);
    for (const Spread& s : r.stages) EXPECT_TRUE(s.least <= s.median && s.median <= s.p99);
    for (const ContactStage stage : {ContactStage::kRest, ContactStage::kForces, ContactStage::kTangent})
      EXPECT_GT(r.of(stage).least, 0.0) << name_of(stage);
    for (const ContactStage stage : {ContactStage::kSkins, ContactStage::kPasses, ContactStage::kGather,
                                     ContactStage::kReadback, ContactStage::kGaps})
      EXPECT_EQ(r.of(stage).median > 0.0, method == "image") << name_of(stage);
    EXPECT_GE(r.to_forces.least, r.query.least + r.of(ContactStage::kForces).least - kRounding);
    EXPECT_LE(r.to_forces.p99, r.query.p99 + r.of(ContactStage::kForces).p99 + kRounding);
    // The lower block is pushed down by the upper one.
    EXPECT_LT(r.forces.back().z(), 0.0);
  }
}

TEST(ContactRun, NamesWhatFindsTheGaps) {
  const ContactDevice device = device_of("distance");
  const std::string_view set = name_of(best_instructions());
  EXPECT_TRUE(device.name.ends_with(set)) << device.name;
  EXPECT_GT(device.name.size(), set.size() + 2) << device.name;
  EXPECT_FALSE(device.software);
  if (!contact::gpu_available()) {
    EXPECT_THROW(device_of("image"), Error);
    return;
  }
  const ContactDevice gpu = device_of("image");
  EXPECT_EQ(gpu.name, contact::gpu_device().name + ", " + contact::gpu_device().driver);
  EXPECT_GT(contact::gpu_device().name.size(), 0u);
  EXPECT_EQ(gpu.software, contact::gpu_device().software);
  const ContactBenchRow r = bench_contact(rubbing_blocks(), {.method = "image"});
  EXPECT_EQ(r.device, gpu.name);
  EXPECT_EQ(r.device_is_software, gpu.software);
}

// Friction follows the pressure one step late if the tangent is symmetric, and opposes the velocity at the
// step's end: a part is omitted, and the force differs, by an amount within the error of a step of this
// length. Relative to the converged solution (64 steps per period) both have errors of a half and a
// quarter of the force, in these 10 steps.
TEST(ContactRun, PricesStandWithBothTangents) {
  const ContactCost price = bench_contact_price(rubbing_blocks());
  EXPECT_EQ(price.scene, "rubbing blocks");
  EXPECT_GT(price.one_body_ms, 0.0);
  EXPECT_GT(price.bodies_ms, 0.0);
  EXPECT_GT(price.contact_free_ms, 0.0);
  EXPECT_GT(price.row.assembly_ms, 0.0);
  EXPECT_GT(price.row.elements_ms, 0.0);
  EXPECT_GT(price.friction.symmetric_ms, 0.0);
  EXPECT_GT(price.friction.full_ms, 0.0);
  EXPECT_GT(price.friction.left_out, 1e-6);
  EXPECT_LT(price.friction.left_out, 0.5);
  EXPECT_GT(price.friction.force_change, 1e-9);
  EXPECT_LT(price.friction.force_change, 0.6);
}

// The two tangents' forces converge to each other: a tenth of the step reduces the difference to less than a
// fifth.
TEST(ContactRun, TheDifferenceOfBothTangentsGoesWithTheStep) {
  const ContactCost coarse = bench_contact_price(rubbing_blocks(5e-3)),
                    fine = bench_contact_price(rubbing_blocks(5e-4));
  EXPECT_GT(fine.friction.force_change, 1e-9);
  EXPECT_LT(fine.friction.force_change, 0.2 * coarse.friction.force_change);
}

}  // namespace
}  // namespace palpate::bench
