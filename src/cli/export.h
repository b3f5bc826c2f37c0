#pragma once
#include <optional>
#include <string>

namespace palpate::cli {

/// Arguments of `palpate export`.
struct ExportArguments {
  std::string run;             ///< Folder of a run, or a file of states
  std::string to;              ///< "vtu", "obj", "ply", "csv" or "gltf"
  std::string folder;          ///< Output folder; empty: a folder named after the format, next to the states
  std::string body;            ///< Body, tool or bone to export; empty: all
  std::optional<double> at_s;  ///< Exports only the state nearest to this time [s]
  std::optional<int> step;     ///< Exports only this state
  int every = 1;               ///< Exports every Nth state
  bool no_skin = false;        ///< Exports surfaces of the tetrahedra instead of skins
};

/// Writes the states of a run to files for other programs.  @return the exit status
int export_run(const ExportArguments& arguments);

}  // namespace palpate::cli
