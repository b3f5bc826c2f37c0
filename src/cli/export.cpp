// Export of a finished run to files that other programs open.
#include "export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "cli/stop.h"
#include "core/time_text.h"
#include "export_animation.h"
#include "export_draft.h"
#include "export_tables.h"
#include "palpate/core/error.h"
#include "palpate/store/run_file.h"
#include "recorded_surfaces.h"
#include "store/vtu.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

/// Selection to export: the run, and its selected states and parts.
struct Chosen {
  const store::RunReader& run;
  std::string run_file, stem;
  std::vector<int> steps, parts;
  bool skins = true;

  std::string name(int step, const char* ending) const {
    return fmt::format("{}_{:04}.{}", stem, step, ending);
  }
  std::string title(int step) const {
    return fmt::format("{}, t = {} s, by palpate", run.info().scene_name,
                       run.times_s()[static_cast<std::size_t>(step)]);
  }
};

/// Returns the run file; for a folder, the file that `palpate run` writes into it.
std::string run_file_of(const std::string& argument) {
  if (fs::is_regular_file(argument)) return argument;
  if (!fs::is_directory(argument))
    fail("{}: no such folder; give the folder of a run, as in `palpate export out/press-ball --to vtu`",
         argument);
  const fs::path file = fs::path(argument) / "run.vtkhdf";
  if (!fs::exists(file))
    fail("{}: no such file; a run writes it if the scene sets record.states = true", file.string());
  return file.string();
}

/// Returns the recorded state nearest to a time.
int step_at(const store::RunReader& run, double time) {
  const std::vector<double>& times = run.times_s();
  const double slack = 1e-9 * std::max(std::abs(times.front()), std::abs(times.back()));
  if (!(time >= times.front() - slack && time <= times.back() + slack))
    fail("--at {}: the states of the run cover {} to {} s", time_text(time), time_text(times.front()),
         time_text(times.back()));
  const auto nearest = std::min_element(times.begin(), times.end(), [time](double a, double b) {
    return std::abs(a - time) < std::abs(b - time);
  });
  return static_cast<int>(nearest - times.begin());
}

std::vector<int> chosen_steps(const store::RunReader& run, const ExportArguments& arguments) {
  if (run.steps() == 0)
    fail("{}: the run recorded no states; set record.states = true and run the scene again", arguments.run);
  if (arguments.at_s) return {step_at(run, *arguments.at_s)};
  if (arguments.step) {
    if (*arguments.step < 0 || *arguments.step >= run.steps())
      fail("--step {}: the run has the states 0 to {}", *arguments.step, run.steps() - 1);
    return {*arguments.step};
  }
  std::vector<int> out;
  for (int step = 0; step < run.steps(); step += arguments.every) out.push_back(step);
  return out;
}

std::vector<int> chosen_parts(const store::RunReader& run, const std::string& name) {
  std::vector<int> out;
  std::vector<std::string> known;
  for (std::size_t i = 0; i < run.parts().size(); ++i) {
    known.push_back(run.parts()[i].name);
    if (name.empty() || name == known.back()) out.push_back(static_cast<int>(i));
  }
  if (out.empty()) fail("--body: the run has no \"{}\"{}", name, suggestion(name, known));
  return out;
}

/// Calls `write` for each step, until Ctrl-C.
void for_each_step(const Chosen& chosen, const std::function<void(int)>& write) {
  for (const int step : chosen.steps) {
    if (stop_flag().load()) return;
    write(step);
  }
}

void export_vtu(const Chosen& chosen, ExportDraft& draft) {
  std::vector<std::pair<double, std::string>> files;
  for_each_step(chosen, [&](int step) {
    files.emplace_back(chosen.run.times_s()[static_cast<std::size_t>(step)], chosen.name(step, "vtu"));
    draft.write(files.back().second, store::vtu_of(chosen.run, step, chosen.parts));
  });
  draft.write(chosen.stem + ".pvd", store::pvd_of(files));
}

using SurfaceWriter = std::string (*)(const std::vector<store::SurfaceState>&, const std::string&);

void export_surfaces(const Chosen& chosen, ExportDraft& draft, const char* ending, SurfaceWriter writer) {
  const RecordedSurfaces surfaces(chosen.run, chosen.run_file, chosen.parts, chosen.skins);
  const double largest = surfaces.largest_displacement(chosen.steps);
  for_each_step(chosen, [&](int step) {
    draft.write(chosen.name(step, ending), writer(surfaces.at(step, largest), chosen.title(step)));
  });
}

void export_obj(const Chosen& chosen, ExportDraft& draft) {
  export_surfaces(chosen, draft, "obj", store::obj_of);
}

void export_ply(const Chosen& chosen, ExportDraft& draft) {
  export_surfaces(chosen, draft, "ply", store::ply_of);
}

void export_csv(const Chosen& chosen, ExportDraft& draft) {
  write_node_table(chosen.run, chosen.steps, chosen.parts, draft.path("nodes.csv"));
  for (const std::string& name : recorded_tables(chosen.run, chosen.run_file))
    fs::copy_file(fs::path(chosen.run_file).parent_path() / name, draft.path(name));
}

void export_gltf(const Chosen& chosen, ExportDraft& draft) {
  const RecordedSurfaces surfaces(chosen.run, chosen.run_file, chosen.parts, chosen.skins);
  const Animation animation = animated(chosen.run, surfaces, chosen.steps);
  if (animation.steps.size() < chosen.steps.size())
    fmt::print("exported {} of {} states: a .glb holds at most {} states and {} MiB of positions\n",
               animation.steps.size(), chosen.steps.size(), kMostKeyframes, kMostPositionBytes >> 20);
  if (!stop_flag().load()) draft.write(chosen.stem + ".glb", animation.glb);
}

struct Format {
  const char* name;
  void (*write)(const Chosen&, ExportDraft&);
};
constexpr Format kFormats[] = {{"vtu", export_vtu},
                               {"obj", export_obj},
                               {"ply", export_ply},
                               {"csv", export_csv},
                               {"gltf", export_gltf}};

const Format& format_of(const std::string& name) {
  std::vector<std::string> known;
  for (const Format& format : kFormats) {
    if (name == format.name) return format;
    known.emplace_back(format.name);
  }
  fail("--to: unknown \"{}\"{}", name, suggestion(name, known));
}

void print_files(const std::string& folder, const std::vector<std::string>& names) {
  if (names.size() <= 4)
    fmt::print("in {}: {}\n", folder, fmt::join(names, ", "));
  else
    fmt::print("in {}: {}, {} ... {}; {} files\n", folder, names[0], names[1], names.back(), names.size());
}

}  // namespace

int export_run(const ExportArguments& arguments) {
  const Format& format = format_of(arguments.to);
  const std::string run_file = run_file_of(arguments.run);
  const store::RunReader run(run_file);
  const Chosen chosen{run,
                      run_file,
                      fs::path(run_file).stem().string(),
                      chosen_steps(run, arguments),
                      chosen_parts(run, arguments.body),
                      !arguments.no_skin};
  const std::string folder =
      arguments.folder.empty() ? (fs::path(run_file).parent_path() / format.name).string() : arguments.folder;
  ExportDraft draft(folder);
  format.write(chosen, draft);
  if (stop_flag().load()) {
    fmt::print(stderr, "palpate: stopped; nothing was exported\n");
    return kExitStopped;
  }
  draft.commit();
  if (arguments.at_s)
    fmt::print("state {}, t = {:g} s\n", chosen.steps[0],
               run.times_s()[static_cast<std::size_t>(chosen.steps[0])]);
  print_files(folder, draft.names());
  return 0;
}

}  // namespace palpate::cli
