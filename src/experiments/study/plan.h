#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/scene/description.h"
#include "scene/study.h"

/// Tasks of a study: scenes x integrators x tolerances or steps x swept values x seeds, in this order, with
/// the last varying fastest.  The same file and scenes give the same list on every machine.
namespace palpate::study {

/// Scene of a study.
struct StudyScene {
  std::string name;  ///< Name as in the study.
  std::string path;  ///< Absolute path of its file.
  std::string text;  ///< Content of its file.
};

/// Run of a study.  list_tasks() sets its choices, settle() the values that follow from its scene.
struct Task {
  std::size_t index = 0;  ///< Index in Plan::tasks.
  std::size_t scene = 0;  ///< Index in Plan::scenes.
  std::string integrator;
  std::vector<std::string> overrides;  ///< Overrides of the scene, as for `--set`.
  /// Value of each varied column, as specified: "seed", "body.0.youngs_modulus_pa", ...
  std::vector<std::pair<std::string, std::string>> varied;

  // Set by settle().
  bool settled = false;
  std::string key;           ///< Key of its result; empty where it is rejected.
  std::string refused;       ///< Reason why the scene rejects the overrides; empty: it accepts them.
  std::string rtol, step_s;  ///< Setting that controls the method; the other one is empty.
  int threads = 1;           ///< Number of threads that it uses.
};

/// Study with its list of tasks.
struct Plan {
  scene::StudySpec spec;  ///< With an absolute path.
  std::vector<StudyScene> scenes;
  std::vector<Task> tasks;
  /// Hash of the whole list: it changes with the study, a scene, or the version of palpate.
  std::string key;
};

/// Callbacks for information that this part lacks.
struct PlanHelp {
  /// Returns the path of a shipped scene by its name.  @throws Error with the nearest name
  std::function<std::string(const std::string& name)> find_scene;
  /// Called before a result gets its key; generates mesh files that are missing.
  std::function<void(const scene::Description&)> prepare = {};
};

/// Lists all tasks without loading their scenes: a million tasks take a second.
/// @throws Error for unknown names, integrators in a scene without bodies, and more than a million tasks
Plan list_tasks(const scene::StudySpec& spec, const PlanHelp& help);

/// Loads the task's scene with its overrides, and sets the remaining members.  A scene that rejects them is a
/// result as well (Task::refused).
void settle(const Plan& plan, Task& task, const PlanHelp& help);

/// Settles every task.
/// @throws Error with the scene's message where a scene rejects all of its tasks: a key is misspelt
void settle_all(Plan& plan, const PlanHelp& help);

}  // namespace palpate::study
