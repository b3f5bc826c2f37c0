// Choice of the contact method: "auto" uses nearest points and does not open OpenGL; "image" does.
#include <gtest/gtest.h>

#include "contact/gpu_device.h"
#include "core/counters.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"

using namespace palpate;

namespace {

/// Two blocks in contact, after one period.
std::unique_ptr<loop::World> after_a_period(const std::string& method) {
  scene::Description d = small_scenes::held_block();
  d.bodies.push_back(d.bodies[0]);
  d.bodies[1].name = "upper";
  d.bodies[1].position_m.z() += 0.0195;
  d.bodies[1].attachments.clear();
  ContactSpec contact;
  contact.first = "block";
  contact.second = "upper";
  contact.method = method;
  contact.stiffness_pa_m = 1e6;
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = d.duration_s = 0.01;
  auto world = loop::assemble(d);
  const loop::RunResult result = loop::run(*world, {});
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_GT(world->contact->samples().size(), 5u);
  return world;
}

}  // namespace

TEST(MethodChoice, AutoTakesNearestPoints) {
  const long before = counters::counter("gl.context").load();
  EXPECT_EQ(after_a_period("auto")->contact->pairs().at(0).method, "distance");
  EXPECT_EQ(counters::counter("gl.context").load(), before);
}

TEST(MethodChoice, AnImageIsMadeByOpenGl) {
  if (!contact::gpu_available()) {
    EXPECT_THROW(after_a_period("image"), Error);
    return;
  }
  EXPECT_EQ(after_a_period("image")->contact->pairs().at(0).method, "image");
  EXPECT_FALSE(contact::gpu_device().name.empty());
}
