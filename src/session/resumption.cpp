#include "session/resumption.h"

#include <fmt/format.h>

#include <filesystem>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "store/provenance.h"
#include "store/summary.h"

namespace palpate::session {

bool is_finished_run(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) fail("{}: no such folder; give the folder of a run", folder);
  const std::filesystem::path summary = std::filesystem::path(folder) / "summary.json";
  return std::filesystem::exists(summary) && store::read_summary(summary.string()).outcome == "finished";
}

Resumption read_resumption(const std::string& folder) {
  const std::string path = checkpoint_path(folder);
  if (!std::filesystem::exists(path))
    fail(
        "{}: no checkpoint; the run was started without --checkpoint-every, or ended before its first "
        "checkpoint; run the scene again",
        path);
  Resumption out{folder, {}, store::read_checkpoint(path), {}};
  out.from.archive = Archive(out.checkpoint.values, path);
  if (const std::string ours = store::full_version(); out.checkpoint.version != ours)
    fail(
        "{}: was written by palpate {}, but this is {}; a run can only be resumed by the same version. Use "
        "that version, or run the scene again",
        path, out.checkpoint.version, ours);
  out.from.archive("command", out.identity);
  return out;
}

scene::Description scene_to_resume(
    const Resumption& resumption,
    const std::function<scene::Description(const scene::SceneArguments&)>& load) {
  const std::string& text = resumption.checkpoint.scene_source;
  scene::SceneArguments scene = resumption.identity.options.scene;
  const bool has_file = !scene.scene.empty();
  scene.scene = resumption.identity.scene_path;
  if (!has_file) return loop::parse(text, scene.scene);
  if (!std::filesystem::exists(scene.scene))
    fail("{}: the scene of this run no longer exists; restore it, or start a new run", scene.scene);
  scene::Description description = load(scene);
  if (description.source != text)
    fail(
        "{}: the scene has changed since the run began, so the recorded data do not belong to it; restore "
        "the old scene, or run it again",
        scene.scene);
  return description;
}

std::vector<std::string> processor_differences(const Resumption& resumption) {
  std::vector<std::string> out;
  const auto compare = [&out](const char* what, const std::string& then, const std::string& now) {
    if (then != now)
      out.push_back(fmt::format(
          "the run began {} ({}, this is {}); it continues, but its results are not bitwise identical to "
          "those of an uninterrupted run",
          what, then, now));
  };
  compare("on another processor", resumption.identity.cpu, store::provenance().cpu);
  compare("with another instruction set", resumption.identity.instructions, instructions_in_use());
  return out;
}

}  // namespace palpate::session
