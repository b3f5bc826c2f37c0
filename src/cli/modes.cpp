#include "loop/modes.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/program.h"
#include "cli/scene_of.h"
#include "commands.h"
#include "palpate/core/error.h"
#include "render/available.h"
#include "render/scene.h"
#include "report/table.h"
#include "scene_options.h"
#include "store/csv.h"
#include "store/folder_lock.h"

namespace palpate::cli {
namespace {

struct ModesArguments {
  SceneArguments scene;
  std::string folder;  ///< Output folder; empty: out/modes-NAME
  int count = 12;
  bool picture = false;
};

void print_modes(const modes::Modes& modes) {
  std::vector<std::vector<std::string>> rows;
  for (int j = 0; j < modes.count(); ++j)
    rows.push_back({std::to_string(j + 1), fmt::format("{:.6g}", modes.frequency_hz(j)),
                    fmt::format("{:.6g}", modes.omega(j)), fmt::format("{:.1e}", modes.residuals[j]),
                    modes.omega_squared[j] < 0.0
                        ? fmt::format("unstable: w^2 = {:.4g}", modes.omega_squared[j])
                    : modes.omega_squared[j] == 0.0 ? "rigid"
                                                    : ""});
  fmt::print("{}", report::format_table({"mode", "frequency [Hz]", "omega [rad/s]", "residual", ""}, rows));
}

void write_table(const modes::Modes& modes, const std::string& path) {
  store::CsvWriter csv(path, {"mode", "frequency_hz", "omega_rad_s", "omega_squared_1_s2", "residual"});
  for (int j = 0; j < modes.count(); ++j)
    csv.row(std::vector<double>{j + 1.0, modes.frequency_hz(j), modes.omega(j), modes.omega_squared[j],
                                modes.residuals[j]});
  csv.close();
}

constexpr int kColumns = 3, kPictured = 6;

/// Draws the first elastic modes side by side, each coloured by its displacement.
void draw_modes(const loop::World& world, const modes::Modes& modes, const std::string& path) {
  std::vector<int> pictured;
  for (int j = 0; j < modes.count() && pictured.size() < kPictured; ++j)
    if (modes.omega_squared[j] != 0.0) pictured.push_back(j);
  if (pictured.empty())
    fail("--picture: the first {} modes are rigid motions; request more modes (--count)", modes.count());
  Eigen::AlignedBox3d box;
  for (const loop::Body& body : world.bodies)
    for (const auto& x : body.placed.colwise()) box.extend(Vec3(x));
  const Vec3 room = box.sizes() + 0.3 * box.sizes().maxCoeff() * Vec3::Ones();
  render::Scene scene;
  std::vector<std::string> frequencies;
  for (std::size_t i = 0; i < pictured.size(); ++i) {
    const Vec3 offset(static_cast<double>(i % kColumns) * room.x(), 0.0,
                      -static_cast<double>(i / kColumns) * room.z());
    for (const loop::Body& body : world.bodies) {
      const Points now = displaced(world, body, modes, pictured[i]), rest = world.positions(body);
      const VecX moved =
          (now - rest).colwise().norm().transpose() / (loop::kModeAmplitude * box.sizes().maxCoeff());
      render::Surface surface{body.name, body.surface_points(now), body.surface_faces(),
                              body.surface_values(moved)};
      surface.points.colwise() += offset;
      scene.surfaces.push_back(surface);
    }
    frequencies.push_back(fmt::format("{}: {:.3g} Hz", pictured[i] + 1, modes.frequency_hz(pictured[i])));
  }
  scene.scale.label = "displacement";
  scene.scale.unit = "of the maximum";
  scene.title = fmt::format("modes of {}", world.description.name);
  scene.subtitle = fmt::format("{}", fmt::join(frequencies, "   "));
  render::Options options;
  options.width = 1600;
  render::save_png(render::draw(scene, options), path);
}

int modes(const ModesArguments& arguments) {
  if (arguments.picture) render::check_available();
  const scene::Description description = scene_of(arguments.scene);
  const std::unique_ptr<loop::World> world = loop::assemble(description);
  const modes::Modes found = loop::find_modes(*world, arguments.count);
  print_modes(found);
  const std::string folder =
      arguments.folder.empty() ? default_folder("modes-" + short_name(description)) : arguments.folder;
  const store::FolderLock mine(folder);
  const std::filesystem::path base(folder);
  MissingOutputs missing;
  write_table(found, (base / "modes.csv").string());
  loop::write_modes(*world, found, (base / "modes.vtkhdf").string());
  if (arguments.picture) {
    std::error_code none;
    std::filesystem::remove(base / "modes.png",
                            none);  // a file of an earlier run would pass for one of this run
    try {
      draw_modes(*world, found, (base / "modes.png").string());
    } catch (const Error& e) { missing.add("picture " + (base / "modes.png").string(), e.what()); }
  }
  fmt::print("in {}: modes.csv, modes.vtkhdf, modes.xdmf{}\n", folder,
             arguments.picture && missing.empty() ? ", modes.png" : "");
  if (!found.converged)
    fail(
        "the modes did not converge (see their residuals); improve the elements of the mesh, or request "
        "fewer modes (--count)");
  return missing.close(0);
}

}  // namespace

void add_modes(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("modes", "compute frequencies and shapes of a scene's free vibrations");
  auto arguments = std::make_shared<ModesArguments>();
  add_scene(*command, arguments->scene, false);
  command->add_option("--count", arguments->count, "number of modes, from the lowest")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--picture", arguments->picture,
                    "also a picture of the first six non-rigid modes (modes.png)");
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/modes-SCENE")
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate modes cantilever
  palpate modes cantilever --count 20 --picture -o out/modes
  palpate modes press-ball --set body.0.youngs_modulus_pa=2e4

Solves K phi = w^2 M phi at the scene's start, without damping; a free body has six rigid motions of 0 Hz.
Writes modes.csv, and modes.vtkhdf, which ParaView opens as a time series of displaced shapes, with the mode's
number as time.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return modes(*arguments); };
    invocation.factorises = true;
  });
}

}  // namespace palpate::cli
