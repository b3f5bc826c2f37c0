#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/program.h"
#include "cli/scene_of.h"
#include "cli/stability_options.h"

/// The commands: one function each, one file each.  Each returns the exit status; Error means that the input
/// is at fault.
namespace palpate::cli {

class MissingOutputs;

struct RunArguments {
  SceneArguments scene;
  std::string folder;       ///< empty: out/NAME
  double duration_s = 0.0;  ///< 0: the scene's
  bool picture = false, report = false, trace = false, real_time = false;
  bool contact_picture = false, frames = false;
  double frames_per_s = 0.0;           ///< of simulated time; 0: as the scene records
  std::string movie;                   ///< file; empty: none
  double fps = 0.0, slow = 1.0;        ///< of the movie as it is played; 0: 25, or what the loop allows
  std::string size;                    ///< of frames and movie, "640x480"; empty: the default
  std::string shade = "displacement";  ///< of picture, frames and movie; or "stress", "penetration"
  std::string passivity = "off";       ///< or "observe", "control"
  bool against_monolithic = false;     ///< repeat it as one system, and print the distance
  double checkpoint_every_s = 0.0;     ///< simulated time between checkpoints; 0: none
};
int run(const RunArguments& arguments);
/// Runs as a part of another command, which prints and closes what is missing.
int run(const RunArguments& arguments, MissingOutputs& missing);

struct ResumeArguments {
  std::string run;  ///< folder of a run with checkpoints
};
int resume(const ResumeArguments& arguments);

struct ReplayArguments {
  std::string run;                     ///< folder of a run
  std::vector<std::string> overrides;  ///< of its scene
  std::string integrator;              ///< instead of its own; empty: its own
  std::string folder;                  ///< empty: out/replay-NAME
  bool changes() const { return !overrides.empty() || !integrator.empty(); }
};
int replay(const ReplayArguments& arguments);

struct MovieArguments {
  std::string run;                     ///< folder of a run
  std::string file;                    ///< empty: movie.png in it
  double fps = 0.0, slow = 1.0;        ///< as it is played; 0: 25, or what was recorded
  std::string size;                    ///< "640x480"; empty: the default
  std::string shade = "displacement";  ///< or "stress"
};
int movie(const MovieArguments& arguments);

struct ExportArguments {
  std::string run;             ///< folder of a run, or a file of states
  std::string to;              ///< "vtu", "obj", "ply", "csv" or "gltf"
  std::string folder;          ///< empty: one named after the format, beside the states
  std::string body;            ///< only this one, a tool or a bone; empty: all
  std::optional<double> at_s;  ///< only the state nearest to this time
  std::optional<int> step;     ///< only this state
  int every = 1;               ///< each Nth of all states
  bool no_skin = false;        ///< surfaces of the tetrahedra instead of skins
};
int export_run(const ExportArguments& arguments);

struct DiffArguments {
  std::string reference, other;  ///< folders of runs
};
int diff(const DiffArguments& arguments);

struct CompareArguments {
  std::vector<std::string> scenes;
  std::vector<std::string> overrides;  ///< of every scene
  std::string folder;
  std::vector<std::string> integrators;  ///< names, or labels of ladders; empty: every one
  bool all = false;                      ///< all others beside those named
  int repeats = 3, jobs = 0;             ///< jobs = 0: what is timed runs alone
  double limit_s = 10.0, reference_limit_s = 120.0;
  double duration_s = 0.0;
  std::string linear_solver = "cholmod";  ///< of all; "best": each method's fastest; "named": the scene's
  bool fresh = false;                     ///< forget what an earlier study left in the folder
  bool haptic = false;                    ///< what a hand feels against one system, of one scene
};
int compare(const CompareArguments& arguments);
int compare_haptic(const CompareArguments& arguments);
int compare(const CompareArguments& arguments, MissingOutputs& missing);

struct ModesArguments {
  SceneArguments scene;
  std::string folder;  ///< empty: out/modes-NAME
  int count = 12;
  bool picture = false;
};
int modes(const ModesArguments& arguments);

int stability_haptic(const StabilityArguments& arguments);
inline constexpr double kHapticDuration = 4.0;  ///< of a simulation [s]

struct StudyArguments {
  std::string study;          ///< STUDY.toml
  std::string folder;         ///< empty: out/study-NAME
  int jobs = 0;               ///< tasks side by side; 0: as many as there are cores for their threads
  bool dry_run = false;       ///< print the tasks alone
  bool merge = false;         ///< make the table of the results that there are, run nothing
  bool fresh = false;         ///< forget the results that an earlier call left in the folder
  std::string tasks;          ///< only these, and no table: "0-3,7"; empty: all
  std::string plan;           ///< key that the list of tasks must have; empty: any
  bool slurm = false;         ///< as an array job
  std::string slurm_options;  ///< of sbatch
  int chunk = 1;              ///< tasks of an element of the array, at least
  bool no_wait = false;       ///< submit alone
};
int study(const StudyArguments& arguments);

struct ReportArguments {
  std::vector<std::string> folders;
  std::string file;  ///< empty: report.html, in the folder where there is one
};
int report(const ReportArguments& arguments);

struct InspectArguments {
  SceneArguments scene;
};
int inspect(const InspectArguments& arguments);

struct ListArguments {
  std::string what;
  bool markdown = false;  ///< as a page of docs/: keys.md, names.md
};
int list(const ListArguments& arguments);

struct HelpArguments {
  std::string topic;                  ///< empty: which there are
  bool markdown = false;              ///< the page as it is written
  std::vector<std::string> commands;  ///< names that an unknown topic may have meant
};
int help(const HelpArguments& arguments);
bool is_help_topic(const std::string& name);

struct DemoArguments {
  std::string folder = "out/demo";
};
int demo(const DemoArguments& arguments);

/// Parses palpate's command line.
/// @throws Error for an invalid line
Invocation parse(int argc, char** argv);

}  // namespace palpate::cli
