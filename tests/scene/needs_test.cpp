#include "scene/needs.h"

#include <gtest/gtest.h>

#include <map>

#include "palpate/loop/load.h"
#include "scene/scene_texts.h"

namespace {

std::map<std::string, bool> used(const std::string& scene, const std::vector<std::string>& overrides = {},
                                 const std::string& linear_solver = "cholmod") {
  std::map<std::string, bool> out;
  for (const auto& need : palpate::scene::needs(
           palpate::loop::load(scene_texts::kScenes + "/" + scene + ".toml", overrides), linear_solver)) {
    EXPECT_FALSE(need.why.empty()) << need.part;
    EXPECT_TRUE(out.emplace(need.part, need.used).second) << need.part << " is listed twice";
  }
  return out;
}

TEST(Needs, ASceneWithoutToolLeavesOutAllThatIsHaptic) {
  auto ball = used("falling-ball");
  EXPECT_TRUE(ball.at("fem") && ball.at("contact") && ball.at("tangent") && ball.at("linear solver") &&
              ball.at("run file"));
  for (const char* part :
       {"tool", "device", "exchange", "exchange thread", "gl", "contact plane", "force file", "friction",
        "fixed nodes", "compare", "skin", "proxies", "contact of a body with itself"})
    EXPECT_FALSE(ball.at(part)) << part;
  auto bar = used("cantilever");
  EXPECT_TRUE(bar.at("fixed nodes"));
  EXPECT_FALSE(bar.at("contact"));
}

TEST(Needs, AnExplicitMethodLeavesOutTangentAndSolver) {
  auto ball = used("falling-ball", {"integrator.name=rk4"}, "");
  EXPECT_TRUE(ball.at("fem"));
  EXPECT_FALSE(ball.at("tangent") || ball.at("linear solver"));
}

TEST(Needs, PressBall) {
  auto press = used("press-ball");
  for (const char* part :
       {"fem", "contact", "tool", "device", "exchange", "fixed nodes", "run file", "force file", "compare"})
    EXPECT_TRUE(press.at(part)) << part;
  EXPECT_FALSE(press.at("gl"));
  EXPECT_FALSE(press.at("gravity"));
  auto image = used("press-ball", {"contact.0.method=analytic", "contact.1.method=image"});
  EXPECT_TRUE(image.at("gl") && image.at("contact plane"));
  EXPECT_FALSE(image.at("nearest points"));
  auto near = used("press-ball", {});
  EXPECT_TRUE(near.at("nearest points"));
  EXPECT_FALSE(near.at("contact plane") || near.at("gl"));
  EXPECT_TRUE(used("touch-head", {"contact.0.method=image"}).at("proxies"));
  EXPECT_FALSE(used("touch-head").at("proxies"));
  auto quiet = used("press-ball", {"record.states=false", "record.forces=false"});
  EXPECT_FALSE(quiet.at("run file") || quiet.at("force file"));
}

}  // namespace
