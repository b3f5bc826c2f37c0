#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "scene/scene_texts.h"

using palpate::loop::parse;
using palpate::scene::Description;

namespace {

Description with(const std::vector<std::string>& overrides) {
  return parse(scene_texts::kWhole, "whole.toml", overrides);
}

std::string refusal(const std::string& override_text) {
  try {
    with({override_text});
  } catch (const palpate::Error& e) { return e.what(); }
  return "accepted";
}

TEST(Override, ReplacesAddsAndReachesIntoLists) {
  EXPECT_EQ(with({"body.0.youngs_modulus_pa=1e5"}).bodies[0].youngs_modulus_pa, 1e5);
  EXPECT_EQ(with({" body.0.youngs_modulus_pa = 1e5 "}).bodies[0].youngs_modulus_pa, 1e5)
      << "blanks do no harm";
  EXPECT_EQ(with({"device.keyframe.1.position_m.2=0.5"}).device->keyframes[1].position_m[2], 0.5);
  EXPECT_EQ(with({"integrator.rtol=1e-6"}).integrator.rtol, 1e-6) << "the table was not there";
  EXPECT_FALSE(with({"record.states=false"}).record->states);
  EXPECT_EQ(with({"scene.gravity_m_s2=[0, 1, 2]"}).gravity_m_s2, palpate::Vec3(0, 1, 2));
  EXPECT_EQ(with({"integrator.rtol=1e-6", "integrator.rtol=1e-7"}).integrator.rtol, 1e-7)
      << "the last one counts";
}

TEST(Override, TakesBareWordsAsText) {
  EXPECT_EQ(with({"integrator.name=linearly-implicit-euler"}).integrator.name, "linearly-implicit-euler");
  EXPECT_EQ(with({"integrator.name=\"cvode-bdf\""}).integrator.name, "cvode-bdf");
  EXPECT_EQ(with({"scene.name=a.b-c_d"}).name, "a.b-c_d");
  EXPECT_NE(refusal("scene.name=/home/you/liver.msh").find("must not contain slashes"), std::string::npos)
      << "read as a path, refused as a name";
}

// A key that takes a text takes it without quotes, also where TOML would read a number, a truth value or a
// list.
TEST(Override, TakesAnyUnquotedValueAsTextWhereTheKeyDoes) {
  const auto options = [](const std::string& value) {
    return with({"device.type=plugin", "device.library=driver.so", "device.library_options=" + value})
        .device->library_options;
  };
  EXPECT_EQ(options("5005"), "5005");
  EXPECT_EQ(options("0.082"), "0.082");
  EXPECT_EQ(options("true"), "true");
  EXPECT_EQ(options("2026-12-01"), "2026-12-01");
  EXPECT_EQ(options("/dev/ttyUSB0, 115200 baud"), "/dev/ttyUSB0, 115200 baud");
  EXPECT_EQ(options("a=b"), "a=b");
  EXPECT_EQ(options("[1, 2]"), "[1, 2]");
  EXPECT_EQ(options("C:\\new \"x\""), "C:\\new \"x\"");
  EXPECT_EQ(options("\"5005\""), "5005") << "quotes are allowed";
  EXPECT_EQ(options("'5005'"), "5005");
  EXPECT_EQ(with({"scene.name=2026"}).name, "2026");
  EXPECT_EQ(refusal("device.library_options=\"5005"),
            "--set device.library_options=\"5005: `\"5005` is not a single TOML value; write a number, true, "
            "false, a word, [1, 2, 3] or \"text\"");
  EXPECT_EQ(refusal("body.0.youngs_modulus_pa=stiff"),
            "--set body.0.youngs_modulus_pa=stiff: body \"ball\": youngs_modulus_pa = \"stiff\" must be a "
            "number")
      << "a number remains one";
}

TEST(Override, ReachesTextsOfSeveralHands) {
  const std::vector<std::string> second = {
      "hand=[{ name = \"left\", tool = { shape = \"sphere\", radius_m = 0.01, mass_kg = 0.1, coupling = { "
      "stiffness_n_m = 100, damping_n_s_m = 1, rotational_stiffness_n_m_rad = 1, "
      "rotational_damping_n_m_s_rad = 0.01 } }, device = { type = \"plugin\", library = \"driver.so\" } }]",
      "hand.0.device.library_options=5005"};
  EXPECT_EQ(with(second).hands.at(0).device.library_options, "5005");
}

TEST(Override, IsNamedInErrors) {
  EXPECT_EQ(refusal("body.0.poissons_ratio=0.5"),
            "--set body.0.poissons_ratio=0.5: body \"ball\": poissons_ratio = 0.5 must lie in (-1, 0.5); use "
            "0.49 for nearly incompressible tissue");
  EXPECT_EQ(refusal("body.0.poisons_ratio=0.4"),
            "--set body.0.poisons_ratio=0.4: body \"ball\": unknown key \"poisons_ratio\" (did you mean "
            "\"poissons_ratio\"?)");
  EXPECT_EQ(refusal("integrater.rtol=1e-3"),
            "--set integrater.rtol=1e-3: unknown key \"integrater\" (did you mean \"integrator\"?)");
  EXPECT_EQ(refusal("contact.1.between=[\"ball\", \"tol\"]"),
            "--set contact.1.between=[\"ball\", \"tol\"]: contact between \"ball\" and \"tol\": nothing is "
            "called \"tol\" (did you mean \"tool\"?)");
  EXPECT_EQ(refusal("device.keyframe.1.time_s=0"),
            "--set device.keyframe.1.time_s=0: device: keyframe[1]: time_s = 0 must come after 0, the "
            "previous keyframe; put keyframes in order of time");
}

TEST(Override, ThatCannotBeAppliedSaysWhy) {
  EXPECT_EQ(refusal("tool.tick_s=1e-12"),
            "--set tool.tick_s=1e-12: exchange: tick_s = 1e-12 of the tool gives 1e+10 ticks per exchange "
            "period of 0.01 s, at most 1e+06 are possible; haptic devices use 0.001");
  EXPECT_EQ(refusal("body.0.youngs_modulus_pa"),
            "--set body.0.youngs_modulus_pa: must be PATH=VALUE, as in body.0.youngs_modulus_pa=1e5");
  EXPECT_EQ(refusal("=3"), "--set =3: must be PATH=VALUE, as in body.0.youngs_modulus_pa=1e5");
  EXPECT_EQ(refusal("body.1.youngs_modulus_pa=1e5"),
            "--set body.1.youngs_modulus_pa=1e5: \"1\" must be an index from 0 to 0");
  EXPECT_EQ(refusal("body.x.youngs_modulus_pa=1e5"),
            "--set body.x.youngs_modulus_pa=1e5: \"x\" must be an index from 0 to 0");
  EXPECT_EQ(refusal("bodi.0.name=a"),
            "--set bodi.0.name=a: the scene has no \"bodi\" (did you mean \"body\"?)");
  EXPECT_EQ(refusal("scene.name.x=1"), "--set scene.name.x=1: \"x\" is inside a value that is not a table");
  EXPECT_EQ(refusal("scene.name.x.y=1"),
            "--set scene.name.x.y=1: \"x\" is inside a value that is not a table");
  EXPECT_EQ(refusal("scene.duration_s=1 2"),
            "--set scene.duration_s=1 2: `1 2` is not a single TOML value; write a number, true, false, a "
            "word, [1, 2, 3] or \"text\"");
  EXPECT_EQ(refusal("scene.duration_s=1\nx=2"),
            "--set scene.duration_s=1\nx=2: `1\nx=2` is not a single TOML value; write a number, true, "
            "false, a word, [1, 2, 3] or \"text\"");
  EXPECT_NE(refusal("scene..x=1"), "accepted");
  EXPECT_NE(refusal("...=1"), "accepted");
}

/// The kept source is the scene as it ran: it parses to bitwise equal values.
TEST(Override, EffectiveSourceParsesToTheSame) {
  const double odd = 0.1 * 0.7;
  const Description d = with({fmt::format("integrator.rtol={}", odd),
                              "body.0.youngs_modulus_pa=123456.789e-7", "integrator.name=cvode-bdf"});
  EXPECT_NE(d.source.find("# --set integrator.name=cvode-bdf"), std::string::npos);
  const Description again = parse(d.source, "again.toml");
  EXPECT_EQ(again.integrator.rtol, odd);
  EXPECT_EQ(again.bodies[0].youngs_modulus_pa, 123456.789e-7);
  EXPECT_EQ(again.device->keyframes[1].position_m, d.device->keyframes[1].position_m);
  EXPECT_EQ(again.contacts.size(), d.contacts.size());
  EXPECT_EQ(again.source, d.source) << "nothing more to change";
}

}  // namespace
