#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/counters.h"
#include "loop/scene_checks.h"
#include "loop/small_scenes.h"
#include "loop/tool_instance.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"

using namespace palpate;
using namespace palpate::small_scenes;
using namespace palpate::scene_checks;

namespace {

void expect_refused(const scene::Description& d, const std::vector<std::string>& parts) {
  const std::string message = refusal(d);
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << message << "\n lacks: " << part;
}

TEST(Assemble, NamesThatNoRegistryKnowsAreRefusedWithTheNearest) {
  scene::Description d = held_block();
  d.integrator.name = "cvode-bfd";
  expect_refused(d, {"integrator", "cvode-bfd", "cvode-bdf"});
  d = held_block();
  d.integrator.linear_solver = "cholmud";
  expect_refused(d, {"cholmud", "cholmod"});
}

TEST(Assemble, MaterialNamesTheConstitutiveLaw) {
  scene::Description d = held_block();
  d.bodies[0].law = "stable-neo-hookean";
  expect_refused(d, {"body \"block\"", "unknown", "law", "stable-neo-hookean", "stable_neo_hookean"});
  d.bodies[0].law = "stable_neo_hookean";
  d.bodies[0].tangent = fem::Tangent::kWarped;
  expect_refused(d, {"body \"block\"", "warped", "stable_neo_hookean", "use \"exact\" or \"projected\""});
  d.bodies[0].tangent = fem::Tangent::kExact;
  d.bodies[0].volumetric = Volumetric::kNodal;
  d.bodies[0].poissons_ratio = 0.2;  // no share is left for the averages; "nodal" is reported all the same
  expect_refused(d, {"body \"block\"", "volumetric", "stable_neo_hookean", "use \"element\""});
}

// A message names the key even where the working folder has a file named like the message's first words.
TEST(Assemble, LocatesErrorsWhateverFilesThereAre) {
  scene::Description d = held_block();
  d.path = "block.toml";
  d.bodies[0].law = "no-such-law";
  const std::string message = refusal(d), words = "body \"block\"";
  ASSERT_TRUE(message.starts_with("block.toml")) << message;
  ASSERT_NE(message.find(words + ":"), std::string::npos) << message;
  const std::filesystem::path before = std::filesystem::current_path(),
                              folder = testing::TempDir() + "named-like-a-message";
  std::filesystem::create_directories(folder);
  std::filesystem::current_path(folder);
  std::ofstream(words) << "no mesh";
  EXPECT_EQ(refusal(d), message);
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
}

// A block that sags by a tenth under its weight: other methods find the same equilibrium of one law, and
// another law has another equilibrium.
TEST(Assemble, EveryKindOfIntegratorRunsEveryMaterial) {
  double sag[2][3];
  int law = 0;
  for (const char* material : {"corotational", "stable_neo_hookean"}) {
    int method = 0;
    for (const char* integrator : {"linearly-implicit-euler", "cvode-bdf", "kinsol-static"}) {
      scene::Description d = held_block();
      d.gravity_m_s2 = Vec3(0, 0, -100.0);
      d.bodies[0].law = material;
      d.bodies[0].youngs_modulus_pa = 5e3;
      d.bodies[0].stiffness_damping_s = 2e-2;
      d.integrator.name = integrator;
      d.duration_s = 2.0;
      if (std::string(integrator) == "cvode-bdf") {
        d.integrator.step_s = {};
        d.integrator.rtol = 1e-5;
      }
      const auto world = loop::assemble(d);
      const auto result = loop::run(*world, {});
      ASSERT_TRUE(result.status.ok()) << material << ", " << integrator;
      sag[law][method++] = world->state.q()(Eigen::seq(2, Eigen::last, 3)).maxCoeff();
    }
    ++law;
  }
  for (int l = 0; l < 2; ++l)
    for (int m = 0; m < 2; ++m) EXPECT_NEAR(sag[l][m], sag[l][2], 1e-6) << l << ", " << m;
  EXPECT_GT(std::abs(sag[0][2] - sag[1][2]), 1e-5);
  EXPECT_LT(sag[0][2], 0.0195);
}

TEST(Assemble, AttachmentsThatHoldNothingOrOverlapAreRefused) {
  scene::Description d = held_block();
  d.bodies[0].attachments[0].box_min_m = d.bodies[0].attachments[0].box_max_m = Vec3(5, 5, 5);
  expect_refused(d, {"block", "contains no node", "5"});
  d = held_block();
  d.bodies[0].attachments.push_back(d.bodies[0].attachments[0]);
  expect_refused(
      d, {"scene: body \"block\": attachment 2 overlaps attachment 1", "the node at [", ", 0] m along x"});
}

#ifdef PALPATE_HAS_TOOL
TEST(Assemble, ContactsThatCannotBeMadeAreRefusedWithARemedy) {
  scene::Description d = pressed_block(0.0);
  d.contacts[0].first = "blok";
  expect_refused(d, {"blok"});
  d = pressed_block(0.0);
  d.contacts[0].method = "vertex";
  expect_refused(d, {"vertex", "does not exist"});
  d.contacts[0].method = "pixel";
  expect_refused(d, {"pixel", "use \"image\""});
  d = pressed_block(0.0);
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "ball";
  d.tool->mesh.radius_m = 0.01;
  d.tool->inertia_kg_m2 = Vec3::Constant(1e-5);
  d.contacts[0].method = "analytic";
  expect_refused(d, {"shape", "auto"});
  d = pressed_block(0.0);
  d.contacts[0].second = "block";
  d.contacts[0].method = "analytic";
  expect_refused(d, {"self-contact needs method = \"distance\"", "use method = \"auto\""});
}
#endif

TEST(Assemble, WhatASceneDoesNotNameIsNotMade) {
  counters::reset();
  scene::Description d = held_block();
  const auto world = loop::assemble(d);
  EXPECT_TRUE(loop::run(*world, {}).status.ok());
  EXPECT_EQ(world->contact, nullptr);
  EXPECT_TRUE(world->tools.empty());
  for (const char* part :
       {"contact.force", "loop.condenser", "loop.skin", "proxy.region_finder", "tool.simbody_system",
        "gl.context", "store.run_file", "render.picture", "integrate.cvode-bdf"})
    EXPECT_EQ(counters::counter(part), 0) << part;
  EXPECT_EQ(counters::counter("integrate.linearly-implicit-euler"), 1) << "the counters count";
}

#ifdef PALPATE_HAS_TOOL
TEST(Assemble, WhatASceneNamesIsMadeOnce) {
  counters::reset();
  const auto world = loop::assemble(pressed_block(0.001));
  EXPECT_TRUE(loop::run(*world, {}).status.ok());
  EXPECT_EQ(counters::counter("contact.force"), 1);
  EXPECT_EQ(counters::counter("tool.simbody_system"), 1);
  EXPECT_EQ(counters::counter("gl.context"), 0) << "an exact sphere needs no image";
}
#endif

}  // namespace
