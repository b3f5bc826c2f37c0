#pragma once
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace scene_texts {

inline const std::string kScenes = PALPATE_SOURCE_DIR "/scenes";
inline const std::string kBroken = PALPATE_SOURCE_DIR "/tests/scene/broken";

inline std::string read(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// The .toml files of a folder, sorted.
inline std::vector<std::string> in_folder(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".toml") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// A small scene with one object of every kind.
inline const char* const kWhole = R"(
[scene]
name = "whole"
duration_s = 0.5
gravity_m_s2 = [0, 0, -9.81]
[[body]]
name = "ball"
youngs_modulus_pa = 1e4
mesh = { generator = "ball", radius_m = 0.03, element_size_m = 0.01 }
[[body.attachment]]
box_min_m = [0, 0, 0]
box_max_m = [1, 1, 1]
[[obstacle]]
name = "floor"
type = "plane"
[[contact]]
between = ["floor", "ball"]
[[contact]]
between = ["ball", "tool"]
[tool]
mass_kg = 0.05
[device]
[[device.keyframe]]
time_s = 0.0
[[device.keyframe]]
time_s = 0.1
position_m = [0, 0, 0.01]
[record]
)";

}  // namespace scene_texts
