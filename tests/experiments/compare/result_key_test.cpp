#include "loop/result_key.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "experiments/compare/scenes.h"
#include "temporary_folder.h"

using namespace palpate;

namespace {

TEST(ResultKey, LeavesOutWhatIsComparedWithWhat) {
  EXPECT_EQ(
      loop::without_compare("a = 1\n[compare]\nx = 2\n[[compare.ladder]]\ny = [\n[1]]\n[body]\nz = 3\n"),
      "a = 1\n[1]]\n[body]\nz = 3\n");
  EXPECT_EQ(loop::without_compare("[comparer]\nx = 2\n"), "[comparer]\nx = 2\n");
  const std::string with_text = "name = \"\"\"\n[compare]\n\"\"\"\n";
  EXPECT_EQ(loop::without_compare(with_text), with_text);
}

TEST(ResultKey, FollowsTheScenesTextAndNotItsLadders) {
  const auto key = [](const scene::Description& d) { return loop::result_key(d, "x"); };
  const std::string one = key(compare_scenes::block(""));
  EXPECT_EQ(one, key(compare_scenes::block(compare_scenes::kLadders)));
  EXPECT_NE(one, key(compare_scenes::block("", "block", 2e4)));
  EXPECT_NE(one, loop::result_key(compare_scenes::block(""), "y"));
  auto shorter = compare_scenes::block("");
  shorter.compare.duration_s = 0.01;
  EXPECT_NE(one, key(shorter));
}

TEST(ResultKey, FollowsTheBytesOfMeshFiles) {
  const TemporaryFolder folder;
  auto d = compare_scenes::block("");
  d.path = (folder / "scene.toml").string();
  d.bodies[0].mesh.file = "body.node";
  const auto put = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
  put("body.node", "1");
  put("body.ele", "1");
  const std::string one = loop::result_key(d, "");
  EXPECT_EQ(one, loop::result_key(d, ""));
  put("body.ele", "2");
  EXPECT_NE(one, loop::result_key(d, ""));
}

TEST(ResultKey, FollowsTheBytesOfRecordings) {
  const TemporaryFolder folder;
  auto d = compare_scenes::tool_only();
  d.path = (folder / "scene.toml").string();
  d.device->file = "poses.csv";
  const auto put = [&](const char* text) { std::ofstream(folder / "poses.csv") << text; };
  put("1");
  const std::string one = loop::result_key(d, "");
  EXPECT_EQ(one, loop::result_key(d, ""));
  put("2");
  EXPECT_NE(one, loop::result_key(d, ""));
}

}  // namespace
