#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "cli/option_checks.h"
#include "cli/other_program.h"
#include "cli/program.h"
#include "commands.h"
#include "loop/new_scene.h"
#include "loop/registries.h"
#include "model_cache.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "store/atomic_file.h"
#include "store/model_file.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

struct NewArguments {
  std::string mesh, output, unit, up = "z", material = "liver";
  double size = 0.0;         ///< Largest extent of the body [m]; 0: by the unit
  double tool_radius = 0.0;  ///< [m]; 0: by rule
  int tetrahedra = 0;        ///< Number for a surface that is filled; 0: the default
  bool force = false;
};

/// Returns the part of a file name that a scene and a body may have as name.
std::string name_of(const fs::path& file) {
  std::string out = file.stem().string();
  for (char& letter : out)
    if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-' && letter != '_') letter = '-';
  return out.empty() || out == "tool" ? "body" : out;
}

/// Returns the command line without paths, for the comment at the head of the scene.
std::string command_text(const NewArguments& a) {
  std::string out = "palpate new " + fs::path(a.mesh).filename().string();
  const auto add = [&](const char* option, const std::string& value) {
    out += fmt::format(" {} {}", option, value);
  };
  if (!a.unit.empty()) add("--unit", a.unit);
  if (a.size > 0.0) add("--size-m", fmt::format("{:g}", a.size));
  if (a.up != "z") add("--up", a.up);
  add("--material", a.material);
  if (a.tool_radius > 0.0) add("--tool-radius-m", fmt::format("{:g}", a.tool_radius));
  if (a.tetrahedra > 0) add("--tetrahedra", std::to_string(a.tetrahedra));
  return out;
}

/// Returns whether palpate reads the tetrahedra of that file itself.
bool has_native_tetrahedra(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".msh" || ending == ".node" || ending == ".ele" || ending == ".h5";
}

/// Completes the choice for a file of tetrahedra, used as it is. @throws Error if it cannot be read
void use_tetrahedra(const NewArguments& a, const fs::path& scene, loop::NewScene& choice) {
  const fs::path mesh = fs::absolute(a.mesh);
  // relative where the mesh lies in the scene's folder or below: the two can then be moved together
  const fs::path relative = fs::proximate(mesh, scene.parent_path());
  choice.file = (*relative.begin() == ".." ? mesh : relative).string();
  choice.scale = a.unit == "mm" ? 1e-3 : a.unit == "cm" ? 1e-2 : 1.0;
  choice.scale_given = !a.unit.empty();
  choice.skin = mesh.extension() == ".h5" && store::is_model(mesh.string());
  constexpr double kQuarter = std::numbers::pi / 2;
  if (a.up == "y") choice.rotation_vector = kQuarter * Vec3::UnitX();
  if (a.up == "x") choice.rotation_vector = -kQuarter * Vec3::UnitY();
}

/// Makes a model of a surface, or of tetrahedra that palpate does not read itself, beside the scene.
void make_model(const NewArguments& a, const fs::path& scene, loop::NewScene& choice) {
  const fs::path model = scene.parent_path() / (choice.name + ".h5");
  std::vector<std::string> words = {fs::absolute(a.mesh).string(), "-o", model.string(), "--up", a.up};
  if (!a.unit.empty()) words.insert(words.end(), {"--unit", a.unit});
  if (a.size > 0.0) words.insert(words.end(), {"--scale", "1"});  // any size: the scene scales the model
  if (a.tetrahedra > 0) words.insert(words.end(), {"--tetrahedra", std::to_string(a.tetrahedra)});
  fmt::print("{}: filled with tetrahedra by palpate model; at most 10 minutes\n", a.mesh);
  std::fflush(stdout);
  if (run_silently(kModel, words) != 0) fail("{}: no scene was written; see above", a.mesh);
  choice.file = model.filename().string();
  choice.skin = true;
}

/// Assembles the body alone.
std::unique_ptr<loop::World> body_of(const loop::NewScene& choice, const std::string& scene) {
  return loop::assemble(loop::body_alone(choice, scene));
}

Vec3 size_of(const loop::Body& body) {
  return body.placed.rowwise().maxCoeff() - body.placed.rowwise().minCoeff();
}

/// Rejects a body that no hand touches: a large one unless its unit is given, a small one in any unit.
void refuse_sizes(const NewArguments& a, const loop::World& world) {
  constexpr double kLargest = 5.0, kSmallest = 1e-3;  // [m]
  const double size = size_of(world.bodies.at(0)).maxCoeff();
  if (a.unit.empty() && a.size == 0.0 && size > kLargest)
    fail(
        "{}: the body would be {:.3g} m large: give the unit of its coordinates, --unit mm, cm or m, or the "
        "size of the body, --size-m",
        a.mesh, size);
  if (size < kSmallest)
    fail("{}: the body would be {:.3g} mm large{}: choose a larger unit, --unit m or cm", a.mesh, 1e3 * size,
         a.unit.empty() ? "" : " with --unit " + a.unit);
}

/// Chooses the source of the body and assembles it, in the unit of the file.
std::unique_ptr<loop::World> choose_source(const NewArguments& a, const fs::path& scene,
                                           loop::NewScene& choice) {
  const fs::path file = a.mesh;
  if (!fs::exists(file) && a.mesh.find_first_of("./") == std::string::npos) {
    choice.file = "model:" + a.mesh;
    choice.skin = true;
    scene::Description alone = loop::with_cached_models(loop::body_alone(choice, scene.string()));
    make_missing_models(alone);
    return loop::assemble(alone);
  }
  if (!fs::exists(file)) fail("{}: there is no such file", a.mesh);
  if (has_native_tetrahedra(file) && a.tetrahedra == 0) {
    const loop::NewScene requested = choice;
    use_tetrahedra(a, scene, choice);
    try {
      loop::NewScene any_size = choice;  // refuse_sizes() judges the size
      any_size.scale_given = true;
      return body_of(any_size, scene.string());
    } catch (const Error& error) {
      if (file.extension() != ".msh") throw;
      fmt::print(stderr, "palpate: {}; palpate model tries it\n", error.what());
    }
    choice = requested;
  }
  make_model(a, scene, choice);
  return body_of(choice, scene.string());
}

/// Chooses the source of the body, scales it to the requested size, and assembles it.
std::unique_ptr<loop::World> choose_body(const NewArguments& a, const fs::path& scene,
                                         loop::NewScene& choice) {
  choice.scale_given = a.size > 0.0;
  std::unique_ptr<loop::World> out = choose_source(a, scene, choice);
  if (a.size == 0.0) return out;
  choice.scale *= a.size / size_of(out->bodies.at(0)).maxCoeff();
  choice.scale_given = true;
  return body_of(choice, scene.string());
}

/// Returns a length in millimetres to a micrometre, with four digits.
std::string in_millimetres(double length_m) {
  return fmt::format("{:.4g}", std::round(1e6 * length_m) / 1e3 + 0.0);  // + 0: no -0
}

void print_result(const NewArguments& a, const loop::World& world, const std::string& output) {
  const loop::ToolPlacement& placed = world.placements.at(0);
  const loop::Body& body = world.bodies[0];
  const Vec3 size = size_of(body);
  fmt::print("body: {} x {} x {} mm, {:.3g} kg of {}, {} nodes, {} tetrahedra\n", in_millimetres(size.x()),
             in_millimetres(size.y()), in_millimetres(size.z()), body.masses.sum(), a.material,
             body.report.nodes, body.report.elements);
  if (fs::exists(a.mesh)) {
    if (a.unit.empty() && a.size == 0.0)
      fmt::print(
          "      the file's numbers are taken as metres: --unit mm, or --size-m 0.2, if they are not\n");
    if (a.up == "z") fmt::print("      the file's z axis is up: --up y if the body lies on its side\n");
  }
  fmt::print("tool: radius {} mm, touches the body at ({}, {}, {}) mm\nwritten: {}\n",
             in_millimetres(world.description.tool->radius_m), in_millimetres(placed.touch_m.x()),
             in_millimetres(placed.touch_m.y()), in_millimetres(placed.touch_m.z()), output);
  fmt::print("next: palpate touch {0}, or palpate run {0} --picture --report\n", output);
}

int make_new(const NewArguments& a) {
  loop::NewScene choice;
  choice.name = name_of(a.mesh);
  choice.title = fmt::format("A hand presses a round tool on {}.", fs::path(a.mesh).filename().string());
  choice.command = command_text(a);
  choice.material = a.material;
  choice.tool_radius = a.tool_radius;
  (void)loop::body_alone(choice, "");  // rejects an unknown material before anything is made
  const std::string output = a.output.empty() ? choice.name + ".toml" : a.output;
  if (!output.ends_with(".toml")) fail("-o {}: scenes end in .toml", output);
  if (fs::exists(output) && !a.force)
    fail("{} exists; choose another name with -o, or overwrite it with --force", output);
  store::check_can_write(output);
  const fs::path scene = fs::absolute(output);
  const std::unique_ptr<loop::World> world = choose_body(a, scene, choice);
  refuse_sizes(a, *world);
  const std::string text = loop::new_scene_text(choice, world->bodies.at(0));
  // assembled before it is written: a scene that does not touch is an error here
  const std::unique_ptr<loop::World> ready = loop::assemble(loop::parse(text, scene.string()));
  store::write_atomically(scene.string(), text);
  print_result(a, *ready, output);
  return 0;
}

/// Returns the names of the materials, for the help.
std::string material_names() {
  std::string out;
  for (const loop::ChoiceList& list : loop::registries())
    if (list.what == "materials")
      for (const loop::Choice& choice : list.choices) out += (out.empty() ? "" : ", ") + choice.name;
  return out;
}

}  // namespace

void add_new(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("new", "write a scene that touches a mesh, with a reason beside each number");
  auto arguments = std::make_shared<NewArguments>();
  command
      ->add_option(
          "MESH", arguments->mesh,
          "closed surface (OBJ, STL, PLY, OFF, VTK, VTP), tetrahedra (Gmsh, TetGen, VTK, VTU, Medit), "
          "or a shape that palpate model knows, such as head")
      ->required();
  command->add_option("-o,--output", arguments->output, "the scene; default NAME.toml here")
      ->type_name("SCENE.toml");
  command->add_option("--unit", arguments->unit, "unit of the file's coordinates; default m, if plausible")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"mm", "cm", "m"}));
  command
      ->add_option("--size-m", arguments->size,
                   "largest extent of the body [m], for a file in no unit; instead of --unit")
      ->type_name("M")
      ->check(positive)
      ->excludes("--unit");
  command->add_option("--up", arguments->up, "axis of the file that becomes z, the vertical")
      ->type_name("AXIS")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  command->add_option("--material", arguments->material, material_names() + ": palpate list materials")
      ->type_name("NAME")
      ->capture_default_str();
  command
      ->add_option("--tool-radius-m", arguments->tool_radius,
                   "radius of the round tool [m]; default by the size of body and elements")
      ->type_name("M")
      ->check(positive);
  command
      ->add_option("--tetrahedra", arguments->tetrahedra,
                   "number of tetrahedra that palpate model makes; default about 10,000")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000'000));
  command->add_flag("--force", arguments->force, "overwrite the scene");
  command->footer(R"(Examples:
  palpate new liver.obj --unit mm                    liver.toml and liver.h5, its model
  palpate new spot.obj --up y --size-m 0.2 --material silicone -o cow.toml
  palpate new head --tool-radius-m 0.012
  palpate run liver.toml --picture --report          the force curve

A surface is filled with tetrahedra by palpate model. The tool starts at the touch, presses, holds and
releases. The scene is a start for your own: every number has a comment with its rule.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return make_new(*arguments); };
    invocation.factorises = true;
  });
}

}  // namespace palpate::cli
