#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/scene/description.h"
#include "palpate/scene/study.h"

/// A study's tasks: scenes x integrators x tolerances or steps x swept values x seeds, in this order, the
/// last the fastest.  The same file and scenes give the same list on every machine.
namespace palpate::study {

/// What a study's scene is called, and where and what it is.
struct StudyScene {
  std::string name;  ///< as the study says it
  std::string path;  ///< absolute
  std::string text;
};

/// One run.  list_tasks() says which, settle() what follows from its scene.
struct Task {
  std::size_t index = 0;  ///< from 0
  std::size_t scene = 0;  ///< in Plan::scenes
  std::string integrator;
  std::vector<std::string> overrides;  ///< of the scene, as for `--set`
  /// value of each varied column, as it was chosen: "seed", "body.0.youngs_modulus_pa", ...
  std::vector<std::pair<std::string, std::string>> varied;

  // by settle()
  bool settled = false;
  std::string key;           ///< of its result: a file's name; empty where it is refused
  std::string refused;       ///< why the scene cannot be run so; empty: it can
  std::string rtol, step_s;  ///< what the method goes by; empty: the other one
  int threads = 1;           ///< that it works on
};

struct Plan {
  scene::StudySpec spec;  ///< its path absolute
  std::vector<StudyScene> scenes;
  std::vector<Task> tasks;
  std::string key;  ///< of the whole list: it changes with the study, a scene, or this palpate
};

/// What the caller knows and this part does not.
struct PlanHelp {
  /// path of a scene by the name of one that comes with palpate  @throws Error with the nearest name
  std::function<std::string(const std::string& name)> find_scene;
  /// called before a result gets its key, where mesh files may still have to be made
  std::function<void(const scene::Description&)> prepare = {};
};

/// Every task, its scene not yet looked at: a list of a million takes a second.
/// @throws Error for names that are unknown, integrators in a scene without bodies, more than a million tasks
Plan list_tasks(const scene::StudySpec& spec, const PlanHelp& help);

/// Loads the task's scene with its overrides.  A scene that refuses them is a result too (Task::refused).
void settle(const Plan& plan, Task& task, const PlanHelp& help);

/// Settles every task.
/// @throws Error with the scene's own message where one scene refuses every task: a key is misspelt
void settle_all(Plan& plan, const PlanHelp& help);

/// "0-3,7" as indices, ascending.  @throws Error for bad text and for indices that the plan has not
std::vector<std::size_t> indices_of(const std::string& text, std::size_t tasks);
/// The other way round.  @pre ascending
std::string text_of(const std::vector<std::size_t>& indices);

}  // namespace palpate::study
