#include <gtest/gtest.h>

#include <filesystem>

#include "core/counters.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "temporary_folder.h"

/// A body whose mesh file is a model: contact uses its skin if the scene specifies it, and only then.
namespace {

using namespace palpate;
using small_scenes::held_block;

/// The block of small_scenes.h as a model, with its boundary, subdivided, as its skin: the same shape with
/// many more points.
LayeredModel block_model(bool with_skin) {
  LayeredModel model;
  model.name = "block";
  model.tets = mesh::box(Vec3(0.04, 0.04, 0.02), {4, 4, 2});
  if (!with_skin) return model;
  model.skin = mesh::box_surface(Vec3(0.04, 0.04, 0.02), {64, 64, 8});
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  return model;
}

struct ModelOnDisk {
  TemporaryFolder folder;
  std::string path;
  explicit ModelOnDisk(const LayeredModel& model, const std::string& name = "block.h5")
      : path((folder / name).string()) {
    store::write_model(path, {model, {}});
  }
};

scene::Description block_from(const std::string& path, bool skin) {
  scene::Description d = held_block();
  d.bodies[0].mesh = {};
  d.bodies[0].mesh.file = path;
  d.bodies[0].skin = skin;
  return d;
}

/// Adds a fixed ball that presses from above, `depth` [m] deep.
scene::Description under_a_ball(scene::Description d, double depth) {
  ObstacleSpec ball;
  ball.name = "ball";
  ball.type = "sphere";
  ball.shape["radius_m"] = 0.015;
  ball.shape["position_m"] = Vec3(0.001, 0.002, 0.02 + 0.015 - depth);
  d.obstacles.push_back(ball);
  ContactSpec contact;
  contact.first = "block";
  contact.second = "ball";
  contact.method = "analytic";
  contact.stiffness_pa_m = 1e7;
  d.contacts.push_back(contact);
  return d;
}

/// Upward force of the undeformed block on the ball [N].
double pressing(const scene::Description& d) {
  const auto world = loop::assemble(d);
  world->contact->refresh(world->state.view());
  double up = 0.0;
  for (const contact::ContactSample& sample : world->contact->samples()) {
    EXPECT_EQ(sample.a.count, d.bodies[0].skin ? 4 : 1);
    up -= 1e7 * std::max(0.0, -sample.gap) * sample.area * sample.normal.z();
  }
  return up;
}

TEST(Skin, OnlyASceneThatNamesItHasOne) {
  const ModelOnDisk file(block_model(true));
  counters::reset();
  const auto plain = loop::assemble(block_from(file.path, false));
  EXPECT_FALSE(plain->bodies[0].skin.has_value());
  EXPECT_EQ(counters::counter("loop.skin"), 0);
  const auto skinned = loop::assemble(block_from(file.path, true));
  ASSERT_TRUE(skinned->bodies[0].skin.has_value());
  EXPECT_EQ(counters::counter("loop.skin"), 1);
  EXPECT_EQ(plain->bodies[0].rest.nodes, skinned->bodies[0].rest.nodes);
  EXPECT_GT(skinned->bodies[0].surface_faces().cols(), 10 * plain->bodies[0].surface_faces().cols());
}

// The skin lies in the block's flat faces, so that both describe the same body; the skin's 0.6 mm resolve the
// dent of radius 4.9 mm, which the nodes' 10 mm miss. The force is k times the overlap's volume, pi d^2 (3R -
// d)/3, except that depth, area and force are measured along the ball's normal: a factor cos^3 of its angle,
// 1 - 3/2 <r^2>/R^2 weighted with the depth, <r^2> = a^2/3 = 2 R d/3. This gives 1 - d/R.
TEST(Skin, FindsWhatLiesBetweenTheNodes) {
  const ModelOnDisk file(block_model(true));
  constexpr double d = 0.0008, R = 0.015, exact = 1e7 * M_PI * d * d * (3.0 * R - d) / 3.0 * (1.0 - d / R);
  EXPECT_NEAR(pressing(under_a_ball(block_from(file.path, true), d)) / exact, 1.0, 0.005);
  EXPECT_GT(std::abs(pressing(under_a_ball(block_from(file.path, false), d)) / exact - 1.0), 0.2);
}

TEST(Skin, CarriesTheContactThroughARun) {
  const ModelOnDisk file(block_model(true));
  scene::Description d = under_a_ball(block_from(file.path, true), 0.0008);
  d.duration_s = 0.2;
  const auto world = loop::assemble(d);
  EXPECT_TRUE(loop::run(*world, {}).status.ok());
  const double deepest =
      world->bodies[0].surface_points(world->positions(world->bodies[0])).row(2).minCoeff();
  EXPECT_GT(deepest, -1e-9) << "nothing went through the floor";
  int pressed = 0;
  for (const contact::ContactSample& sample : world->contact->samples()) pressed += sample.gap < 0.0;
  EXPECT_GT(pressed, 20);
}

TEST(Skin, ScalesWithItsMesh) {
  const ModelOnDisk file(block_model(true));
  scene::Description d = block_from(file.path, true);
  d.bodies[0].mesh.scale = 0.5;
  d.bodies[0].attachments.clear();
  d.bodies[0].position_m = Vec3::Zero();
  const auto world = loop::assemble(d);
  const loop::Body& body = world->bodies[0];
  const Points points = body.surface_points(world->positions(body));
  EXPECT_LT((points - body.skin->rest.vertices).norm(), 1e-12);
  EXPECT_NEAR(points.row(0).maxCoeff(), 0.01, 1e-12);
}

void expect_refused(const scene::Description& d, const std::vector<std::string>& words) {
  try {
    loop::assemble(d);
    ADD_FAILURE() << "not refused";
  } catch (const Error& e) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

TEST(Skin, WhatAModelDoesNotHaveIsRefused) {
  const ModelOnDisk bare(block_model(false), "bare.h5");
  expect_refused(block_from(bare.path, true), {"block", "skin = true", "bare.h5", "palpate model"});
}

TEST(Skin, RegionsOfItsModelAct) {
  LayeredModel stiff = block_model(true);
  stiff.regions.push_back({"core", {0, 1}, 10.0, 1.0});
  const ModelOnDisk file(stiff, "stiff.h5");
  const auto world = loop::assemble(block_from(file.path, true));
  ASSERT_EQ(world->bodies[0].term->materials().size(), 2u);
  EXPECT_DOUBLE_EQ(world->bodies[0].term->materials()[1].youngs_modulus,
                   10.0 * world->bodies[0].term->materials()[0].youngs_modulus);
}

}  // namespace
