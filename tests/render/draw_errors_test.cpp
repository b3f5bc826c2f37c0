#include <gtest/gtest.h>

#include <functional>

#include "palpate/core/error.h"
#include "render/scene.h"
#include "render/shapes.h"

using namespace palpate;

namespace {

/// Returns the message for a valid scene after `spoil` has made it invalid.
std::string message_of(const std::function<void(render::Scene&, render::Options&)>& seed_defect) {
  render::Scene scene;
  scene.surfaces.push_back(cube_surface());
  scene.surfaces[0].name = "cube";
  render::Options options;
  seed_defect(scene, options);
  try {
    render::draw(scene, options);
  } catch (const Error& e) { return e.what(); }
  return "no error";
}

testing::AssertionResult says(const std::string& part,
                              const std::function<void(render::Scene&, render::Options&)>& seed_defect) {
  const std::string message = message_of(seed_defect);
  return (message.find(part) != std::string::npos ? testing::AssertionSuccess() : testing::AssertionFailure())
         << message;
}

}  // namespace

TEST(DrawErrors, NameTheSurfaceAndTheValue) {
  EXPECT_TRUE(says("surface \"cube\": a face refers to point 8 of 8",
                   [](auto& scene, auto&) { scene.surfaces[0].faces(0, 0) = 8; }));
  EXPECT_TRUE(says("surface \"cube\": a face refers to point -1 of 8",
                   [](auto& scene, auto&) { scene.surfaces[0].faces(0, 0) = -1; }));
  EXPECT_TRUE(says("surface \"cube\": a position is not finite",
                   [](auto& scene, auto&) { scene.surfaces[0].points(1, 2) = std::nan(""); }));
  EXPECT_TRUE(says("surface \"cube\": 3 values for 8 points",
                   [](auto& scene, auto&) { scene.surfaces[0].values = VecX::Zero(3); }));
  EXPECT_TRUE(says("nothing to show", [](auto& scene, auto&) { scene.surfaces.clear(); }));
  EXPECT_TRUE(says("8 x 900 pixels", [](auto&, auto& options) { options.width = 8; }));
  EXPECT_TRUE(says("supersampling = 0", [](auto&, auto& options) { options.supersampling = 0; }));
}

TEST(SavePng, NamesThePathThatCannotBeWritten) {
  try {
    render::save_png(render::Picture(16, 16, {}), "/nowhere/picture.png");
    FAIL() << "a folder that is not there was written to";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("/nowhere/picture.png: the picture cannot be written"),
              std::string::npos);
  }
}
