#include "session/run_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace palpate::session {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kScene = "scene.toml", kSummary = "summary.json";
constexpr std::string_view kNames[] = {"run.vtkhdf", "run.xdmf",    "force.csv",     "haptic.h5",
                                       "bones.csv",  "energy.csv",  "trace.csv",     "clock.csv",
                                       "depth.png",  "contact.png", "checkpoint.h5", "picture.png",
                                       kScene,       kSummary,      "report.html"};

/// Returns whether a run with these hands writes a file of that name.
bool is_of_a_run(const std::string& name, const std::vector<scene::Hand>& hands) {
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames) ||
         std::any_of(hands.begin(), hands.end(), [&](const scene::Hand& hand) {
           return hand.tool_key != "tool" && (name == fmt::format("force-{}.csv", hand.name) ||
                                              name == fmt::format("haptic-{}.h5", hand.name));
         });
}

}  // namespace

std::vector<std::string> run_files(const scene::Description& description, const std::string& folder) {
  const std::vector<scene::Hand> hands = scene::hands_of(description);
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string name = entry.path().filename().string();
        entry.is_regular_file() && is_of_a_run(name, hands))
      out.push_back(name);
  std::sort(out.begin(), out.end());
  return out;
}

void remove_run_files(const scene::Description& description, const std::string& folder) {
  for (const std::string& name : run_files(description, folder)) {
    if (name == kScene || name == kSummary) continue;
    const fs::path path = fs::path(folder) / name;
    std::error_code error;
    fs::remove(path, error);
    if (error) fail("{}: file of an earlier run cannot be removed: {}", path.string(), error.message());
  }
}

void refuse_own_input(const scene::Description& description, const std::string& folder) {
  const fs::path scene(description.path);
  const std::vector<scene::Hand> hands = scene::hands_of(description);
  const auto refuse = [&](const fs::path& input, const char* what) {
    std::error_code none;
    if (is_of_a_run(input.filename().string(), hands) &&
        fs::equivalent(input.parent_path() / ".", folder, none))
      fail("{}: is {}, and the run would overwrite it; choose another folder with -o DIR", input.string(),
           what);
  };
  refuse(fs::absolute(scene), "the scene of this run");
  for (const scene::Hand& hand : hands)
    if (!hand.device->file.empty())
      refuse(fs::absolute(scene.parent_path() / hand.device->file), "the recording that the hand replays");
}

}  // namespace palpate::session
