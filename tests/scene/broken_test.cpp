// Each broken scene is rejected at its location, with the value and a remedy.
#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "scene/scene_texts.h"

namespace {

struct Broken {
  const char* file;
  const char* location;  ///< LINE:COLUMN
  const char* message;
};

const Broken kCases[] = {
    {"attachment-box", "10:13",
     "body \"ball\": attachment[0]: box_max_m = -1 must not be below box_min_m = 0 along y"},
    {"attachment-nowhere", "8:1",
     "body \"ball\": attachment[0]: box_min_m is missing; select nodes by box_min_m and box_max_m, or by "
     "centre_m and radius_m"},
    {"attachment-to-unknown", "9:6",
     "body \"ball\": attachment[0]: no bone is called \"fermur\" (did you mean \"femur\"?)"},
    {"attachment-to-unknown-hand", "9:6",
     "body \"ball\": attachment[0]: no bone and no tool is called \"rigth\" (did you mean \"right\"?)"},
    {"attachment-to-unknown-tool", "9:6",
     "body \"ball\": attachment[0]: no bone and no tool is called \"tol\" (did you mean \"tool\"?)"},
    {"attachment-two-regions", "11:12",
     "body \"ball\": attachment[0]: a box and a sphere exclude each other; remove box_min_m and box_max_m, "
     "or centre_m and radius_m"},
    {"bone-carries-nothing", "8:1",
     "bone \"femur\": carries no nodes; give a body a [[body.attachment]] with to = \"femur\""},
    {"bone-fixed-mass", "14:11", "bone \"femur\": mass_kg does not apply to a fixed bone; remove it"},
    {"bone-inertia", "13:17",
     "bone \"femur\": inertia_kg_m2 = [1e-06, 1e-06, 3e-06] is not the inertia of a rigid body: none may be "
     "larger than the sum of the other two"},
    {"bone-shape", "10:1", "bone \"femur\": length_m is missing: shape = \"capsule\" needs it"},
    {"change-order", "12:10",
     "body \"ball\": change: time_s = 0.4 must be greater than the previous one (0.5)"},
    {"bone-without-mass", "10:1",
     "bone \"femur\": mass_kg (or density_kg_m3 of its shape) is missing; a bone that does not move needs "
     "fixed = true or a [[bone.keyframe]]"},
    {"skeleton-hinge", "8:1",
     "body \"limb\": joint of \"hand\": axis is missing: a hinge needs an axis in the body frame, for "
     "example [1.0, 0.0, 0.0]"},
    {"skeleton-scripted-type", "10:8",
     "body \"limb\": joint of \"hand\": type does not apply to a joint with keyframes; remove it"},
    {"skeleton-twice", "11:8",
     "body \"limb\": joint of \"hand\": this bone has two joint tables; remove one"},
    {"skeleton-without-model", "8:1",
     "body \"limb\": skeleton: needs mesh = { file = \"MODEL.h5\" }, a model file with bones; `palpate model "
     "human -o human.h5` makes one"},
    {"contact-with-itself", "10:10",
     "contact between \"ball\" and \"ball\": contact of a body with itself requires method = \"distance\", "
     "not \"image\"; write \"distance\", or remove the key that selects the other"},
    {"contact-with-nothing", "12:20",
     "contact between \"ball\" and \"flor\": nothing is called \"flor\" (did you mean \"floor\"?)"},
    {"contact-without-tool", "9:12",
     "contact between \"tool\" and \"ball\": \"tool\" is given, but the scene has no [tool]"},
    {"grasp-without-contact", "6:16",
     "tool: grasp_switch = 0, but no [[contact]] is between the tool and a soft body, so there is nothing to "
     "grasp; add one, or remove the key"},
    {"device-without-tool", "8:1",
     "device: a device needs something to move: add [tool], or remove [device]"},
    {"exchange-period", "9:21",
     "exchange: exchange_period_s = 0.0105 must be a multiple of the tool's tick of 0.001 s; use 0.01 or "
     "0.011"},
    {"hand-of-a-name", "14:8", "hand \"tool\": name \"tool\" is reserved for [tool]; choose another"},
    {"hand-ticks", "14:10",
     "exchange: exchange_period_s = 0.01 must be a multiple of the tool's tick of 0.003 s; use 0.009 or "
     "0.012"},
    {"hand-without-tool", "8:1",
     "hand \"left\": [[hand]] adds further hands to that of [tool] and [device], which are missing; add "
     "them"},
    {"hands-that-meet", "15:10",
     "contact between \"tool\" and \"left\": contact of two tools requires method = \"distance\", not "
     "\"image\"; write \"distance\", or remove the key that selects the other"},
    {"idle-key", "11:10",
     "body \"ball\": mesh: size_m does not apply to generator = \"ball\", which takes radius_m, "
     "element_size_m, grading; remove it (used by box, tet)"},
    {"inertia", "5:17",
     "tool: inertia_kg_m2 = [1e-06, 1e-06, 3e-06] is not the inertia of a rigid body: all must be positive "
     "and none larger than the sum of the other two"},
    {"keyframe-order", "9:10",
     "device: keyframe[1]: time_s = 0.25 must come after 0.5, the previous keyframe; put keyframes in order "
     "of time"},
    {"ladder-order", "11:8",
     "compare: ladder[0]: rtol must decrease from the coarsest to the finest, but 0.01 comes after 0.001"},
    {"missing-stiffness", "5:1", "body \"ball\": youngs_modulus_pa is missing and has no default"},
    {"latency", "10:17", "exchange: latency_ticks = 101 is longer than 10 exchange periods, 100 ticks"},
    {"latency-without-ticks", "10:17",
     "exchange: latency_ticks applies only to a tool that steps separately: scheme = \"partitioned\" and "
     "[tool]"},
    {"misspelt-key", "6:1",
     "body \"ball\": unknown key \"young_modulus_pa\" (did you mean \"youngs_modulus_pa\"?)"},
    {"nan", "4:27", "scene: gravity_m_s2 = [0, 0, nan] must be a finite number"},
    {"nothing", "1:1", "there is nothing to simulate: add a [[body]], or a [tool] with a [device]"},
    {"poissons-ratio", "7:18",
     "body \"ball\": poissons_ratio = 0.5 must lie in (-1, 0.5); use 0.49 for nearly incompressible tissue"},
    {"refresh", "10:21",
     "exchange: contact_refresh_s = 0.003 must divide exchange_period_s = 0.01 evenly; use 0.0025"},
    {"short-vector", "4:16", "scene: gravity_m_s2 = [0, -9.81] must be three numbers, [x, y, z]"},
    {"shortest-refresh", "11:22",
     "exchange: shortest_refresh_s = 0.02 must be less than contact_refresh_s = 0.01: otherwise \"substep\" "
     "has no effect"},
    {"single-brackets", "4:1", "body must be a list of tables: write [[body]] with double brackets"},
    {"skin-of-generator", "8:8",
     "body \"ball\": skin = true needs mesh = { file = \"MODEL.h5\" }, a model file; `palpate model SURFACE "
     "-o MODEL.h5` makes one"},
    {"springs-between-tools", "15:10",
     "contact between \"tool\" and \"left\": spring = \"per_point\" does not apply to two tools, whose "
     "contact is at nearest points that represent areas, not at vertices; remove it"},
    {"syntax", "3:14", "not valid TOML: "},
    {"tool-without-device", "4:1", "tool: a tool needs a device: add [device] with [[device.keyframe]]"},
    {"two-of-a-name", "10:8",
     "obstacle \"ball\": name \"ball\" is already taken; bodies, bones, obstacles and hands need distinct "
     "names"},
    {"unknown-choice", "7:11", "body \"ball\": tangent = \"exakt\" is not known (did you mean \"exact\"?)"},
    {"unknown-table", "4:2", "unknown key \"integrater\" (did you mean \"integrator\"?)"},
    {"wrong-type", "3:14", "scene: duration_s = \"one second\" must be a number"},
};

std::string message_of(const std::string& path) {
  try {
    palpate::loop::load(path);
  } catch (const palpate::Error& e) { return e.what(); }
  return "no error";
}

TEST(BrokenScene, IsRefusedAtItsLocation) {
  for (const Broken& one : kCases) {
    const std::string path = scene_texts::kBroken + "/" + one.file + ".toml";
    const std::string expected = path + ":" + one.location + ": " + one.message, message = message_of(path);
    if (std::string(one.file) == "syntax")
      EXPECT_TRUE(message.starts_with(expected)) << message;
    else
      EXPECT_EQ(message, expected);
  }
}

TEST(BrokenScene, EveryFileIsListed) {
  EXPECT_EQ(scene_texts::in_folder(scene_texts::kBroken).size(), std::size(kCases));
}

TEST(BrokenScene, AFileThatIsNotThereIsNamed) {
  EXPECT_EQ(
      message_of("/no/such/scene.toml"),
      "/no/such/scene.toml: no such scene file; `palpate list scenes` shows those that come with palpate");
  EXPECT_EQ(message_of("/tmp"), "/tmp: is a folder; give a scene file (.toml) in it");
}

}  // namespace
