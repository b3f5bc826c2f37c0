#include "cli/stability_options.h"

#include <CLI/CLI.hpp>

#include "cli/option_checks.h"
#include "cli/other_program.h"

namespace palpate::cli {
namespace {

constexpr const char* kStabilityExamples = R"(Examples:
  palpate stability --jobs 2
  palpate stability --row youngs-modulus --integrator cvode-bdf --cells
  palpate stability --slow --seeds 100 -o out/stability
  palpate stability --haptic press-ball --device-mass-kg 0.1 --delay-ticks 1

After Ctrl-C or a crash the same command continues where it stopped (DIR/results.db).
Writes stability.csv, stability.json and report.html with the heat map; haptic: z_width.csv and report.html
with a chart. Exit status 0 if every cell agrees with theory; haptic: if the passive range lies within the
stable one; else 1.)";

void add_matrix_options(CLI::App& command, StabilityArguments& arguments) {
  command.add_option("--row", arguments.rows, "only this row; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command
      .add_option("--integrator", arguments.integrators, "only this integrator; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command.add_flag("--slow", arguments.slow, "also run the rows that take minutes");
  command.add_flag("--cells", arguments.cells,
                   "print every cell with its figure, not only the unexpected ones");
  command.add_option("--seeds", arguments.seeds, "random starts of the squashed and scattered bodies")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command.add_option("--jobs", arguments.jobs, "number of parallel processes")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command
      .add_option("--limit-s", arguments.limit_s,
                  "limit of the CPU time per cell; ten times as much in the slow rows [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command.add_option("-o,--output", arguments.folder, "folder for the results; default out/stability")
      ->type_name("DIR");
  CLI::Option* fresh = command.add_flag("--fresh", arguments.fresh,
                                        "start anew instead of keeping the results of earlier calls");
  add_array_options(command, arguments.array)->excludes(fresh);
}

void add_haptic_options(CLI::App& command, StabilityArguments& arguments) {
  CLI::Option* haptic = command.add_flag(
      "--haptic", arguments.haptic,
      "instead: largest wall stiffness that the loop of device, coupling and tool of a scene can render, by "
      "passivity, by its exact linear map, and by simulation");
  command.add_option("SCENE", arguments.scene.scene, std::string("haptic: ") + kSceneHelp);
  command.add_option("--set", arguments.scene.overrides, "haptic: change one value of the scene, KEY=VALUE")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->needs(haptic);
  command
      .add_option("--device-mass-kg", arguments.device_mass_kg,
                  "haptic: apparent mass of the device at its handle; default: the scene's, else 0.045")
      ->check(CLI::Range(1e-4, 1e3))
      ->needs(haptic);
  command
      .add_option("--device-damping-n-s-m", arguments.device_damping_n_s_m,
                  "haptic: viscous friction of the device, without which no wall is passive; default: the "
                  "scene's if it has a hand, else 0.1")
      ->check(CLI::Range(0.0, 1e3))
      ->needs(haptic);
  command
      .add_option("--delay-ticks", arguments.delay_ticks,
                  "haptic: delay from a sample to its force; default: the scene's, else 0")
      ->check(CLI::Range(0, 100))
      ->needs(haptic);
  command
      .add_option("--contact-stiffness-n-m", arguments.contact_stiffness_n_m,
                  "haptic: smallest and largest contact stiffness at the tool; default: estimated")
      ->type_name("LEAST GREATEST")
      ->expected(2)
      ->needs(haptic);
}

/// Refuses options of the matrix with --haptic, and the reverse.
void check_haptic(const StabilityArguments& arguments) {
  if (arguments.haptic && arguments.scene.scene.empty()) throw CLI::RequiredError("--haptic: SCENE");
  // checked after options with typing errors are reported: the word after such an option is no scene
  if (!arguments.haptic && !arguments.scene.scene.empty()) throw CLI::RequiresError("SCENE", "--haptic");
  if (arguments.haptic && !(arguments.rows.empty() && arguments.integrators.empty()))
    throw CLI::ExcludesError("--haptic", "--row and --integrator");
  if (arguments.haptic && (arguments.array.slurm || !arguments.array.tasks.empty()))
    throw CLI::ExcludesError("--haptic", "--slurm and --task");
}

}  // namespace

void add_stability(CLI::App& app, std::function<void(const std::shared_ptr<StabilityArguments>&)> then) {
  CLI::App* command = app.add_subcommand(std::string(kStability.command), kStability.summary);
  auto arguments = std::make_shared<StabilityArguments>();
  add_matrix_options(*command, *arguments);
  add_haptic_options(*command, *arguments);
  command->footer(kStabilityExamples);
  command->callback([arguments, then = std::move(then)] {
    check_haptic(*arguments);
    then(arguments);
  });
}

}  // namespace palpate::cli
