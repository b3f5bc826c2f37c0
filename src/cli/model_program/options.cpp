#include "options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <sstream>

#include "cli/help_formatter.h"
#include "cli/option_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "sources.h"
#include "store/provenance.h"

namespace palpate::cli {
namespace {

constexpr const char* kDescription =
    "palpate model: makes a layered model of a closed surface, for mesh = {file = \"MODEL.h5\"} in a scene.  "
    "The surface is repaired, filled with tetrahedra, attached to them as the skin,\nand decomposed into "
    "convex proxies; the quality of each step is measured, and a bad mesh is rejected.  The same input gives "
    "the same file, byte for byte.";

constexpr const char* kExamples = R"(Examples:
  palpate model liver.obj -o liver.h5                         about 10,000 tetrahedra
  palpate model scan.stl --unit mm --up y -o scan.h5          a file in millimetres, whose y axis points up
  palpate model part.ply --tetrahedra 30000 --creases 40      edges that turn by more than 40 degrees stay
                                                              sharp
  palpate model liver.msh --remesh --element-size-m 0.01      the boundary of tetrahedra, remeshed
  palpate model liver.msh --accept-angles                     tetrahedra as they are, however flat
  palpate model liver.obj --picture liver.png                 surface, tetrahedra cut open, skin and proxies
  palpate model leg.obj --region bone=femur.obj -o leg.h5     tetrahedra inside femur.obj become the region
                                                              "bone"
  palpate model head --tetrahedra 1000000 --skin-vertices 1000000
                                                              a shape of the paper at another resolution
  palpate model human --region bone=skeleton -o human.h5      those inside the bones

A scene gives a region its own material: [[body.region]] with name = "bone" and youngs_modulus_pa, ...
Regions of a file of tetrahedra are kept.

The budget is printed first: the model is rejected if it exceeds --limit-s seconds or --points points.
A body larger than 10 m or smaller than 1 mm requires confirmation, or --scale 1.
The result is printed: counts, smallest dihedral angle (at least 8 degrees, 4 if creases are kept), volume
error (at most 1 %), worst aspect ratio, seconds per step, peak memory.  Exit status 0, or 1 if the surface
or the mesh is rejected; the message states where, why, and what to do.  Ctrl-C stops at once, with status
130, and writes nothing.)";

void set_creases(const std::string& text, model::Options& options) {
  if (text == "auto") return;
  options.creases = text == "none" ? model::Creases::kNone : model::Creases::kAngle;
  if (text != "none" && !CLI::detail::lexical_cast(text, options.crease_deg))
    fail("--creases {}: must be auto, none, or an angle in degrees; see `palpate model --help`", text);
}

std::string source_help() {
  const std::string shapes = shape_names();
  return fmt::format("a file ({}){}", model::known_endings(),
                     shapes.empty() ? "" : ", or a shape of the paper: " + shapes);
}

/// Returns NAME=FILE without the folder of the file: a record contains no path of a machine.
std::string without_folder(const std::string& region) {
  const std::size_t at = region.find('=') + 1;
  return region.substr(0, at) + std::filesystem::path(region.substr(at)).filename().string();
}

/// Parses NAME=FILE or NAME=skeleton.
model::RegionSource region_of(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    fail(
        "--region {}: must be NAME=FILE, a closed surface around the region, or NAME=skeleton, for the bones",
        text);
  model::RegionSource out;
  out.name = text.substr(0, at);
  if (const std::string what = text.substr(at + 1); what == "skeleton") {
    out.skeleton = true;
  } else {
    model::Input file = model::input_of_file(what);
    out.surface = file.tets.tets.cols() > 0 ? mesh::boundary(file.tets).surface : std::move(file.surface);
    out.from = std::move(file.from);
  }
  return out;
}

/// Returns the options that affect the model, in canonical order and spelling.
std::string canonical(const CLI::App& app) {
  std::string out;
  for (const char* name : {"--tetrahedra", "--element-size-m", "--skin-vertices", "--scale", "--unit", "--up",
                           "--creases", "--proxies", "--bone-margin-m", "--region", "--remesh",
                           "--accept-angles", "--largest-shell", "--no-wrap"})
    if (const CLI::Option* option = app.get_option(name); option->count() > 0) {
      if (std::string_view(name) == "--region") {
        for (const std::string& given : option->results())
          out += fmt::format("{}--region {}", out.empty() ? "" : " ", without_folder(given));
        continue;
      }
      out += fmt::format("{}{}", out.empty() ? "" : " ", name);
      if (option->get_items_expected() > 0) out += " " + option->results().back();
    }
  return out;
}

/// Returns the rotation that makes an axis of the file the z axis: about x for y, about y for x.
Quat rotation_of(const std::string& up) {
  constexpr double kQuarter = std::numbers::pi / 2;
  if (up == "y") return Quat(Eigen::AngleAxisd(kQuarter, Vec3::UnitX()));
  if (up == "x") return Quat(Eigen::AngleAxisd(-kQuarter, Vec3::UnitY()));
  return Quat::Identity();
}

/// Options that are parsed after CLI11 has read all words.
struct Texts {
  std::string creases = "auto", unit, up = "z";
  std::vector<std::string> regions;
};

void add_shape_options(CLI::App& app, ModelArguments& out, Texts& texts) {
  model::Options& options = out.options;
  app.add_option("SURFACE", out.source, source_help())->required();
  app.add_option("-o,--output", out.output, "the model file; default NAME.h5 here")->type_name("FILE.h5");
  CLI::Option* count =
      app.add_option("--tetrahedra", options.tetrahedra.tetrahedra, "target number, met within 3 %")
          ->type_name("N")
          ->capture_default_str();
  app.add_option("--element-size-m", options.tetrahedra.element_size_m,
                 "instead: target mean edge length [m], met within 3 %")
      ->type_name("M")
      ->check(positive)
      ->excludes(count);
  app.add_option("--skin-vertices", out.skin_vertices,
                 "for a shape: number of skin vertices, met within 1 %; 0: default of the shape")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--scale", options.scale, "multiplies every coordinate: 0.001 for a file in millimetres")
      ->type_name("S")
      ->check(positive)
      ->capture_default_str();
  app.add_option("--unit", texts.unit, "unit of the file's coordinates; same as --scale 0.001, 0.01, 1")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"mm", "cm", "m"}))
      ->excludes("--scale");
  app.add_option("--up", texts.up, "axis of the file that becomes z, the vertical")
      ->type_name("AXIS")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  app.add_option("--creases", texts.creases,
                 "edges to keep sharp: auto, none, or those that turn by more than this angle [degrees]")
      ->type_name("WHICH")
      ->capture_default_str();
  app.add_option("--proxies", options.proxies, "number of convex hulls; 0: none")
      ->type_name("N")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  app.add_option("--bone-margin-m", options.bone_margin_m,
                 "nodes inside a bone or closer to it than this distance belong to it [m]")
      ->type_name("M")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--region", texts.regions,
                 "tetrahedra with their centre inside the closed surface FILE become the region NAME; with "
                 "skeleton instead of FILE: those inside the bones.  May be repeated; the last takes "
                 "precedence")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
}

void add_repair_options(CLI::App& app, ModelArguments& out) {
  model::Options& options = out.options;
  app.add_flag("--remesh", options.remesh,
               "for a file of tetrahedra: remesh the volume inside their boundary");
  app.add_flag("--accept-angles", options.accept_angles,
               "for a file of tetrahedra: accept any dihedral angles, and print the cost");
  app.add_flag("--largest-shell", options.repair.largest_shell,
               "for several bodies in one file: keep the largest");
  app.add_flag_callback(
      "--no-wrap", [&options] { options.repair.wrap = false; },
      "reject a surface that cannot be repaired locally, instead of wrapping it");
  app.add_option("--limit-s", options.tetrahedra.limits.seconds, "time limit of all steps together [s]")
      ->type_name("S")
      ->check(positive)
      ->capture_default_str();
  app.add_option("--points", options.tetrahedra.limits.points, "maximum number of points made by refinement")
      ->type_name("N")
      ->check(CLI::Range(100, 100'000'000))
      ->capture_default_str();
  app.add_option("--picture", out.picture, "draw the steps: surface, tetrahedra cut open, skin, proxies")
      ->type_name("FILE.png");
  app.add_flag_callback(
      "--beyond-memory", [] { ::setenv("PALPATE_BEYOND_MEMORY", "1", 1); },
      "continue even if the model probably needs more memory than is available");
  app.add_flag("-q,--quiet", out.quiet, "only errors");
  app.add_flag("-v,--verbose", out.verbose, "also details");
}

/// Sets what follows from several options together.
void settle(const CLI::App& app, const Texts& texts, ModelArguments& out) {
  model::Options& options = out.options;
  set_creases(texts.creases, options);
  for (const std::string& region : texts.regions) options.regions.push_back(region_of(region));
  out.counted = app.count("--tetrahedra") > 0;
  out.scaled = app.count("--scale") + app.count("--unit") > 0;
  if (!texts.unit.empty()) options.scale = texts.unit == "mm" ? 1e-3 : texts.unit == "cm" ? 1e-2 : 1.0;
  options.rotation = rotation_of(texts.up);
  if (out.counted || options.tetrahedra.element_size_m > 0) options.remesh = true;
  if (options.remesh && options.accept_angles)
    fail(
        "--accept-angles keeps the tetrahedra of the file, but --remesh, --tetrahedra and --element-size-m "
        "replace them; remove one of the options");
  options.tetrahedra.at_least = !out.counted;
  out.as_given = canonical(app);
  out.given = true;
}

}  // namespace

ModelArguments parse_model(int argc, char** argv) {
  ModelArguments out;
  Texts texts;
  CLI::App app(kDescription, "palpate model");
  app.formatter(std::make_shared<HelpFormatter>());
  app.footer(kExamples);
  app.set_version_flag("--version",
                       [] { return fmt::format("palpate model {}", store::provenance().version); });
  add_shape_options(app, out, texts);
  add_repair_options(app, out);
  if (argc == 1) {
    fmt::print("{}", app.help());
    return out;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    app.exit(asked, text, text);
    fmt::print("{}", text.str());
    return out;
  } catch (const CLI::ParseError& error) { fail("{}; see `palpate model --help`", error.what()); }
  settle(app, texts, out);
  return out;
}

}  // namespace palpate::cli
