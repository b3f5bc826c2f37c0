#include <CLI/CLI.hpp>
#include <memory>

#include "cli/program.h"
#include "commands.h"
#include "export.h"

namespace palpate::cli {

void add_export(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("export", "write a completed run as files for other programs");
  auto arguments = std::make_shared<ExportArguments>();
  command->add_option("run", arguments->run, "folder of a run, which contains run.vtkhdf; or such a file")
      ->required()
      ->type_name("DIR");
  command->add_option("--to", arguments->to, "vtu, obj, ply, csv or gltf")->required()->type_name("FORMAT");
  command->add_option("-o,--output", arguments->folder, "folder for the files; default DIR/FORMAT")
      ->type_name("DIR");
  command->add_option("--body", arguments->body, "only this body, tool or bone")->type_name("NAME");
  CLI::Option* at =
      command->add_option("--at", arguments->at_s, "only the recorded state nearest to this time [s]")
          ->type_name("SECONDS");
  CLI::Option* step = command->add_option("--step", arguments->step, "only this recorded state, from 0")
                          ->type_name("N")
                          ->excludes(at);
  command->add_option("--every", arguments->every, "every Nth recorded state, beginning with the first")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000000))
      ->excludes(at)
      ->excludes(step);
  command->add_flag("--no-skin", arguments->no_skin,
                    "obj, ply, gltf: the surfaces of the tetrahedra instead of skins; the run file suffices");
  command->footer(R"(Examples:
  palpate export out/press-ball --to vtu                     run_0000.vtu ..., and run.pvd for ParaView
  palpate export out/press-ball --to ply --at 0.12           the surface, coloured by displacement
  palpate export out/press-ball --to obj --body ball --every 10 -o shapes
  palpate export out/press-ball --to csv                     nodes.csv, and the tables of the run
  palpate export out/two-heads --to gltf                     run.glb, an animation for browsers

Writes every recorded state, or those selected by --at, --step or --every.  Units: metres, seconds, pascals.
  vtu   tetrahedra and tools with displacement, velocity and stress
  obj   skins, or the surfaces of tetrahedra without skins, and tools: one file per state
  ply   as obj, with displacement, stress and colours, one range of colours for all states
  csv   one row per node and state
  gltf  the surfaces as one animated .glb of at most 100 states, thinned evenly if the run has more
Files get their final names once all are complete; after an error or Ctrl-C no file remains.)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return export_run(*arguments); }; });
}

}  // namespace palpate::cli
