#include "run_files.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kScene = "scene.toml", kSummary = "summary.json";
constexpr std::string_view kNames[] = {"run.vtkhdf", "run.xdmf",    "force.csv",     "haptic.h5",
                                       "bones.csv",  "energy.csv",  "trace.csv",     "clock.csv",
                                       "depth.png",  "contact.png", "checkpoint.h5", "picture.png",
                                       kScene,       kSummary,      "report.html"};
/// Of further hands: force-NAME.csv, haptic-NAME.h5.
constexpr std::pair<std::string_view, std::string_view> kPatterns[] = {{"force-", ".csv"},
                                                                       {"haptic-", ".h5"}};

bool is_of_a_run(const std::string& name) {
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames) ||
         std::any_of(std::begin(kPatterns), std::end(kPatterns), [&](const auto& pattern) {
           return name.starts_with(pattern.first) && name.ends_with(pattern.second);
         });
}

}  // namespace

std::vector<std::string> run_files(const std::string& folder) {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string name = entry.path().filename().string();
        entry.is_regular_file() && is_of_a_run(name))
      out.push_back(name);
  std::sort(out.begin(), out.end());
  return out;
}

void remove_run_files(const std::string& folder) {
  for (const std::string& name : run_files(folder)) {
    if (name == kScene || name == kSummary) continue;
    const fs::path path = fs::path(folder) / name;
    std::error_code error;
    fs::remove(path, error);
    if (error) fail("{}: of an earlier run, cannot be removed: {}", path.string(), error.message());
  }
}

void refuse_own_input(const scene::Description& description, const std::string& folder) {
  const fs::path scene(description.path);
  const auto refuse = [&](const fs::path& input, const char* what) {
    std::error_code none;
    if (is_of_a_run(input.filename().string()) && fs::equivalent(input.parent_path() / ".", folder, none))
      fail("{}: is {}, and the run would write its own over it; choose another folder with -o DIR",
           input.string(), what);
  };
  refuse(fs::absolute(scene), "the scene that is to run");
  for (const scene::Hand& hand : scene::hands_of(description))
    if (!hand.device->file.empty())
      refuse(fs::absolute(scene.parent_path() / hand.device->file), "the recording that the hand repeats");
}

}  // namespace palpate::cli
