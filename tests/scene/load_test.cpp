#include "palpate/loop/load.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "scene/contact_sides.h"
#include "scene/needs.h"
#include "scene/scene_texts.h"

using palpate::Vec3;
using palpate::loop::parse;
using palpate::scene::Description;

namespace {

TEST(Load, EverySceneThatComesWithPalpate) {
  const auto paths = scene_texts::in_folder(scene_texts::kScenes);
  EXPECT_GE(paths.size(), 5u);
  for (const std::string& path : paths) {
    const Description d = palpate::loop::load(path);
    EXPECT_EQ(d.path, path);
    EXPECT_EQ(d.name, std::filesystem::path(path).stem()) << path;
    EXPECT_EQ(d.source, scene_texts::read(path)) << "with its comments";
  }
}

TEST(Load, PressBallAsWritten) {
  const Description d = palpate::loop::load(scene_texts::kScenes + "/press-ball.toml");
  ASSERT_EQ(d.bodies.size(), 1u);
  const palpate::SoftBodySpec& ball = d.bodies[0];
  EXPECT_EQ(ball.youngs_modulus_pa, 1e4);
  EXPECT_EQ(ball.mesh.generator, "ball");
  EXPECT_EQ(ball.mesh.radius_m, 0.03);
  ASSERT_EQ(ball.attachments.size(), 2u);
  EXPECT_EQ(ball.attachments[0].axes, "xyz");
  EXPECT_EQ(ball.attachments[1].axes, "xy");
  ASSERT_EQ(d.contacts.size(), 2u);
  EXPECT_EQ(d.contacts[1].second, "tool");
  ASSERT_TRUE(d.tool && d.device && d.record);
  EXPECT_EQ(d.tool->coupling.stiffness_n_m, 300.0);
  EXPECT_EQ(d.tool->coupling.rotational_damping_n_m_s_rad, 1e-3);
  ASSERT_EQ(d.device->keyframes.size(), 4u);
  EXPECT_EQ(d.device->keyframes[1].position_m, Vec3(0, 0, 0.072));
  EXPECT_EQ(d.device->keyframes[1].interpolation, Interpolation::kMinimumJerk);
  ASSERT_EQ(d.compare.ladders.size(), 6u);
  EXPECT_EQ(d.compare.ladders[1].integrator, "linearly-implicit-euler");
  EXPECT_TRUE(d.compare.ladders[1].values.empty()) << "down to where the reference cannot tell errors";
  EXPECT_EQ(d.compare.ladders[2].label, "cvode-bdf, root finding");
}

TEST(Load, HandsHaveToolsAndDevicesOfTheirOwn) {
  const Description d = palpate::loop::load(scene_texts::kScenes + "/two-hands.toml");
  ASSERT_EQ(d.hands.size(), 1u);
  EXPECT_EQ(d.hands[0].name, "left");
  EXPECT_EQ(d.hands[0].tool.position_m.x(), -d.tool->position_m.x());
  EXPECT_EQ(d.hands[0].device.keyframes.size(), 4u);
  EXPECT_EQ(d.contacts[2].second, "left");
  const auto hands = palpate::scene::hands_of(d);
  ASSERT_EQ(hands.size(), 2u);
  EXPECT_EQ(hands[0].name, "tool");
  EXPECT_EQ(palpate::scene::tool_named(d, "left"), &d.hands[0].tool);
  EXPECT_EQ(palpate::scene::tool_named(d, "right"), nullptr);
  // the kinds of further hands are checked like those of the first
  const std::string path = scene_texts::kScenes + "/two-hands.toml";
  for (const auto& [override, said] : {std::pair("hand.0.device.type=robot", "robot"),
                                       {"hand.0.tool.shape=cube", "shape"},
                                       {"hand.0.device.port=3", "port"},
                                       {"hand.0.tool.grasp_switch=40", "grasp_switch"}})
    try {
      palpate::loop::load(path, {override});
      ADD_FAILURE() << override;
    } catch (const palpate::Error& e) {
      EXPECT_NE(std::string(e.what()).find(said), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("hand"), std::string::npos) << e.what();
    }
}

TEST(Load, BonesAndWhatIsTiedToThem) {
  const std::string text = std::string(scene_texts::kWhole) + R"(
[[bone]]
name = "femur"
shape = "capsule"
radius_m = 0.005
length_m = 0.03
density_kg_m3 = 1800
[[bone]]
name = "tibia"
fixed = true
[[body]]
name = "leg"
youngs_modulus_pa = 1e4
mesh = { generator = "ball", radius_m = 0.03, element_size_m = 0.01 }
[[body.attachment]]
to = "femur"
[[body.attachment]]
to = "tibia"
centre_m = [0, 0, 0.03]
radius_m = 0.01
)";
  const Description d = parse(text, "bones.toml");
  ASSERT_EQ(d.bones.size(), 2u);
  EXPECT_EQ(d.bones[0].density_kg_m3, 1800.0);
  EXPECT_TRUE(d.bones[0].gravity);
  EXPECT_TRUE(d.bones[1].fixed);
  EXPECT_EQ(d.bodies[0].attachments[0].region, Selection::kBox);
  EXPECT_EQ(d.bodies[1].attachments[0].region, Selection::kShape)
      << "the bone's own, where nothing else is given";
  EXPECT_EQ(d.bodies[1].attachments[1].region, Selection::kSphere);
  EXPECT_EQ(d.bodies[1].attachments[1].to, "tibia");
  EXPECT_THROW(parse(text, "bones.toml", {"body.1.attachment.1.axes=\"xy\""}), palpate::Error);
  EXPECT_THROW(parse(text, "bones.toml", {"bone.0.mass_kg=1"}), palpate::Error) << "mass and density";
  const Description mono = parse(text, "bones.toml",
                                 {"exchange.scheme=\"monolithic\"", "body.1.attachment.0.to=\"tool\"",
                                  "body.1.attachment.0.radius_m=0.01", "body.1.attachment.0.centre_m=[0,0,0]",
                                  "body.0.attachment.0.to=\"femur\""});
  EXPECT_EQ(mono.bodies[1].attachments[0].to, "tool");
}

TEST(Load, DefaultsAndNormalOrder) {
  const Description d = parse(scene_texts::kWhole, "whole.toml");
  EXPECT_EQ(d.contacts[0].first, "ball") << "the soft body comes first, whatever the file says";
  EXPECT_EQ(d.contacts[0].second, "floor");
  EXPECT_EQ(d.gravity_m_s2, Vec3(0, 0, -9.81)) << "whole numbers are numbers";
  EXPECT_TRUE(d.record->states) << "an empty table is a table";
  const Description e = parse(scene_texts::kWhole, "whole.toml", {"exchange.exchange_period_s=0.02"});
  EXPECT_EQ(e.exchange.contact_refresh_s, 0.02) << "follows the exchange period where it is not given";
  const Description f = parse(scene_texts::kWhole, "whole.toml", {"obstacle.0.normal=[0, 3, 4]"});
  EXPECT_EQ(std::get<Vec3>(f.obstacles[0].shape.at("normal")), Vec3(0, 3, 4)) << "as given; of any length";
}

TEST(Load, AbsentTablesStayAbsent) {
  const Description d = palpate::loop::load(scene_texts::kScenes + "/falling-ball.toml");
  EXPECT_FALSE(d.tool);
  EXPECT_FALSE(d.device);
  EXPECT_TRUE(d.compare.ladders.empty());
}

TEST(Load, RegionsSayWhatDiffersFromTheBody) {
  const Description d =
      parse(scene_texts::kWhole, "whole.toml",
            {"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01, density_kg_m3 = 2e3}, "
             "{name = \"half\", box_min_m = [0, 0, 0], box_max_m = [1, 1, 1]}]",
             "body.0.change=[{time_s = 0.1, youngs_modulus_pa = 1e5}, {time_s = 0.1, youngs_modulus_pa = "
             "2e5, region = \"half\"}]"});
  ASSERT_EQ(d.bodies[0].regions.size(), 2u);
  EXPECT_EQ(d.bodies[0].regions[0].region, Selection::kSphere);
  EXPECT_EQ(d.bodies[0].regions[1].region, Selection::kBox);
  EXPECT_EQ(d.bodies[0].regions[0].density_kg_m3, 2e3);
  EXPECT_FALSE(d.bodies[0].regions[0].youngs_modulus_pa);
  EXPECT_EQ(d.bodies[0].changes[1].region, "half") << "a region that changes may start as the body is";
}

TEST(Load, TwoSoftBodiesHaveNoExactGaps) {
  const auto refusal = [](const std::string& more, const std::string& contact) -> std::string {
    try {
      parse(
          "[scene]\nname = \"pair\"\nduration_s = 1.0\n[[body]]\nname = \"a\"\nmesh = { generator = "
          "\"ball\", radius_m = 0.1, element_size_m = 0.05 }\nyoungs_modulus_pa = 1e4\n[[body]]\nname = "
          "\"b\"\nyoungs_modulus_pa = 1e4\n" +
              more + "[[contact]]\nbetween = [\"a\", \"b\"]\n" + contact,
          "pair.toml", {});
    } catch (const palpate::Error& e) { return e.what(); }
    return "accepted";
  };
  const std::string ball = "mesh = { generator = \"ball\", radius_m = 0.1, element_size_m = 0.05 }\n",
                    model = "mesh = { file = \"b.h5\" }\nskin = true\nproxies = true\n";
  EXPECT_EQ(refusal(ball, "method = \"image\"\n"), "accepted");
  EXPECT_EQ(refusal(ball, ""), "accepted");
  EXPECT_NE(refusal(ball, "method = \"analytic\"\n")
                .find("two soft bodies have no exact gaps: leave the method out, or write \"auto\""),
            std::string::npos);
  EXPECT_NE(refusal(ball, "method = \"image\"\n[[contact]]\nbetween = [\"b\", \"a\"]\nmethod = \"image\"\n")
                .find("this pair has two [[contact]] tables"),
            std::string::npos);
  EXPECT_NE(refusal(model, "method = \"image\"\n")
                .find("proxies = true is set for \"b\" alone; set it for both bodies or for neither"),
            std::string::npos);
}

TEST(Load, ABodyTouchesItself) {
  const auto refusal = [](const std::string& keys, const std::string& contact) -> std::string {
    try {
      const Description d = parse(
          "[scene]\nname = \"fist\"\nduration_s = 1.0\n[[obstacle]]\nname = \"floor\"\ntype = "
          "\"plane\"\n[[body]]\nname = \"hand\"\nyoungs_modulus_pa = 1e4\nmesh = { file = \"hand.h5\" }\n" +
              keys + "[[contact]]\n" + contact,
          "fist.toml", {});
      bool needed = false;
      for (const auto& need : palpate::scene::needs(d, "cholmod"))
        needed |= need.part == "contact of a body with itself" && need.used;
      EXPECT_TRUE(needed);
    } catch (const palpate::Error& e) { return e.what(); }
    return "accepted";
  };
  const std::string itself = "between = [\"hand\", \"hand\"]\n";
  EXPECT_EQ(refusal("", itself), "accepted");
  EXPECT_EQ(refusal("skin = true\n", itself), "accepted");
  for (const std::string method : {"analytic", "image"})
    EXPECT_NE(
        refusal("", itself + "method = \"" + method + "\"\n")
            .find("contact of a body with itself requires method = \"distance\", not \"" + method + "\""),
        std::string::npos)
        << refusal("", itself + "method = \"" + method + "\"\n");
  EXPECT_NE(refusal("", itself + "pixels = 128\n")
                .find("contact of a body with itself requires method = \"distance\""),
            std::string::npos);
  EXPECT_NE(refusal("", itself + "[[contact]]\n" + itself).find("this pair has two [[contact]] tables"),
            std::string::npos);
  EXPECT_NE(refusal("", "between = [\"floor\", \"floor\"]\n")
                .find("only a soft body may touch itself; give two different names"),
            std::string::npos);
}

// Bodies in their order, the tool, obstacles: independently of the order in the scene.
TEST(Load, SidesOfAContactAreInTheirOrder) {
  const auto sides = [](const std::string& between, const std::string& bodies) {
    const auto d = parse(scene_texts::kWhole + bodies, "whole.toml", {"contact.1.between=" + between});
    return d.contacts[1].first + " - " + d.contacts[1].second + ", " + d.contacts[1].method;
  };
  EXPECT_EQ(sides("[\"tool\", \"floor\"]", ""), "tool - floor, distance");
  EXPECT_EQ(sides("[\"floor\", \"tool\"]", ""), "tool - floor, distance");
  EXPECT_EQ(sides("[\"tool\", \"ball\"]", ""), "ball - tool, distance");
  const std::string another = R"(
[[body]]
name = "apple"
youngs_modulus_pa = 1e4
mesh = { generator = "ball", radius_m = 0.03, element_size_m = 0.01 }
)";
  EXPECT_EQ(sides("[\"apple\", \"ball\"]", another), "ball - apple, distance");
  EXPECT_EQ(sides("[\"ball\", \"apple\"]", another), "ball - apple, distance");
}

/// Changes to a scene, and the message with which it is refused.
const std::pair<std::vector<std::string>, const char*> kBadCombinations[] = {
    {{"body.0.mesh.file=\"a.msh\""}, "file and generator exclude each other"},
    {{"body.0.mesh={radius_m = 1.0}"}, "needs file = \"PATH\" or generator = \"ball\""},
    {{"body.0.mesh.generator=box"}, "size_m is missing: generator = \"box\" needs it"},
    {{"body.0.mesh.scale=2.0"}, "scale does not apply to generator = \"ball\""},
    {{"obstacle.0.radius_m=1.0"}, "radius_m does not apply to type = \"plane\""},
    {{"obstacle.0.type=sphere"}, "radius_m is missing: type = \"sphere\" needs it"},
    {{"obstacle.0.normal=[0,0,0]"}, "has no direction"},
    {{"obstacle.0.name=tool"}, "name \"tool\" is reserved for [tool]"},
    {{"body.0.name=\"a/b\""}, "must not contain slashes"},
    {{"contact.0.method=image"}, "an obstacle has exact gaps"},
    {{"contact.0.method=distance", "contact.0.pixels=128"}, "pixels does not apply to method = \"distance\""},
    {{"contact.1.quadrature_error=0.0"}, "quadrature_error = 0 must lie in [1e-06, 0.1]"},
    {{"contact.1.method=distance", "contact.1.pixels=128"}, "pixels does not apply to method = \"distance\""},
    {{"contact.1.method=distance", "contact.1.spring=per_point"}, "whose points represent areas"},
    {{"contact.0.pixels=128"}, "pixels does not apply to an obstacle, whose gaps are exact; remove it"},
    {{"contact.0.gaps=exact"}, "unknown key \"gaps\""},
    {{"contact.0.hunt_crossley_s_m=1.0"},
     "hunt_crossley_s_m does not apply to law = \"kelvin_voigt\", which takes damping_pa_s_m, "
     "damping_n_s_m; remove it (used by hunt_crossley)"},
    {{"contact.0.law=hunt_crossley", "contact.0.damping_pa_s_m=1.0"},
     "damping_pa_s_m does not apply to law = \"hunt_crossley\", which takes hunt_crossley_s_m; remove it "
     "(used by kelvin_voigt)"},
    {{"contact.1.between=[\"floor\", \"ball\"]"}, "this pair has two [[contact]] tables"},
    {{"contact.1.between=[\"floor\", \"tool\"]", "contact.1.method=image"}, "an obstacle has exact gaps"},
    {{"contact.1.between=[\"floor\", \"tool\"]", "contact.1.pixels=128"},
     "an obstacle, whose gaps are exact"},
    {{"contact.1.between=[\"floor\", \"tool\"]", "contact.1.spring=per_point"},
     "a tool with shape = \"sphere\", which has no vertices"},
    {{"contact.1.between=[\"tool\", \"tool\"]"},
     "only a soft body may touch itself; give two different names"},
    {{"obstacle=[{name = \"floor\", type = \"plane\"}, {name = \"wall\", type = \"plane\"}]",
      "contact.1.between=[\"wall\", \"floor\"]"},
     "obstacles do not move, so these two cannot touch; one of the two must be a soft body or the tool"},
    {{"contact.1.between=[\"ball\"]"}, "between must list two names, as in [\"ball\", \"floor\"], not 1"},
    {{"tool.shape=mesh"}, "needs a [tool.mesh]"},
    {{"tool.mesh.file=\"a.obj\""}, "mesh does not apply to shape = \"sphere\""},
    {{"tool.shape=mesh", "tool.mesh.file=\"a.obj\""}, "inertia_kg_m2 is missing"},
    {{"tool.shape=mesh", "tool.mesh.file=\"a.obj\"", "tool.inertia_kg_m2=[1,1,1]",
      "contact.1.method=analytic"},
     "needs a tool with shape = \"sphere\""},
    {{"device.keyframe=[]"}, "write [[keyframe]] with double brackets"},
    {{"compare.exchange_periods_s=[50.0, 0.01]"}, "exchange_periods_s = 50 is longer than the run"},
    {{"exchange.exchange_period_s=50.0"}, "exchange_period_s = 50 is longer than the run"},
    {{"obstacle.0.type=box"}, "size_m is missing: type = \"box\" needs it"},
    {{"obstacle.0.type=cylinder", "obstacle.0.radius_m=1.0"},
     "length_m is missing: type = \"cylinder\" needs it"},
    {{"compare.ladder=[{integrator = \"x\", rtol = [1e-3], step_s = [1e-3]}]"},
     "rtol and step_s exclude each other"},
    {{"tool.tick_s=0.003"},
     "exchange_period_s = 0.01 must be a multiple of the tool's tick of 0.003 s; use 0.009 or 0.012"},
    {{"exchange.scheme=monolith"}, "exchange: scheme = \"monolith\" is not known"},
    {{"integrator.max_order=2.5"}, "must be a whole number"},
    {{"tool.gravity=1"}, "must be true or false"},
    {{"contact.0.stiffness_pa_m=-1"}, "must be positive"},
    {{"contact.0.friction=inf"}, "must be a finite number"},
    {{"body.0.region=[{name = \"core\", youngs_modulus_pa = 1e5}]"},
     "region \"core\": box_min_m is missing: generator = \"ball\" defines no regions; select elements"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01}]"},
     "sets no material: give youngs_modulus_pa"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], youngs_modulus_pa = 1e5}]"},
     "region \"core\": radius_m is missing"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01, box_min_m = [0, 0, 0], "
      "youngs_modulus_pa = 1e5}]"},
     "a box and a sphere exclude each other"},
    {{"body.0.region=[{name = \"core\", box_min_m = [0, 0, 0], box_max_m = [1, -1, 1], youngs_modulus_pa = "
      "1e5}]"},
     "box_max_m = -1 must not be below box_min_m = 0 along y"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01, youngs_modulus_pa = 1e5}, "
      "{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.02, density_kg_m3 = 2e3}]"},
     "region \"core\": this region has two tables"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01, poissons_ratio = 0.5}]"},
     "poissons_ratio = 0.5 must lie in (-1, 0.5)"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01, youngs_modulus = 1e5}]"},
     "unknown key \"youngs_modulus\" (did you mean \"youngs_modulus_pa\"?)"},
    {{"body.0.change=[{time_s = 0.1, youngs_modulus_pa = 1e5, region = \"core\"}]"},
     "change: region = \"core\", but the body has no [[body.region]]"},
    {{"body.0.region=[{name = \"core\", centre_m = [0, 0, 0], radius_m = 0.01, density_kg_m3 = 2e3}]",
      "body.0.change=[{time_s = 0.1, youngs_modulus_pa = 1e5, region = \"cor\"}]"},
     "no [[body.region]] is called \"cor\" (did you mean \"core\"?)"},
    {{"body.0.change=[{time_s = 0.1, youngs_modulus_pa = 1e5}, {time_s = 0.1, youngs_modulus_pa = 2e5}]"},
     "time_s = 0.1 must be greater than the previous one (0.1): both change the same elements"},
    {{"record=true"}, "record must be one table: write [record]"},
};

/// Dependencies between two keys of one table; broken_test covers the locations.
TEST(Load, KeysThatExcludeOrNeedEachOther) {
  const auto refusal = [](const std::vector<std::string>& overrides) -> std::string {
    try {
      parse(scene_texts::kWhole, "whole.toml", overrides);
    } catch (const palpate::Error& e) { return e.what(); }
    return "accepted";
  };
  EXPECT_EQ(refusal({}), "accepted");
  for (const auto& [overrides, expected] : kBadCombinations) {
    const std::string message = refusal(overrides);
    EXPECT_NE(message.find(expected), std::string::npos) << overrides.front() << "\n  " << message;
  }
}

}  // namespace
