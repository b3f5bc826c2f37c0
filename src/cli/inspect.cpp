#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/program.h"
#include "cli/scene_of.h"
#include "commands.h"
#include "core/clock.h"
#include "loop/attached_nodes.h"
#include "loop/memory.h"
#include "loop/summary.h"
#include "palpate/loop/run.h"
#include "placing_tables.h"
#include "report/table.h"
#include "scene_options.h"
#include "session/start_picture.h"

namespace palpate::cli {
namespace {

struct InspectArguments {
  SceneArguments scene;
  bool all = false;     ///< Also parts, element quality, bounding boxes, and costs.
  std::string picture;  ///< PNG file; empty: none
};

using Rows = std::vector<std::vector<std::string>>;

void print_needs(const scene::Description& description) {
  Rows rows;
  for (const scene::Need& need : loop::needs(description))
    rows.push_back({need.part, need.used ? "in use" : "left out", need.why});
  fmt::print("{}\n", report::format_table({"part", "", "why"}, rows));
}

std::string size_text(const Points& points) {
  const Vec3 size = 1e3 * (points.rowwise().maxCoeff() - points.rowwise().minCoeff());
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", size.x(), size.y(), size.z());
}

/// Prints the answer to the first questions about a body: how large, how heavy, held where.
void print_short_bodies(const loop::World& world) {
  Rows rows;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const loop::Body& body = world.bodies[i];
    rows.push_back({body.name, std::to_string(body.report.nodes), std::to_string(body.report.elements),
                    std::to_string(loop::driven_nodes(world, i).size()),
                    fmt::format("{:.3g}", body.masses.sum()), size_text(body.surface_points(body.placed))});
  }
  if (!rows.empty())
    fmt::print("{}\n", report::format_table(
                           {"body", "nodes", "tetrahedra", "held nodes", "mass [kg]", "size [mm]"}, rows));
}

void print_bodies(const loop::World& world) {
  Rows rows;
  for (const loop::Body& body : world.bodies)
    rows.push_back({body.name, std::to_string(body.report.nodes), std::to_string(body.report.elements),
                    std::to_string(body.boundary.surface.faces.cols()),
                    fmt::format("{:.3g}", body.report.volume), fmt::format("{:.3g}", body.masses.sum()),
                    fmt::format("{:.3g} to {:.3g}", body.report.smallest_edge, body.report.largest_edge),
                    fmt::format("{:.1f}", body.report.smallest_dihedral_deg),
                    std::to_string(body.report.flipped)});
  if (!rows.empty())
    fmt::print("{}\n", report::format_table({"body", "nodes", "tetrahedra", "surface faces", "volume [m^3]",
                                             "mass [kg]", "edges [m]", "least dihedral [deg]", "mended"},
                                            rows));
}

/// Prints the regions of each body with their materials, and the elements in no region.
void print_regions(const loop::World& world) {
  Rows rows;
  for (const loop::Body& body : world.bodies) {
    if (body.regions.empty()) continue;
    const auto add = [&](const std::string& name, int tetrahedra, double volume, int material) {
      const fem::Material& m = body.term->materials()[static_cast<std::size_t>(material)];
      rows.push_back({body.name, name, std::to_string(tetrahedra), fmt::format("{:.3g}", volume),
                      fmt::format("{:.3g}", m.density * volume), material > 0 ? "own" : "of the body",
                      fmt::format("{:.4g}", m.youngs_modulus), fmt::format("{:g}", m.poissons_ratio),
                      fmt::format("{:g}", m.density), fmt::format("{:g}", m.mass_damping),
                      fmt::format("{:g}", m.stiffness_damping)});
    };
    int left = body.report.elements;
    double volume = body.report.volume;
    for (const loop::Region& region : body.regions) {
      add(region.name, static_cast<int>(region.tets.size()), region.volume, region.material);
      left -= static_cast<int>(region.tets.size());
      volume -= region.volume;
    }
    if (left > 0) add("(the rest)", left, volume, 0);
  }
  if (!rows.empty())
    fmt::print("{}\n",
               report::format_table({"body", "region", "tetrahedra", "volume [m^3]", "mass [kg]", "material",
                                     "E [Pa]", "nu", "rho [kg/m^3]", "alpha [1/s]", "beta [s]"},
                                    rows));
}

void print_bones(const loop::World& world) {
  Rows rows;
  for (const loop::Bone& bone : world.bones) {
    const Pose pose = world.bone_pose(bone);
    const Vec3 rotation = rotation_vector(pose.rotation);
    rows.push_back({bone.name,
                    bone.path   ? "prescribed motion"
                    : bone.tree ? "on a joint"
                                : "free",
                    bone.path ? "-" : fmt::format("{:.3g}", bone.mass), std::to_string(bone.dofs.size() / 3),
                    fmt::format("{:.3g} {:.3g} {:.3g}", pose.translation.x(), pose.translation.y(),
                                pose.translation.z()),
                    fmt::format("{:.3g} {:.3g} {:.3g}", rotation.x(), rotation.y(), rotation.z())});
  }
  if (!rows.empty())
    fmt::print("{}\n",
               report::format_table(
                   {"bone", "", "mass [kg]", "nodes", "position [m]", "rotation vector [rad]"}, rows));
}

std::size_t free_unknowns(const loop::World& world) {
  return static_cast<std::size_t>(world.state.u().size()) - world.system.driven_dofs().size();
}

double estimated_mib(const loop::World& world) {
  std::vector<loop::MeshCounts> counts;
  for (const loop::Body& body : world.bodies) counts.push_back(loop::counts_of(body));
  return loop::estimate_memory(world.description, counts).total() / 1048576.0;
}

/// Prints the size of the run in one line.
void print_short_system(const loop::World& world) {
  if (world.stepper) fmt::print("{} unknowns, {}; ", free_unknowns(world), world.stepper->name());
  fmt::print("{:g} s in periods of {:g} ms; a run needs about {:.0f} MiB\n", world.description.duration_s,
             1e3 * loop::period_of(world.description), estimated_mib(world));
}

void print_system(loop::World& world, double assemble_s, double memory_mib) {
  Rows rows;
  const auto add = [&](const std::string& name, const std::string& value) { rows.push_back({name, value}); };
  if (world.stepper) {
    dynamics::BorderedMatrix A;
    world.system.step_matrix(world.state.view(), 1.0, 0.0, 0.0, A);
    add("unknowns (velocities)", std::to_string(free_unknowns(world)));
    add("held or driven directions", std::to_string(world.system.driven_dofs().size()));
    add("blocks of the step matrix (3 x 3)", std::to_string(A.body.slot_count()));
    if (A.border_size() > 0) add("border width of the step matrix", std::to_string(A.border_size()));
    add("integrator", world.stepper->name());
  }
  add("period of the loop [s]", fmt::format("{:g}", loop::period_of(world.description)));
  add("simulated time [s]", fmt::format("{:g}", world.description.duration_s));
  add("time to assemble [s]", fmt::format("{:.3f}", assemble_s));
  add("memory of the assembled scene [MiB]", fmt::format("{:.1f}", memory_mib));
  add("estimated memory of a run [MiB]", fmt::format("{:.0f}", estimated_mib(world)));
  fmt::print("{}", report::format_table({"system", ""}, rows));
}

int inspect(const InspectArguments& arguments) {
  if (!arguments.picture.empty()) session::check_start_picture(arguments.picture);
  const scene::Description description = scene_of(arguments.scene);
  fmt::print("{}: {}\n\n", description.path, description.name);
  if (arguments.all) print_needs(description);
  const double memory = resident_memory_mib(), start = wall_seconds();
  const std::unique_ptr<loop::World> world = loop::assemble(description);
  const double seconds = wall_seconds() - start, used = resident_memory_mib() - memory;
  if (arguments.all) {
    print_bodies(*world);
    print_boxes(*world);
  } else {
    print_short_bodies(*world);
  }
  print_regions(*world);
  print_bones(*world);
  print_clearances(*world, arguments.all);
  if (arguments.all)
    print_system(*world, seconds, used);
  else
    print_short_system(*world);
  if (!arguments.picture.empty()) {
    session::draw_start(*world, arguments.picture);
    fmt::print("picture: {}\n", arguments.picture);
  }
  if (!arguments.all) fmt::print("--all adds the parts in use, bounding boxes, element quality and costs\n");
  return 0;
}

}  // namespace

void add_inspect(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(
      "inspect", "check a scene before it runs: sizes, masses, held nodes, gaps at the start; draw it");
  auto arguments = std::make_shared<InspectArguments>();
  add_scene(*command, arguments->scene, true);
  command->add_flag("--all", arguments->all,
                    "also the parts in use and left out, bounding boxes, element quality, costs");
  command
      ->add_option("--picture", arguments->picture,
                   "draw the scene at its start: axes, sizes of the bodies, attached nodes")
      ->type_name("FILE.png");
  command->footer(R"(Examples:
  palpate inspect press-ball
  palpate inspect press-ball --all                    parts in use, element quality, memory
  palpate inspect press-ball --picture start.png      what touches what, held nodes, sizes
  palpate inspect my.toml --set body.0.mesh.element_size_m=0.005      size with finer elements)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return inspect(*arguments); }; });
}

}  // namespace palpate::cli
